#include "solvers/auto/band_pivoting.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "solvers/linear_algebra/vector_register.h"
#include "solvers/pivoting/tableau_rules.h"

namespace lcpbench {
namespace {

size_t At(Index i) { return static_cast<size_t>(i); }

// Forward and backward, of an over-relaxed method.
constexpr int kSymmetricSweeps = 3;
constexpr double kRelaxation = 1.5;
// Violations below this part of the sum of absolute values that they are the difference of are rounding.
constexpr double kNoise = 3e-14;
// Exchanges in a row that may fail to lower the least number of violated rows, and in all.
constexpr int kPatience = 3;
constexpr int kMostRounds = 24;

Index InRegisters(Index count) { return (count + kRegister - 1) / kRegister; }

}  // namespace

void BandPivoting::Reserve(Index n) {
  if (f_.size() >= n) return;
  for (Eigen::VectorXd* v : {&f_, &w_, &size_, &inverse_pivot_}) v->resize(n);
  is_active_.resize(At(n));
  active_rows_.resize(At(n));
  place_.resize(At(n));
}

// One step of the relaxation; w_ holds A f + b of a dense A. False if nothing moved.
bool BandPivoting::SweepRow(Index i) {
  const ProblemArrays& arrays = A_->arrays();
  double gap = w_[i];
  if (!A_->is_dense()) {
    gap = arrays.b[At(i)];
    const int* const column = arrays.column.data();
    const double* const value = arrays.value.data();
    for (int e = arrays.row_start[At(i)]; e < arrays.row_start[At(i) + 1]; ++e) gap += value[e] * f_[column[e]];
  }
  const double wanted = f_[i] - kRelaxation * gap / A_->diagonal()[At(i)];
  const double f = A_->is_joint(i) ? wanted : std::max(wanted, 0.0);
  const double change = f - f_[i];
  if (change == 0) return false;
  f_[i] = f;
  if (A_->is_dense()) {
    w_.head(n_) += change * Eigen::Map<const Eigen::VectorXd>(arrays.value.data() + i * n_, n_);
  }
  return true;
}

void BandPivoting::GuessActiveRows(const Eigen::VectorXd* initial_f) {
  if (initial_f == nullptr) {
    f_.head(n_).setZero();
    w_.head(n_) = Eigen::Map<const Eigen::VectorXd>(A_->arrays().b.data(), n_);
  } else {
    f_.head(n_) = *initial_f;
    ClipForces();
    FindGaps();
  }
  bool moves = true;
  for (int sweep = 0; sweep < kSymmetricSweeps && moves; ++sweep) {
    moves = false;
    for (Index i = 0; i < n_; ++i) moves |= SweepRow(i);
    for (Index i = n_; moves && i-- > 0;) SweepRow(i);
  }
  for (Index i = 0; i < n_; ++i) is_active_[At(i)] = f_[i] > 0 || A_->is_joint(i) ? 1 : 0;
}

void BandPivoting::FindGaps() {
  const ProblemArrays& arrays = A_->arrays();
  if (A_->is_dense()) {
    auto w = w_.head(n_);
    auto size = size_.head(n_);
    w = Eigen::Map<const Eigen::VectorXd>(arrays.b.data(), n_);
    size = w.cwiseAbs();
    for (Index j = 0; j < n_; ++j) {
      if (f_[j] == 0) continue;
      const Eigen::Map<const Eigen::VectorXd> row(arrays.value.data() + j * n_, n_);
      w += f_[j] * row;
      size += std::abs(f_[j]) * row.cwiseAbs();
    }
    return;
  }
  const int* const column = arrays.column.data();
  const double* const value = arrays.value.data();
  int e = 0;
  for (Index i = 0; i < n_; ++i) {
    double w = arrays.b[At(i)];
    double size = std::abs(w);
    for (const int end = arrays.row_start[At(i) + 1]; e < end; ++e) {
      const double term = value[e] * f_[column[e]];
      w += term;
      size += std::abs(term);
    }
    w_[i] = w;
    size_[i] = size;
  }
}

// Columns of A_FF from their diagonal down.
void BandPivoting::LoadFactor() {
  const ProblemArrays& arrays = A_->arrays();
  active_count_ = 0;
  for (Index i = 0; i < n_; ++i) {
    place_[At(i)] = is_active_[At(i)] != 0 ? static_cast<std::int32_t>(active_count_) : -1;
    if (is_active_[At(i)] != 0) active_rows_[At(active_count_++)] = static_cast<std::int32_t>(i);
  }
  const Index m = active_count_;
  band_ = A_->is_dense() ? std::max<Index>(m - 1, 0) : 0;
  for (Index k = 0; k < m && !A_->is_dense(); ++k) {
    const auto row = At(active_rows_[At(k)]);
    for (int e = arrays.row_start[row + 1] - 1; e >= arrays.row_start[row]; --e) {
      const std::int32_t last = place_[At(arrays.column[At(e)])];
      if (last < 0) continue;
      band_ = std::max(band_, last - k);
      break;
    }
  }
  // A register more, so that whole ones may be read from any place of a column.
  stride_ = (InRegisters(band_ + 1) + 1) * kRegister;
  if (factor_.size() < m * stride_) factor_.resize(m * stride_);
  if (y_.size() < m + stride_) y_.resize(m + stride_);
  factor_.head(m * stride_).setZero();
  for (Index k = 0; k < m; ++k) {
    double* const to = factor_.data() + k * stride_;
    const Index row = active_rows_[At(k)];
    if (A_->is_dense()) {
      const double* const from = arrays.value.data() + row * n_;
      for (Index j = k; j < m; ++j) to[j - k] = from[active_rows_[At(j)]];
      continue;
    }
    for (int e = arrays.row_start[At(row)]; e < arrays.row_start[At(row) + 1]; ++e) {
      const Index at = place_[At(arrays.column[At(e)])];
      if (at >= k) to[at - k] = arrays.value[At(e)];
    }
  }
}

// False if a row depends on those before it.
bool BandPivoting::Factorize() {
  LoadFactor();
  const Index m = active_count_;
  for (Index k = 0; k < m; ++k) {
    const double* const column = factor_.data() + k * stride_;
    const double least = tableau::kLeastPivot * A_->diagonal()[At(active_rows_[At(k)])];
    if (!(column[0] > least)) return false;
    const double inverse = 1 / column[0];
    inverse_pivot_[k] = inverse;
    const Index reach = std::min(band_, m - 1 - k);
    for (Index t = 1; t <= reach; ++t) {
      if (column[t] == 0) continue;
      const double factor = column[t] * inverse;
      Register* const to = AsRegisters(factor_.data() + (k + t) * stride_);
      const Register* const from = AsRegisters(column + t);
      const Index registers = InRegisters(reach + 1 - t);
      for (Index v = 0; v < registers; ++v) to[v] -= factor * from[v];
    }
  }
  return true;
}

// y := (L D L^T)^-1 y.
void BandPivoting::SolveFactor() {
  const Index m = active_count_;
  const Index registers = InRegisters(band_);
  y_.segment(m, stride_).setZero();
  for (Index k = 0; k < m; ++k) {
    const double factor = y_[k] * inverse_pivot_[k];
    if (factor == 0) continue;
    const Register* const from = AsRegisters(factor_.data() + k * stride_ + 1);
    Register* const to = AsRegisters(y_.data() + k + 1);
    for (Index v = 0; v < registers; ++v) to[v] -= factor * from[v];
  }
  for (Index k = m; k-- > 0;) {
    const Register* const column = AsRegisters(factor_.data() + k * stride_ + 1);
    const Register* const x = AsRegisters(y_.data() + k + 1);
    Register sum = {};
    for (Index v = 0; v < registers; ++v) sum += column[v] * x[v];
    y_[k] = (y_[k] - Sum(&sum)) * inverse_pivot_[k];
  }
}

// How many rows have changed sides.
Index BandPivoting::ExchangeViolated() {
  Index count = 0;
  for (Index i = 0; i < n_; ++i) {
    if (A_->is_joint(i)) continue;
    const bool is_active = is_active_[At(i)] != 0;
    const double value = is_active ? f_[i] * A_->diagonal()[At(i)] : w_[i];
    if (!(value < -kNoise * size_[i])) continue;
    is_active_[At(i)] = is_active ? 0 : 1;
    ++count;
  }
  return count;
}

void BandPivoting::ClipForces() {
  for (Index i = 0; i < n_; ++i) {
    if (f_[i] < 0 && !A_->is_joint(i)) f_[i] = 0;
  }
}

// @param epsilon  of the sums w, of which each row has as many terms as the band is wide, and a few more
template <typename Real>
ResidualSums<double>::Known BandPivoting::Judge(double tolerance, const Real* w, double epsilon) const {
  ResidualSums<double> sums(tableau::kMargin * std::sqrt(tolerance));
  for (Index i = 0; i < n_; ++i) {
    sums.Add(A_->diagonal()[At(i)], A_->arrays().b[At(i)], static_cast<double>(w[i]), f_[i], A_->is_joint(i), size_[i]);
  }
  return sums.Judge(tolerance, static_cast<double>(2 * A_->bandwidth() + 5) * epsilon);
}

bool BandPivoting::MeetsInExtended(double tolerance) {
  const ProblemArrays& arrays = A_->arrays();
  if (extended_w_.size() < At(n_)) extended_w_.resize(At(n_));
  for (Index i = 0; i < n_; ++i) {
    const Index begin = A_->is_dense() ? i * n_ : arrays.row_start[At(i)];
    const Index end = A_->is_dense() ? begin + n_ : arrays.row_start[At(i) + 1];
    long double sum = arrays.b[At(i)];
    for (Index e = begin; e < end; ++e) {
      const Index j = A_->is_dense() ? e - begin : arrays.column[At(e)];
      sum += static_cast<long double>(arrays.value[At(e)]) * f_[j];
    }
    extended_w_[At(i)] = sum;
  }
  const auto epsilon = static_cast<double>(std::numeric_limits<long double>::epsilon());
  return Judge(tolerance, extended_w_.data(), epsilon) == ResidualSums<double>::Known::kRight;
}

bool BandPivoting::Meets(double tolerance) {
  using Known = ResidualSums<double>::Known;
  ClipForces();
  FindGaps();
  const Known known = Judge(tolerance, w_.data(), std::numeric_limits<double>::epsilon());
  return known == Known::kRight || (known == Known::kUnclear && MeetsInExtended(tolerance));
}

bool BandPivoting::Solve(const MatrixArrays& A, const LcpOptions& options, LcpResult* result) {
  A_ = &A;
  n_ = A.size();
  Reserve(n_);
  const Deadline deadline(options);
  GuessActiveRows(options.initial_f);
  Index least = n_ + 1;
  int patience = kPatience;
  for (int round = 1; round <= kMostRounds; ++round) {
    if (!Factorize()) return false;
    const Index m = active_count_;
    for (Index k = 0; k < m; ++k) y_[k] = -A.arrays().b[At(active_rows_[At(k)])];
    SolveFactor();
    f_.head(n_).setZero();
    for (Index k = 0; k < m; ++k) f_[active_rows_[At(k)]] = y_[k];
    FindGaps();
    const Index violated = ExchangeViolated();
    bool is_done = violated == 0 && Meets(options.tolerance);
    if (violated == 0 && !is_done) {
      for (Index k = 0; k < m; ++k) y_[k] = w_[active_rows_[At(k)]];
      SolveFactor();
      for (Index k = 0; k < m; ++k) f_[active_rows_[At(k)]] -= y_[k];
      is_done = Meets(options.tolerance);
      if (!is_done) return false;
    }
    const bool is_late = !is_done && deadline.Expired();
    if (is_done || is_late) {
      ClipForces();
      result->f = f_.head(n_);
      result->status = is_done ? LcpStatus::kSolved : LcpStatus::kTimeLimit;
      result->iterations = round;
      result->detail = "band";
      return true;
    }
    if (violated < least) {
      least = violated;
      patience = kPatience;
    } else if (--patience == 0) {
      return false;
    }
  }
  return false;
}

}  // namespace lcpbench
