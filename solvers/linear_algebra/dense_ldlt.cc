#include "solvers/linear_algebra/dense_ldlt.h"

#include <Eigen/Core>
#include <algorithm>
#include <vector>

#include "solvers/lcp/factor_clock.h"
#include "solvers/linear_algebra/scaled_lcp.h"

namespace lcpbench {
namespace {

using Index = Eigen::Index;

// Columns handled together, so that the vector they share is loaded and stored once for all of them.
constexpr Index kBlock = 4;
// Independent partial sums of a dot product: one 512-bit or two 256-bit registers. Also the width of a panel.
constexpr Index kLanes = DenseLdlt::kLanes;
using Lanes = Eigen::Array<double, kLanes, 1>;
using LanesOfColumn = Eigen::Map<Lanes, Eigen::AlignedMax>;
using ReadLanes = Eigen::Map<const Lanes, Eigen::AlignedMax>;
// Multiply-adds of a factorization between two looks at the clock, some 10 us.
constexpr Index kUpdatesPerClockRead = 1 << 17;

Index FirstLane(Index row) { return row / kLanes * kLanes; }

}  // namespace

void DenseLdlt::Reserve(Index max_rows) {
  size_ = 0;
  if (max_rows <= pivots_.size()) return;
  stride_ = PaddedStride(max_rows);
  columns_.setZero(stride_ * (max_rows + kBlock));
  for (Eigen::VectorXd* v : {&pivots_, &inverse_, &update_}) v->resize(max_rows);
}

void DenseLdlt::Reset(Index rows) {
  size_ = 0;
  stride_ = PaddedStride(rows);
}

// Columns [begin, begin + width) of L from what the panels before have left of the matrix. Left out rows get a column
// of zeros and the pivot 0. Whole lanes are computed, also where they reach above the diagonal: nobody reads that.
void DenseLdlt::FactorPanel(Index begin, Index width, Index rows, double threshold, bool all_enter) {
  for (Index j = begin; j < begin + width; ++j) {
    double* c = column(j);
    for (Index t = begin; t < j; ++t) {
      const double* l = column(t);
      const double s = l[j] * pivots_[t];
      if (s == 0) continue;
      for (Index i = begin; i < rows; i += kLanes) LanesOfColumn(c + i) -= ReadLanes(l + i) * s;
    }
    const double least = threshold * update_[j];
    pivots_[j] = all_enter ? std::max(c[j], least) : c[j] > least ? c[j] : 0.0;
    inverse_[j] = pivots_[j] != 0 ? 1 / pivots_[j] : 0.0;
    for (Index i = begin; i < rows; i += kLanes) LanesOfColumn(c + i) *= inverse_[j];
  }
}

// The matrix behind the panel at `begin`, four columns from `column` on: minus L D L^T of the panel.
void DenseLdlt::UpdateBehindPanel(Index begin, Index column_begin, Index rows) {
  double* c[kBlock];
  double s[kLanes][kBlock];
  for (Index q = 0; q < kBlock; ++q) c[q] = column(column_begin + q);
  bool any = false;
  for (Index t = 0; t < kLanes; ++t) {
    for (Index q = 0; q < kBlock; ++q) {
      s[t][q] = column(begin + t)[column_begin + q] * pivots_[begin + t];
      any = any || s[t][q] != 0;
    }
  }
  if (!any) return;
  const double* l = column(begin);
  for (Index i = FirstLane(column_begin); i < rows; i += kLanes) {
    Lanes sum[kBlock];
    for (Index q = 0; q < kBlock; ++q) sum[q] = LanesOfColumn(c[q] + i);
    for (Index t = 0; t < kLanes; ++t) {
      const Lanes from = ReadLanes(l + t * stride_ + i);
      for (Index q = 0; q < kBlock; ++q) sum[q] -= from * s[t][q];
    }
    for (Index q = 0; q < kBlock; ++q) LanesOfColumn(c[q] + i) = sum[q];
  }
}

void DenseLdlt::Keep(const std::vector<Index>& kept) {
  size_ = std::ssize(kept);
  const auto from = [&](Index k) { return kept[static_cast<size_t>(k)]; };  // >= k
  for (Index k = 0; k < size_; ++k) {
    pivots_[k] = pivots_[from(k)];
    inverse_[k] = inverse_[from(k)];
    for (Index i = k + 1; i < size_; ++i) column(k)[i] = column(from(k))[from(i)];
  }
}

bool DenseLdlt::Factor(Index rows, double threshold, std::vector<Index>* kept, const Deadline* deadline) {
  const FactorClock::Scope clock;
  size_ = 0;
  for (Index k = 0; k < rows; ++k) update_[k] = column(k)[k];
  Index work = 0;
  for (Index begin = 0; begin < rows; begin += kLanes) {
    const Index width = std::min(kLanes, rows - begin);
    FactorPanel(begin, width, rows, threshold, kept == nullptr);
    for (Index k = begin + kLanes; k < rows; k += kBlock) {
      // The last columns may be none of the matrix: their storage is there, and nobody reads it.
      UpdateBehindPanel(begin, k, rows);
      work += kBlock * kLanes * (rows - k);
      if (deadline == nullptr || work < kUpdatesPerClockRead) continue;
      work = 0;
      if (deadline->Expired()) return false;
    }
  }
  size_ = rows;
  if (kept == nullptr) return true;
  kept->clear();
  for (Index k = 0; k < rows; ++k) {
    if (pivots_[k] != 0) kept->push_back(k);
  }
  if (std::ssize(*kept) < rows) Keep(*kept);
  return true;
}

void DenseLdlt::ForwardSolve(double* __restrict x) const {
  const Index m = size_;
  Index j = 0;
  for (; j + kBlock <= m; j += kBlock) {
    const double* __restrict c0 = columns_.data() + j * stride_;
    const double* __restrict c1 = c0 + stride_;
    const double* __restrict c2 = c1 + stride_;
    const double* __restrict c3 = c2 + stride_;
    const double x0 = x[j];
    const double x1 = x[j + 1] - c0[j + 1] * x0;
    const double x2 = x[j + 2] - c0[j + 2] * x0 - c1[j + 2] * x1;
    const double x3 = x[j + 3] - c0[j + 3] * x0 - c1[j + 3] * x1 - c2[j + 3] * x2;
    x[j + 1] = x1;
    x[j + 2] = x2;
    x[j + 3] = x3;
    if (x0 == 0 && x1 == 0 && x2 == 0 && x3 == 0) continue;
    for (Index i = j + kBlock; i < m; ++i) x[i] -= (c0[i] * x0 + c1[i] * x1) + (c2[i] * x2 + c3[i] * x3);
  }
  for (; j < m; ++j) {
    const double* c = columns_.data() + j * stride_;
    for (Index i = j + 1; i < m; ++i) x[i] -= c[i] * x[j];
  }
}

void DenseLdlt::BackSolve(double* x) const {
  const Eigen::Map<const Eigen::MatrixXd, 0, Eigen::OuterStride<>> L(columns_.data(), size_, size_,
                                                                     Eigen::OuterStride<>(stride_));
  Eigen::Map<Eigen::VectorXd> solution(x, size_);
  L.transpose().triangularView<Eigen::UnitUpper>().solveInPlace(solution);
}

void DenseLdlt::Solve(double* x) const {
  ForwardSolve(x);
  for (Index k = 0; k < size_; ++k) x[k] *= inverse_[k];
  BackSolve(x);
}

double DenseLdlt::PivotOf(const double* z, double diagonal) const {
  double sum = 0;
  for (Index k = 0; k < size_; ++k) sum += z[k] * z[k] * inverse_[k];
  return diagonal - sum;
}

void DenseLdlt::Append(const double* z, double pivot) {
  const Index m = size_;
  for (Index k = 0; k < m; ++k) columns_[k * stride_ + m] = z[k] * inverse_[k];
  pivots_[m] = pivot;
  inverse_[m] = 1 / pivot;
  ++size_;
}

void DenseLdlt::Remove(Index k) {
  const Index m = size_;
  for (Index j = 0; j < k; ++j) {
    double* c = columns_.data() + j * stride_;
    std::copy(c + k + 1, c + m, c + k);
  }
  // u = l, the part of column k that becomes a rank-one term; weight = d_k.
  double* __restrict u = update_.data();
  std::copy(columns_.data() + k * stride_ + k + 1, columns_.data() + k * stride_ + m, u + k + 1);
  double weight = pivots_[k];
  for (Index j = k + 1; j < m; ++j) {
    const double* __restrict from = columns_.data() + j * stride_;
    double* __restrict to = columns_.data() + (j - 1) * stride_ - 1;  // row i lands in row i - 1
    const double p = u[j];
    if (p == 0) {
      pivots_[j - 1] = pivots_[j];
      inverse_[j - 1] = inverse_[j];
      std::copy(from + j + 1, from + m, to + j + 1);
      continue;
    }
    const double old_pivot = pivots_[j];
    const double new_pivot = old_pivot + weight * p * p;
    const double inverse = 1 / new_pivot;
    const double beta = weight * p * inverse;
    weight *= old_pivot * inverse;
    pivots_[j - 1] = new_pivot;
    inverse_[j - 1] = inverse;
    for (Index i = j + 1; i < m; ++i) {
      const double l = from[i];
      u[i] -= p * l;
      to[i] = l + beta * u[i];
    }
  }
  --size_;
}

}  // namespace lcpbench
