#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <vector>

#include "solvers/lcp/problem.h"

namespace lcpbench {

/// Not a solver but the limit of those that factorize: what an oracle that knows the active set F would still have to
/// pay [s]. The least of: one sparse Cholesky analyse + factor + solve of A_FF on independent rows; with factors of A
/// also of the body system M + J_F^T W J_F, with its ordering. The shortest of a few runs of each.
/// Not timed: forming these matrices, finding independent rows. Negative without CHOLMOD.
/// @param f, w  a verified solution
/// O(what a sparse factorization costs).
double TimeOracle(const LcpProblem& problem, const Eigen::VectorXd& f, const Eigen::VectorXd& w);

/// What one check of an answer takes, by rho and backward error in double from the caller's arrays [s]: what whoever
/// asks several solvers in turn pays after each. The median of a few runs.
double TimeCheck(const LcpProblem& problem, const Eigen::VectorXd& f);

/// What one ordering, analysis, factorization and solve takes, and how large the factor is.
struct Factorization {
  double seconds = 0;
  double fill = 0;   ///< entries of L
  double flops = 0;  ///< of the factorization
};

/// Factorizations of the body system of `active`: by AMD and by METIS on its graph of bodies, by supernodes and where
/// these pay little also by columns. Empty without factors of A or without CHOLMOD.
std::vector<Factorization> TimeBodySpace(const LcpProblem& problem, const std::vector<Index>& active);

/// M + J_F^T W J_F on the bodies that can move and take part in an active row: what a method pays for that works on
/// bodies instead of contacts. W is diagonal, row i has kStiffness / A_ii. Bodies that no active row touches are left
/// out.
struct BodySystem {
  using ColumnMatrix = Eigen::SparseMatrix<double, Eigen::ColMajor, int>;

  /// Lower triangle. The unknowns of one body follow each other, bodies in the problem's order.
  ColumnMatrix lower;
  std::vector<Index> column_of;  ///< of each unknown: its column of J
  std::vector<int> first;        ///< of each body: its first unknown; one more entry, the number of unknowns
  /// Bodies x bodies: an entry where two share a row; values and the diagonal mean nothing.
  ColumnMatrix graph;
  int bodies() const { return static_cast<int>(first.size()) - 1; }
  /// An order of bodies, of the graph for little fill, as one of the unknowns. Ordering bodies takes a graph a third of
  /// the size, and unknowns of a body, which have the same neighbours, end up beside each other all the same.
  Eigen::VectorXi Expand(const Eigen::VectorXi& bodies) const;
};

/// Stiff against the masses and far from the limits of double.
inline constexpr double kStiffness = 1e6;

/// @param problem  by factors, columns of J in blocks of three per body
/// @param rows     the active ones
/// O(sum over rows of their entries squared), and sorting those.
BodySystem MakeBodySystem(const LcpProblem& problem, const std::vector<Index>& rows);

/// Rows of the active set at a solution: bilateral ones, and unilateral ones with D^1/2 f > D^-1/2 w.
std::vector<Index> ActiveRows(const LcpProblem& problem, const Eigen::VectorXd& f, const Eigen::VectorXd& w);

/// A maximal subset of `rows` on which A is nonsingular to rounding: rows are eliminated one by one in a fill-reducing
/// order, and a row whose pivot falls below kDependent times its diagonal entry depends on those before it. By LDL^T of
/// A with a slightly larger diagonal.
inline constexpr double kDependent = 1e-10;
std::vector<Index> IndependentRows(const SparseMatrix& A, const std::vector<Index>& rows);

}  // namespace lcpbench
