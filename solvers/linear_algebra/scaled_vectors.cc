#include "solvers/linear_algebra/scaled_vectors.h"

#include <algorithm>
#include <cmath>

#include "solvers/linear_algebra/power_of_two.h"

namespace lcpbench {

void ScaledVectors::Reset(const LcpProblem& problem) {
  for (Eigen::VectorXd* v : {&scale, &diagonal, &b, &b_unit}) v->setZero(problem.size());
  for (std::vector<char>* v : {&can_act, &bilateral}) v->assign(static_cast<size_t>(problem.size()), 0);
  for (const Eigen::Index i : problem.bilateral_rows()) bilateral[static_cast<size_t>(i)] = 1;
}

double ScaledVectors::Rho(const Eigen::VectorXd& f, const Eigen::VectorXd& w) const {
  double sum = 0;
  for (Eigen::Index i = 0; i < f.size(); ++i) {
    const double r = b_unit[i] * (is_joint(i) ? w[i] : std::min(diagonal[i] * f[i], w[i]));
    sum += r * r / diagonal[i];
  }
  return std::sqrt(sum) / b_norm;
}

void ScaledVectors::Clip(const Eigen::VectorXd& given, Eigen::VectorXd* f) const {
  for (Eigen::Index i = 0; i < given.size(); ++i) {
    const double force = given[i] / (scale[i] * b_unit[i]);
    (*f)[i] = !acts(i) ? 0.0 : is_joint(i) ? force : std::max(force, 0.0);
  }
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
  const double b_scale = ScaleOfLargest(largest);
  b *= b_scale;
  b_unit.setConstant(1 / b_scale);
  return true;
}

}  // namespace lcpbench
