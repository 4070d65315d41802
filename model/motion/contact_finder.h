#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "model/contact/assembly.h"
#include "model/contact/system.h"
#include "model/contact/world.h"
#include "model/detection/detection.h"
#include "model/detection/overlap.h"
#include "model/shape/outline.h"

namespace lcpbench {

/// How large a body is, from its outline's spans in its body frame; 0 without any.
struct Extent {
  double radius = 0;  ///< of the circle about the centre of mass that holds the box around them [m]
  double width = 0;   ///< the smaller side of that box [m]
};

/// Finds the contacts of a world's bodies again and again as they move, and where they overlap: keeps what does not
/// change.
class ContactFinder {
 public:
  /// Chains every body's outline (OutlineOf) and excludes pairs that share a joint.  O(edges + joints log joints)
  /// @param check  DetectionOptions::check of every search; not owned
  explicit ContactFinder(const World& world, const StopCheck* check = nullptr);

  /// The contacts of the same bodies at other positions, as DetectContacts.
  /// @param tolerance, penetration  as DetectionOptions [m]
  std::vector<Constraint> Find(std::span<const Body> bodies, double tolerance, double penetration) const;

  /// Whether bodies i < j share a joint.
  bool AreJoined(int i, int j) const;

  /// The extents of all bodies.
  const std::vector<Extent>& extents() const { return extents_; }
  /// The least width > 0 of a movable body; 0 if no movable body has an outline.
  double least_width() const { return least_width_; }

  /// Every pair's overlap, as OverlapFinder::Find; without contacts only those deeper than a part of the least width.
  std::vector<BodyOverlap> FindOverlaps(std::span<const Body> bodies, std::span<const Constraint> contacts,
                                        double limit) const;
  /// Those that contacts down to the depth `treated` [m] do not undo: deeper ones, and those without a contact that
  /// parts the bodies there, as of coincident ones.
  /// @param least  shallower overlaps need not be found [m]
  std::vector<BodyOverlap> FindUntreatable(std::span<const Body> bodies, double least, double treated) const;
  /// OverlapFinder::DepthAt of a contact's points, at most -d; where that is next to nothing, -d [m].
  double DepthAt(std::span<const Body> bodies, const Constraint& contact, Vec2 p1, Vec2 p2, double d) const;

  /// @param level  the motion's, by its name
  /// @throws InputError naming bodies, edges and depth where two bodies overlap by more than `limit` [m], what a motion
  ///         at that level can treat
  void RequireShallow(const World& world, std::string_view level, double limit) const;

 private:
  bool Undoes(std::span<const Body> bodies, const Constraint& contact, const BodyOverlap& overlap) const;

  std::vector<Outline> outlines_;
  std::vector<std::pair<int, int>> joined_;
  std::vector<Extent> extents_;
  double least_width_ = 0;
  std::unique_ptr<const OverlapFinder> overlaps_;  // none where no movable body has an outline
  const StopCheck* check_;
};

/// "bodies 'floor' (edge 0) and 'ball' (edge 2) overlap by 1.3e-05 m"
std::string OverlapText(const World& world, const BodyOverlap& overlap);

/// The contacts of an instant without ghosts: contacts deeper than `doubtful` [m] of two bodies that have a shallower
/// one which lies behind both surfaces of the deeper and faces another way. A corner a little below a face may lie deep
/// below the next one.
/// @param rows  those of the assembled system, contacts after all other constraints
std::vector<Constraint> WithoutGhosts(const ContactSystem& system, const std::vector<RowInfo>& rows, double doubtful);

/// Moves the start values s1, s2 of path joints on general curves to where the joints are at the bodies' present
/// positions, so that the next search begins there: a search without a start value looks through the whole curve, and
/// may find another of its stationary points. Those on paths are followed along them (FollowPath). Other constraints
/// are left as they are.
/// @throws InputError as FindClosestPoints, PathEnd
void FollowPathJoints(std::span<const Body> bodies, std::span<Constraint> constraints);

/// Recognises the rows of one instant in the next: the same constraint type and axis between the same features of the
/// same bodies. Where one pair of features touches at several places (two general curves), rows go to those whose
/// normals have turned least. One object follows one motion.
class RowMatching {
 public:
  /// For every row of the instant the index that it had in the instant given before, or nothing: it was not there.
  /// O(rows) expected; k places of one pair of features cost O(k^2).
  /// @param system  the instant whose assembly `rows` is (AssembledLcp::rows)
  std::vector<std::optional<int>> Follow(const ContactSystem& system, const std::vector<RowInfo>& rows);

 private:
  std::vector<std::vector<double>> keys_;  // of the instant before, by row
  std::vector<Vec2> normals_;
};

}  // namespace lcpbench
