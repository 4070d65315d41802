#pragma once

#include <memory>
#include <optional>
#include <string>

#include "solvers/lcp/range_scaling.h"
#include "solvers/lcp/rounding_floor.h"
#include "solvers/lcp/settings.h"
#include "solvers/lcp/solver.h"

namespace lcpbench {

/// An own solver: options in its header, with `void Read(SettingsReader* reader)` where settings change them, and an
/// engine in its .cc. The engine is the class that does the work; the header only declares it:
///
///     using PgsSolver = EngineSolver<PgsOptions, class PgsEngine>;
///     extern template class EngineSolver<PgsOptions, PgsEngine>;
///
/// The .cc file defines the engine and ends with `template class EngineSolver<PgsOptions, PgsEngine>;`. An engine has
///     explicit PgsEngine(const PgsOptions&);                           throws InputError for options out of range
///     std::string WhyUnsupported(const LcpProblem&) const;             optional: LcpSolver::WhyUnsupported
///     void Reserve(Index max_rows);                                    optional: LcpSolver::Reserve
///     void Prepare(const LcpProblem&);                                 LcpSolver::DoPrepare
///     void Solve(const LcpProblem&, const LcpOptions&, LcpResult*);    LcpSolver::DoSolve
///     bool SolveArrays(const ProblemArrays&, const LcpOptions&, LcpResult*);   optional: LcpSolver::DoSolveArrays
///     static constexpr bool kTakesFriction, kTakesBounded, kSolvesByFaces;     optional: LcpSolver::TakesFriction,
///     TakesBounded, SolvesByFaces
///     static constexpr bool kReadsFriction;                            optional: SolveArrays takes friction rows
///     bool takes_other_laws() const;                                   the same where options decide about both
/// none of them virtual. No engine sees extreme numbers: such a problem is brought into range first (RangeScaling), and
/// what is claimed of it judged by the verifier. A solver that offers more than LcpSolver derives from this class.
template <typename SolverOptions, typename SolverEngine>
class EngineSolver : public LcpSolver {
 public:
  using Options = SolverOptions;  ///< of this solver, documented beside it
  using Engine = SolverEngine;    ///< what does the work

  /// @throws InputError for options out of their ranges
  explicit EngineSolver(const Options& options = {});
  ~EngineSolver() override;

  std::string WhyUnsupported(const LcpProblem& problem) const override;  ///< the engine's
  bool TakesFriction() const override;                                   ///< the engine's
  bool TakesBounded() const override;                                    ///< the engine's
  bool SolvesByFaces() const override;                                   ///< the engine's
  void Reserve(Index max_rows) override;                                 ///< the engine's

 protected:
  void DoPrepare(const LcpProblem& problem) override;  ///< the engine's Prepare
  /// The engine's Solve.
  void DoSolve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) override;
  /// The engine's SolveArrays.
  bool DoSolveArrays(const ProblemArrays& arrays, const LcpOptions& options, LcpResult* result) override;

  const std::unique_ptr<Engine> engine_;  ///< never null

 private:
  std::optional<RangeScaling> scaling_;  // of a prepared matrix out of range
};

/// WhyUnsupported of solvers for symmetric A: names the own solvers that take any other.
inline std::string WhyNotSymmetric(const LcpProblem& problem) {
  if (problem.IsNumericallySymmetric()) return {};
  return "A is not symmetric; solvers that take it: pgs, psor, ipopt-ncp, and several peers";
}

/// WhyUnsupported of methods made for friction: a plain problem would be another method's to solve.
inline std::string WhyNotFriction(const LcpProblem& problem) {
  const std::string why = WhyNotSymmetric(problem);
  return why.empty() && problem.is_plain() ? "plain rows: the method is made for friction" : why;
}

template <typename Options, typename Engine>
EngineSolver<Options, Engine>::EngineSolver(const Options& options) : engine_(std::make_unique<Engine>(options)) {}

template <typename Options, typename Engine>
EngineSolver<Options, Engine>::~EngineSolver() = default;

template <typename Options, typename Engine>
std::string EngineSolver<Options, Engine>::WhyUnsupported(const LcpProblem& problem) const {
  if constexpr (requires { engine_->WhyUnsupported(problem); }) return engine_->WhyUnsupported(problem);
  return {};
}

template <typename Options, typename Engine>
bool EngineSolver<Options, Engine>::TakesFriction() const {
  if constexpr (requires { engine_->takes_other_laws(); }) return engine_->takes_other_laws();
  if constexpr (requires { Engine::kTakesFriction; }) return Engine::kTakesFriction;
  return false;
}

template <typename Options, typename Engine>
bool EngineSolver<Options, Engine>::TakesBounded() const {
  if constexpr (requires { engine_->takes_other_laws(); }) return engine_->takes_other_laws();
  if constexpr (requires { Engine::kTakesBounded; }) return Engine::kTakesBounded;
  return SolvesByFaces();
}

template <typename Options, typename Engine>
bool EngineSolver<Options, Engine>::SolvesByFaces() const {
  if constexpr (requires { Engine::kSolvesByFaces; }) return Engine::kSolvesByFaces;
  return false;
}

template <typename Options, typename Engine>
void EngineSolver<Options, Engine>::Reserve(Index max_rows) {
  if constexpr (requires { engine_->Reserve(max_rows); }) engine_->Reserve(max_rows);
}

template <typename Options, typename Engine>
void EngineSolver<Options, Engine>::DoPrepare(const LcpProblem& problem) {
  scaling_.reset();
  if (problem.has_extreme_matrix()) scaling_.emplace(problem);
  engine_->Prepare(scaling_ ? scaling_->matrix() : problem);
}

template <typename Options, typename Engine>
void EngineSolver<Options, Engine>::DoSolve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) {
  const FloorTeller floor;
  if (!problem.has_extreme_matrix() && !problem.has_extreme_b()) {
    engine_->Solve(problem, options, result);
    return floor.Tell(problem, options.tolerance, result);
  }
  if (!scaling_) scaling_.emplace(problem);  // of b alone
  scaling_->SolveScaled(problem, options, result,
                        [this](const LcpProblem& scaled, const LcpOptions& wanted, LcpResult* found) {
                          if (!scaled.is_plain()) engine_->Prepare(scaled);  // its bounds are scaled with b
                          engine_->Solve(scaled, wanted, found);
                        });
  if (!problem.is_plain() && !problem.has_extreme_matrix()) engine_->Prepare(problem);  // for another b
}

template <typename Options, typename Engine>
bool EngineSolver<Options, Engine>::DoSolveArrays(const ProblemArrays& arrays, const LcpOptions& options,
                                                  LcpResult* result) {
  if constexpr (requires { engine_->SolveArrays(arrays, options, result); }) {
    constexpr bool kReadsFriction = requires { Engine::kReadsFriction; };
    if (!kReadsFriction && !arrays.friction.empty()) return false;
    return engine_->SolveArrays(arrays, options, result);
  }
  return false;
}

}  // namespace lcpbench
