#pragma once

#include <optional>
#include <string>
#include <vector>

#include "model/contact/body.h"
#include "model/geometry/feature.h"

namespace lcpbench {

/// What a constraint demands, and how many rows it has.
enum class ConstraintType {
  kContact,    ///< unilateral: gap >= 0, f >= 0; one row
  kPathJoint,  ///< bilateral: a vertex kept on an edge; one row
  kPin,        ///< bilateral: two vertices kept together; two rows, world x then y (and a torque's)
  kRod,        ///< bilateral: two vertices kept at distance `length`, d = |p1 - p2| - length; one row
  kRope,       ///< unilateral: two vertices at most `length` apart, d = length - |p1 - p2|, f >= 0 pulls; one row
};

/// A constraint between two features of two bodies (indices into ContactSystem::bodies, different).
/// The normal points from body 2 to body 1, whichever body owns the edge that defines it. [docs/model.md sections 1, 2]
struct Constraint {
  ConstraintType type = ConstraintType::kContact;
  int body1 = 0;
  int body2 = 1;
  Feature feature1 = {};
  Feature feature2 = {};
  /// Start values for the closest-point search (curve parameters); absent for vertices, and where none is known.
  std::optional<double> s1 = {};
  std::optional<double> s2 = {};
  /// Without start values, the local minimum whose gap is closest to this is meant [m].
  double nominal_gap = 0;
  /// Length of a rod or rope [m], > 0; ignored by all others.
  double length = 0;
  /// The path of a path joint, where it has ends: pieces of edges of the body that owns it, each beginning where the
  /// one before ends (path.h). Motions go on from piece to piece where they join smoothly. Empty: the edge stands for
  /// all of its line, circle or curve.
  std::vector<OutlineEdge> path = {};
  std::size_t piece = 0;  ///< of `path`, on which the joint is now: its edge is that piece's curve
  /// Coefficient of Coulomb friction of a contact, in [0, kMostFriction]; ignored by all others.
  double friction = 0;
  /// The largest torque [N m], >= 0, with which a pin drives omega1 - omega2 to `speed` [rad/s]: a motor, or dry
  /// friction of the joint where the speed is 0. It adds one row.
  double torque_limit = 0;
  double speed = 0;
  /// +-1: it is known that the pin turns faster or slower than that, so its torque on body 1 is -slip torque_limit.
  signed char slip = 0;
  bool operator==(const Constraint&) const = default;
};

/// Bodies and the constraints between them at one instant: what assembly turns into an LCP.
struct ContactSystem {
  std::string name;
  std::vector<Body> bodies;
  std::vector<Constraint> constraints;
};

}  // namespace lcpbench
