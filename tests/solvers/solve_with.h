#pragma once

#include <gtest/gtest.h>

#include <string_view>

#include "solvers/lcp/solver.h"
#include "solvers/lcp/verify.h"
#include "solvers/registry.h"

namespace lcpbench {

/// An answer as a solver hands it out.
inline LcpResult Claim(const Eigen::VectorXd& f, LcpStatus status = LcpStatus::kSolved) {
  LcpResult result;
  result.status = status;
  result.f = f;
  return result;
}

/// One solve by a solver that may have solved others.
inline LcpResult SolveWith(LcpSolver* solver, const LcpProblem& problem, const LcpOptions& options = {}) {
  LcpResult result;
  solver->Solve(problem, options, &result);
  return result;
}

/// The same from the problem's arrays.
inline LcpResult SolveArraysWith(LcpSolver* solver, const LcpProblem& problem, const LcpOptions& options = {}) {
  LcpResult result;
  solver->SolveArrays(ProblemArrays::Of(problem), options, &result);
  return result;
}

/// One solve by a solver of the registry.
inline LcpResult SolveBy(std::string_view key, const LcpProblem& problem, double tolerance = LcpOptions{}.tolerance,
                         const Settings& settings = {}) {
  LcpOptions options;
  options.tolerance = tolerance;
  return SolveWith(MakeSolver(key, settings).get(), problem, options);
}

/// Claimed to be solved, and verified at the tolerance.
inline void ExpectSolved(const LcpProblem& problem, const LcpResult& result,
                         double tolerance = LcpOptions{}.tolerance) {
  const Verdict verdict = Verify(problem, result, tolerance);
  EXPECT_EQ(result.status, LcpStatus::kSolved) << problem.id() << ": " << result.detail;
  EXPECT_TRUE(verdict.passes) << problem.id() << ": " << verdict.reason << "; " << result.detail;
}

/// A clock for LcpOptions::now that moves one second per look, from `ticks` on.
inline double ticks = 0;
inline double TickingClock() { return ticks += 1; }

/// Proved infeasible by a ray that the verifier accepts.
inline void ExpectRay(const LcpProblem& problem, const LcpResult& result) {
  EXPECT_EQ(result.status, LcpStatus::kInfeasible) << problem.id() << ": " << result.detail;
  ASSERT_TRUE(result.farkas_ray.has_value()) << problem.id();
  const FarkasVerdict verdict = VerifyFarkasRay(problem, *result.farkas_ray);
  EXPECT_TRUE(verdict.accepted) << problem.id() << ": " << verdict.reason;
}

}  // namespace lcpbench
