#pragma once

#include <Eigen/SparseCore>
#include <Eigen/SparseLU>

namespace lcpbench {

/// Eigen's sparse LU with pivoting, with supernodes that its triangular solves can take: from 48 rows on, with one
/// right-hand side, those of Eigen 3.4 may block for fewer rows than a panel that they pack has, and write past their
/// workspace on the stack.
template <typename Ordering>
class SparseLu : public Eigen::SparseLU<Eigen::SparseMatrix<double>, Ordering> {
 public:
  SparseLu() { this->m_perfv.maxsuper = kMostColumnsOfSupernode; }

 private:
  static constexpr Eigen::Index kMostColumnsOfSupernode = 32;
};

}  // namespace lcpbench
