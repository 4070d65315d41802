#pragma once

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cstdint>

#include "tests/solvers/solve_with.h"

namespace lcpbench {

/// 1/2 f.A f + b.f, which no first-order method may raise.
inline double Energy(const LcpProblem& problem, const Eigen::VectorXd& f) {
  Eigen::VectorXd w;
  problem.ComputeW(f, &w);
  return 0.5 * f.dot(w + problem.b());
}

/// Blocks in a row, each pushed onto the next: every row couples two bodies, all pressed.
inline LcpProblem PressedChain(Index n) {
  SparseMatrix J(n, 3 * (n + 1));
  for (Index i = 0; i < n; ++i) {
    J.insert(i, 3 * i) = -1;
    J.insert(i, 3 * i + 3) = 1;
  }
  Eigen::VectorXd b(n);
  for (Index i = 0; i < n; ++i) b[i] = i % 5 == 3 ? 0.5 : -1;
  return LcpProblem::FromFactors("pressed-chain", J, Eigen::VectorXd::Ones(3 * (n + 1)), b);
}

/// From `start`, or from 0.
/// @param iterations  the limit; 0 is the solver's own
inline LcpResult Iterate(LcpSolver* solver, const LcpProblem& problem, double tolerance, std::int64_t iterations,
                         const Eigen::VectorXd* start = nullptr) {
  return SolveWith(solver, problem, {.tolerance = tolerance, .max_iterations = iterations, .initial_f = start});
}
template <typename Solver>
LcpResult IterateNew(const LcpProblem& problem, const typename Solver::Options& options, double tolerance,
                     std::int64_t iterations, const Eigen::VectorXd* start = nullptr) {
  Solver solver(options);
  return Iterate(&solver, problem, tolerance, iterations, start);
}

}  // namespace lcpbench
