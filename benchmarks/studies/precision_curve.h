#pragma once

#include <string>
#include <vector>

#include "solvers/lcp/problem.h"

namespace lcpbench {

/// One answer in one precision, judged against the problem as given, in double.
struct PrecisionPoint {
  std::string method;      ///< "gauss-seidel" or "tableau"
  bool is_single = false;  ///< gauss-seidel: J, inverse masses, b, f and velocities; tableau: J alone, sums in double
  int sweeps = 0;          ///< of gauss-seidel, 0 else
  double rho = 0;          ///< as the verifier measures it
  double seconds = 0;      ///< from J as an engine's arrays hold it to f
};

/// Projected Gauss-Seidel over the velocities of bodies, the same code in both precisions, after 1, 3, 10, ... sweeps;
/// and StepSolver with StepRows::J and with J_single. Nothing where a row acts on more than two bodies.
std::vector<PrecisionPoint> ComparePrecisions(const LcpProblem& problem);

}  // namespace lcpbench
