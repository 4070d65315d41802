#pragma once

#include <algorithm>
#include <cstring>

#include "solvers/lcp/problem.h"

namespace lcpbench {

/// Whether n numbers are the same, bit by bit: -0 and 0 are equal, and not the same.
inline bool SameBits(const double* a, const double* b, Index n) {
  return n == 0 || std::memcmp(a, b, sizeof(double) * static_cast<std::size_t>(n)) == 0;
}

/// Whether the same entries are stored, zeros included, with the same bits.
template <int order>
bool SameBits(const Eigen::SparseMatrix<double, order, int>& a, const Eigen::SparseMatrix<double, order, int>& b) {
  return a.rows() == b.rows() && a.cols() == b.cols() && a.nonZeros() == b.nonZeros() &&
         std::equal(a.outerIndexPtr(), a.outerIndexPtr() + a.outerSize() + 1, b.outerIndexPtr()) &&
         std::equal(a.innerIndexPtr(), a.innerIndexPtr() + a.nonZeros(), b.innerIndexPtr()) &&
         SameBits(a.valuePtr(), b.valuePtr(), a.nonZeros());
}

}  // namespace lcpbench
