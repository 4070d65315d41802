#pragma once

#include <functional>
#include <map>
#include <memory>
#include <ostream>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "solvers/lcp/method_class.h"
#include "solvers/lcp/problem.h"
#include "solvers/lcp/settings.h"
#include "solvers/lcp/solver.h"
#include "solvers/peers/protocol/external_solver.h"

namespace lcpbench {

/// Where a backend comes from.
enum class SolverOrigin {
  kOwn,       ///< written here, on the libraries of this build
  kPeer,      ///< another project's, behind a worker process (solvers/peers/)
  kExternal,  ///< a command that the user named (RegisterExternalSolver); a variant has the origin of its base
};

/// One backend. The key is the same in files, tests, benchmarks and the report.
struct SolverEntry {
  std::string key;         ///< "auto", "pgs", ...
  std::string method;      ///< one line
  std::string source;      ///< paper or library
  bool available = false;  ///< false: not in this build (the row stays)
  /// Whether the answer depends on the requested tolerance. False: one run stands for every tier.
  bool uses_tolerance = false;
  /// "" where theory (and our tests) promise a solution at `tolerance` for this problem, else the reason in words.
  std::string (*why_not_guaranteed)(const LcpProblem& problem, double tolerance) = nullptr;
  /// Empty where not available. @throws InputError for unknown or impossible settings
  std::function<std::unique_ptr<LcpSolver>(const Settings& settings)> make;
  SolverOrigin origin = SolverOrigin::kOwn;  ///< of a variant: its base's
  std::string licence = "Apache-2.0";        ///< SPDX expression: of our code, or of the peer's library
  std::string base = {};                     ///< of a variant (RegisterSolverVariant): the key it is another setting of
  Settings settings = {};                    ///< of a variant: what it adds to what `make` is given
  /// Where settings depend on the number of rows (RegisterSolverBySize): the keys that run in the place of this one, by
  /// the rows that each is meant for.
  std::map<Index, std::string> by_rows = {};
  /// LcpSolver::TakesFriction and TakesBounded: what problems campaigns give it.
  bool takes_friction = false;
  bool takes_bounded = false;  ///< see takes_friction
  /// The law of friction that its answers obey, in words (FrictionLaw): "Coulomb", "relaxed", ...; "" where it takes no
  /// friction, and for a user's command, whose law is not known.
  std::string_view law = {};
  /// False of a method made for friction: campaigns give it no plain problem.
  bool takes_plain = true;
  /// What limits its size (SizeLimitOf).
  MethodClass method_class = MethodClass::kAnySize;
  /// A library's own options, never asked for the tier's tolerance.
  bool library_defaults = false;
  /// It solves A with a larger diagonal on purpose (PeerEntry::is_shifted): its answers are those of another problem.
  bool shifted = false;

  /// What the requested tolerance is to it: "follows", "direct" (the method has none) or "default" (library_defaults).
  std::string_view tolerance() const;
};

/// "" where a solver is given problems of this size in campaigns, else the rule by which it is not (SizeLimitOf). What
/// is larger and allowed is ended by the time limit.
std::string SizeRefusal(const SolverEntry& solver, Index rows);

/// Writes the key, for listings of tests.
inline std::ostream& operator<<(std::ostream& out, const SolverEntry& entry) { return out << entry.key; }

/// Every backend, in the report's order: own, peers, then what was registered. Valid until the next registration.
std::span<const SolverEntry> AllSolvers();

/// An older key of a solver, `suitesparse` for `ipm`, finds it too.
/// @throws InputError naming the known keys
const SolverEntry& FindSolver(std::string_view key);

/// A solver by key. @throws InputError when unknown, not in this build, or for a wrong setting
std::unique_ptr<LcpSolver> MakeSolver(std::string_view key, const Settings& settings = {});

/// The version of the library behind a peer or external solver, as its worker says; "" for own solvers, and for peers'
/// workers that do not start. Starts the worker on the first call.
/// @throws InputError where an external solver does not start
std::string WorkerVersion(std::string_view key);

/// Adds a solver. Not thread-safe, and so are those below.
/// @throws InputError unless the key is new and made of a-z, 0-9, '-', '_'
void RegisterSolver(SolverEntry entry);

/// Adds a solver that is another one with settings of its own, or with none: one solver under two names.
/// @throws InputError as RegisterSolver, and for an unknown base, one that is not in this build, or wrong settings
void RegisterSolverVariant(const std::string& key, const std::string& base, const Settings& settings);

/// Adds a solver that is another one with settings by the number of rows: campaigns run the keys in its place
/// (KeyForRows), and name it in their results. Made by itself it is its base.
/// @param by_rows  the base and variants of it, by the rows that each is meant for; not empty
/// @throws InputError as RegisterSolver, and for unknown keys
void RegisterSolverBySize(const std::string& key, const std::string& base, const std::map<Index, std::string>& by_rows);

/// The key that runs where a problem has so many rows, at least 1: of by_rows the one that is meant for the nearest
/// number by ratio, of two the smaller one; else the solver's own.
const std::string& KeyForRows(const SolverEntry& solver, Index rows);

/// Adds a solver that runs as a command of the user's (solvers/peers/protocol/protocol.h). KEY-baseline, where KEY is
/// an own solver, stands for that one in another build, `lcpbench serve KEY`, with the facts of KEY.
/// @param command  program and arguments
/// @param start_limit_s  for the worker to greet [s]
/// @throws InputError as RegisterSolver, and for an empty command
void RegisterExternalSolver(const std::string& key, const std::vector<std::string>& command,
                            double start_limit_s = kStartLimit);

}  // namespace lcpbench
