#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "solvers/lcp/solver.h"

namespace lcpbench {

/// 1/2 f.A f + b.f, which no first-order method may raise.
inline double Energy(const LcpProblem& problem, const Eigen::VectorXd& f) {
  Eigen::VectorXd w;
  problem.ComputeW(f, &w);
  return 0.5 * f.dot(w + problem.b());
}

/// @param iterations  the limit; 0 is the solver's own
inline LcpResult Iterate(LcpSolver* solver, const LcpProblem& problem, double tolerance, std::int64_t iterations) {
  LcpOptions options;
  options.tolerance = tolerance;
  options.max_iterations = iterations;
  LcpResult result;
  solver->Solve(problem, options, &result);
  return result;
}

}  // namespace lcpbench
