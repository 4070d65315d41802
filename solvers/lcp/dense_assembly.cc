#include "solvers/lcp/dense_assembly.h"

#include <algorithm>
#include <memory>
#include <vector>

namespace lcpbench {
namespace {

// An entry of J in the list of its column.
struct ColumnEntry {
  int next;  // the entry above it in the column; -1: it is the first
  int row;
  double value;
};

}  // namespace

// Rows enter their columns' lists one after the other; row i meets those above it in every one of its columns, in the
// order of the columns.
void AssembleDenseA(const FactorView& factors, double* A, Index stride) {
  std::fill_n(A, factors.rows * stride, 0.0);
  std::vector<int> last(static_cast<size_t>(factors.columns), -1);
  const auto entries = std::make_unique_for_overwrite<ColumnEntry[]>(
      static_cast<size_t>(factors.rows > 0 ? factors.row_start[factors.rows] : 0));
  for (Index i = 0; i < factors.rows; ++i) {
    double* row = A + i * stride;
    for (int e = factors.row_start[i]; e < factors.row_start[i + 1]; ++e) {
      const int k = factors.column[e];
      const double m = factors.inverse_mass[k];
      if (m == 0) continue;
      const double value = factors.value[e];
      entries[static_cast<size_t>(e)] = {last[static_cast<size_t>(k)], static_cast<int>(i), value};
      last[static_cast<size_t>(k)] = e;
      for (int other = e; other >= 0;) {
        const ColumnEntry& entry = entries[static_cast<size_t>(other)];
        row[entry.row] += m * (value * entry.value);
        A[entry.row * stride + i] = row[entry.row];
        other = entry.next;
      }
    }
  }
}

void AssembleDenseA(const LcpProblem& problem, double* A, Index stride) {
  const SparseMatrix& J = problem.J();
  AssembleDenseA(
      FactorView{J.rows(), J.cols(), J.outerIndexPtr(), J.innerIndexPtr(), J.valuePtr(), problem.inverse_mass().data()},
      A, stride);
}

void AssembleDenseA(const ProblemArrays& arrays, double* A, Index stride) {
  const Index n = arrays.rows;
  switch (arrays.form) {
    case MatrixForm::kFactors:
      AssembleDenseA(FactorView{n, arrays.columns, arrays.row_start.data(), arrays.column.data(), arrays.value.data(),
                                arrays.inverse_mass.data()},
                     A, stride);
      return;
    case MatrixForm::kSparse:
      std::fill_n(A, n * stride, 0.0);
      for (Index i = 0; i < n; ++i) {
        for (auto e = static_cast<size_t>(arrays.row_start[static_cast<size_t>(i)]);
             e < static_cast<size_t>(arrays.row_start[static_cast<size_t>(i) + 1]); ++e) {
          A[i * stride + arrays.column[e]] = arrays.value[e];
        }
      }
      return;
    case MatrixForm::kDense:
      for (Index i = 0; i < n; ++i) {
        double* const padding = std::copy_n(arrays.value.data() + i * n, n, A + i * stride);
        std::fill_n(padding, stride - n, 0.0);
      }
      return;
  }
}

}  // namespace lcpbench
