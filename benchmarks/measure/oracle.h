#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "solvers/lcp/problem.h"
#include "solvers/lcp/solver.h"

namespace lcpbench {

/// What one factorisation and one solve take, the shortest of a few runs, and how large the factor is.
struct Factorisation {
  std::string name;  ///< how: the order, and "-simplicial" where CHOLMOD was not left to choose supernodes
  double order_s = 0;
  double analyse_s = 0;
  double factor_s = 0;
  double solve_s = 0;
  double fill = 0;   ///< entries of L
  double flops = 0;  ///< of the factorisation
  double total_s() const { return order_s + analyse_s + factor_s + solve_s; }
};

/// Not a solver but the limit of those that factorise: what an oracle that is told the active set would still have to
/// pay, one sparse Cholesky analyse + factor + solve.
struct OracleTime {
  Index active = 0;       ///< rows with f > 0 at the solution, and bilateral rows
  Index independent = 0;  ///< of these, a maximal set whose A_FF is nonsingular
  /// Wall time of CHOLMOD's analyse, factor and solve, the shortest of a few runs [s]; negative where there is none.
  double contact_s = -1;  ///< A_FF on the independent rows: `independent` unknowns
  double body_s = -1;     ///< M + J_F^T J_F / epsilon (body_system.h), the cheapest of TimeBodySpace; factors only
  /// The smaller of the two; negative where there is none.
  double best() const;
};

/// @param f, w  a verified solution
/// Not timed: forming A_FF, finding independent rows. O(what a sparse factorisation costs).
OracleTime TimeOracle(const LcpProblem& problem, const Eigen::VectorXd& f, const Eigen::VectorXd& w);

/// Order + analyse + factor + solve of the body-space matrix (body_system.h) on `active`, in several ways; the matrix
/// and the graph of bodies are given. Empty without factors of A or without CHOLMOD.
/// @param now  the clock [s]
std::vector<Factorisation> TimeBodySpace(const LcpProblem& problem, const std::vector<Index>& active,
                                         double (*now)() = &SteadyNow);

/// Analyse + factor + solve of A_FF on the independent ones of `active` [s]; negative without CHOLMOD.
double TimeContactSpace(const LcpProblem& problem, const std::vector<Index>& active, double (*now)() = &SteadyNow);

/// The one with the least total.
std::optional<Factorisation> Cheapest(const std::vector<Factorisation>& times);

/// Rows of the active set at a solution: bilateral ones, and unilateral ones with D^1/2 f > D^-1/2 w.
std::vector<Index> ActiveRows(const LcpProblem& problem, const Eigen::VectorXd& f, const Eigen::VectorXd& w);

/// A maximal subset of `rows` on which A is nonsingular to rounding: rows are eliminated one by one in a fill-reducing
/// order, and a row whose pivot falls below kDependent times its diagonal entry depends on those before it.
/// Up-looking sparse LDL^T. [Davis, Direct Methods for Sparse Linear Systems, 2006, sec. 4.8]
inline constexpr double kDependent = 1e-10;
std::vector<Index> IndependentRows(const SparseMatrix& A, const std::vector<Index>& rows);

}  // namespace lcpbench
