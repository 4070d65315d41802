#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "solvers/exact/exact_lcp.h"
#include "solvers/lcp/problem.h"

namespace lcpbench {

/// A reference answer for problems beyond exact arithmetic. Every bound is evaluated without rounding errors, or with
/// all of them rounded up, from the doubles of the problem as given and from f as it is.
///
/// Let f >= 0 on unilateral rows, w = A f + b, and w~ >= 0 on unilateral rows, = 0 on bilateral ones. With b~ = b + (w~
/// - w) the problem has the feasible point f, hence, A being positive semidefinite, a solution f~* with gaps w~*, and
///   |f - f~*|_A^2 = (f - f~*).(w~ - w~*) = f.w~ - f.w~* - f~*.w~ + f~*.w~* <= f.w~ = E,
/// as f~*.w~* = 0 and what is subtracted is >= 0. By Cauchy's inequality |w~ - w~*|_i = |e_i.A (f - f~*)| <= A_ii^1/2
/// E^1/2 for every row.
struct BoundedReference {
  /// Which problem f solves, and how that is proved.
  enum class Proof {
    /// The problem as given, whose solution f* has its active rows F where f is > 0: A_FF is nonsingular (its least
    /// eigenvalue has a proved bound, independent_block.h), the exact solution of A_FF x = -b_F is so near to f_F that
    /// x >
    /// 0, and the gaps elsewhere so large that they are > 0 with x, too. f* is then the only solution.
    kActiveRows,
    /// The problem as given: w >= 0, w = 0 on bilateral rows, exactly. b~ = b.
    kFeasiblePoint,
    /// A problem nearby: f solves (A, b~) exactly, w~ being w on unilateral rows with f = 0 and w > 0, and 0 elsewhere.
    /// For solutions f* of the given problem, if it has any: |f - f*|_A^2 <= (f - f*).(b - b~) <= energy_shift |D^1/2
    /// (f - f*)|_2; so sums of forces must be known to say more. Rows that depend on others lead here: as their doubles
    /// say it, they contradict each other by a rounding.
    kNearbyProblem,
  };
  Proof proof = Proof::kNearbyProblem;

  std::vector<Rational> f;  ///< in binary digits
  /// The gaps of f, rounded to doubles: 0 on F of kActiveRows; w~ of kNearbyProblem.
  Eigen::VectorXd w;
  /// |f - f*|_A^2 <= energy_bound, f* any solution of the problem that `proof` names.
  double energy_bound = 0;
  /// |D^-1/2 (b~ - b)|_2 rounded up, D = diag A with 1 where that is 0; 0 but for kNearbyProblem.
  double energy_shift = 0;
  /// A_ii^-1/2 |w_i - w*_i| <= w_bound on every row, before w is rounded to doubles; w* belongs to f*.
  double w_bound = 0;
  /// |D^1/2 (f - f*)|_inf <= f_bound, of kActiveRows, where f is unique.
  std::optional<double> f_bound;

  Index active = 0;     ///< rows with f != 0, and bilateral ones
  Index dependent = 0;  ///< of these, those that doubles take to depend on the others
  int exchanges = 0;    ///< active sets tried
  int refinements = 0;  ///< solves with the factor
  int pivots = 0;       ///< among dependent rows
  std::string detail;   ///< why the proof is no better
};
const char* ToString(BoundedReference::Proof proof);

struct BoundedOptions {
  double time_limit_s = 600;  ///< checked between refinements; the f reached by then is bounded
  /// Dependent rows up to which the active ones among them are searched: some seconds for 200
  /// of them among 1000 rows.
  Index most_dependent_rows = 300;
};

/// Refines f_start, the answer of some solver, and proves how good the result is. From the active rows of f_start, A_FF
/// f_F = -b_F is solved by iterative refinement: a factor in doubles, residuals in integers without any rounding
/// (dyadic_lcp.h), f in some 200 binary digits. Rows with wrong signs are exchanged. Of
/// rows that depend on others, pivots tell which are active as the doubles say it; else they share their forces.
/// A poor f_start gives poor bounds, never wrong ones.
/// O(fill) of a sparse LDL^T for every active set, O(nnz of the given form) integer operations a refinement
/// @throws InputError where f_start has another size or is not finite, or A is not symmetric or not known to be
///                    positive semidefinite
BoundedReference RefineReference(const LcpProblem& problem, const Eigen::VectorXd& f_start,
                                 const BoundedOptions& options);

}  // namespace lcpbench
