#include "benchmarks/collection/recipes/another_b.h"

#include <algorithm>
#include <cmath>

#include "model/scenes/random.h"

namespace lcpbench {

Eigen::VectorXd AnotherB(const LcpProblem& problem, std::uint64_t seed) {
  constexpr double kShare = 0.1;
  const Eigen::VectorXd& D = problem.DiagonalA();
  const Eigen::VectorXd& b = problem.b();
  double load = 0;
  for (Index i = 0; i < problem.size(); ++i) {
    if (D[i] > 0) load = std::max(load, std::abs(b[i]) / std::sqrt(D[i]));
  }
  Random random(seed);
  Eigen::VectorXd d = Eigen::VectorXd::Zero(problem.size());
  for (Index i = 0; i < problem.size(); ++i) {
    const double u = random.Uniform(problem.is_bilateral(i) ? -1 : 0, 1);
    if (D[i] > 0) d[i] = kShare * load / std::sqrt(D[i]) * u;
  }
  Eigen::VectorXd w;
  problem.ComputeW(d, &w);  // A d + b
  return b - (w - b);
}

}  // namespace lcpbench
