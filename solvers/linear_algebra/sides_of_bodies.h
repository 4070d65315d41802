#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "solvers/lcp/problem.h"
#include "support/array_index.h"

/// Internal to solvers/.
namespace lcpbench {

/// The sides of two-body rows by the bodies that they are on, as lists. Side 2 i + s is the first (s = 0) or second one
/// of row i. Only Reserve allocates.
class SidesOfBodies {
 public:
  /// No body has a side at first.
  void Reserve(Index max_rows, Index max_bodies) {
    if (before_.size() < At(2 * max_rows)) before_.resize(At(2 * max_rows));
    if (last_.size() < At(max_bodies)) last_.resize(At(max_bodies), -1);
  }
  /// @param body  >= 0
  void Add(Index body, std::int32_t side) { before_[At(side)] = std::exchange(last_[At(body)], side); }
  /// The body has no side again.
  void Forget(Index body) { last_[At(body)] = -1; }
  /// visit(side) for all sides of the body, the latest first.
  template <typename Visit>
  void ForEach(Index body, const Visit& visit) const {
    for (std::int32_t side = last_[At(body)]; side >= 0; side = before_[At(side)]) visit(side);
  }

 private:
  std::vector<std::int32_t> last_, before_;  // by body its latest side, -1: none; by side the one before on its body
};

}  // namespace lcpbench
