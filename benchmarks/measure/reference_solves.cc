#include "benchmarks/measure/reference_solves.h"

#include <algorithm>
#include <array>
#include <memory>
#include <string_view>
#include <utility>

#include "solvers/exact/unique_forces.h"
#include "solvers/lcp/verify.h"
#include "solvers/pivoting/least_norm.h"
#include "solvers/registry.h"

namespace lcpbench {
namespace {

constexpr double kTolerance = 1e-12;
constexpr double kTimeLimit = 30;
// By expected cost. The answers of an interior point, of pivoting and of descent from 0 lie apart where f is not
// unique: their floors differ by up to 50 on redundant packings.
constexpr std::array<const char*, 3> kModeSolvers = {"auto", "relaxation", "pgs"};
constexpr std::array<std::string_view, 4> kReferenceSolvers = {"auto", "ipm", "nncg", "dantzig"};

LcpResult SolveBy(const char* key, const LcpProblem& problem) {
  LcpOptions options;
  options.tolerance = kTolerance;
  options.time_limit_s = kTimeLimit;
  LcpResult result;
  MakeSolver(key)->Solve(problem, options, &result);
  return result;
}

}  // namespace

ExactGuess GuessBySolvers(const LcpProblem& problem) {
  ExactGuess guess;
  for (const char* key : {"dantzig", "auto"}) {
    const LcpResult result = SolveBy(key, problem);
    if (result.status == LcpStatus::kInfeasible && result.farkas_ray.has_value()) {
      guess.ray = *result.farkas_ray;
      return guess;
    }
    if (guess.f.size() == 0 || result.status == LcpStatus::kSolved) guess.f = result.f;
    if (result.status == LcpStatus::kSolved) return guess;
  }
  return guess;
}

LcpResult SolveNearly(const LcpProblem& problem) { return SolveBy("auto", problem); }

ModeGuess GuessModes(const LcpProblem& problem) {
  ModeGuess guess;
  guess.proof = ProveNearby(problem, Eigen::VectorXd::Zero(problem.size()));
  for (const char* key : kModeSolvers) {
    const SolverEntry& entry = FindSolver(key);
    if (!problem.friction_rows().empty() && !entry.takes_friction) continue;
    if (!problem.bounded_rows().empty() && !entry.takes_bounded) continue;
    const LcpResult result = SolveBy(key, problem);
    if (result.f.size() != problem.size() || !result.f.allFinite()) continue;
    ModeProof proof = ProveModes(problem, result.f);
    const bool is_proved = proof.proof == ModeProof::Proof::kModes;
    guess.modes.insert(is_proved ? guess.modes.begin() : guess.modes.end(), proof.modes);
    guess.modes.push_back(ModesOf(problem, result.f));
    if (proof.IsBetterThan(guess.proof)) guess.proof = std::move(proof);
    if (is_proved) break;
  }
  return guess;
}

ExactOptions FromSolvers(const LcpProblem& problem, double time_limit_s) {
  ExactOptions options{.time_limit_s = time_limit_s, .guess = GuessBySolvers};
  options.guessed_modes = [&problem] { return GuessModes(problem).modes; };
  return options;
}

std::optional<bool> IsOnlyAnswer(const LcpProblem& problem, const Eigen::VectorXd& f, double tolerance) {
  constexpr Index kMostRows = 300;
  constexpr double kClearly = 1e-3;
  const std::optional<bool> known = UniqueForces(problem, f);
  if (known || problem.size() > kMostRows) return known;
  const LeastNormForces least = FindLeastNormForces(problem, f, {.tolerance = tolerance});
  const bool differs = least.status == LcpStatus::kSolved && (least.f - f).norm() > kClearly * f.norm();
  return differs ? std::optional<bool>(false) : std::nullopt;
}

std::optional<double> FindReferenceFloor(const LcpProblem& problem, double tolerance, double time_limit_s) {
  std::optional<double> least;
  LcpOptions options;
  options.tolerance = tolerance;
  options.time_limit_s = time_limit_s;
  for (const std::string_view key : kReferenceSolvers) {
    const SolverEntry& entry = FindSolver(key);
    if (!entry.available || !SizeRefusal(entry, problem.size()).empty()) continue;
    LcpResult result;
    entry.make({})->Solve(problem, options, &result);
    LcpReference own;
    own.floor = RoundingFloor(problem, result.f);
    if (!Verify(problem, result, tolerance, &own).passes) continue;
    least = std::min(least.value_or(*own.floor), *own.floor);
    if (*least <= tolerance) break;
  }
  return least;
}

}  // namespace lcpbench
