#include "solvers/linear_algebra/supernodal_factor.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "support/array_index.h"

// The Fortran interface, which every BLAS and LAPACK has; lengths of character arguments come last.
extern "C" {
void dsyrk_(const char* uplo, const char* trans, const int* n, const int* k, const double* alpha, const double* a,
            const int* lda, const double* beta, double* c, const int* ldc, std::size_t, std::size_t);
void dgemm_(const char* trans_a, const char* trans_b, const int* m, const int* n, const int* k, const double* alpha,
            const double* a, const int* lda, const double* b, const int* ldb, const double* beta, double* c,
            const int* ldc, std::size_t, std::size_t);
void dtrsm_(const char* side, const char* uplo, const char* trans, const char* diag, const int* m, const int* n,
            const double* alpha, const double* a, const int* lda, double* b, const int* ldb, std::size_t, std::size_t,
            std::size_t, std::size_t);
void dtrsv_(const char* uplo, const char* trans, const char* diag, const int* n, const double* a, const int* lda,
            double* x, const int* incx, std::size_t, std::size_t, std::size_t);
void dgemv_(const char* trans, const int* m, const int* n, const double* alpha, const double* a, const int* lda,
            const double* x, const int* incx, const double* beta, double* y, const int* incy, std::size_t);
void dpotrf_(const char* uplo, const int* n, double* a, const int* lda, int* info, std::size_t);
}

