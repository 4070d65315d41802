#pragma once

#include <cstdint>

#include "solvers/lcp/engine_solver.h"

namespace lcpbench {

/// Options of SemismoothNewtonSolver.
struct SemismoothNewtonOptions {
  /// Weight eps of the proximal term (eps/2) |D^1/2 (f - c)|^2 in the first subproblem, D = diag A; in [1e-10, 1].
  /// Heavier ones need fewer Newton steps and more proximal ones. With the default most problems up to 10^3 rows are
  /// solved by the first proximal step.
  double first_weight = 1e-3;
  /// eps falls by weight_factor, in (0, 1], with every proximal step, down to least_weight, in [1e-10, first_weight].
  double weight_factor = 1e-2;
  double least_weight = 1e-8;  ///< see weight_factor
  /// Problems of at least so many rows are solved by continuation instead (below), whatever the three weights.
  Index continuation_rows = 2'000;
  /// SettingsReader::SelfCheck; without it kSolved is claimed where rho in double, as the method computes it in scaled
  /// units, meets the tolerance.
  bool self_check = true;

  /// Keys `first_weight`, `weight_factor`, `least_weight`, `continuation_rows` and `self_check`. @throws InputError for
  /// others, or out of their range
  static SemismoothNewtonOptions FromSettings(const Settings& settings, const char* key = "semismooth-newton");
};

/// Proximal-point iteration whose subproblems are solved by a semismooth Newton method with an exact line search, on
/// a factor of the active block in the form that is cheapest (ActiveBlock).
///
/// Outer loop [Rockafellar 1976]: c <- argmin 1/2 f.A f + b.f + (eps/2) |D^1/2 (f - c)|^2 over f_C >= 0, C the
/// unilateral rows. With u any forces, w(u) = A u + b and f(u) = (c - w(u) / (eps D))_+ on C (not clipped on bilateral
/// rows), the subproblem's dual is the minimum of
///     Phi(u) = 1/2 u.A u + (eps/2) |D^1/2 f(u)|^2,
/// convex, once differentiable and piecewise quadratic. Newton step: with F = {i : f_i(u) > 0} and all bilateral rows,
///     (A_FF + eps D_F) u'_F = eps D_F c_F - b_F,  u' = 0 elsewhere,
/// which is also the step of block principal pivoting; but here the step goes only as far along u' - u as Phi falls,
/// found exactly (Phi is piecewise quadratic along a line). So cycling, the trouble of block pivoting, cannot happen:
/// Phi falls strictly until F repeats after a full step, which solves the subproblem, after finitely many steps. [Qi,
/// Sun 1999; Hermans, Themelis, Patrinos 2019 (QPALM) for the line search; Li, Sun, Toh 2018 for the pairing.]
///
/// Continuation, for problems of continuation_rows and more, where the path above cycles through hundreds of sets F:
/// eps starts at 1, falls tenfold after a subproblem of at most 5 Newton steps, or of up to 15 where rho hardly fell,
/// and rises again where rho does for eps below 1e-6 (rounding of w is magnified by 1 / eps). Successive F differ by
/// few rows at a constant eps, so a step is an update of the factor through the bodies (BodyActiveBlock) where A has
/// ten entries per row or more. Subproblems are solved exactly, and the next c is their u, not c - w / (eps D): the two
/// are the same but for rounding. On redundant problems of 10^4 rows: 30 to 60 factorisations and 150 to 200 updates.
/// The finish is tried each time rho has fallen tenfold, by exchanges as from a warm start, not after each step; rays
/// where c grows. After 50 proximal steps without an answer the other path goes on from c.
///
/// Finish: after each proximal step the forces c of the active set F are corrected by A_FF d = -w_F, with a shift that
/// only keeps a singular A_FF solvable, refined until w_F is rounding: the answer is exact as soon as F is right. Where
/// contacts are redundant this finds forces near c, which are positive where c is; a basic solution might not be.
///
/// Guaranteed for symmetric positive semidefinite A of any rank, in exact arithmetic: converges to a solution if there
/// is one [Rockafellar 1976]; otherwise c grows along a ray, w / D^1/2 of the subproblems tends to its least norm, and
/// the difference of successive c is offered to VerifyFarkasRay after a correction into the null space; kInfeasible is
/// claimed only if accepted. Bilateral rows may be dependent. A that is not symmetric is refused. kSolved is claimed
/// only if the given form meets the tolerance in extended precision.
///
/// Unit of `iterations` and max_iterations: factors asked for, new or updated, kDefaultFactors at most and
/// kContinuationFactors with continuation. Typically 3 to 30, 15 to 250 with continuation. Each costs O(sum over
/// columns of L of (entries)^2) and a product with A; L of two-dimensional piles has some ten entries per row.
///
/// Warm start: c = u = initial_f, clipped at 0, if its rho is at most half the one at f = 0; else it is ignored. Its F
/// = {D f > w} is finished first, wrong rows changing sides while their number falls, so that an answer with the same
/// active set costs one factorisation; where that fails, proximal steps go on from what is better, it or initial_f.
///
/// Set-up: order (approximate minimum degree) and room for L. Solve allocates nothing but a ray, and what CHOLMOD does
/// where the block is in body space. The clock is read
/// every some thousand multiply-adds of a factorisation, and between all other steps, each O(nnz A). kTimeLimit,
/// kIterationLimit and kNumericalFailure (no progress over all proximal steps) leave the f of least rho that was seen.
///
/// Departures from the sources: the proximal weight falls in the fixed ratio weight_factor or by the rule above, and
/// rises where a subproblem takes so many steps that rounding must be what keeps it from ending; subproblems are solved
/// to the end (their last steps cost nothing that an inexact rule would save); the finish.
class SemismoothNewtonSolver final : public EngineSolver<SemismoothNewtonOptions, class SemismoothNewtonEngine> {
 public:
  using EngineSolver::EngineSolver;

  static constexpr std::int64_t kDefaultFactors = 500;         ///< limit where max_iterations is 0
  static constexpr std::int64_t kContinuationFactors = 5'000;  ///< most of which are updates

  /// Nanoseconds of one iteration on the prepared problem, predicted from its structure.
  double StepTime() const;
};
extern template class EngineSolver<SemismoothNewtonOptions, SemismoothNewtonEngine>;

}  // namespace lcpbench
