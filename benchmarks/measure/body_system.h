#pragma once

#include <Eigen/SparseCore>
#include <vector>

#include "solvers/lcp/problem.h"

namespace lcpbench {

/// M + J_F^T W J_F on the bodies that can move and take part in an active row: what a method pays for that works on
/// bodies instead of contacts. W is diagonal, one stiffness per row. Bodies that no active row touches are left out.
struct BodySystem {
  using ColumnMatrix = Eigen::SparseMatrix<double, Eigen::ColMajor, int>;

  /// Lower triangle. The unknowns of one body follow each other, bodies in the problem's order.
  ColumnMatrix lower;
  std::vector<int> column_of;  ///< of each unknown: its column of J
  std::vector<int> first;      ///< of each body: its first unknown; one more entry, the number of unknowns
  /// Bodies x bodies: an entry where two share a row; values and the diagonal mean nothing.
  ColumnMatrix graph;
  int bodies() const { return static_cast<int>(first.size()) - 1; }
  /// An order of bodies, of the graph for little fill, as one of the unknowns. Ordering bodies takes a graph a third of
  /// the size, and unknowns of a body, which have the same neighbours, end up beside each other all the same.
  Eigen::VectorXi Expand(const Eigen::VectorXi& bodies) const;
};

/// Row i has the stiffness kStiffness / A_ii: stiff against the masses and far from the limits of double.
inline constexpr double kStiffness = 1e6;

/// @param problem  by factors, columns of J in blocks of three per body
/// @param rows     the active ones
/// O(sum over rows of their entries squared), and sorting those.
BodySystem MakeBodySystem(const LcpProblem& problem, const std::vector<Index>& rows);

}  // namespace lcpbench
