#pragma once

#include <span>
#include <string>
#include <vector>

#include "model/contact/body.h"
#include "model/contact/system.h"
#include "support/input_error.h"

namespace lcpbench {

// Paths with ends (Constraint::path): where a path joint's point is on its path, and what becomes of it there.

/// A point this far beyond the end of a piece, as a part of the piece, is still on it.
inline constexpr double kPathSlack = 1e-9;
/// A path may turn by this where two pieces join [rad]; more is a kink. A point that passes at the speed v is made to
/// turn with the path, and loses 1e-6 v at most.
inline constexpr double kSmoothJoin = 1e-6;

/// A point has come to an end of its path, or to a kink of it. what() names the joint's bodies and the place.
class PathEnd : public InputError {
 public:
  using InputError::InputError;
};

/// Where the point of a path joint is on its piece, by the closest point.
struct PlaceOnPiece {
  double s = 0;      ///< its parameter, of an angle the one nearest to the joint's start value
  double along = 0;  ///< 0 where the piece begins, 1 where it ends; the point is beyond an end outside 0..1
  double gap = 0;    ///< signed distance from the piece's whole curve [m]
};
/// @param joint  a path joint with a path
/// @throws InputError as FindClosestPoints, and far beyond the end of a Bezier curve
PlaceOnPiece FindPlaceOnPiece(const Constraint& joint, std::span<const Body> bodies);
/// Positive while the point is on its piece, 0 kPathSlack beyond either end, in parts of the piece.
double LeftOnPiece(const PlaceOnPiece& place);

/// Puts the joint on the nearest piece of its path, with the start value there if it has no other.  O(pieces)
void PutOnPath(std::span<const Body> bodies, Constraint* joint);

/// Follows the point along its path to where it is now: piece, feature and start value.
/// @throws PathEnd where the path ends or has a kink before; InputError as FindPlaceOnPiece
void FollowPath(std::span<const Body> bodies, Constraint* joint);

/// Whether a path comes back to its begin: then it has no ends there.
bool IsClosed(const std::vector<OutlineEdge>& path);

/// What a constraint's path must satisfy, in words, where it does not; else empty: only a path joint has one; each
/// piece is valid and begins where the one before ends; `piece` is one of them, and the joint's edge its curve.
std::string WhyInvalidPath(const Constraint& constraint);

}  // namespace lcpbench
