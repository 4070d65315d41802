#include "solvers/pivoting/dantzig.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "solvers/lcp/verify.h"
#include "solvers/pivoting/pivot_base.h"

namespace lcpbench {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// A step within this part of the full one is taken for the full one: a tie needs no pivot.
constexpr double kTie = 64 * std::numeric_limits<double>::epsilon();
// A step that raises w_d by less than this part of |w_d| is degenerate.
constexpr double kDegenerateStep = 1e-12;
// Degenerate steps in a row before ties go to the least index. Until then they go to the largest pivot, for stability.
constexpr int kDegenerateLimit = 20;
// A negative component of a would-be ray below this part of |D^1/2 y| may be the error of solving for y. The ray is
// refined and put to the proof before the component may block: it would at an f_d of 1 / kSmallComponent and more.
constexpr double kSmallComponent = 1e-8;

}  // namespace

// Positions: F = [0, m), of which [0, joints) are bilateral; watched rows [m, q) with f = 0, w >= 0; the driven row q
// and the waiting rows behind it, [q, open); then rows out of play: dependent bilateral rows and stuck ones.
class DantzigEngine final : public PivotBase {
 public:
  explicit DantzigEngine(const DantzigOptions& options)
      : PivotBase(options, options.order == DantzigOrder::kIndex ? std::optional(TableauRule::kDriven) : std::nullopt),
        order_(options.order) {}

  void Reserve(Index max_rows) override;

 private:
  struct Blocking {
    Index row = kNoRow;
    double step = 0;
  };

  bool FindViolations(int round) override;
  End MakeRight(LcpResult* result) override;
  End Drive(LcpResult* result);
  Blocking FindBlocking(double s, double norm2, bool singular, bool least_index) const;
  void Advance(double step, double s, bool singular);
  void Retreat(double norm2);
  double NoiseAlongDirection() const;
  bool IsSmall(Index p, double norm2) const;

  Index rates_end() const { return order_ == DantzigOrder::kIndex ? q_ : open_; }

  const DantzigOrder order_;
  Index q_ = 0;
  Eigen::VectorXd dw_;  // rates of w along the direction, by position
};

// A y = 0 for y = (df_F, 1), so w_q = y.w = y.b but for the rounding of every row of F, each weighted by its |y_i|.
double DantzigEngine::NoiseAlongDirection() const {
  const double* df = active_.df();
  const double own = std::abs(lcp_.f[q_]);
  const double* c = lcp_.column(q_);
  double sum = lcp_.FreshW(q_, m()).magnitude + lcp_.diagonal[q_] * own;
  for (Index p = 0; p < m(); ++p) {
    if (df[p] != 0) sum += std::abs(df[p]) * (lcp_.FreshW(p, m()).magnitude + std::abs(c[p]) * own);
  }
  return kNoise * sum;
}

bool DantzigEngine::IsSmall(Index p, double norm2) const {
  const double df = active_.df()[p];
  return df * df * lcp_.diagonal[p] <= kSmallComponent * kSmallComponent * norm2;
}

// w_q = 0 but for rounding while row q depends on F through A (df_F, 1) = 0: goes back along that direction, which
// changes no w, until row q or a row of F that it can replace has f = 0.
void DantzigEngine::Retreat(double norm2) {
  const double* df = active_.df();
  Index leaving = q_;
  double step = lcp_.f[q_];
  for (Index p = joints_; p < m(); ++p) {
    if (df[p] <= 0 || lcp_.f[p] >= step * df[p]) continue;
    if (df[p] * df[p] * lcp_.diagonal[p] <= kNoise * kNoise * norm2) continue;
    step = lcp_.f[p] / df[p];
    leaving = p;
  }
  Advance(-step, 0, true);
  lcp_.w[q_] = 0;
  lcp_.f[leaving] = 0;
  if (leaving != q_) {
    lcp_.w[leaving] = 0;
    active_.Leave(leaving);
    const double pivot = active_.SetDriven(q_);
    if (pivot > 0) {
      active_.EnterDriven(q_, pivot);
    } else {
      lcp_.f[q_] = 0;
    }
  }
  ++q_;
}

void DantzigEngine::Advance(double step, double s, bool singular) {
  const double* df = active_.df();
  double* f = lcp_.f.data();
  double* w = lcp_.w.data();
  for (Index p = 0; p < joints_; ++p) f[p] += step * df[p];
  for (Index p = joints_; p < m(); ++p) f[p] = std::max(f[p] + step * df[p], 0.0);
  f[q_] += step;
  if (singular) return;  // no w moves
  for (Index p = m(); p < q_; ++p) w[p] = std::max(w[p] + step * dw_[p], 0.0);
  for (Index p = q_ + 1; p < rates_end(); ++p) w[p] += step * dw_[p];
  w[q_] += step * s;
}

