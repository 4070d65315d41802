#pragma once

#include <Eigen/Core>

#include "solvers/lcp/problem.h"

namespace lcpbench {

/// The rounding floor of an answer: the largest change of rho (verify.h) that rounding f to double alone can bring,
///     u |D^-1/2 |A| |f||_2 / |D^-1/2 b|_2,   u = 2^-53 (unit roundoff),
/// with rho's conventions: D = diag A with 1 where A_ii = 0 and |A_ii| where it is negative, and absolute where b = 0.
/// Independent of units and of row scaling, as rho is.
///
/// Why: f (1 + d), |d_i| <= u, changes w by at most u |A||f| componentwise, and D_ii f_i by at most u |A_ii f_i|; min
/// is nonexpansive, so |rho(f (1 + d)) - rho(f)| <= floor (where every A_ii != 0; for PSD A an A_ii = 0 means that f_i
/// acts on nothing). Even the rounded exact solution has rho up to the floor, and no tier below it can be demanded of a
/// solver that returns doubles. [Oettli, Prager 1964; Higham, Accuracy and Stability of Numerical Algorithms, 2002,
/// sec. 3.5, 7.1]
///
/// From factors |A| |f| is bounded by |J| M^-1 (|J|^T |f|), so that A is never formed.
///
/// The floor belongs to f. Where contacts are redundant f is not unique, and a self-stress raises it as far as one
/// likes: a verdict may lean on the floor of an answer that the judged solver has no say in only (LcpReference::floor).
///
/// Infinite where f does not have n finite entries; 0 for n = 0. O(nnz of the given form).
double RoundingFloor(const LcpProblem& problem, const Eigen::VectorXd& f);

}  // namespace lcpbench
