#include "solvers/auto/band_pivoting.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "solvers/linear_algebra/tableau_rules.h"
#include "solvers/linear_algebra/vector_register.h"
#include "solvers/rows/exchange_blocks.h"
#include "support/array_index.h"

namespace lcpbench {
namespace {

// The relaxation of the two sweeps that guess the active set. With 1 obstacle problems of some hundred rows take 10 %
// more time.
constexpr double kRelaxation = 1.5;
// Violations below this part of the sum of absolute values that they are the difference of are rounding.
constexpr double kNoise = 3e-14;
// Exchanges in a row that may fail to lower the least number of violated rows, and in all.
constexpr int kPatience = 3;
constexpr int kMostRounds = 24;

}  // namespace

void BandPivoting::Reserve(Index n) {
  const Index width = A_->is_dense() ? n / 2 + 1 : A_->bandwidth();
  factor_.Reserve(n, (width + 2 * kRegister) * n);
  if (f_.size() >= n + kRegister) return;
  for (Eigen::VectorXd* v : {&f_, &w_, &size_, &correction_}) v->setZero(n + kRegister);
  is_active_.resize(At(n));
}

// Entries of row i: visit(column, value).
template <typename Visit>
void BandPivoting::ForEntries(Index i, const Visit& visit) const {
  const ProblemArrays& arrays = A_->arrays();
  if (A_->is_dense()) {
    for (Index j = 0; j < n_; ++j) visit(j, arrays.value[At(i * n_ + j)]);
    return;
  }
  const int* const column = arrays.column.data();
  const double* const value = arrays.value.data();
  for (int e = arrays.row_start[At(i)]; e < arrays.row_start[At(i) + 1]; ++e) visit(Index{column[e]}, value[e]);
}

// (A f + b)_i in sums of type Real.
template <typename Real>
Real BandPivoting::Gap(Index i, double* size) const {
  Real gap = A_->arrays().b[At(i)];
  double sum = std::abs(static_cast<double>(gap));
  ForEntries(i, [&](Index j, double a) {
    const Real term = static_cast<Real>(a) * f_[j];
    gap += term;
    sum += std::abs(static_cast<double>(term));
  });
  *size = sum;
  return gap;
}

// One step of the relaxation; w_ holds A f + b of a dense A. False if nothing moved.
bool BandPivoting::SweepRow(Index i) {
  double gap = w_[i];
  if (!A_->is_dense()) {
    gap = A_->arrays().b[At(i)];
    ForEntries(i, [&](Index j, double a) { gap += a * f_[j]; });
  }
  const double wanted = f_[i] - kRelaxation * gap / A_->diagonal()[At(i)];
  const double f = A_->is_joint(i) ? wanted : std::max(wanted, 0.0);
  const double change = f - f_[i];
  if (change == 0) return false;
  f_[i] = f;
  if (A_->is_dense()) {
    w_.head(n_) += change * Eigen::Map<const Eigen::VectorXd>(A_->arrays().value.data() + i * n_, n_);
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
  bool moves = false;
  for (Index i = 0; i < n_; ++i) moves |= SweepRow(i);
  for (Index i = n_; moves && i-- > 0;) SweepRow(i);
  for (Index i = 0; i < n_; ++i) is_active_[At(i)] = f_[i] > 0 || A_->is_joint(i) ? 1 : 0;
}

void BandPivoting::FindGaps() {
  if (!A_->is_dense()) {
    for (Index i = 0; i < n_; ++i) w_[i] = Gap<double>(i, &size_[i]);
    return;
  }
  const ProblemArrays& arrays = A_->arrays();
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
}

bool BandPivoting::LoadFactor() {
  const ProblemArrays& arrays = A_->arrays();
  const bool has_room = factor_.LayOut(
      n_, [&](Index i) { return A_->is_dense() ? 0 : std::min(i, Index{arrays.column[At(arrays.row_start[At(i)])]}); });
  if (!has_room) return false;
  factor_.Clear();
  for (Index i = 0; i < n_; ++i) {
    double* const row = factor_.row(i);
    ForEntries(i, [&](Index j, double a) {
      if (j <= i) row[j] = a;
    });
  }
  return true;
}

// False if a row depends on those before it.
bool BandPivoting::FindBasicPoint() {
  if (!factor_.Factorize(is_active_.data(), 0, nullptr)) return false;
  for (Index i = 0; i < n_; ++i) f_[i] = is_active_[At(i)] != 0 ? -A_->arrays().b[At(i)] : 0.0;
  factor_.Solve(f_.data());
  FindGaps();
  return true;
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

// @param gap      of a row, in sums of type Real, of which each has as many terms as the band is wide, and a few more
template <typename Real, typename OfRow>
LawSums<double>::Known BandPivoting::Judge(double tolerance, const OfRow& gap) const {
  LawSums<double> sums(tableau::kMargin * std::sqrt(tolerance));
  for (Index i = 0; i < n_; ++i) {
    const auto w = static_cast<double>(gap(i));
    sums.Add(A_->diagonal()[At(i)], A_->arrays().b[At(i)], w, f_[i], A_->is_joint(i), size_[i]);
  }
  const auto epsilon = static_cast<double>(std::numeric_limits<Real>::epsilon());
  double rho = 0;
  return sums.Judge(tolerance, static_cast<double>(2 * A_->bandwidth() + 5) * epsilon, &rho);
}

// In double, and in extended precision where rounding may hide more than the tolerance.
bool BandPivoting::Meets(double tolerance) {
  using Known = LawSums<double>::Known;
  ClipForces();
  FindGaps();
  const Known known = Judge<double>(tolerance, [&](Index i) { return w_[i]; });
  if (known != Known::kUnclear) return known == Known::kRight;
  return Judge<long double>(tolerance, [&](Index i) { return Gap<long double>(i, &size_[i]); }) == Known::kRight;
}

bool BandPivoting::Solve(const MatrixArrays& A, const LcpOptions& options, const Deadline* deadline,
                         LcpResult* result) {
  A_ = &A;
  n_ = A.size();
  Reserve(n_);
  GuessActiveRows(options.initial_f);
  if (!LoadFactor()) return false;
  std::int64_t factors = 0;
  bool is_late = false;
  const auto find = [&] {
    is_late = factors > 0 && deadline != nullptr && deadline->Expired();
    return !is_late && ++factors > 0 && FindBasicPoint();
  };
  bool is_done = ExchangeBlocks(kMostRounds, kPatience, find, [&] { return ExchangeViolated(); });
  if (!is_done && !is_late) return false;
  if (is_done && !Meets(options.tolerance)) {
    for (Index i = 0; i < n_; ++i) correction_[i] = is_active_[At(i)] != 0 ? w_[i] : 0.0;
    factor_.Solve(correction_.data());
    f_.head(n_) -= correction_.head(n_);
    if (!Meets(options.tolerance)) return false;
  }
  ClipForces();
  result->f = f_.head(n_);
  result->status = is_done ? LcpStatus::kSolved : LcpStatus::kTimeLimit;
  result->iterations = factors;
  result->detail = "band";
  return true;
}

}  // namespace lcpbench
