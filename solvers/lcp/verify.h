#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "solvers/lcp/law_metrics.h"
#include "solvers/lcp/problem.h"
#include "solvers/lcp/solver.h"

namespace lcpbench {

/// Independent measures of how well f answers a problem. w = A f + b is recomputed here from the *given* form in
/// extended precision (x87 long double, 64-bit significand); nothing is taken from a solver but f. D = diag A with 1
/// where A_ii = 0 (absolute value where it is negative). C = unilateral rows, B = bilateral rows. On friction, sliding
/// and bounded rows rho and backward_error are those of docs/friction.md section 4, relative to the S there; the
/// measures of the literature leave these rows out.
/// Any measure is NaN or infinite when f is: then no tier passes.
struct Metrics : LawMetrics {
  Eigen::VectorXd w;  ///< A f + b, rounded to double

  /// max |min(f_i, w_i)| on C, |w_i| on B: absolute, mixes units; for comparison with the literature.
  double natural_residual = -1;
  /// |f - max(0, f - w)|_2 / |b|_2 (w on B), as Siconos' lcp_compute_error; absolute when b = 0.
  double natural_residual_siconos = -1;
  /// 1/2 sum phi_i^2, phi = sqrt(p^2+q^2) - p - q with p = D^1/2 f, q = D^-1/2 w on C (evaluated as
  /// -2pq/(sqrt(p^2+q^2)+p+q) where p + q > 0, so that nothing cancels), phi = q on B. [Fischer 1992]
  double fischer_burmeister = -1;
  double primal_infeasibility = -1;  ///< max over C of max(0, -f_i)
  double dual_infeasibility = -1;    ///< max over C of max(0, -w_i), over B of |w_i|
  double complementarity = -1;       ///< max over C of |f_i w_i|
  double gap = -1;                   ///< |f.w| over all rows
  double gap_rel = -1;               ///< gap / (|f.A f| + |b.f|), 0/0 = 0
  /// Energy certificate, for symmetric PSD A only (else -1): with f_C clipped at 0, w~ = max(w, 0) on C and 0 on B,
  /// b~ = b + (w~ - w), the solution f~* of the problem with b~ satisfies |f - f~*|_A^2 <= f_C . w~_C = energy_bound.
  /// It bounds the error for b itself only where b~ = b exactly; energy_shift = |D^-1/2 (b~ - b)|_2 says how far off
  /// that is. (The short form |f - f*|_A^2 <= f.w holds at exactly feasible points only.)
  double energy_bound = -1;
  double energy_shift = -1;  ///< how far the problem of energy_bound is from the given one
  /// Against a known answer, -1 without one: max |w_i - w*_i| / (1 + |b|_inf), and for unique f
  /// max |f_i - f*_i| / (1 + |f*|_inf).
  double w_error = -1;
  double f_error = -1;  ///< -1 also where f is not unique
  /// The problem's rounding floor, from the reference; -1 unknown. What verdicts are relative to.
  double floor = -1;
  /// The rounding floor of f itself, see RoundingFloor: a self-stress shows as answer_floor far above floor. No verdict
  /// depends on it.
  double answer_floor = -1;
};

/// O(nnz of the given form) plus, from factors, the cost of one pass over the entries of A.
Metrics ComputeMetrics(const LcpProblem& problem, const Eigen::VectorXd& f, const LcpReference* reference = nullptr);

/// Judgement of a claimed Farkas ray y (symmetric A). A solution f has 0 <= y.w = f.A y + b.y, hence
/// -b.y <= |D^1/2 f|_1 |D^-1/2 A y|_inf: any solution needs |D^1/2 f|_1 >= force_min.
///
/// *Proved*: y_C >= 0, b.y < 0, and y^T A = 0, or J^T y = 0 on the columns of positive inverse mass, all without any
/// rounding, for the numbers as they are given. There is no solution.
///
/// *Within rounding*: accepted, and not proved. y_C >= 0, b.y < 0, null_residual <= kNullTolerance and force_min >=
/// kRayThreshold |D^-1/2 b|_1 (a small A y alone tells nothing: A = diag(1, 1e-10), b = (1, -1)). A problem whose data
/// differ from the given ones in their last digits has no solution then; the given one has none, or one with forces of
/// force_min and more. From factors the residual is that of J^T y: A y has the square of small angles between rows, and
/// J = ((1, 0), (1, 2^-24)), b = (0, -1) has the solution (-2^48, 2^48). Where A is given, such a problem cannot be
/// told from an infeasible one.
struct FarkasVerdict {
  static constexpr double kRayThreshold = 1e12;  ///< of force_min over |D^-1/2 b|_1
  /// 32 u: the entries rounded (2 u), y rounded (u), and a factor of 10 for rays that make A y = 0 exactly on some
  /// rows and leave the rounding to the others.
  static constexpr double kNullTolerance = 0x1p-48;
  bool accepted = false;  ///< there is no solution: proved, or within rounding
  bool proved = false;    ///< accepted, and nothing was rounded
  double b_dot_y = 0;     ///< negative for a ray
  double force_min = 0;   ///< F_min = -b.y / |D^-1/2 A y|_inf; infinite where proved
  /// From factors the largest |J^T y|_k / (|J^T||y|)_k over columns k of positive inverse mass, else |D^-1/2 A y|_inf /
  /// |D^-1/2 |A||y||_inf.
  double null_residual = 0;
  std::string reason;  ///< why it was not accepted; empty otherwise
};
/// O(nnz of the given form).
/// @param y  n values
FarkasVerdict VerifyFarkasRay(const LcpProblem& problem, const Eigen::VectorXd& y);

/// Tiers that results are sorted into.
inline constexpr double kTiers[] = {1e-9, 1e-6, 1e-3};

/// A problem's floor raises a tier to this at most: f = 0 always has rho <= 1, and must never pass.
inline constexpr double kLargestFloor = 1e-3;

/// The judgement, the same code for every solver.
/// Tier T passes if and only if f is finite, rho <= T' and backward_error <= sqrt(T'), where T' = T, or, where the
/// reference knows the problem's rounding floor, T' = max(T, min(floor, kLargestFloor)): below it not even the rounded
/// exact solution can be expected to be.
struct Verdict {
  double requested = 0;   ///< the tolerance asked for
  bool passes = false;    ///< at `requested`
  bool at_floor = false;  ///< passes thanks to the problem's floor only: without it, it would not
  double best_tier = 0;   ///< smallest of kTiers that passes; 0 when none does
  /// Claimed kSolved and does not pass; of an answer of another model: does not solve that, model_rho > T'.
  bool false_success = false;
  /// The residual of an answer in its own model; -1: its model is Coulomb's law, which `passes` is about whatever the
  /// model. Of the relaxation |D^1/2 f - projection of D^1/2 f - D^-1/2 w on the scaled cones| / S; of frozen bounds
  /// rho of the problem whose friction rows are bounded rows of these.
  double model_rho = -1;
  /// Claimed kInfeasible, but a solution is known (or known to exist), or f passes and no ray is accepted; where there
  /// are friction, sliding or bounded rows also where no ray is accepted.
  bool false_infeasible = false;
  std::optional<FarkasVerdict> farkas;  ///< when the result carries a ray
  std::string reason;                   ///< one line: why it does not pass; empty when it does
  Metrics metrics;                      ///< what the judgement rests on
};

/// @param tolerance  the requested tier, in (0, 1)
Verdict Verify(const LcpProblem& problem, const LcpResult& result, double tolerance,
               const LcpReference* reference = nullptr);

/// T' of Verdict: the tier, or the problem's floor where that is known (m.floor) and larger.
double EffectiveTier(const Metrics& m, double tolerance);

/// True if `m` passes tier `tolerance`: finite, rho <= T', backward_error <= sqrt(T') with T' = EffectiveTier.
bool PassesTier(const Metrics& m, double tolerance);

/// Names and formulas of the scalar metrics: one table for files, the command and the report.
struct MetricEntry {
  std::string_view key;      ///< in files and tables: "rho", "backward_error", ...
  double Metrics::*value;    ///< where Metrics has it
  std::string_view formula;  ///< one line
};

/// The primary metric first.
std::span<const MetricEntry> AllMetrics();

/// The rounding floor of an answer: the largest change of rho that rounding f to double alone can bring,
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
/// Where there are friction, sliding or bounded rows, over S (docs/friction.md section 4) in place of |D^-1/2 b|_2, and
/// with u mu (A_tt / A_nn)^1/2 |A_nn^1/2 f_n| more on friction rows.
///
/// From factors |A| |f| is bounded by |J| M^-1 (|J|^T |f|), so that A is never formed.
///
/// The floor belongs to f. Where contacts are redundant f is not unique, and a self-stress raises it as far as one
/// likes: a verdict may lean on the floor of an answer that the judged solver has no say in only (LcpReference::floor).
///
/// Infinite where f does not have n finite entries; 0 for n = 0. O(nnz of the given form).
double RoundingFloor(const LcpProblem& problem, const Eigen::VectorXd& f);

}  // namespace lcpbench
