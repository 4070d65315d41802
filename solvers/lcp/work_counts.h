#pragma once

#include <cstdint>

namespace lcpbench {

/// The large pieces of work that solvers have done in this thread so far, counted where they are done: for tests that
/// compare two ways to the same answer by what they did and not by the clock.
struct WorkCounts {
  std::int64_t factorizations = 0;  ///< numeric: whole factors and CHOLMOD's updates, as FactorClock times them
  std::int64_t analyses = 0;        ///< symbolic, each with its order; of Ipopt the objects built for a program

  /// Of the calling thread, so far.
  static WorkCounts& OfThread() {
    static thread_local WorkCounts counts;
    return counts;
  }

  /// What was done since `before`.
  WorkCounts operator-(const WorkCounts& before) const {
    return {factorizations - before.factorizations, analyses - before.analyses};
  }
  /// The same work.
  bool operator==(const WorkCounts&) const = default;
};

}  // namespace lcpbench
