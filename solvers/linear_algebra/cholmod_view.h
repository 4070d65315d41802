#pragma once

#include <cholmod.h>

#include <Eigen/SparseCore>

namespace lcpbench {

/// A matrix as CHOLMOD sees it, which takes what it only reads as non-const. Internal to solvers/.
/// @param values   CHOLMOD_REAL or CHOLMOD_PATTERN
/// @param storage  -1: the lower triangle of a symmetric matrix; 0: all of it
inline cholmod_sparse ViewOf(const Eigen::SparseMatrix<double, Eigen::ColMajor, int>& matrix, int values, int storage) {
  cholmod_sparse view{};
  view.nrow = static_cast<size_t>(matrix.rows());
  view.ncol = static_cast<size_t>(matrix.cols());
  view.nzmax = static_cast<size_t>(matrix.nonZeros());
  view.p = const_cast<int*>(matrix.outerIndexPtr());
  view.i = const_cast<int*>(matrix.innerIndexPtr());
  if (values == CHOLMOD_REAL) view.x = const_cast<double*>(matrix.valuePtr());
  view.stype = storage;
  view.itype = CHOLMOD_INT;
  view.xtype = values;
  view.dtype = CHOLMOD_DOUBLE;
  view.sorted = 1;
  view.packed = 1;
  return view;
}

}  // namespace lcpbench
