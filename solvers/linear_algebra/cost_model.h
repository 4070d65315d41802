#pragma once

#include "solvers/lcp/problem.h"

namespace lcpbench {

/// Predicted times in nanoseconds, for choices between methods and forms that must not depend on the clock: measured
/// with AVX-512 on one machine on scenes of 10^3 to 10^5 rows. Only ratios matter, and only to time, not to answers.
struct CostModel {
  // A dense active block, by multiply-add and entry of A.
  static constexpr double kDenseMultiplyAdd = 0.03;
  static constexpr double kDenseEntry = 1;  ///< gathering and solving
  static constexpr double kDenseOverhead = 700;
  // A sparse active block, by rows.
  static constexpr double kSparseMultiplyAdd = 0.4;
  // A step of block pivoting, in its factorization and by row.
  static constexpr double kDenseStep = 0.5;
  static constexpr double kSparseStep = 2;
  static constexpr double kSparseStepRow = 25;
  // An iteration of nncg, by row with two bodies or by entry of an assembled A, against a factorization of the interior
  // point with all its solves.
  static constexpr double kSweepRow = 8;
  static constexpr double kSweepEntry = 1.5;
  static constexpr double kInteriorFlop = 0.1;
  static constexpr double kInteriorEntry = 12;

  /// Time of an nncg iteration [s].
  static double Sweep(const LcpProblem& problem) {
    if (problem.has_factors() && problem.columns_per_body() == 3 && problem.has_two_body_rows()) {
      return kSweepRow * static_cast<double>(problem.size());
    }
    return kSweepEntry * static_cast<double>(problem.SparseA().nonZeros());
  }
  /// How many of these take as long as one factorization of `flops` and `fill` in the interior point, with its solves.
  static double SweepsPerFactorization(const LcpProblem& problem, double flops, double fill) {
    return (kInteriorFlop * flops + kInteriorEntry * fill) / Sweep(problem);
  }
};

}  // namespace lcpbench
