#pragma once

#include "solvers/auto/auto_limits.h"
#include "solvers/lcp/problem.h"
#include "solvers/lcp/solver.h"

/// Internal to solvers/.
namespace lcpbench {

/// AutoMethod::kExact: the exact solution rounded to doubles, of plain problems by ExactSolver, of those with other
/// rows, and of few contacts whose A is not semidefinite, by their modes. kSolved where f passes PassesTier,
/// kInfeasible where AcceptedRay accepts the ray; else f is the better one of result->f and the rounded solution.
/// Appends to `detail`. Does nothing beyond its sizes, nor where options.max_iterations, in other methods' unit, is
/// set.
/// @param deadline  of the whole solve; no exact solve is begun that may outlast it
void TryExact(const LcpProblem& problem, const LcpOptions& options, const AutoLimits& limits, const Deadline& deadline,
              LcpResult* result);

}  // namespace lcpbench
