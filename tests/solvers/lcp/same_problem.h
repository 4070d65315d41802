#pragma once

#include <algorithm>
#include <cstring>
#include <string>

#include "solvers/lcp/problem.h"

namespace lcpbench {

// -0 and 0 are equal, and not the same.
inline bool SameBits(const double* a, const double* b, Index n) {
  return n == 0 || std::memcmp(a, b, sizeof(double) * static_cast<std::size_t>(n)) == 0;
}

inline bool SameBits(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  return a.size() == b.size() && SameBits(a.data(), b.data(), a.size());
}

/// The same entries are stored, zeros included.
inline bool SameBits(const SparseMatrix& a, const SparseMatrix& b) {
  return a.rows() == b.rows() && a.cols() == b.cols() && a.nonZeros() == b.nonZeros() &&
         std::equal(a.outerIndexPtr(), a.outerIndexPtr() + a.rows() + 1, b.outerIndexPtr()) &&
         std::equal(a.innerIndexPtr(), a.innerIndexPtr() + a.nonZeros(), b.innerIndexPtr()) &&
         SameBits(a.valuePtr(), b.valuePtr(), a.nonZeros());
}

/// What differs between A, b and the kinds of rows; "" for nothing.
inline std::string DifferenceOfRows(const LcpProblem& a, const LcpProblem& b) {
  if (!SameBits(a.b(), b.b())) return "another b";
  if (a.bilateral_rows() != b.bilateral_rows()) return "other bilateral rows";
  return SameBits(a.SparseA(), b.SparseA()) ? "" : "another A";
}

/// The same, and the factors where there are any.
inline std::string DifferenceOfProblems(const LcpProblem& a, const LcpProblem& b) {
  if (a.has_factors() != b.has_factors()) return "another form";
  if (a.has_factors() && !(SameBits(a.J(), b.J()) && SameBits(a.inverse_mass(), b.inverse_mass()))) {
    return "other factors";
  }
  return DifferenceOfRows(a, b);
}

/// The same A by its entries alone.
inline LcpProblem WithoutFactors(const LcpProblem& given) {
  return LcpProblem::FromSparse(given.id(), given.SparseA(), given.b(),
                                RowBounds::WithBilateralRows(given.size(), given.bilateral_rows()));
}

}  // namespace lcpbench
