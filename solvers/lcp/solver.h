#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <ostream>
#include <string>
#include <string_view>

#include "solvers/lcp/problem.h"
#include "support/clock.h"

namespace lcpbench {

/// How a solve ended, in the solver's own words: a claim that Verify() judges.
enum class LcpStatus {
  kNotRun,            ///< Solve() was not called; never returned by it
  kSolved,            ///< the solver believes that f meets the requested tolerance
  kInfeasible,        ///< no f exists, or none within rounding: see FarkasVerdict of farkas_ray (verify.h)
  kIterationLimit,    ///< stopped by options.max_iterations or the solver's own default limit
  kTimeLimit,         ///< stopped by options.time_limit_s
  kNumericalFailure,  ///< breakdown, stagnation above the tolerance, or cycling; detail says which
  kUnsupported,       ///< the problem is outside what the solver takes; detail says why
};

/// The key used in files and tables: "solved", "iteration_limit", ...
std::string_view ToString(LcpStatus status);
/// Writes the key.
inline std::ostream& operator<<(std::ostream& out, LcpStatus status) { return out << ToString(status); }
/// @throws InputError for an unknown key
LcpStatus LcpStatusFromString(std::string_view key);

/// What every solver understands. Options of one method are typed structs given to its constructor.
struct LcpOptions {
  /// Requested bound on the scaled natural residual rho (verify.h), dimensionless, in (0, 1).
  double tolerance = 1e-9;
  /// In the solver's own unit (pivots, sweeps, Newton steps); 0 means the solver's documented default.
  std::int64_t max_iterations = 0;
  /// Wall-clock limit [s], > 0.
  double time_limit_s = std::numeric_limits<double>::infinity();
  /// Warm start: n values, finite; nullptr is a cold start. Not owned; must outlive the call.
  const Eigen::VectorXd* initial_f = nullptr;
  /// Whether adapters of foreign code shall say own_solve_s and own_convert_s: clock reads around the library's call,
  /// so not where the whole is timed.
  bool time_parts = false;
  /// Whether LcpResult::factor_s is wanted: two clock reads a factorization, so not where the solve itself is timed.
  bool time_factorizations = false;
  /// The clock that the time limit is read from; tests inject their own.
  double (*now)() = &SteadyNow;
};

/// The law of contact with friction that an answer claims to obey.
enum class FrictionModel {
  kCoulomb,       ///< the problem's own
  kRelaxation,    ///< f in the friction cones, w in their duals, f.w = 0: slip separates [docs/friction.md section 1]
  kFrozenBounds,  ///< friction rows are bounded rows, of bounds that the solver chose once: LcpResult::friction_bounds
};

/// A solver's answer. `f` always has n finite-or-not entries: the best iterate, also when not solved; zeros when the
/// solver had none.
struct LcpResult {
  LcpStatus status = LcpStatus::kNotRun;          ///< the solver's claim
  Eigen::VectorXd f;                              ///< n
  FrictionModel model = FrictionModel::kCoulomb;  ///< what `status` is a claim about
  Eigen::VectorXd friction_bounds;                ///< n, of kFrozenBounds: the largest |f| of friction rows; else empty
  /// Pivots, sweeps or Newton steps, as the solver's header defines them; -1 before a solve.
  std::int64_t iterations = -1;
  /// The reason in words, with an external library's own code where there is one. Empty when there is nothing to say.
  std::string detail;
  /// Adapters of foreign code time the solve themselves [s]: the call of Solve contains conversions or a process
  /// boundary besides, and own_convert_s says how long conversions took. Negative: the call's time is the solve's.
  double own_solve_s = -1;
  double own_convert_s = -1;  ///< [s], see own_solve_s
  /// Time of a solver in another process [s]: one interval there, from the caller's arrays to f, set-up and warm start
  /// inside; after LcpProblem::WithB from the new b to f. Negative: the solver runs in this process.
  double own_fresh_s = -1;
  /// Time of the solve in numeric factorizations [s] (factor_clock.h); negative: not asked for, or not known.
  double factor_s = -1;
  /// Ray of kInfeasible, where the solver has it: y >= 0 on unilateral rows, A y = 0, b.y < 0 (docs/model.md section
  /// 8, property 3). VerifyFarkasRay says whether it is a proof, or holds within rounding only.
  std::optional<Eigen::VectorXd> farkas_ray;
};

/// Reads the clock of `options` from its construction on. Whoever asks it anything is interrupted where the thread's
/// work is (support/cancellation.h).
class Deadline {
 public:
  /// Whether one is needed: time is limited, or the thread's work may be interrupted. Else reading the clock would cost
  /// for nothing.
  static bool IsNeeded(const LcpOptions& options);
  /// Starts now.
  explicit Deadline(const LcpOptions& options);
  /// One clock read; call it often enough for the accuracy that the limit shall have.
  bool Expired() const;
  /// Seconds since the construction.
  double Elapsed() const;
  /// Seconds left (may be infinite), never negative.
  double Remaining() const;
  /// Remaining as a LcpOptions::time_limit_s, which must be > 0.
  double RestOfLimit() const;

