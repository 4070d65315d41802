#include "solvers/linear_algebra/scaled_vectors.h"

#include <algorithm>
#include <cmath>

#include "solvers/linear_algebra/power_of_two.h"

namespace lcpbench {

void ScaledVectors::Resize(Eigen::Index n) {
  for (Eigen::VectorXd* v : {&scale, &diagonal, &b}) v->setZero(n);
  can_act.assign(static_cast<size_t>(n), 0);
}

bool ScaledVectors::Load(const LcpProblem& problem) {
  const Eigen::VectorXd& d = problem.DiagonalA();
  const Eigen::VectorXd& given = problem.b();
  double largest = 0;
  double squared = 0;
  for (Eigen::Index i = 0; i < d.size(); ++i) {
    if (d[i] < 0) return false;
    const bool acts = d[i] > 0;
    can_act[static_cast<size_t>(i)] = acts ? 1 : 0;
    scale[i] = acts ? ScaleOfDiagonal(d[i]) : 1.0;
    diagonal[i] = acts ? (d[i] * scale[i]) * scale[i] : 1.0;
    b[i] = acts ? given[i] * scale[i] : 0.0;
    largest = std::max(largest, std::abs(b[i]));
    squared += acts ? given[i] * (given[i] / d[i]) : given[i] * given[i];
  }
  b_norm = squared == 0 ? 1.0 : std::sqrt(squared);
  b_scale = ScaleOfLargest(largest);
  b *= b_scale;
  return true;
}

}  // namespace lcpbench
