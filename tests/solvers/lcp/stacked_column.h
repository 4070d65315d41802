#pragma once

#include <cmath>
#include <vector>

#include "solvers/lcp/problem.h"

namespace lcpbench {

/// A column of bodies standing on the ground, one vertical row between neighbours, mass 1 below and `ratio` above in
/// turns; only gravity. Every contact carries what lies above it, f_i = g (m_i + m_{i+1} + ...), and w = 0.
struct StackedColumn {
  LcpProblem problem;          ///< by factors, n rows
  std::vector<long double> f;  ///< exact but for the rounding of long double
};

inline StackedColumn MakeStackedColumn(Index n, double ratio) {
  constexpr double kGravity = 9.81;
  SparseMatrix J(n, 3 * n);
  J.reserve(Eigen::VectorXi::Constant(n, 2));
  Eigen::VectorXd inverse_mass(3 * n);
  std::vector<long double> f(static_cast<size_t>(n));
  long double above = 0;
  for (Index i = n - 1; i >= 0; --i) {
    const double mass = i % 2 == 0 ? 1 : ratio;
    inverse_mass.segment(3 * i, 3).setConstant(1 / mass);
    above += 1 / static_cast<long double>(1 / mass);  // the mass that the problem holds, not the one it was made from
    f[static_cast<size_t>(i)] = kGravity * above;
  }
  for (Index i = 0; i < n; ++i) {
    if (i > 0) J.insert(i, 3 * i - 2) = -1;
    J.insert(i, 3 * i + 1) = 1;
  }
  // Between bodies that fall alike gaps do not change.
  Eigen::VectorXd b = Eigen::VectorXd::Zero(n);
  b[0] = -kGravity;
  return {LcpProblem::FromFactors("column", J, inverse_mass, b), f};
}

}  // namespace lcpbench