// The first row to reach zero along the direction, before w_q does.
DantzigEngine::Blocking DantzigEngine::FindBlocking(double s, double norm2, bool singular, bool least_index) const {
  const double* df = active_.df();
  const double full = singular ? kInfinity : -lcp_.w[q_] / s;
  const double still = singular ? 0 : kDegenerateStep * full;
  const double rounding = kNoise * kNoise * norm2;  // squared size of components of y that are rounding
  Blocking blocking{kNoRow, full * (1 - kTie)};
  double strength = 0;
  const auto offer = [&](Index p, double step, double candidate) {
    if (least_index && step <= still) step = 0;
    if (step > blocking.step) return;
    if (step == blocking.step && blocking.row != kNoRow) {
      const bool prefer = least_index ? lcp_.row[static_cast<size_t>(p)] < lcp_.row[static_cast<size_t>(blocking.row)]
                                      : candidate > strength;
      if (!prefer) return;
    }
    blocking = {p, step};
    strength = candidate;
  };
  for (Index p = joints_; p < m(); ++p) {
    if (df[p] >= 0) continue;
    const double size = df[p] * df[p] * lcp_.diagonal[p];
    if (size > rounding) offer(p, lcp_.f[p] / -df[p], size / norm2);
  }
  if (!singular) {
    for (Index p = m(); p < q_; ++p) {
      if (dw_[p] >= 0) continue;
      const double size = dw_[p] * dw_[p] / lcp_.diagonal[p];
      if (size > rounding) offer(p, lcp_.w[p] / -dw_[p], size / s);
    }
  }
  if (blocking.row == kNoRow) blocking.step = full;
  return blocking;
}

PivotBase::End DantzigEngine::Drive(LcpResult* result) {
  int degenerate = 0;
  double s = active_.SetDriven(q_);
  for (;;) {
    if (pivots_ >= pivot_limit_) return End::kIterationLimit;
    if (TimeIsUp(m() * (m() + rates_end() - m()))) return End::kTimeLimit;
    ++pivots_;
    const double norm2 = active_.Direction(q_);
    const bool singular = !(s > rank_tolerance_ * norm2);
    if (singular) {
      if (lcp_.w[q_] >= -NoiseAlongDirection()) {
        Retreat(norm2);
        return End::kDone;
      }
    } else {
      std::copy(lcp_.column(q_) + m(), lcp_.column(q_) + rates_end(), dw_.data() + m());
      lcp_.AddColumns(m(), rates_end(), m(), active_.df(), dw_.data());
    }
    Blocking blocking;
    double s_blocking = 0;
    for (;;) {
      blocking = FindBlocking(s, norm2, singular, degenerate >= kDegenerateLimit);
      if (blocking.row < m()) break;
      s_blocking = active_.PivotOf(blocking.row);
      if (s_blocking > rank_tolerance_ * lcp_.diagonal[blocking.row]) break;
      dw_[blocking.row] = 0;  // depends on F, so only rounding moves its w
    }
    if (singular && (blocking.row == kNoRow || IsSmall(blocking.row, norm2))) {
      const bool matters = lcp_.ResidualShare(q_, lcp_.w[q_]) > proof_tolerance_;
      if (matters && ClaimRay(q_, 1, result)) return End::kInfeasible;
      if (blocking.row == kNoRow) return End::kStuck;
    }
    const bool still = singular || blocking.step * s <= -kDegenerateStep * lcp_.w[q_];
    degenerate = still ? degenerate + 1 : 0;
    Advance(blocking.step, s, singular);
    if (blocking.row == kNoRow) {
      lcp_.w[q_] = 0;
      active_.EnterDriven(q_, s);
      ++q_;
      return End::kDone;
    }
    lcp_.f[blocking.row] = 0;
    lcp_.w[blocking.row] = 0;
    if (blocking.row < m()) {
      active_.Leave(blocking.row);
      s = active_.SetDriven(q_);
    } else {
      s = active_.Enter(blocking.row, s_blocking, q_);
    }
  }
}

PivotBase::End DantzigEngine::MakeRight(LcpResult* result) {
  while (q_ < open_) {
    if (order_ == DantzigOrder::kMostNegative) {
      const auto size = [this](Index p) { return lcp_.w[p] * std::abs(lcp_.w[p]) / lcp_.diagonal[p]; };
      Index worst = q_;
      for (Index p = q_ + 1; p < open_; ++p) {
        if (size(p) < size(worst)) worst = p;
      }
      lcp_.Swap(worst, q_);
    }
    const PermutedLcp::Sum w = lcp_.FreshW(q_, m());
    lcp_.w[q_] = w.value;
    if (w.value >= -kNoise * w.magnitude) {
      lcp_.w[q_] = std::max(w.value, 0.0);
      ++q_;
      continue;
    }
    const End end = Drive(result);
    if (end == End::kStuck) {
      const bool moved = lcp_.f[q_] != 0;
      lcp_.f[q_] = 0;
      lcp_.Swap(q_, --open_);
      if (moved) {
        SolveForces(Leaving::kAll);
        q_ = SetViolatedApart();
      }
    } else if (end != End::kDone) {
      return end;
    }
  }
  return End::kDone;
}

void DantzigEngine::Reserve(Index max_rows) {
  if (max_rows <= dw_.size()) return;
  PivotBase::Reserve(max_rows);
  dw_.setZero(max_rows);
}

// Violated rows wait to be driven, the others are watched. At first all rows wait that no block has looked at.
bool DantzigEngine::FindViolations(int round) {
  const bool is_known = round == 0 && (violated_ > m() || order_ == DantzigOrder::kIndex);
  q_ = is_known ? violated_ : SetViolatedApart();
  return q_ < open_;
}

DantzigOptions DantzigOptions::FromSettings(const Settings& settings) {
  SettingsReader reader("dantzig", settings);
  DantzigOptions options;
  options.Read(&reader);
  if (reader.Choice("order", "index", {"index", "most-negative"}) == "most-negative") {
    options.order = DantzigOrder::kMostNegative;
  }
  reader.Finish();
  return options;
}

template class EngineSolver<DantzigOptions, DantzigEngine>;

}  // namespace lcpbench
