#pragma once

#include <Eigen/Core>

#include "solvers/lcp/problem.h"

namespace lcpbench {

/// How far f is from the laws of all rows.
struct LawMetrics {
  /// PRIMARY.  rho = |r|_2 / |D^-1/2 b|_2 with r_i = min(D_ii^1/2 f_i, D_ii^-1/2 w_i) on C, D_ii^-1/2 w_i on B;
  /// |r|_2 itself when b = 0. Independent of units and of row scaling. [docs/model.md section 8]
  double rho = -1;
  /// max over rows of |min(A_ii f_i, w_i)| / (|A||f| + |b|)_i on C, |w_i| / (...) on B; 0/0 = 0, and a
  /// defect within the rounding of its own evaluation counts as 0. Componentwise, so that
  /// one bad row among many, or one huge b, cannot hide another row. [Oettli, Prager 1964 in the LCP's variables]
  double backward_error = -1;
  /// Parts of the error, over S as rho is; of problems that are not plain, else -1 [docs/friction.md section 4]. Norms
  /// over the rows: of (-omega)_+, (-phi)_+ and min(phi, omega)_+ on unilateral rows, with phi = D^1/2 f and omega =
  /// D^-1/2 w; of what phi exceeds the cone by and, once it is clipped there, of the residual of a friction row; of
  /// omega on bilateral rows and the residual of sliding ones; of the residual of bounded rows. rho^2 / 2 <= the sum
  /// of their squares <= 2 rho^2.
  double penetration = -1;
  double adhesion = -1;       ///< see penetration
  double separation = -1;     ///< see penetration: force at a contact that opens
  double cone = -1;           ///< see penetration
  double dissipation = -1;    ///< see penetration: friction that does not oppose slip, or does not use its bound
  double joints = -1;         ///< see penetration
  double beyond_bounds = -1;  ///< see penetration
  /// Over S^2, of problems with friction and without sliding and bounded rows, else -1: sum f_t w_t over friction rows,
  /// the sum of its positive terms, and b.f + f.A f / 2, which is <= 0 for every solution.
  double friction_power = -1;
  double created = -1;  ///< see friction_power: energy that friction makes
  double energy = -1;   ///< see friction_power
};

/// n numbers in the verifier's precision: x87 long double, 64-bit significand.
using ExtendedVector = Eigen::Matrix<long double, Eigen::Dynamic, 1>;

/// What the verifier knows of the rows of a problem at f. Internal to the verifier (verify.cc).
struct JudgedRows {
  const LcpProblem& problem;  ///< not plain
  const Eigen::VectorXd& f;   ///< n, finite
  ExtendedVector w;           ///< n, A f + b
  ExtendedVector diagonal;    ///< n, |A_ii|
  ExtendedVector magnitude;   ///< n, |A||f|
  /// n: defects of w up to this are the rounding of w itself.
  ExtendedVector rounding;
};

/// All of LawMetrics of a problem with friction, sliding or bounded rows [docs/friction.md section 4].  O(n)
LawMetrics MeasureLaws(const JudgedRows& rows);

/// S of docs/friction.md section 4, what rho of a problem that is not plain is relative to.  O(n)
/// @param root  n, D^1/2 with 1 where A_ii = 0
long double LoadScale(const LcpProblem& problem, const ExtendedVector& root);

/// Verdict::model_rho: contacts with more than one friction row count by their boxes, one row after the other.  O(n)
/// @param f, w  n; infinite where they are not finite
double RelaxationResidual(const LcpProblem& problem, const Eigen::VectorXd& f, const Eigen::VectorXd& w);

}  // namespace lcpbench
