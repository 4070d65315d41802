#include "solvers/answers/answer_judge.h"

#include <algorithm>

namespace lcpbench {
namespace {

constexpr double kNearTolerance = 0.01;

}  // namespace

void AnswerJudge::Reset(const LcpProblem& problem, bool dense) {
  problem_ = problem;
  estimate_.Reset(problem, dense);
  for (Eigen::VectorXd* v : {&f_, &w_, &w_best_}) v->setZero(problem.size());
  if (problem.has_factors()) {
    body_.resize(problem.J().cols());
    body_extended_.resize(problem.J().cols());
  }
}

void AnswerJudge::SetB(const LcpProblem& problem) {
  problem_ = problem;
  estimate_.SetB(problem);
}

void AnswerJudge::Start(double tolerance) {
  tolerance_ = tolerance;
  tier_ = std::numeric_limits<double>::infinity();
  latest_is_best_ = false;
}

// w = A f + b for A given by factors, through body space, as LcpProblem::ComputeW, which allocates.
template <typename Real>
void AnswerJudge::ComputeWByFactors(Eigen::Matrix<Real, Eigen::Dynamic, 1>* body) {
  const SparseMatrix& J = problem_->J();
  const Eigen::VectorXd& b = problem_->b();
  const Eigen::VectorXd& inverse_mass = problem_->inverse_mass();
  body->setZero();
  for (Index i = 0; i < J.rows(); ++i) {
    if (f_[i] == 0) continue;
    for (SparseMatrix::InnerIterator it(J, i); it; ++it) (*body)[it.col()] += static_cast<Real>(it.value()) * f_[i];
  }
  for (Index k = 0; k < J.cols(); ++k) (*body)[k] *= inverse_mass[k];
  for (Index i = 0; i < J.rows(); ++i) {
    Real sum = 0;
    for (SparseMatrix::InnerIterator it(J, i); it; ++it) sum += it.value() * (*body)[it.col()];
    w_[i] = static_cast<double>(sum + b[i]);
  }
}

void AnswerJudge::ComputeWInExtendedPrecision() {
  if (problem_->has_factors()) {
    ComputeWByFactors(&body_extended_);
    return;
  }
  for (Index i = 0; i < f_.size(); ++i) {
    long double sum = problem_->b()[i];
    if (problem_->given_form() == MatrixForm::kDense) {
      for (Index j = 0; j < f_.size(); ++j) sum += static_cast<long double>(problem_->DenseA()(i, j)) * f_[j];
    } else {
      for (SparseMatrix::InnerIterator it(problem_->SparseA(), i); it; ++it) {
        sum += static_cast<long double>(it.value()) * f_[it.col()];
      }
    }
    w_[i] = static_cast<double>(sum);
  }
}

bool AnswerJudge::Publish(LcpResult* result) {
  latest_is_best_ = false;
  if (problem_->has_factors()) {
    ComputeWByFactors(&body_);
  } else {
    problem_->ComputeW(f_, &w_);
  }
  double rho = estimate_.Rho(f_, w_);
  if (!(rho < tier_)) return false;
  double backward = estimate_.BackwardError(f_, w_);
  // The verdict is made in extended precision, so the estimate is, too, where rounding may matter: where rho is near
  // the tolerance (it is as large as the rounding of w at least), and where sums cancel in a row whose own terms are
  // all (nearly) 0, so that its backward error is rounding over nothing.
  if ((rho <= tolerance_ && rho > kNearTolerance * tolerance_) ||
      (rho <= tolerance_ && backward * backward > tolerance_)) {
    ComputeWInExtendedPrecision();
    rho = estimate_.Rho(f_, w_);
    backward = estimate_.BackwardError(f_, w_);
  }
  const double tier = std::max(rho, backward * backward);
  if (!(tier < tier_)) return false;
  tier_ = tier;
  result->f.swap(f_);
  w_best_.swap(w_);
  latest_is_best_ = true;
  return tier <= kGoodEnough;
}

}  // namespace lcpbench
