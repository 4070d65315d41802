#include "solvers/rows/matrix_arrays.h"

#include <algorithm>

#include "solvers/lcp/number_range.h"

namespace lcpbench {
namespace {

// Rows and columns of a tile that stays in the cache while it is read both ways.
constexpr Index kTileOfMirrors = 16;

}  // namespace

bool MatrixArrays::Take(const ProblemView& arrays) {
  const Index n = arrays.rows;
  if (n < 1 || arrays.form == MatrixForm::kFactors || arrays.b.size() != At(n)) return false;
  if (!arrays.bilateral.empty() && arrays.bilateral.size() != At(n)) return false;
  if (!arrays.is_checked) {
    NumberRange loads(kLoadRange);
    loads.Look(arrays.b.data(), n);
    NumberRange entries(kEntryRange);
    entries.Look(arrays.value.data(), std::ssize(arrays.value));
    if (!loads.is_within() || !entries.is_within()) return false;
  }
  arrays_ = arrays;
  if (diagonal_.size() < At(n)) diagonal_.resize(At(n));
  if (!(is_dense() ? TakeDense() : TakeRows())) return false;
  return std::all_of(diagonal_.begin(), diagonal_.begin() + n, [](double d) { return d > 0; });
}

bool MatrixArrays::TakeDense() {
  const Index n = size();
  if (arrays_.value.size() % At(n) != 0 || arrays_.value.size() / At(n) != At(n)) return false;
  bandwidth_ = n - 1;
  const double* const A = arrays_.value.data();
  for (Index i = 0; i < n; ++i) diagonal_[At(i)] = A[i * n + i];
  for (Index top = 0; top < n; top += kTileOfMirrors) {
    for (Index left = 0; left <= top; left += kTileOfMirrors) {
      for (Index i = top; i < std::min(top + kTileOfMirrors, n); ++i) {
        for (Index j = left; j < std::min(left + kTileOfMirrors, i); ++j) {
          if (A[i * n + j] != A[j * n + i]) return false;
        }
      }
    }
  }
  return true;
}

// Entries (i, j), j > i, come in the order of their rows, and so do the mirror images within row j.
bool MatrixArrays::TakeRows() {
  const Index n = size();
  const std::span<const int> start = arrays_.row_start;
  const std::span<const int> column = arrays_.column;
  const std::span<const double> value = arrays_.value;
  if (arrays_.columns != n || start.size() != At(n) + 1 || value.size() != column.size()) return false;
  if (start.front() != 0 || At(start.back()) != column.size() || !std::ranges::is_sorted(start)) return false;
  next_.assign(start.begin(), start.end() - 1);
  bandwidth_ = 0;
  for (size_t i = 0; i < At(n); ++i) {
    int e = next_[i];
    const int end = start[i + 1];
    if (e >= end || At(column[At(e)]) != i) return false;  // what is left of the diagonal has met its mirror image
    diagonal_[i] = value[At(e)];
    for (int last = column[At(e++)]; e < end; ++e) {
      const int j = column[At(e)];
      if (j <= last || j >= n) return false;
      const int mirror = next_[At(j)]++;
      if (mirror >= start[At(j) + 1] || At(column[At(mirror)]) != i || value[At(mirror)] != value[At(e)]) return false;
      last = j;
    }
    bandwidth_ = std::max<Index>(bandwidth_, column[At(end) - 1] - static_cast<Index>(i));
  }
  return true;
}

}  // namespace lcpbench
