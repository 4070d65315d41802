#include "solvers/linear_algebra/body_active_block.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "solvers/linear_algebra/cost_model.h"
#include "support/array_index.h"

namespace lcpbench {
namespace {

constexpr Index kAxes = BodySpace::kAxes;
constexpr int kNone = -1;

// Refinement ends when the residual is rounding, (|r| + |x|) times this, or falls by less than kSlow.
constexpr double kRounding = 16 * std::numeric_limits<double>::epsilon();
constexpr double kSlow = 0.25;
constexpr int kMaxRefinements = 4;
// A residual above this is not what rounding of a good factor leaves.
constexpr double kWornOut = 1e-11;

}  // namespace

void BodyActiveBlock::Analyze(const LcpProblem& problem) {
  n_ = problem.size();
  bodies_.Prepare(problem, {}, /*will_update=*/true);
  if (bodies_.analyses() > 0) {
    by_supernodes_ = bodies_.factor().is_supernodal();
    flop_time_ = by_supernodes_ ? CostModel::kSupernodalFlop : CostModel::kColumnFlop;
    path_ = bodies_.factor().EntriesToRoot();
  }
  for (Eigen::VectorXd* v : {&diagonal_, &theta_, &right_, &residual_, &x_, &step_}) v->setZero(n_);
  active_.assign(At(n_), 0);
  entering_.reserve(At(n_));
  leaving_.reserve(At(n_));
  valid_ = false;
}

double BodyActiveBlock::factor_time() const {
  return NewFactorTime() + CostModel::kSolveEntry * bodies_.factor().fill();
}

double BodyActiveBlock::NewFactorTime() const {
  return flop_time_ * bodies_.factor().flops() + CostModel::kFactorEntry * bodies_.factor().fill() +
         CostModel::kBodyRow * static_cast<double>(n_);
}

Index BodyActiveBlock::CountDependentRows() const {
  std::vector<char> touched(At(bodies_.bodies()), 0);
  Index rows = 0;
  Index degrees_of_freedom = 0;
  for (Index i = 0; i < n_; ++i) {
    if (active_[At(i)] == 0) continue;
    ++rows;
    for (const int body : {bodies_.row(i).first, bodies_.row(i).second}) {
      if (body == kNone || touched[At(body)] != 0) continue;
      touched[At(body)] = 1;
      degrees_of_freedom += kAxes;
    }
  }
  return std::max<Index>(0, rows - degrees_of_freedom);
}

void BodyActiveBlock::Load(const LcpProblem& problem, const Eigen::VectorXd& scale) {
  diagonal_ = problem.DiagonalA().cwiseProduct(scale).cwiseProduct(scale);
  bodies_.Load(problem, scale.cwiseInverse());
  valid_ = false;
  factorizations_ = 0;
  updates_ = 0;
}

void BodyActiveBlock::FactorAnew() {
  ++factorizations_;
  updated_ = false;
  // Every pivot of K is at least 1 but for rounding.
  valid_ = bodies_.Factorize(theta_);
  if (!valid_) throw std::runtime_error(bodies_.why());
}

double BodyActiveBlock::UpdateTime() const {
  double time = updated_ || !by_supernodes_ ? 0.0 : CostModel::kConvertEntry * bodies_.factor().fill();
  for (const std::vector<int>* rows : {&entering_, &leaving_}) {
    for (const int i : *rows)
      time += CostModel::kUpdateRow + CostModel::kUpdateEntry * path_[At(kAxes * bodies_.row(i).first)];
  }
  return time;
}

bool BodyActiveBlock::Factor(const std::vector<char>& active, double shift, const Deadline* deadline) {
  const bool fresh = !valid_ || shift != shift_;
  entering_.clear();
  leaving_.clear();
  for (Index i = 0; i < n_; ++i) {
    const bool acts = active[At(i)] != 0;
    theta_[i] = acts ? shift * diagonal_[i] : BodySpace::kOut;
    if (active[At(i)] == active_[At(i)]) continue;
    active_[At(i)] = active[At(i)];
    if (bodies_.row(i).first != kNone) (acts ? entering_ : leaving_).push_back(static_cast<int>(i));
  }
  shift_ = shift;
  if (!fresh && entering_.empty() && leaving_.empty()) return true;
  valid_ = false;
  if (deadline != nullptr && deadline->Expired()) return false;
  if (fresh || UpdateTime() >= NewFactorTime()) {
    FactorAnew();
  } else {
    ++updates_;
    updated_ = true;
    // Rows enter before others leave, so that K stays well away from being indefinite.
    if (!bodies_.Update(&entering_, theta_, true) || !bodies_.Update(&leaving_, theta_, false)) FactorAnew();
  }
  valid_ = deadline == nullptr || !deadline->Expired();
  return valid_;
}

// residual_ = right_ - K_FF x_ on F. Returns its largest entry as a part of the largest ones of right_ and x_.
double BodyActiveBlock::Residual() {
  Multiply(x_.data(), residual_.data());
  double largest = 0;
  double size = 0;
  for (Index i = 0; i < n_; ++i) {
    residual_[i] = active_[At(i)] != 0 ? right_[i] - residual_[i] - shift_ * diagonal_[i] * x_[i] : 0.0;
    largest = std::max(largest, std::abs(residual_[i]));
    size = std::max(size, std::max(std::abs(right_[i]), std::abs(x_[i])));
  }
  return size == 0 ? 0.0 : largest / size;
}

void BodyActiveBlock::Solve(double* x) {
  for (Index i = 0; i < n_; ++i) right_[i] = active_[At(i)] != 0 ? x[i] : 0.0;
  for (;;) {
    bodies_.Solve(right_, &step_);
    x_ = step_;
    double residual = Residual();
    for (int k = 0; k < kMaxRefinements && residual > kRounding; ++k) {
      bodies_.Solve(residual_, &step_);
      x_ += step_;
      const double before = residual;
      residual = Residual();
      if (residual < before) {
        if (residual > kSlow * before) break;
        continue;
      }
      x_ -= step_;
      residual = before;
      break;
    }
    if (residual <= kWornOut || !updated_) break;
    FactorAnew();
  }
  std::copy(x_.data(), x_.data() + n_, x);
}

void BodyActiveBlock::Multiply(const double* x, double* y) const { bodies_.Multiply(x, y); }

}  // namespace lcpbench
