#include "solvers/pivoting/lemke.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "solvers/pivoting/pivot_base.h"

namespace lcpbench {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// A negative component of a would-be ray below this part of |D^1/2 y| may be the error of solving for y. The ray is put
// to the proof before the component may block.
constexpr double kSmallComponent = 1e-8;
// First-order terms of tied rows are equal within this part of the largest: then the next column decides.
constexpr double kEqualOrder = 1e-10;

// In [1, 2), generic but fixed: a Weyl sequence on the golden ratio.
double Generic(Index i) {
  constexpr double kGolden = 0.6180339887498949;
  const double x = static_cast<double>(i + 1) * kGolden;
  return 1 + (x - std::floor(x));
}

}  // namespace

class LemkePivoting final : public PivotBase {
 public:
  explicit LemkePivoting(const LemkeOptions& options) : PivotBase(options, TableauRule::kAlongPath) {}

  void Reserve(Index max_rows) override;

 private:
  bool FindViolations(int round) override;
  // From z = 1 to z = 0, starting at F with f_F >= 0 and gaps no less than -violation_ sqrt(A_ii).
  End MakeRight(LcpResult* result) override;

  void SetCover();
  void SetPerturbation();
  double ComputeRates();
  double Noise(Index p) const;
  bool IsRounding(Index p, double rate, double size) const;
  template <typename Skip>
  Index FirstToReachZero(const Eigen::VectorXd& rate, Index end, double limit, Index event, const Skip& skip,
                         double* step);
  Index BreakTie(const Eigen::VectorXd& rate, Index event);
  void ComputePerturbation(Index k);
  End EnterOrExchange(Index p, LcpResult* result);

  double violation_ = 0;
  Index in_play_ = 0;  // open_ at the start of every path
  double z_ = 0;
  double largest_force_ = 0;      // D^1/2 f, over the path so far
  Eigen::VectorXd cover_;         // d, by row of the problem
  Eigen::VectorXd perturbation_;  // g, by row of the problem
  Eigen::VectorXd rate_;          // by position, per unit of falling z: of f in F, of w outside
  Eigen::VectorXd y_;             // by position, the direction of an exchange in F
  Eigen::VectorXd first_order_;   // by position: what one column of the perturbation does to f in F and w outside
  Eigen::VectorXd work_;
  std::vector<Index> ties_;  // positions
};

void LemkePivoting::SetCover() {
  cover_.head(lcp_.n).setZero();
  for (Index p = m(); p < open_; ++p) {
    const double d = violation_ * GapRoot(p);
    cover_[RowAt(p)] = d;
    lcp_.w[p] = std::max(lcp_.w[p] + d, 0.0);
  }
}

// g = h_w - A h_f for h_w, h_f > 0, so that the point at z = 1 has f_F + e h_f, w + e h_w > 0.
void LemkePivoting::SetPerturbation() {
  for (Index p = 0; p < joints_; ++p) work_[p] = 0;
  for (Index p = joints_; p < m(); ++p) work_[p] = -Generic(RowAt(p)) / ForceRoot(p);
  first_order_.head(open_).setZero();
  lcp_.AddColumns(0, open_, m(), work_.data(), first_order_.data());
  for (Index p = m(); p < open_; ++p) first_order_[p] += Generic(RowAt(p)) * GapRoot(p);
  for (Index p = 0; p < open_; ++p) perturbation_[RowAt(p)] = first_order_[p];
}

// Returns s + |D^1/2 f_F'|_1, which times D^1/2 bounds the terms that w_p' is the sum of.
double LemkePivoting::ComputeRates() {
  double size = 0;
  bool covered = false;
  for (Index p = 0; p < m(); ++p) {
    rate_[p] = cover_[RowAt(p)];
    covered = covered || rate_[p] != 0;
  }
  if (covered) active_.SolveSystem(rate_.data());
  for (Index p = 0; p < m(); ++p) size += std::abs(rate_[p]) * ForceRoot(p);
  double largest_cover = 0;
  for (Index p = m(); p < open_; ++p) {
    const double d = cover_[RowAt(p)];
    largest_cover = std::max(largest_cover, d / GapRoot(p));
    rate_[p] = -d;
  }
  if (covered) lcp_.AddColumns(m(), open_, m(), rate_.data(), rate_.data());
  return size + largest_cover;
}

// f_p or w_p below this is 0 but for rounding.
double LemkePivoting::Noise(Index p) const {
  return kNoise * (p < m() ? largest_force_ / ForceRoot(p) : largest_force_ * GapRoot(p));
}

