#pragma once

#include <vector>

#include "solvers/exact/rational.h"

namespace lcpbench {

/// Rationals of one point, direction or row.
using RationalVector = std::vector<Rational>;

/// normal.x + constant >= 0.
struct Halfspace {
  RationalVector normal;
  Rational constant;
};

/// The convex hull of `vertices`, plus nonnegative combinations of `rays`, plus all combinations of `lines`: the least
/// such lists. Where there are lines, a vertex stands for one point of a least face. No vertices: the empty set.
struct Polyhedron {
  std::vector<RationalVector> vertices, rays, lines;
  bool is_empty() const { return vertices.empty(); }
};

/// The points of all half-spaces, in `dimension` coordinates, by the double description method [Motzkin, Raiffa,
/// Thompson, Thrall 1953]. Exponential in the dimension at worst; here it is that of self-stresses, a few.
/// @param halfspaces  at most kMostHalfspaces; std::logic_error beyond
Polyhedron Intersect(Index dimension, const std::vector<Halfspace>& halfspaces);
inline constexpr Index kMostHalfspaces = 255;

}  // namespace lcpbench
