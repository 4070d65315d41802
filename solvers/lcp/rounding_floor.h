#pragma once

#include "solvers/lcp/verify.h"

namespace lcpbench {

/// What a solve in double reaches lies within so many rounding floors of its f.
inline constexpr double kFloorReach = 4;

/// Whether an answer of which these are the metrics is as good as double precision lets it be, and `tolerance` below
/// that: tolerance < answer_floor, and rho <= kFloorReach answer_floor, at most kLargestFloor. False where the
/// reference knows the problem's own floor, which the verdict rests on then.
///
/// The floor is that of the given f: where f is not unique, another answer may have a lower one.
bool IsBelowFloor(const Metrics& metrics, double tolerance);

/// For the length of an own solver's solve: tells why it failed. Within another one, that of a solver which asks this
/// one, it does nothing.
class FloorTeller {
 public:
  FloorTeller() : is_outermost_(!on_) { on_ = true; }
  ~FloorTeller() {
    if (is_outermost_) on_ = false;
  }
  FloorTeller(const FloorTeller&) = delete;
  FloorTeller& operator=(const FloorTeller&) = delete;

  /// Where a numerical failure is below the floor, its detail says so: "1e-09 is below the rounding floor 1.4e-08 of
  /// this problem", as estimated from f.  O(nnz of the given form), of a numerical failure only
  void Tell(const LcpProblem& problem, double tolerance, LcpResult* result) const;

 private:
  bool is_outermost_;
  static inline thread_local bool on_ = false;
};

}  // namespace lcpbench
