#include "solvers/friction/profile_lu.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "support/array_index.h"

namespace lcpbench {

void ProfileLu::Reserve(Index max_rows) {
  entry_.reserve(At(max_rows * max_rows));
  for (std::vector<Index>* const numbers : {&last_row_, &last_column_, &pivot_}) numbers->reserve(At(max_rows));
}

void ProfileLu::Start(Index m) {
  m_ = m;
  entry_.assign(At(m * m), 0);
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
    double* const pivots = entry_.data() + k * m_;
    const Index end = last_row_[At(k)] + 1;
    Index pivot = k;
    for (Index i = k + 1; i < end; ++i) {
      if (std::abs(pivots[i]) > std::abs(pivots[pivot])) pivot = i;
    }
    if (!(std::abs(pivots[pivot]) > 0)) return false;
    pivot_[At(k)] = pivot;
    std::swap(pivots[k], pivots[pivot]);
    const double inverse = 1 / pivots[k];
    pivots[k] = inverse;
    for (Index i = k + 1; i < end; ++i) pivots[i] *= inverse;
    for (Index j = k + 1; j <= last_column_[At(k)]; ++j) {
      double* const column = entry_.data() + j * m_;
      std::swap(column[k], column[pivot]);
      const double factor = column[k];
      if (factor == 0) continue;
      for (Index i = k + 1; i < end; ++i) column[i] -= factor * pivots[i];
    }
  }
  return true;
}

void ProfileLu::Solve(double* y) const {
  for (Index k = 0; k < m_; ++k) {
    const double* const pivots = entry_.data() + k * m_;
    std::swap(y[k], y[pivot_[At(k)]]);
    if (y[k] == 0) continue;
    for (Index i = k + 1; i <= last_row_[At(k)]; ++i) y[i] -= y[k] * pivots[i];
  }
  // Row i reaches column k from `first` on.
  for (Index k = m_ - 1, first = m_ - 1; k >= 0; --k) {
    const double* const column = entry_.data() + k * m_;
    y[k] *= column[k];
    first = std::min(first, k);
    while (first > 0 && last_column_[At(first - 1)] >= k) --first;
    for (Index i = first; i < k; ++i) y[i] -= y[k] * column[i];
  }
}

}  // namespace lcpbench
