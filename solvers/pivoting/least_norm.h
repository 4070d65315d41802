#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>
#include <string>

#include "solvers/lcp/problem.h"
#include "solvers/lcp/solver.h"

namespace lcpbench {

/// Options of FindLeastNormForces.
struct LeastNormOptions {
  double tolerance = 1e-9;  ///< tier that the answer must pass, in (0, 1)
  /// Eigenvalues of D^-1/2 A D^-1/2 on the active rows up to this part of the largest are 0, > 0: they say which forces
  /// are free. Inexact geometry makes the zeros of redundant contacts small numbers.
  double rank_tolerance = 1e-12;
  double time_limit_s = std::numeric_limits<double>::infinity();  ///< of the inner LCP [s], > 0
};

/// The solution of least norm.
struct LeastNormForces {
  LcpStatus status = LcpStatus::kNotRun;  ///< kSolved: f passes the tolerance; else see detail
  Eigen::VectorXd f;                      ///< n forces; those given where the status is not kSolved
  Index nullity = 0;                      ///< free directions of the forces on the active rows
  double rank_tolerance = 0;              ///< that was used
  std::string detail;                     ///< why it was not found
};

/// Up to this many rows: there is an eigenvalue decomposition of the active rows, O(n^3).
inline constexpr Index kMostRowsOfLeastNorm = 1000;

/// Finds the solution of a plain PSD problem with the least Euclidean norm |f|_2, in the units given; it is unique
/// [docs/model.md section 8, property 5]. From any solution f, with w = A f + b and P the rows with w = 0:
///     min |g|_2   over   A_PP g_P = -b_P,   g_C >= 0,   g = 0 elsewhere.
/// With N an orthonormal basis of null(A_PP) and q = f_P - N N^T f_P, g_P = q + N N^T s, where s
/// solves the LCP  g = N N^T s + q, 0 <= s _|_ g >= 0  on the unilateral rows of P, by Dantzig's
/// method. The answer is judged by the given form at `tolerance`. Where A is not known to be PSD, its eigenvalues say.
/// @param f  a solution: n numbers that pass the tolerance
/// @throws InputError for options out of range and f of another size
LeastNormForces FindLeastNormForces(const LcpProblem& problem, const Eigen::VectorXd& f,
                                    const LeastNormOptions& options = {});

/// Gives a solved result the forces of least norm. Where there are none, its detail says why.
/// @return  nothing where the result has other forces
std::optional<LeastNormForces> TakeLeastNorm(const LcpProblem& problem, const LeastNormOptions& options,
                                             LcpResult* result);

}  // namespace lcpbench
