#pragma once

#include <algorithm>
#include <cstddef>
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
/// @throws InputError naming the first box that is not finite or has lower > upper, and for more than kMostPairs pairs
std::vector<std::pair<int, int>> FindOverlappingPairs(std::span<const BoundingBox> boxes);
inline constexpr std::size_t kMostPairs = 50'000'000;  ///< 400 MB

/// A binary tree over bounds in their given order, for pieces along a curve: near in order is near in the plane.
template <class Bound>
class RunTree {
 public:
  /// @param join  join(a, b) bounds what a and b bound.  O(n)
  template <class Join>
  RunTree(std::span<const Bound> bounds, const Join& join) : count_(bounds.size()) {
    if (count_ > 0) Build(bounds, join);
  }

  /// Calls enter(bound, first, count) for runs of bounds, the whole one first, and for the halves of those for which it
  /// returns true; single bounds come in their order.
  template <class Enter>
  void Visit(const Enter& enter) const {
    if (count_ > 0) Visit(enter, 0, 0, count_);
  }

 private:
  // A node's first half follows it, then its second half: 2 n - 1 nodes of n bounds.
  static std::size_t SecondHalf(std::size_t node, std::size_t count) { return node + 2 * (count / 2); }

  template <class Join>
  void Build(std::span<const Bound> bounds, const Join& join) {
    const std::size_t node = nodes_.size();
    const std::size_t count = bounds.size();
    nodes_.push_back(bounds.front());
    if (count == 1) return;
    Build(bounds.first(count / 2), join);
    Build(bounds.subspan(count / 2), join);
    nodes_[node] = join(nodes_[node + 1], nodes_[SecondHalf(node, count)]);
  }

  template <class Enter>
  void Visit(const Enter& enter, std::size_t node, std::size_t first, std::size_t count) const {
    if (!enter(nodes_[node], first, count) || count == 1) return;
    Visit(enter, node + 1, first, count / 2);
    Visit(enter, SecondHalf(node, count), first + count / 2, count - count / 2);
  }

  std::size_t count_;
  std::vector<Bound> nodes_;
};

}  // namespace lcpbench
