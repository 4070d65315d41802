#include "solvers/friction/profile_lu.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "solvers/linear_algebra/scaled_lcp.h"
#include "solvers/linear_algebra/vector_register.h"
#include "support/array_index.h"

namespace lcpbench {
namespace {

// A diagonal pivot is taken down to this part of the largest entry below it.
constexpr double kLeastPivot = 0.1;

Index RegisterOf(Index row) { return row / Lanes::kWidth * Lanes::kWidth; }

// y := y - factor x in the rows of the registers from `begin` to `end`
void Subtract(double factor, const double* x, Index begin, Index end, double* y) {
  const Lanes::V by = Lanes::Set(factor);
  for (Index i = begin; i < end; i += Lanes::kWidth) {
    Lanes::Store(y + i, Lanes::Fnma(by, Lanes::Load(x + i), Lanes::Load(y + i)));
  }
}

// The row of the pivot of column k, whose entries reach down to row `last`; 0 below.
Index FindPivot(const double* column, Index k, Index last) {
  const double diagonal = std::abs(column[k]);
  const Index first = RegisterOf(k);
  const Lanes::M is_below = Lanes::LanePlaces(Lanes::M{}) > Lanes::M{} + (k - first);
  Lanes::V largest = Lanes::Masked(is_below, Lanes::Abs(Lanes::Load(column + first)));
  for (Index i = first + Lanes::kWidth; i <= last; i += Lanes::kWidth) {
    largest = Lanes::Max(largest, Lanes::Abs(Lanes::Load(column + i)));
  }
  const bool is_small = !(diagonal > 0) || Lanes::Any(Lanes::Set(kLeastPivot) * largest > Lanes::Set(diagonal));
  if (!is_small) return k;
  Index pivot = k;
  for (Index i = k + 1; i <= last; ++i) {
    if (std::abs(column[i]) > std::abs(column[pivot])) pivot = i;
  }
  return pivot;
}

// Divides what is below the pivot of column k, and moves it to L.
void TakeLower(Index k, Index last, double* column, double* lower) {
  const double inverse = 1 / column[k];
  const Index first = RegisterOf(k);
  const Lanes::M lanes = Lanes::LanePlaces(Lanes::M{}), of_pivot = Lanes::M{} + (k - first);
  const Lanes::V across = Lanes::Load(column + first);
  Lanes::Store(lower + first, Lanes::Masked(lanes > of_pivot, across * Lanes::Set(inverse)));
  Lanes::Store(column + first, Lanes::Masked(lanes < of_pivot, across));
  for (Index i = first + Lanes::kWidth; i <= last; i += Lanes::kWidth) {
    Lanes::Store(lower + i, Lanes::Load(column + i) * Lanes::Set(inverse));
    Lanes::Store(column + i, Lanes::V{});
  }
  column[k] = inverse;
}

}  // namespace

void ProfileLu::Reserve(Index max_rows) {
  const Index stride = PaddedStride(max_rows);
  if (y_.size() < stride) {
    entry_.resize(stride * stride);
    lower_.resize(stride * stride);
    y_.resize(stride);
  }
  for (std::vector<Index>* const numbers : {&last_row_, &last_column_, &pivot_}) numbers->reserve(At(max_rows));
}

void ProfileLu::Start(Index m) {
  Reserve(m);
  m_ = m;
  stride_ = PaddedStride(m);
  entry_.head(m * stride_).setZero();
  last_row_.resize(At(m));
  last_column_.resize(At(m));
  for (Index k = 0; k < m; ++k) last_row_[At(k)] = last_column_[At(k)] = k;
}

// Rows are exchanged with a pivot's as far down as its column and those before reach, and bring their columns along.
void ProfileLu::FindReach() {
  for (Index k = 1; k < m_; ++k) last_row_[At(k)] = std::max(last_row_[At(k)], last_row_[At(k - 1)]);
  pivot_.resize(At(m_));
  Index seen = 0, last = 0;
  for (Index k = 0; k < m_; ++k) {
    for (; seen <= last_row_[At(k)]; ++seen) last = std::max(last, last_column_[At(seen)]);
    pivot_[At(k)] = last;
  }
  last_column_.swap(pivot_);
}

bool ProfileLu::Factorize() {
  FindReach();
  for (Index k = 0; k < m_; ++k) {
    double* const pivots = entry_.data() + k * stride_;
    double* const lower = lower_.data() + k * stride_;
    const Index last = last_row_[At(k)];
    const Index pivot = pivot_[At(k)] = FindPivot(pivots, k, last);
    // Writing single numbers of registers that are read next is slow.
    const bool is_exchanged = pivot != k;
    if (is_exchanged) std::swap(pivots[k], pivots[pivot]);
    if (!(std::abs(pivots[k]) > 0)) return false;
    TakeLower(k, last, pivots, lower);
    for (Index j = k + 1; j <= last_column_[At(k)]; ++j) {
      double* const column = entry_.data() + j * stride_;
      if (is_exchanged) std::swap(column[k], column[pivot]);
      Subtract(column[k], lower, RegisterOf(k), last + 1, column);
    }
  }
  return true;
}

void ProfileLu::Solve(double* y) {
  double* const own = y_.data();
  std::copy_n(y, m_, own);
  std::fill(own + m_, own + stride_, 0.0);
  for (Index k = 0; k < m_; ++k) {
    if (pivot_[At(k)] != k) std::swap(own[k], own[pivot_[At(k)]]);
    Subtract(own[k], lower_.data() + k * stride_, RegisterOf(k), last_row_[At(k)] + 1, own);
  }
  // Row i reaches column k from `first` on.
  for (Index k = m_ - 1, first = m_ - 1; k >= 0; --k) {
    double* const column = entry_.data() + k * stride_;
    const double value = own[k] * column[k];
    first = std::min(first, k);
    while (first > 0 && last_column_[At(first - 1)] >= k) --first;
    Subtract(value, column, RegisterOf(first), k + 1, own);
    y[k] = value;
  }
}

}  // namespace lcpbench