namespace lcpbench {
namespace {

constexpr double kOne = 1;
constexpr double kMinusOne = -1;
constexpr double kZero = 0;
constexpr int kStride = 1;
constexpr int kNone = -1;

// Up to these many multiply-adds plain loops are faster than a call of the BLAS, which takes about a microsecond before
// it begins to multiply: measured on the narrow supernodes of piles, three of four products.
constexpr std::size_t kSmallProduct = 6000;
constexpr int kSmallTriangle = 8;

// C = B B_1^T below its diagonal: B has `outer` rows, of which the first `inner` are B_1, and `columns`.
void MultiplySmall(const double* b, std::size_t stride, int columns, int inner, int outer, double* c) {
  for (int j = 0; j < inner; ++j) {
    double* __restrict column = c + At(j) * At(outer);
    const double* __restrict first = b;
    const double by = first[j];
    for (int i = j; i < outer; ++i) column[i] = by * first[i];
    for (int k = 1; k < columns; ++k) {
      const double* __restrict next = b + At(k) * stride;
      const double factor = next[j];
      for (int i = j; i < outer; ++i) column[i] += factor * next[i];
    }
  }
}

// The panel's own triangle and the rows below it at once, right-looking. False at a pivot that is not positive.
bool FactorizeSmall(double* panel, int height, int columns) {
  const std::size_t stride = At(height);
  for (int j = 0; j < columns; ++j) {
    double* __restrict column = panel + At(j) * stride;
    if (!(column[j] > 0)) return false;
    const double root = std::sqrt(column[j]);
    const double scale = 1 / root;
    column[j] = root;
    for (int i = j + 1; i < height; ++i) column[i] *= scale;
    for (int k = j + 1; k < columns; ++k) {
      double* __restrict other = panel + At(k) * stride;
      const double factor = column[k];
      for (int i = k; i < height; ++i) other[i] -= factor * column[i];
    }
  }
  return true;
}

}  // namespace

void SupernodalFactor::Prepare(const Structure& structure, const int* starts, const int* rows) {
  structure_ = structure;
  const int n = structure.n;
  const std::size_t size = At(n);
  const std::size_t entries = At(starts[n]);
  std::vector<int> place(size);
  bool in_order = true;
  for (int k = 0; k < n; ++k) {
    place[At(structure.order[k])] = k;
    in_order = in_order && structure.order[k] == k;
  }
  starts_.assign(size + 1, 0);
  rows_.resize(entries);
  if (in_order) {
    std::copy_n(starts, size + 1, starts_.begin());
    std::copy_n(rows, entries, rows_.begin());
    source_.clear();
  } else {
    source_.resize(entries);
    const auto column = [&](int row, int col) { return std::min(place[At(row)], place[At(col)]); };
    for (int j = 0; j < n; ++j) {
      for (int p = starts[j]; p < starts[j + 1]; ++p) ++starts_[At(column(rows[p], j)) + 1];
    }
    std::partial_sum(starts_.begin(), starts_.end(), starts_.begin());
    std::vector<int> next(starts_.begin(), starts_.end() - 1);
    for (int j = 0; j < n; ++j) {
      for (int p = starts[j]; p < starts[j + 1]; ++p) {
        const std::size_t to = At(next[At(column(rows[p], j))]++);
        rows_[to] = std::max(place[At(rows[p])], place[At(j)]);
        source_[to] = p;
      }
    }
  }
  supernode_of_.resize(size);
  int tallest = 0;
  for (int s = 0; s < structure.supernodes; ++s) {
    for (int j = structure.first_column[s]; j < structure.first_column[s + 1]; ++j) supernode_of_[At(j)] = s;
    tallest = std::max(tallest, structure.row_start[s + 1] - structure.row_start[s]);
  }
  for (std::vector<int>* list : {&head_, &next_, &reached_}) list->assign(At(structure.supernodes), kNone);
  place_.assign(size, 0);
  target_.assign(At(tallest), 0);
  gathered_.assign(At(tallest), 0);
  l_.assign(structure.values, 0);
  update_.assign(structure.largest_update, 0);
  x_.assign(size, 0);
}

SupernodalFactor::Panel SupernodalFactor::PanelOf(int supernode) {
  Panel panel;
  panel.values = l_.data() + structure_.value_start[supernode];
  panel.rows = structure_.rows + structure_.row_start[supernode];
  panel.first = structure_.first_column[supernode];
  panel.columns = structure_.first_column[supernode + 1] - panel.first;
  panel.height = structure_.row_start[supernode + 1] - structure_.row_start[supernode];
  return panel;
}

// The matrix's own columns; place_ becomes the panel's row of every row of the matrix.
void SupernodalFactor::Scatter(const Panel& panel, const double* values) {
  for (int i = 0; i < panel.height; ++i) place_[At(panel.rows[i])] = i;
  for (int j = 0; j < panel.columns; ++j) {
    double* column = panel.values + At(j) * At(panel.height);
    std::fill_n(column, panel.height, 0.0);
    const int end = starts_[At(panel.first + j) + 1];
    for (int p = starts_[At(panel.first + j)]; p < end; ++p) {
      column[place_[At(rows_[At(p)])]] += values[source_.empty() ? p : source_[At(p)]];
    }
  }
}

// Subtracts what `from` owes: B B_1^T, B its rows from `begin` on (`outer` of them), B_1 the first `inner` of those,
// which are columns of `to`.
void SupernodalFactor::Collect(const Panel& from, int begin, const Panel& to, int inner, int outer) {
  const double* block = from.values + begin;
  if (At(inner) * At(outer) * At(from.columns) <= kSmallProduct) {
    MultiplySmall(block, At(from.height), from.columns, inner, outer, update_.data());
  } else {
    Multiply(block, from, inner, outer);
  }
  for (int i = 0; i < outer; ++i) target_[At(i)] = place_[At(from.rows[begin + i])];
  for (int j = 0; j < inner; ++j) {
    double* column = to.values + At(target_[At(j)]) * At(to.height);
    const double* owed = update_.data() + At(j) * At(outer);
    for (int i = j; i < outer; ++i) column[target_[At(i)]] -= owed[i];
  }
}

void SupernodalFactor::Multiply(const double* block, const Panel& from, int inner, int outer) {
  dsyrk_("L", "N", &inner, &from.columns, &kOne, block, &from.height, &kZero, update_.data(), &outer, 1, 1);
  if (const int below = outer - inner; below > 0) {
    dgemm_("N", "T", &below, &inner, &from.columns, &kOne, block + inner, &from.height, block, &from.height, &kZero,
           update_.data() + inner, &outer, 1, 1);
  }
}

void SupernodalFactor::Enqueue(int supernode, int at_row) {
  const Panel panel = PanelOf(supernode);
  if (at_row >= panel.height) return;
  reached_[At(supernode)] = at_row;
  int& head = head_[At(supernode_of_[At(panel.rows[at_row])])];
  next_[At(supernode)] = head;
  head = supernode;
}

bool SupernodalFactor::Factorize(const double* values) {
  std::fill(head_.begin(), head_.end(), kNone);
  for (int s = 0; s < structure_.supernodes; ++s) {
    const Panel panel = PanelOf(s);
    Scatter(panel, values);
    const int end_column = panel.first + panel.columns;
    for (int d = head_[At(s)], after = kNone; d != kNone; d = after) {
      after = next_[At(d)];
      const Panel from = PanelOf(d);
      const int begin = reached_[At(d)];
      int end = begin;
      while (end < from.height && from.rows[end] < end_column) ++end;
      Collect(from, begin, panel, end - begin, from.height - begin);
      Enqueue(d, end);
    }
    if (At(panel.columns) * At(panel.columns) * At(panel.height) <= kSmallProduct) {
      if (!FactorizeSmall(panel.values, panel.height, panel.columns)) return false;
      Enqueue(s, panel.columns);
      continue;
    }
    int info = 0;
    dpotrf_("L", &panel.columns, panel.values, &panel.height, &info, 1);
    if (info != 0) return false;
    if (const int below = panel.height - panel.columns; below > 0) {
      dtrsm_("R", "L", "T", "N", &below, &panel.columns, &kOne, panel.values, &panel.height,
             panel.values + panel.columns, &panel.height, 1, 1, 1, 1);
    }
    Enqueue(s, panel.columns);
  }
  return true;
}

// own = L_1^-1 own, gathered_ = L_2 own.
void SupernodalFactor::SolveSmall(const Panel& panel, double* own) {
  const int below = panel.height - panel.columns;
  double* __restrict sums = gathered_.data();
  for (int j = 0; j < panel.columns; ++j) {
    const double* __restrict column = panel.values + At(j) * At(panel.height);
    const double x = own[j] / column[j];
    own[j] = x;
    for (int i = j + 1; i < panel.columns; ++i) own[i] -= column[i] * x;
    const double* __restrict rest = column + panel.columns;
    if (j == 0) {
      for (int i = 0; i < below; ++i) sums[i] = rest[i] * x;
    } else {
      for (int i = 0; i < below; ++i) sums[i] += rest[i] * x;
    }
  }
}

// own = L_1^-T (own - L_2^T gathered_).
void SupernodalFactor::SolveSmallTransposed(const Panel& panel, double* own) {
  using Values = Eigen::Map<const Eigen::VectorXd>;
  const int below = panel.height - panel.columns;
  const Values gathered(gathered_.data(), below);
  for (int j = panel.columns - 1; j >= 0; --j) {
    const double* column = panel.values + At(j) * At(panel.height);
    double x = own[j] - Values(column + panel.columns, below).dot(gathered);
    for (int i = j + 1; i < panel.columns; ++i) x -= column[i] * own[i];
    own[j] = x / column[j];
  }
}

void SupernodalFactor::Solve(double* x) {
  for (int k = 0; k < structure_.n; ++k) x_[At(k)] = x[structure_.order[k]];
  for (int s = 0; s < structure_.supernodes; ++s) {
    const Panel panel = PanelOf(s);
    double* own = x_.data() + panel.first;
    const int below = panel.height - panel.columns;
    if (panel.columns <= kSmallTriangle) {
      SolveSmall(panel, own);
      for (int i = 0; i < below; ++i) x_[At(panel.rows[panel.columns + i])] -= gathered_[At(i)];
      continue;
    }
    dtrsv_("L", "N", "N", &panel.columns, panel.values, &panel.height, own, &kStride, 1, 1, 1);
    if (below == 0) continue;
    dgemv_("N", &below, &panel.columns, &kOne, panel.values + panel.columns, &panel.height, own, &kStride, &kZero,
           gathered_.data(), &kStride, 1);
    for (int i = 0; i < below; ++i) x_[At(panel.rows[panel.columns + i])] -= gathered_[At(i)];
  }
  for (int s = structure_.supernodes - 1; s >= 0; --s) {
    const Panel panel = PanelOf(s);
    double* own = x_.data() + panel.first;
    const int below = panel.height - panel.columns;
    for (int i = 0; i < below; ++i) gathered_[At(i)] = x_[At(panel.rows[panel.columns + i])];
    if (panel.columns <= kSmallTriangle) {
      SolveSmallTransposed(panel, own);
      continue;
    }
    if (below > 0) {
      dgemv_("T", &below, &panel.columns, &kMinusOne, panel.values + panel.columns, &panel.height, gathered_.data(),
             &kStride, &kOne, own, &kStride, 1);
    }
    dtrsv_("L", "T", "N", &panel.columns, panel.values, &panel.height, own, &kStride, 1, 1, 1);
  }
  for (int k = 0; k < structure_.n; ++k) x[structure_.order[k]] = x_[At(k)];
}

}  // namespace lcpbench
