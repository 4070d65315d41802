#pragma once

#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "model/contact/assembly.h"
#include "model/contact/system.h"
#include "model/contact/world.h"
#include "model/detection/detection.h"
#include "model/detection/normal_span.h"
#include "model/shape/outline.h"

namespace lcpbench {

/// Finds the contacts of a world's bodies again and again as they move: keeps what does not change.
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

 private:
  std::vector<Outline> outlines_;
  std::vector<std::pair<int, int>> joined_;
  const StopCheck* check_;
};

/// How large a body is, from its outline's spans in its body frame; 0 without any.
struct Extent {
  double radius = 0;  ///< of the circle about the centre of mass that holds the box around them [m]
  double width = 0;   ///< the smaller side of that box [m]
};
Extent ExtentOf(std::span<const NormalSpan> spans);
/// The least width > 0 of a movable body; 0 if no movable body has an outline.
double LeastWidth(const World& world, std::span<const Extent> extents);

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
