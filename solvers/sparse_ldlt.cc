#include "solvers/sparse_ldlt.h"

#include <algorithm>
#include <cstdint>
#include <limits>

namespace lcpbench {
namespace {

// Multiply-adds between two looks at the clock: some 10 to 20 us.
constexpr Eigen::Index kWorkPerClockRead = 8192;

size_t At(Eigen::Index i) { return static_cast<size_t>(i); }

}  // namespace

bool SparseLdlt::Analyse(const OrderedLcp& lcp) {
  n_ = static_cast<int>(lcp.n);
  for (std::vector<int>* v : {&count_, &pattern_}) v->assign(At(n_), 0);
  for (std::vector<int>* v : {&parent_, &mark_}) v->assign(At(n_), -1);
  for (std::vector<double>* v : {&work_, &pivot_}) v->assign(At(n_), 0);
  in_F_.assign(At(n_), 0);
  rows_.clear();
  rows_.reserve(At(n_));
  for (int k = 0; k < n_; ++k) {
    mark_[At(k)] = k;
    for (int e = lcp.begin[At(k)]; e < lcp.diagonal_at[At(k)]; ++e) {
      for (int i = lcp.column[At(e)]; mark_[At(i)] != k; i = parent_[At(i)]) {
        if (parent_[At(i)] < 0) parent_[At(i)] = k;
        ++count_[At(i)];
        mark_[At(i)] = k;
      }
    }
  }
  std::int64_t entries = 0;
  for (const int count : count_) entries += count;
  if (entries > std::numeric_limits<int>::max()) return false;
  start_.resize(At(n_) + 1);
  start_[0] = 0;
  for (int j = 0; j < n_; ++j) start_[At(j) + 1] = start_[At(j)] + count_[At(j)];
  index_.resize(At(start_[At(n_)]));
  lower_.resize(At(start_[At(n_)]));
  std::fill(count_.begin(), count_.end(), 0);
  std::fill(parent_.begin(), parent_.end(), -1);
  Forget();
  return true;
}

// Forgets all rows from `first` on.
void SparseLdlt::Truncate(int first) {
  while (!rows_.empty() && rows_.back() >= first) {
    const int j = rows_.back();
    rows_.pop_back();
    count_[At(j)] = 0;
    parent_[At(j)] = -1;
  }
  for (const int j : rows_) {
    if (parent_[At(j)] >= first) parent_[At(j)] = -1;
    int count = count_[At(j)];
    while (count > 0 && index_[At(start_[At(j)] + count - 1)] >= first) --count;
    count_[At(j)] = count;
  }
}

// Row k of L. Returns the multiply-adds that it took.
SparseLdlt::Index SparseLdlt::AppendRow(const OrderedLcp& lcp, int k, const char* in_F) {
  double* __restrict y = work_.data();
  int* __restrict mark = mark_.data();
  int* __restrict pattern = pattern_.data();
  mark[k] = k;
  int top = n_;
  const int end = lcp.diagonal_at[At(k)];
  for (int e = lcp.begin[At(k)]; e < end; ++e) {
    int i = lcp.column[At(e)];
    if (in_F[i] == 0) continue;
    y[i] = lcp.value[At(e)];
    int length = 0;
    for (; i >= 0 && mark[i] != k; i = parent_[At(i)]) {
      pattern[length++] = i;
      mark[i] = k;
    }
    while (length > 0) pattern[--top] = pattern[--length];
  }
  const double diagonal = lcp.diagonal[k];
  double pivot = diagonal * (1 + shift_);
  Index work = 1;
  for (int t = top; t < n_; ++t) {
    const int i = pattern[t];
    const double yi = y[i];
    y[i] = 0;
    const int from = start_[At(i)];
    const int to = from + count_[At(i)]++;
    for (int e = from; e < to; ++e) y[index_[At(e)]] -= lower_[At(e)] * yi;
    const double l = yi / pivot_[At(i)];
    pivot -= l * yi;
    lower_[At(to)] = l;
    index_[At(to)] = k;
    if (parent_[At(i)] < 0) parent_[At(i)] = k;
    work += to - from + 1;
  }
  least_pivot_ = std::min(least_pivot_, pivot / diagonal);
  pivot_[At(k)] = std::max(pivot, shift_ * diagonal);
  rows_.push_back(k);
  return work;
}

bool SparseLdlt::Factor(const OrderedLcp& lcp, double shift, const char* in_F, const Deadline& deadline) {
  int first = 0;
  if (shift == shift_) {
    while (first < n_ && (in_F[first] != 0) == (in_F_[At(first)] != 0)) ++first;
  }
  shift_ = shift;
  if (first == 0) least_pivot_ = std::numeric_limits<double>::infinity();
  Truncate(first);
  std::copy(in_F + first, in_F + n_, in_F_.begin() + first);
  std::fill(mark_.begin(), mark_.end(), -1);
  Index work = 0;
  for (int k = first; k < n_; ++k) {
    if (in_F[k] == 0) continue;
    work += AppendRow(lcp, k, in_F);
    if (work < kWorkPerClockRead) continue;
    work = 0;
    if (deadline.Expired()) {
      Forget();
      return false;
    }
  }
  return true;
}

void SparseLdlt::Solve(double* __restrict x) const {
  for (int p = 0; p < n_; ++p) {
    if (in_F_[At(p)] == 0) x[p] = 0;
  }
  for (const int j : rows_) {
    const double xj = x[j];
    if (xj == 0) continue;
    const int from = start_[At(j)];
    const int to = from + count_[At(j)];
    for (int e = from; e < to; ++e) x[index_[At(e)]] -= lower_[At(e)] * xj;
  }
  for (auto it = rows_.rbegin(); it != rows_.rend(); ++it) {
    const int j = *it;
    double sum = x[j] / pivot_[At(j)];
    const int from = start_[At(j)];
    const int to = from + count_[At(j)];
    for (int e = from; e < to; ++e) sum -= lower_[At(e)] * x[index_[At(e)]];
    x[j] = sum;
  }
}

}  // namespace lcpbench
