#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "solvers/lcp/step_rows.h"
#include "solvers/linear_algebra/sides_of_bodies.h"

namespace lcpbench {

/// Orders one island so that A has a narrow profile: bodies that can move are numbered breadth-first from a body far
/// from the first one [Cuthill, McKee 1969], rows go by the later one of their bodies. Only Reserve allocates.
class BodyOrder {
 public:
  /// For islands of up to `max_rows` rows, of steps with up to `max_bodies` bodies.
  void Reserve(Index max_rows, Index max_bodies);
  /// False if a row acts on no body that can move.  O(n p)
  /// @param part   the island's rows
  /// @param order  the same in their order
  bool Find(const StepRows& all, std::span<const std::int32_t> part, std::vector<Index>* order);

  /// By number, the body of the step.
  std::span<const std::int32_t> bodies() const { return {body_.data(), static_cast<std::size_t>(count_)}; }
  /// By body of the step its number; -1: cannot move, or no row of the island names it.
  const std::int32_t* number() const { return number_.data(); }

 private:
  bool NumberBodies(const StepRows& all, std::span<const std::int32_t> part);
  std::int32_t body_of_side(std::int32_t side) const {
    return (side % 2 == 0 ? first_ : second_)[static_cast<std::size_t>(side / 2)];
  }
  void OrderBodies();
  void OrderRows(std::span<const std::int32_t> part, std::vector<Index>* order);

  Index n_ = 0;      // rows of the island
  Index count_ = 0;  // bodies of the island that can move
  std::vector<std::int32_t> number_, body_;
  // By row of `part` its bodies, as numbered when rows name them first; by that number the place in the order.
  std::vector<std::int32_t> first_, second_, place_;
  SidesOfBodies sides_;                  // by that number, rows of `part`
  std::vector<std::int32_t> queue_;      // of the breadth-first search
  std::vector<std::int32_t> order_end_;  // by place, the end of its rows so far
};

}  // namespace lcpbench