bool LemkePivoting::IsRounding(Index p, double rate, double size) const {
  if (p < m()) return std::abs(rate) * ForceRoot(p) <= kNoise * size;
  if (std::abs(rate) > kNoise * size * GapRoot(p)) return false;
  const double* a = lcp_.column(p);
  double magnitude = cover_[RowAt(p)];
  for (Index j = 0; j < m(); ++j) magnitude += std::abs(a[j] * rate_[j]);
  return std::abs(rate) <= kNoise * magnitude;
}

// What column k of the perturbation (0: g, k: the unit vector of row k - 1) does to f_F and w, by position.
void LemkePivoting::ComputePerturbation(Index k) {
  for (Index p = 0; p < open_; ++p) {
    work_[p] = k == 0 ? perturbation_[RowAt(p)] : static_cast<double>(RowAt(p) == k - 1);
  }
  first_order_.head(m()) = -work_.head(m());
  active_.SolveSystem(first_order_.data());
  first_order_.segment(m(), open_ - m()) = work_.segment(m(), open_ - m());
  lcp_.AddColumns(m(), open_, m(), first_order_.data(), first_order_.data());
}

// The row of those in ties_, which reach 0 together, that reaches it first in the perturbed problem. `event` < 0:
// they move by rate_. Otherwise by `rate` along the direction of an exchange, at the z of the event.
Index LemkePivoting::BreakTie(const Eigen::VectorXd& rate, Index event) {
  for (Index k = 0; k <= lcp_.n && ties_.size() > 1; ++k) {
    ComputePerturbation(k);
    const double lag = event < 0 ? 0.0 : first_order_[event] / -rate_[event];
    const auto order = [&](Index p) { return (first_order_[p] + (event < 0 ? 0.0 : lag * rate_[p])) / -rate[p]; };
    double least = kInfinity;
    double largest = 0;
    for (const Index p : ties_) {
      least = std::min(least, order(p));
      largest = std::max(largest, std::abs(order(p)));
    }
    std::erase_if(ties_, [&](Index p) { return order(p) > least + kEqualOrder * largest; });
  }
  return ties_.front();
}

// The row in [joints_, end) whose f or w reaches 0 first by `rate`, kNoRow if none does before `limit`.
// `event` as for BreakTie.
template <typename Skip>
Index LemkePivoting::FirstToReachZero(const Eigen::VectorXd& rate, Index end, double limit, Index event,
                                      const Skip& skip, double* step) {
  double bound = limit;
  ties_.clear();
  const auto steps = [&](Index p) { return (p < m() ? lcp_.f[p] : lcp_.w[p]) / -rate[p]; };
  for (Index p = joints_; p < end; ++p) {
    if (rate[p] >= 0 || skip(p) || steps(p) > bound) continue;
    bound = std::min(bound, steps(p) + Noise(p) / -rate[p]);
    ties_.push_back(p);
  }
  *step = limit;
  if (bound >= limit) return kNoRow;
  std::erase_if(ties_, [&](Index p) { return steps(p) > bound; });
  const Index p = BreakTie(rate, event);
  *step = steps(p);
  return p;
}

// Row p, outside F with w_p = 0, enters F, or takes the place of a row that it depends on.
PivotBase::End LemkePivoting::EnterOrExchange(Index p, LcpResult* result) {
  for (Index event = p;; event = kNoRow) {  // more than once only where rounding spoils the pivot of an exchange
    const double pivot = active_.SetDriven(p);
    const double norm2 = active_.Direction(p);
    if (pivot > rank_tolerance_ * norm2) {
      active_.EnterDriven(p, pivot);
      return End::kDone;
    }
    std::copy(active_.df(), active_.df() + m(), y_.data());
    double step = 0;
    const auto is_rounding = [&](Index j) { return y_[j] * y_[j] * lcp_.diagonal[j] <= kNoise * kNoise * norm2; };
    const Index leaving = FirstToReachZero(y_, m(), kInfinity, event, is_rounding, &step);
    bool set_aside = leaving == kNoRow;
    if (set_aside || y_[leaving] * y_[leaving] * lcp_.diagonal[leaving] <= kSmallComponent * kSmallComponent * norm2) {
      // y.w = y.b + z y.d is 0 here, so y.b = -z y.d. Where that is next to nothing, so would be the use of a long step
      // that ends at a component which may be rounding.
      const bool matters = event != kNoRow && lcp_.ResidualShare(p, z_ * rate_[p]) > proof_tolerance_;
      if (matters && ClaimRay(p, 1, result)) return End::kInfeasible;
      set_aside = set_aside || !matters;
    }
    if (set_aside) {
      lcp_.f[p] = 0;
      lcp_.Swap(p, --open_);  // the final check decides
      return End::kDone;
    }
    if (pivots_ >= pivot_limit_) return End::kIterationLimit;
    ++pivots_;
    for (Index j = 0; j < joints_; ++j) lcp_.f[j] += step * y_[j];
    for (Index j = joints_; j < m(); ++j) lcp_.f[j] = std::max(lcp_.f[j] + step * y_[j], 0.0);
    lcp_.f[p] += step;
    Release(leaving);  // which moves rows of F and the first one outside only, not p
  }
}

