#include "solvers/lcp/residual.h"

#include <algorithm>
#include <cmath>

namespace lcpbench {

void ResidualEstimate::Reset(const LcpProblem& problem, bool dense) {
  problem_ = problem;
  dense_ = dense;
  const Index n = problem.size();
  force_ = problem.DiagonalA();
  root_.resize(n);
  bilateral_.setConstant(n, false);
  double sum = 0;
  for (Index i = 0; i < n; ++i) {
    root_[i] = force_[i] == 0 ? 1.0 : std::sqrt(std::abs(force_[i]));
    const double scaled = problem.b()[i] / root_[i];
    sum += scaled * scaled;
  }
  for (const Index i : problem.bilateral_rows()) bilateral_[i] = true;
  b_norm_ = sum == 0 ? 1.0 : std::sqrt(sum);
  if (dense) {
    problem.DenseA();
  } else {
    problem.SparseA();
  }
}

double ResidualEstimate::Rho(const Eigen::VectorXd& f, const Eigen::VectorXd& w) const {
  double sum = 0;
  for (Index i = 0; i < f.size(); ++i) {
    const double q = w[i] / root_[i];
    const double residual = bilateral_[i] ? q : std::min(root_[i] * f[i], q);
    sum += residual * residual;
  }
  return std::sqrt(sum) / b_norm_;
}

double ResidualEstimate::BackwardError(const Eigen::VectorXd& f, const Eigen::VectorXd& w) const {
  const Index n = f.size();
  double worst = 0;
  for (Index i = 0; i < n; ++i) {
    const double defect = std::abs(bilateral_[i] ? w[i] : std::min(std::abs(force_[i]) * f[i], w[i]));
    if (defect == 0) continue;
    double scale = std::abs(problem_->b()[i]);
    if (dense_) {
      // A is symmetric wherever the estimate is used densely, so column i serves as row i and stays contiguous.
      scale += problem_->DenseA().col(i).cwiseAbs().dot(f.cwiseAbs());
    } else {
      for (SparseMatrix::InnerIterator it(problem_->SparseA(), i); it; ++it) {
        scale += std::abs(it.value() * f[it.col()]);
      }
    }
    const double ratio = defect / scale;
    if (!(ratio <= worst)) worst = ratio;  // NaN stays
    if (std::isnan(worst)) return worst;
  }
  return worst;
}

bool ResidualEstimate::Meets(double tolerance, const Eigen::VectorXd& f, const Eigen::VectorXd& w) const {
  return Rho(f, w) <= tolerance && BackwardError(f, w) <= std::sqrt(tolerance);
}

double RhoByGivenForm(const LcpProblem& problem, const Eigen::VectorXd& f) {
  const Eigen::VectorXd& diagonal = problem.DiagonalA();
  Eigen::VectorXd w;
  problem.ComputeW(f, &w);
  double defect = 0;
  double scale = 0;
  for (Index i = 0; i < f.size(); ++i) {
    const double root = diagonal[i] == 0 ? 1.0 : std::sqrt(std::abs(diagonal[i]));
    const double q = w[i] / root;
    const double residual = problem.is_bilateral(i) ? q : std::min(root * f[i], q);
    defect += residual * residual;
    const double b = problem.b()[i] / root;
    scale += b * b;
  }
  return std::sqrt(defect) / (scale == 0 ? 1.0 : std::sqrt(scale));
}

}  // namespace lcpbench
