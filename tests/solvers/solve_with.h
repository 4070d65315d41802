#pragma once

#include <gtest/gtest.h>

#include "solvers/lcp/solver.h"
#include "solvers/lcp/verify.h"

namespace lcpbench {

/// One solve by a solver that may have solved others.
inline LcpResult SolveWith(LcpSolver* solver, const LcpProblem& problem, const LcpOptions& options = {}) {
  LcpResult result;
  solver->Solve(problem, options, &result);
  return result;
}

/// Claimed to be solved, and verified at the default tolerance.
inline void ExpectSolved(const LcpProblem& problem, const LcpResult& result) {
  const Verdict verdict = Verify(problem, result, LcpOptions{}.tolerance);
  EXPECT_EQ(result.status, LcpStatus::kSolved) << problem.id() << ": " << result.detail;
  EXPECT_TRUE(verdict.passes) << problem.id() << ": " << verdict.reason;
}

/// Proved infeasible by a ray that the verifier accepts.
inline void ExpectRay(const LcpProblem& problem, const LcpResult& result) {
  EXPECT_EQ(result.status, LcpStatus::kInfeasible) << problem.id() << ": " << result.detail;
  ASSERT_TRUE(result.farkas_ray.has_value());
  EXPECT_TRUE(VerifyFarkasRay(problem, *result.farkas_ray).accepted);
}

}  // namespace lcpbench
