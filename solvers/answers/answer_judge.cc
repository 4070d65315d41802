#include "solvers/answers/answer_judge.h"

#include <algorithm>
#include <cmath>

#include "solvers/lcp/verify.h"

namespace lcpbench {
namespace {

// What rounding can hide of rho at f. As w_i is summed, its absolute terms come to (|A||f|)_i + |b_i|, from factors to
// (|J| M^-1 |J^T| |f|)_i + |b_i|: over A_ii^1/2 no more than |D^1/2 f|_1 and |D^-1/2 b|_2, since |A_ij|^2 <= A_ii A_jj.
double Rounding(const LcpProblem& problem, const Eigen::VectorXd& f) {
  const Eigen::VectorXd& D = problem.DiagonalA();
  double size = 0;
  double b_squared = 0;
  for (Index i = 0; i < f.size(); ++i) {
    const double root = D[i] == 0 ? 1.0 : std::sqrt(std::abs(D[i]));
    size += root * std::abs(f[i]);
    b_squared += (problem.b()[i] / root) * (problem.b()[i] / root);
  }
  constexpr double kTermsBesideRows = 64;
  const auto rows = static_cast<double>(f.size());
  const double relative = b_squared == 0 ? size : size / std::sqrt(b_squared) + 1;
  return (rows + kTermsBesideRows) * std::numeric_limits<double>::epsilon() * std::sqrt(rows) * relative;
}

// Whether what rounding hides of a row's gap, which Rounding bounds over all rows, may be what its backward error
// misses the limit by.  O(n)
bool RoundingMayHideARow(const LcpProblem& problem, const Eigen::VectorXd& f, const Eigen::VectorXd& w, double limit) {
  if (!problem.has_factors()) return false;  // entries of A are given, not sums that may cancel
  constexpr double kRounding = 64 * std::numeric_limits<double>::epsilon();
  const Eigen::VectorXd& D = problem.DiagonalA();
  double forces = 0;
  for (Index i = 0; i < f.size(); ++i) forces += std::sqrt(std::abs(D[i])) * std::abs(f[i]);
  for (Index i = 0; i < f.size(); ++i) {
    const double b = problem.b()[i];
    // (|A| |f| + |b|)_i is no less.
    const double least = std::max(std::abs(w[i] - b), std::abs(D[i] * f[i])) + std::abs(b);
    const double defect = std::abs(LawSums<double>::Defect(w[i], D[i] * f[i], problem.is_bilateral(i)));
    if (defect + kRounding * std::sqrt(std::abs(D[i])) * forces > limit * least) return true;
  }
  return false;
}

// Entries of D^1/2 y below this part of the largest may be rounding of zeros.
constexpr double kNoise = 1e-12;
// A ray is multiplied by these, then its entries are cut to so many bits.
constexpr double kMultiples[] = {1, 3, 5, 7};
constexpr int kFewBits = 20;

double WithFewBits(double value) {
  int exponent = 0;
  const double fraction = std::frexp(value, &exponent);
  return std::ldexp(std::nearbyint(std::ldexp(fraction, kFewBits)), exponent - kFewBits);
}

}  // namespace

void AnswerJudge::Reset(const LcpProblem& problem, bool dense) {
  estimate_.Reset(problem, dense ? ResidualEstimate::Rows::kDense : ResidualEstimate::Rows::kSparse);
  extended_.Reset(problem, GivenFormTest::Rows::kGivenWhenNeeded);
  extended_.MakeRoom();
  for (Eigen::VectorXd* v : {&f_, &w_, &w_best_}) v->setZero(problem.size());
}

void AnswerJudge::Start(const LcpProblem& problem, double tolerance, LcpResult* result) {
  estimate_.SetB(problem);
  extended_.SetB(problem);
  result_ = result;
  tolerance_ = tolerance;
  tier_ = std::numeric_limits<double>::infinity();
}

bool AnswerJudge::Publish() {
  estimate_.ComputeW(f_, &w_);
  double rho = estimate_.Rho(f_, w_);
  const bool is_unclear = std::abs(rho - tolerance_) <= Rounding(estimate_.problem(), f_);
  if (!(rho < tier_) && !is_unclear) return tier_ <= kGoodEnough;
  double backward = estimate_.BackwardError(f_, w_);
  // The verdict is made in extended precision, so the estimate is, too, where rounding may matter: where it could
  // decide about rho, and where sums cancel in a row whose own terms are all (nearly) 0, so that its backward error is
  // rounding over nothing, or seems small for it.
  if (is_unclear || (rho <= tolerance_ && (backward * backward > tolerance_ ||
                                           RoundingMayHideARow(estimate_.problem(), f_, w_, std::sqrt(tolerance_))))) {
    extended_.Rho(f_);
    for (Index i = 0; i < w_.size(); ++i) w_[i] = static_cast<double>(extended_.w(i));
    rho = estimate_.Rho(f_, w_);
    backward = static_cast<double>(extended_.BackwardError(f_));
  }
  const double tier = std::max(rho, backward * backward);
  if (tier < tier_) {
    tier_ = tier;
    result_->f.swap(f_);
    w_best_.swap(w_);
  }
  return tier_ <= kGoodEnough;
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

std::optional<Eigen::VectorXd> AcceptedRay(const LcpProblem& problem, const Eigen::VectorXd& direction) {
  Eigen::VectorXd ray = direction;
  FarkasVerdict verdict = VerifyFarkasRay(problem, ray);
  if (!verdict.accepted) {
    const Eigen::ArrayXd size = problem.DiagonalA().cwiseAbs().cwiseSqrt().cwiseProduct(ray).array().abs();
    ray = (size < kNoise * size.maxCoeff()).select(0.0, ray.array());
    verdict = VerifyFarkasRay(problem, ray);
    if (!verdict.accepted) return std::nullopt;
  }
  if (verdict.proved) return ray;
  for (const double multiple : kMultiples) {
    Eigen::VectorXd short_ray = ray.unaryExpr([&](double y) { return WithFewBits(multiple * y); });
    if (VerifyFarkasRay(problem, short_ray).proved) return short_ray;
  }
  return ray;
}

}  // namespace lcpbench
