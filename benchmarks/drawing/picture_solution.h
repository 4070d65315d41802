#pragma once

#include <Eigen/Core>
#include <string>

#include "solvers/lcp/problem.h"

namespace lcpbench {

/// The answer that a picture shows.
struct PictureSolution {
  bool found = false;   ///< whether there is anything to show
  Eigen::VectorXd f;    ///< n forces
  Eigen::VectorXd w;    ///< n gap accelerations, of the verifier
  std::string caption;  ///< the solver and its verdict, in a few words
};

/// The answer of one solver whatever the verdict, or, without a key, the first verified answer of any solver of this
/// build; nothing found where there is none, or no row.
/// @param solver_key  a registry key, or ""
/// @throws InputError as MakeSolver
PictureSolution SolveForPicture(const LcpProblem& problem, const std::string& solver_key);

}  // namespace lcpbench
