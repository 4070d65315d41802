#pragma once

#include <memory>

#include "solvers/lcp/problem.h"
#include "solvers/lcp/solver.h"

/// What the opaque types of lcpbench.h are.

struct lcpbench_problem {
  lcpbench::LcpProblem problem;
};

struct lcpbench_solver {
  std::unique_ptr<lcpbench::LcpSolver> solver;
};

struct lcpbench_result {
  lcpbench::LcpResult result;
};
