#pragma once

#include <algorithm>
#include <span>
#include <utility>
#include <vector>

#include "model/geometry/vec2.h"

namespace lcpbench {

/// An axis-parallel box, lower <= upper in both coordinates [m]; its boundary belongs to it.
struct BoundingBox {
  Vec2 lower;
  Vec2 upper;
};

inline bool Overlap(const BoundingBox& p, const BoundingBox& q) {
  return p.lower.x <= q.upper.x && q.lower.x <= p.upper.x && p.lower.y <= q.upper.y && q.lower.y <= p.upper.y;
}

inline BoundingBox Union(const BoundingBox& p, const BoundingBox& q) {
  return {{std::min(p.lower.x, q.lower.x), std::min(p.lower.y, q.lower.y)},
          {std::max(p.upper.x, q.upper.x), std::max(p.upper.y, q.upper.y)}};
}

/// The box moved by `shift` and widened by `margin` on every side.
inline BoundingBox Inflated(const BoundingBox& box, Vec2 shift, double margin) {
  const Vec2 around{margin, margin};
  return {box.lower + shift - around, box.upper + shift + around};
}

/// All pairs of overlapping (or touching) boxes: the candidates for contacts between bodies.
/// A sorted sweep [Baraff 1997] along the axis along which the boxes are spread the widest in terms of their sizes. The
/// boxes that the sweep is passing through lie in strips across the other axis, about one box wide, so that a box is
/// compared with those of its own strips only. Sizes and spreads are quantiles, which a few huge boxes do not move.
/// Exact: no pair missed, none twice. O(n log n + pairs) for boxes of mostly similar size, wherever they are and with a
/// few huge ones among them; O(n^2) only if many boxes are much longer than most.
/// @param boxes  finite
/// @return pairs (i, j) of indices, i < j, in lexicographic order: deterministic
/// @throws InputError naming the first box that is not finite or has lower > upper
std::vector<std::pair<int, int>> FindOverlappingPairs(std::span<const BoundingBox> boxes);

}  // namespace lcpbench
