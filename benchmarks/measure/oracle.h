#pragma once

#include <Eigen/Core>
#include <vector>

#include "solvers/lcp/problem.h"

namespace lcpbench {

/// Not a solver but the limit of those that factorize: what an oracle that is told the active set F would still have to
/// pay [s]. The least of: one sparse Cholesky analyse + factor + solve of A_FF on independent rows; with factors of A
/// also of the body system M + J_F^T W J_F (body_system.h), with its ordering. The shortest of a few runs of each.
/// Not timed: forming these matrices, finding independent rows. Negative without CHOLMOD.
/// @param f, w  a verified solution
/// O(what a sparse factorization costs).
double TimeOracle(const LcpProblem& problem, const Eigen::VectorXd& f, const Eigen::VectorXd& w);

/// What one ordering, analysis, factorization and solve takes, and how large the factor is.
struct Factorization {
  double seconds = 0;
  double fill = 0;   ///< entries of L
  double flops = 0;  ///< of the factorization
};

/// Of the body system of `active`: by AMD and by METIS on its graph of bodies, by supernodes and where these pay little
/// also by columns. Empty without factors of A or without CHOLMOD.
std::vector<Factorization> TimeBodySpace(const LcpProblem& problem, const std::vector<Index>& active);

/// Rows of the active set at a solution: bilateral ones, and unilateral ones with D^1/2 f > D^-1/2 w.
std::vector<Index> ActiveRows(const LcpProblem& problem, const Eigen::VectorXd& f, const Eigen::VectorXd& w);

/// A maximal subset of `rows` on which A is nonsingular to rounding: rows are eliminated one by one in a fill-reducing
/// order, and a row whose pivot falls below kDependent times its diagonal entry depends on those before it. By LDL^T of
/// A with a slightly larger diagonal.
inline constexpr double kDependent = 1e-10;
std::vector<Index> IndependentRows(const SparseMatrix& A, const std::vector<Index>& rows);

}  // namespace lcpbench