 private:
  double (*now_)();
  double start_;
  double limit_;
};

/// An LCP solver. One object serves one thread at a time; distinct objects are independent. Nothing carries over from
/// one problem to another but workspace, so that an object that has solved others does the same work as a new one and
/// gives the same bits; a warm start is options.initial_f. Only SetInSequence lets more carry over.
///
/// The life of a solve: Prepare(problem) does what depends on A and the bounds only, never on b (forms of A that the
/// method reads, allocation, orders, symbolic analysis), and holds for every problem that shares the matrix
/// (LcpProblem::WithB), as does what a Solve prepares besides: backends that are asked where others failed. Solve
/// prepares by itself where the caller did not. A user with a new problem pays for both.
///
/// Own solvers that check their answer before they claim it do so by rho and backward error, the measures of the
/// verifier (verify.h), mostly by residual.h, rays by VerifyFarkasRay itself.
class LcpSolver {
 public:
  virtual ~LcpSolver() = default;

  /// "" if the solver takes this problem, else the reason in words (reported as kUnsupported).
  virtual std::string WhyUnsupported(const LcpProblem& problem) const;

  /// WhyUnsupported, or the kind of rows that the solver does not take. What Solve asks.
  std::string WhyRefused(const LcpProblem& problem) const;

  /// Whether it takes problems with friction and sliding rows; the others refuse them as kUnsupported.
  virtual bool TakesFriction() const { return false; }
  /// Whether it takes problems with bounded rows; the others refuse them as kUnsupported.
  virtual bool TakesBounded() const { return SolvesByFaces(); }
  /// Whether problems with bounded rows, and no friction rows, are solved face by face: DoSolve sees plain problems
  /// only.
  ///
  /// In a face a bounded row is unilateral at one of its bounds, f = lower + g or upper - g with g >= 0, bilateral
  /// where both bounds are far beyond its load, or held at a bound and left out. Rows whose force is beyond the bound
  /// that the face lacks get that bound instead of the other. Where such exchanges do not settle, an active-set method
  /// goes on: from forces within all bounds towards the answer of the face, a convex quadratic program, up to the first
  /// bound, whose row is held from there on; rows are let go where w has the wrong sign in the answer of a face. The
  /// energy 1/2 f.A f + b.f falls with every step, so that no face comes again, unless a step has no length.
  ///
  /// kSolved only where the clipped forces pass by ComputeMetrics; kInfeasible only where a ray of a face reaches no
  /// bound and VerifyFarkasRay accepts it. Guaranteed in exact arithmetic for symmetric PSD A but for steps of no
  /// length, if faces are solved; mostly one to four of them. Iterations are the sum over faces.
  virtual bool SolvesByFaces() const { return false; }

  /// Allocates workspace for problems of up to `max_rows` rows, so that a dense solver's later Solve does not allocate.
  virtual void Reserve(Index max_rows);

  /// Whether the problems to come are steps of a sequence, each much like the one before; off at first. On: the order
  /// and the symbolic analysis of the problem before are kept where the pattern is the same.
  void SetInSequence(bool in_sequence) { in_sequence_ = in_sequence; }

  /// Set-up for `problem`, see above. Idempotent: a second call with a problem of the same matrix costs nothing.
  void Prepare(const LcpProblem& problem);

  /// Solves. Never throws for a hard problem: that is a status. Exceptions of libraries below end as
  /// kNumericalFailure with the original message in detail.
  /// @throws InputError for options out of their range (tolerance, limits, initial_f's length or finiteness)
  void Solve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result);

  /// Solve of LcpProblem::FromArrays(arrays): all that a user with a new problem pays. An adapter of a code that takes
  /// A as it is assembled goes there without an LcpProblem, as an engine does.
  /// @param arrays  checked already, as LcpProblem::FromArrays does (the protocol's worker has, off the clock)
  /// @throws InputError as Solve, and LcpProblem::FromArrays
  void SolveArrays(const ProblemArrays& arrays, const LcpOptions& options, LcpResult* result);

 protected:
  /// n >= 1, WhyUnsupported() empty. Must not read b.
  virtual void DoPrepare(const LcpProblem& problem) = 0;
  /// As above, a problem of the same matrix prepared, options checked; result->f has n zeros, iterations is 0, detail
  /// and ray are empty, status is kNumericalFailure until the solver says otherwise.
  virtual void DoSolve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) = 0;
  /// As DoSolve, for a cold start from arrays. Returns false and leaves the result unchanged where the arrays need an
  /// LcpProblem; the caller then makes one.
  virtual bool DoSolveArrays(const ProblemArrays& arrays, const LcpOptions& options, LcpResult* result);

 private:
  bool IsByFaces(const LcpProblem& problem) const {
    return !problem.is_plain() && SolvesByFaces() && problem.friction_rows().empty();
  }
  void SolveByFaces(const LcpProblem& problem, const LcpOptions& options, LcpResult* result);

  std::optional<LcpProblem> prepared_;
  bool in_sequence_ = false;
};

}  // namespace lcpbench
