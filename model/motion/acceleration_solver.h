#pragma once

#include <string>

#include "model/motion/motion.h"
#include "solvers/lcp/problem.h"
#include "solvers/lcp/solver.h"

namespace lcpbench {

/// A solver gave forces or impulses that are not finite: the motion cannot go on.
struct NoFinitePoint {
  std::string detail;
};

/// Hands LCPs to a solver and keeps the books of a motion: number of solves, failures, time. Failed solves go on with
/// the best point that the solver gives.
class CountedSolver {
 public:
  /// @param solver, statistics  must outlive this
  /// @param options  of every solve; initial_f is not read
  CountedSolver(LcpSolver& solver, const LcpOptions& options, MotionStatistics* statistics);

  /// @param initial_f  warm start, nullptr for a cold one; left out where its length does not fit
  /// @throws NoFinitePoint if the answer is not finite
  void Solve(const LcpProblem& problem, const Eigen::VectorXd* initial_f, LcpResult* result);

 private:
  LcpSolver& solver_;
  LcpOptions options_;
  MotionStatistics* statistics_;
};

}  // namespace lcpbench
