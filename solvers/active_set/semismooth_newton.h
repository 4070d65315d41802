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

  /// Keys `first_weight`, `weight_factor`, `least_weight` and `continuation_rows`. @throws InputError for others, or
  /// out of their range
  void Read(SettingsReader* reader);
};

/// Proximal-point iteration whose subproblems are solved by a semismooth Newton method with an exact line search, on
/// a factor of the active block in the form that is cheapest (ActiveBlock). Details: docs/solvers/active_set.md.
///
/// Outer loop [Rockafellar 1976]: c <- argmin 1/2 f.A f + b.f + (eps/2) |D^1/2 (f - c)|^2 over f_C >= 0, C the
/// unilateral rows. With u any forces, w(u) = A u + b and f(u) = (c - w(u) / (eps D))_+ on C (not clipped on bilateral
/// rows), the subproblem's dual is the minimum of
///     Phi(u) = 1/2 u.A u + (eps/2) |D^1/2 f(u)|^2,
/// convex, once differentiable and piecewise quadratic. Newton step: with F = {i : f_i(u) > 0} and all bilateral rows,
///     (A_FF + eps D_F) u'_F = eps D_F c_F - b_F,  u' = 0 elsewhere,
/// the step of block principal pivoting; but it goes only as far along u' - u as Phi falls, found exactly. So cycling
/// cannot happen: Phi falls strictly until F repeats after a full step, which solves the subproblem. [Qi, Sun 1999;
/// Hermans, Themelis, Patrinos 2019 (QPALM) for the line search; Li, Sun, Toh 2018 for the pairing.]
///
/// Continuation, from continuation_rows on: eps starts at 1 and falls tenfold where subproblems are easy; successive F
/// differ by few rows, so that most rows of the factor stay (SparseActiveBlock). After 50 proximal steps without an
/// answer the other path goes on from c.
///
/// Finish (BlockPivoting::Finish): after each proximal step, with continuation each time rho has fallen tenfold, the
/// forces c of F are corrected until w_F is rounding.
///
/// Guaranteed for symmetric PSD A of any rank, in exact arithmetic; other A are refused. Where there is no solution c
/// grows along a ray: kInfeasible if VerifyFarkasRay accepts it. kSolved only if the given form meets the tolerance.
///
/// Unit of iterations and max_iterations: factors asked for, new or updated, kDefaultFactors at most and
/// kContinuationFactors with continuation. Each costs O(sum over columns of L of (entries)^2) and a product with A.
///
/// Warm start: c = u = initial_f, clipped at 0, if its rho is at most half the one at f = 0. Its F = {D f > w} is
/// finished first, wrong rows changing sides while their number falls.
///
/// From arrays, up to 128 rows of at most two moving bodies each need no LcpProblem (RowEngine), with a dense block.
///
/// Solve allocates nothing but a ray. kTimeLimit, kIterationLimit and kNumericalFailure leave the best f that was
/// judged, else c. Departures: the rules for eps; subproblems are solved to the end; the finish.
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
