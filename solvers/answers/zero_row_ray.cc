#include "solvers/answers/zero_row_ray.h"

#include <cmath>

#include "solvers/lcp/verify.h"

namespace lcpbench {

std::optional<Eigen::VectorXd> FindZeroRowRay(const LcpProblem& problem, double threshold) {
  const Eigen::VectorXd& d = problem.DiagonalA();
  for (Index i = 0; i < problem.size(); ++i) {
    if (d[i] != 0) continue;
    const double b = problem.b()[i];
    if ((b >= 0 && !problem.is_bilateral(i)) || std::abs(b) <= threshold) continue;
    Eigen::VectorXd ray = Eigen::VectorXd::Zero(problem.size());
    ray[i] = b < 0 ? 1 : -1;
    if (VerifyFarkasRay(problem, ray).accepted) return ray;
  }
  return std::nullopt;
}

}  // namespace lcpbench
