#pragma once

#include <Eigen/Core>

#include "solvers/lcp/problem.h"

namespace lcpbench {

/// Writes A into a library's memory, columns `stride` apart, without a copy in between: from factors by the assembly
/// that everybody pays for, else from the given form. What lies beyond a column's n numbers may be written with zeros.
inline void WriteDenseColumns(const LcpProblem& problem, Index stride, double* A) {
  if (problem.has_factors()) {
    AssembleDenseA(problem, A, stride);  // bitwise symmetric
    return;
  }
  Eigen::Map<Eigen::MatrixXd, 0, Eigen::OuterStride<>>(A, problem.size(), problem.size(),
                                                       Eigen::OuterStride<>(stride)) = problem.DenseA();
}

/// The same with rows `stride` apart; what lies between them is zero.
inline void WriteDenseRows(const LcpProblem& problem, Index stride, double* A) {
  if (problem.has_factors()) {
    AssembleDenseA(problem, A, stride);
    return;
  }
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  Eigen::Map<RowMajor> rows(A, problem.size(), stride);
  rows.leftCols(problem.size()) = problem.DenseA();
  rows.rightCols(stride - problem.size()).setZero();
}

}  // namespace lcpbench
