#pragma once

#include <span>
#include <vector>

#include "model/contact/body.h"
#include "model/contact/system.h"
#include "model/contact/world.h"
#include "model/detection/normal_span.h"
#include "model/motion/contact_finder.h"

namespace lcpbench {

/// Where the two features of a unilateral constraint are closest, and how fast that changes. World frame.
struct TouchPoint {
  Vec2 n;   ///< unit normal from body 2 to body 1
  Vec2 R1;  ///< arms from the centres of mass to the closest points [m]
  Vec2 R2;
  double d = 0;      ///< gap [m]; of a rope, length - distance
  double d_dot = 0;  ///< [m/s]
};

/// A contact or rope, and where it is.
struct TouchingConstraint {
  Constraint constraint;
  TouchPoint touch;
};

/// Whether the constraint stands for one of the known contacts: the same features of the same bodies, or closest points
/// and normals that agree to 1e-7 (an edge and its neighbour at a smooth join). Curves can have several contacts with
/// the same features, 1e-3 of the arms from each other at least.
bool IsKnown(const TouchingConstraint& contact, const std::vector<TouchingConstraint>& known);

/// The unilateral constraints between moving bodies: contacts found from outlines, and ropes that may become taut.
/// Features are meant locally (feature.h), so that a contact can be followed beyond the end of its edges: as a gap that
/// is smooth in time. Whether the bodies really are closest there is another question, which LiesOn answers.
class ContactWatch {
 public:
  /// @param world   its bodies' outlines are kept, positions are given later
  /// @param finder  of that world; must outlive this
  ContactWatch(const World& world, const ContactFinder& finder);

  /// The closest points of a constraint's features; general curves from its start values, which are moved to the points
  /// found.  @throws InputError where they are singular or not found
  static TouchPoint Evaluate(std::span<const Body> bodies, Constraint* constraint);

  /// Whether the closest points lie on the outlines: feet on their edges, normals in their corners' cones.
  bool LiesOn(std::span<const Body> bodies, const Constraint& constraint, const TouchPoint& touch) const;

  /// All contacts and ropes with -range() <= d <= range(), as DetectContacts.
  std::vector<Constraint> Find(std::span<const Body> bodies) const;

  /// Gaps and overlaps that are looked for [m]: a quarter of the thinnest movable body, ten contact tolerances at
  /// least.
  double range() const { return range_; }

  /// The longest step of at most `step` [s] in which no two bodies that can touch approach each other by more than
  /// `stride` [m], or, where that is longer, by the distance between the circles around them. A body's surface moves by
  /// at most (|v| + r |omega|) t + (|a| + r |alpha|) t^2 / 2.  O(bodies^2), a few operations a pair.
  /// @param accelerations  three a body
  double LongestStep(std::span<const Body> bodies, std::span<const double> accelerations, double stride,
                     double step) const;

 private:
  const ContactFinder& finder_;
  std::vector<std::vector<NormalSpan>> spans_;  // of every body, body frame
  std::vector<Extent> extents_;                 // with the ends of ropes
  std::vector<Constraint> ropes_;
  double range_ = 1;
  // How far a normal may leave a corner's cone [rad] before a contact at that corner ends: two straight edges that
  // lie flush within this keep both their contacts.
  double flush_angle_ = 0;
};

}  // namespace lcpbench