PivotBase::End LemkePivoting::MakeRight(LcpResult* result) {
  if (violation_ == 0) return End::kDone;
  SetCover();
  SetPerturbation();
  z_ = 1;
  largest_force_ = violation_;
  while (z_ > 0) {
    if (pivots_ >= pivot_limit_) return End::kIterationLimit;
    if (TimeIsUp(m() * (m() + open_))) return End::kTimeLimit;
    ++pivots_;
    const double size = ComputeRates();
    double step = 0;
    const auto is_rounding = [&](Index j) { return IsRounding(j, rate_[j], size); };
    const Index p = FirstToReachZero(rate_, open_, z_, kNoRow, is_rounding, &step);
    step = std::max(step, 0.0);
    for (Index j = 0; j < m(); ++j) {
      lcp_.f[j] += step * rate_[j];
      if (j >= joints_) lcp_.f[j] = std::max(lcp_.f[j], 0.0);
      largest_force_ = std::max(largest_force_, std::abs(lcp_.f[j]) * ForceRoot(j));
    }
    for (Index j = m(); j < open_; ++j) lcp_.w[j] = std::max(lcp_.w[j] + step * rate_[j], 0.0);
    z_ = p == kNoRow ? 0.0 : z_ - step;
    if (p == kNoRow) break;
    if (p < m()) {
      Release(p);
    } else {
      lcp_.w[p] = 0;
      const End end = EnterOrExchange(p, result);
      if (end != End::kDone) return end;
    }
  }
  return End::kDone;
}

void LemkePivoting::Reserve(Index max_rows) {
  if (max_rows <= rate_.size()) return;
  PivotBase::Reserve(max_rows);
  for (Eigen::VectorXd* v : {&cover_, &perturbation_, &rate_, &y_, &first_order_, &work_}) v->setZero(max_rows);
  ties_.reserve(static_cast<size_t>(max_rows));
}

bool LemkePivoting::FindViolations(int round) {
  if (round == 0) in_play_ = open_;
  open_ = in_play_;
  violation_ = 0;
  for (Index p = SetViolatedApart(); p < open_; ++p) violation_ = std::max(violation_, -lcp_.w[p] / GapRoot(p));
  return violation_ > 0;
}

LemkeOptions LemkeOptions::FromSettings(const Settings& settings) {
  SettingsReader reader("lemke", settings);
  LemkeOptions options;
  options.Read(&reader);
  reader.Finish();
  return options;
}

// Pivoting for plain problems, options.make_other for others.
class LemkeEngine {
 public:
  explicit LemkeEngine(const LemkeOptions& options) : pivoting_(options) {
    if (options.make_other) other_ = options.make_other();
  }

  bool takes_other_laws() const { return other_ != nullptr; }

  std::string WhyUnsupported(const LcpProblem& problem) const {
    return problem.is_plain() || other_ == nullptr ? pivoting_.WhyUnsupported(problem)
                                                   : other_->WhyUnsupported(problem);
  }
  void Reserve(Index max_rows) { pivoting_.Reserve(max_rows); }
  void Prepare(const LcpProblem& problem) {
    problem.is_plain() ? pivoting_.Prepare(problem) : other_->Prepare(problem);
  }
  void Solve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) {
    problem.is_plain() ? pivoting_.Solve(problem, options, result) : other_->Solve(problem, options, result);
  }
  bool SolveArrays(const ProblemArrays& arrays, const LcpOptions& options, LcpResult* result) {
    return pivoting_.SolveArrays(arrays, options, result);
  }

 private:
  LemkePivoting pivoting_;
  std::unique_ptr<LcpSolver> other_;
};

template class EngineSolver<LemkeOptions, LemkeEngine>;

}  // namespace lcpbench
