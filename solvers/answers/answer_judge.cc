#include "solvers/answers/answer_judge.h"

#include <algorithm>
#include <cmath>

#include "solvers/lcp/verify.h"

namespace lcpbench {
namespace {

constexpr double kNearTolerance = 0.01;

}  // namespace

void AnswerJudge::Reset(const LcpProblem& problem, bool dense) {
  estimate_.Reset(problem, dense ? ResidualEstimate::Rows::kDense : ResidualEstimate::Rows::kSparse);
  extended_.Reset(problem, GivenFormTest::Rows::kGivenWhenNeeded);
  extended_.MakeRoom();
  for (Eigen::VectorXd* v : {&f_, &w_, &w_best_}) v->setZero(problem.size());
}

void AnswerJudge::SetB(const LcpProblem& problem) {
  estimate_.SetB(problem);
  extended_.SetB(problem);
}

void AnswerJudge::Start(double tolerance) {
  tolerance_ = tolerance;
  tier_ = std::numeric_limits<double>::infinity();
  latest_is_best_ = false;
}

bool AnswerJudge::Publish(LcpResult* result) {
  latest_is_best_ = false;
  estimate_.ComputeW(f_, &w_);
  double rho = estimate_.Rho(f_, w_);
  if (!(rho < tier_)) return false;
  double backward = estimate_.BackwardError(f_, w_);
  // The verdict is made in extended precision, so the estimate is, too, where rounding may matter: where rho is near
  // the tolerance (it is as large as the rounding of w at least), and where sums cancel in a row whose own terms are
  // all (nearly) 0, so that its backward error is rounding over nothing.
  if ((rho <= tolerance_ && rho > kNearTolerance * tolerance_) ||
      (rho <= tolerance_ && backward * backward > tolerance_)) {
    extended_.Rho(f_);
    for (Index i = 0; i < w_.size(); ++i) w_[i] = static_cast<double>(extended_.w(i));
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
