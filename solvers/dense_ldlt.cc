#include "solvers/dense_ldlt.h"

#include <algorithm>

namespace lcpbench {
namespace {

using Index = Eigen::Index;

// Columns handled together, so that the vector they share is loaded and stored once for all of them.
constexpr Index kBlock = 4;
// Independent partial sums of a dot product: one 512-bit or two 256-bit registers.
constexpr Index kLanes = 8;

// Whole cache lines, but no multiple of 4 KiB: walking along a row would then hit one cache set only.
Index PaddedStride(Index rows) {
  const Index stride = (rows + 7) / 8 * 8;
  return stride % 512 == 0 ? stride + 8 : stride;
}

double Dot(const double* a, const double* x, Index count) {
  double sum = 0;
  Index i = 0;
  if (count >= kLanes) {
    double lanes[kLanes] = {};
    for (; i + kLanes <= count; i += kLanes) {
      for (Index l = 0; l < kLanes; ++l) lanes[l] += a[i + l] * x[i + l];
    }
    for (const double lane : lanes) sum += lane;
  }
  for (; i < count; ++i) sum += a[i] * x[i];
  return sum;
}

}  // namespace

void DenseLdlt::Reserve(Index max_rows) {
  size_ = 0;
  if (max_rows <= pivots_.size()) return;
  stride_ = PaddedStride(max_rows);
  columns_.resize(stride_ * max_rows);
  pivots_.resize(max_rows);
  update_.resize(max_rows);
}

void DenseLdlt::Reset(Index rows) {
  size_ = 0;
  stride_ = PaddedStride(rows);
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
  const Index m = size_;
  for (Index j = m - 2; j >= 0; --j) {
    x[j] -= Dot(columns_.data() + j * stride_ + j + 1, x + j + 1, m - j - 1);
  }
}

void DenseLdlt::Solve(double* x) const {
  ForwardSolve(x);
  for (Index k = 0; k < size_; ++k) x[k] /= pivots_[k];
  BackSolve(x);
}

double DenseLdlt::PivotOf(const double* z, double diagonal) const {
  double sum = 0;
  for (Index k = 0; k < size_; ++k) sum += z[k] * z[k] / pivots_[k];
  return diagonal - sum;
}

void DenseLdlt::Append(const double* z, double pivot) {
  const Index m = size_;
  for (Index k = 0; k < m; ++k) columns_[k * stride_ + m] = z[k] / pivots_[k];
  pivots_[m] = pivot;
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
      std::copy(from + j + 1, from + m, to + j + 1);
      continue;
    }
    const double old_pivot = pivots_[j];
    const double new_pivot = old_pivot + weight * p * p;
    const double beta = weight * p / new_pivot;
    weight *= old_pivot / new_pivot;
    pivots_[j - 1] = new_pivot;
    for (Index i = j + 1; i < m; ++i) {
      const double l = from[i];
      u[i] -= p * l;
      to[i] = l + beta * u[i];
    }
  }
  --size_;
}

}  // namespace lcpbench
