#pragma once

#include "solvers/lcp/problem.h"
#include "solvers/lcp/problem_arrays.h"

namespace lcpbench {

/// J in compressed rows and the inverse masses, as they lie in somebody's memory.
struct FactorView {
  /// n.
  Index rows = 0;
  /// Of J.
  Index columns = 0;
  /// n + 1 numbers.
  const int* row_start = nullptr;
  /// Ascending within a row.
  const int* column = nullptr;
  /// Of J, by rows.
  const double* value = nullptr;
  /// A number per column, >= 0.
  const double* inverse_mass = nullptr;
};

/// Writes A = J M^-1 J^T into `rows` rows of `stride` numbers each, padding zero: the one dense assembly that own
/// solvers and peers pay for. Entry (i, j) sums m_k (J_ik J_jk) over ascending k, so that A is bitwise symmetric
/// (row-major is column-major) and equal to that of LcpProblem::SparseA. O(n stride + sum over columns of (column
/// count)^2).
/// @param factors  checked already (LcpProblem::FromArrays does)
/// @param stride   >= rows
void AssembleDenseA(const FactorView& factors, double* A, Index stride);

/// As above from a problem that has factors, whose A is not formed by this.
void AssembleDenseA(const LcpProblem& problem, double* A, Index stride);

/// As above from a caller's arrays in any form, row after row: dense and sparse ones are copied.
void AssembleDenseA(const ProblemArrays& arrays, double* A, Index stride);

}  // namespace lcpbench
