#pragma once

#include <optional>

#include "python/core/arrays.h"
#include "solvers/lcp/problem.h"
#include "solvers/lcp/solver.h"
#include "solvers/lcp/verify.h"

namespace lcpbench::python {

/// An answer, and what is computed of it when it is read.
struct Result {
  LcpProblem problem;
  LcpResult answer;
  double tolerance = 0;                   ///< that was asked for
  double time_s = 0;                      ///< from the caller's arrays to f [s]
  std::optional<Eigen::VectorXd> w = {};  ///< once it was read
  std::optional<Verdict> verdict = {};    ///< once it was read
};

/// The key of a status, a string that lives as long as the module.
nb::object StatusKey(LcpStatus status);

/// The classes Result, Verdict and Ray, and the function verify.
void BindResult(nb::module_& module);

}  // namespace lcpbench::python
