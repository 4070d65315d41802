#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "solvers/lcp/step_rows.h"

namespace lcpbench {

/// The parts of a step's rows that share no body that can move: each may be solved by itself. Only Reserve allocates.
class RowIslands {
 public:
  void Reserve(Index max_rows, Index max_bodies);
  /// Islands in the order of their first rows, by union-find over bodies.  O(n + islands), almost: bodies that no row
  /// names are not looked at.
  void Find(const StepRows& all);

  Index count() const { return count_; }
  /// Ascending.
  std::span<const std::int32_t> rows(Index island) const {
    const auto begin = begin_.begin() + island;
    return {order_.data() + begin[0], static_cast<std::size_t>(begin[1] - begin[0])};
  }

 private:
  std::int32_t Root(std::int32_t body);
  void Forget(const StepRows& all);

  Index count_ = 0;
  std::vector<std::int32_t> parent_;   // by body; itself: a root
  std::vector<std::int32_t> of_body_;  // by root: its island, < 0 so far; else < 0
  std::vector<std::int32_t> of_row_, order_, begin_;
};

}  // namespace lcpbench
