#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "benchmarks/collection/problem_formats.h"
#include "benchmarks/motions/scene_source.h"
#include "model/contact/assembly.h"
#include "solvers/lcp/settings.h"
#include "solvers/registry.h"

namespace lcpbench {

// Options that several commands have.

/// Refuses all but numbers for which `holds` is true: "expected <expected>, found '...'".
CLI::Validator Expect(const std::string& expected, const std::function<bool(double)>& holds);
CLI::Validator AtLeast(int least);
CLI::Validator PositiveSeconds();
CLI::Validator Tolerance();

void AddToleranceOption(CLI::App& command, double* tolerance);
void AddTimeLimitOption(CLI::App& command, double* time_limit_s);
/// --cpu; refuses a processor that this process may not use.
void AddCpuOption(CLI::App& command, int* cpu);

/// --fclib-triplets, --without-friction, --box-friction and --symmetrize: choices of readers.
void AddReadingOptions(CLI::App& command, ReadingOptions* reading);

/// A scene, and what overrides its own way of moving.
struct SceneOptions {
  std::string scene = {};  ///< family or file
  int size = 100;
  std::uint64_t seed = 1;
  std::string level = {};                                     ///< "": the scene's own
  double step = 0;                                            ///< [s]; 0: the scene's own
  double budget_s = std::numeric_limits<double>::infinity();  ///< wall clock of the motion

  double friction = -1;  ///< of every contact; < 0: the scene's own

  /// @return the options that it adds
  std::vector<CLI::Option*> AddSizeAndSeed(CLI::App& command);
  void AddFriction(CLI::App& command);
  void AddLevel(CLI::App& command);
  void AddStep(CLI::App& command);
  void AddBudget(CLI::App& command);
  /// @throws InputError as LoadScene, and for an unknown level
  MovingScene Load() const;
  /// The problem of one instant (LoadInstant): the time step of the scene where it has friction (AssembleInstant).
  /// @throws InputError as LoadInstant and Load
  std::pair<ContactSystem, AssembledLcp> LoadProblem() const;
};

/// Adds --set NAME=VALUE, which may be repeated: options of the solver itself.
void AddSettingsOption(CLI::App& command, std::vector<std::string>* pairs);
/// @throws InputError for a pair that is not NAME=VALUE, and for a name that stands twice
Settings ParseSettings(const std::vector<std::string>& pairs);

/// Solvers that a command line names besides those of the registry. They are registered before keys are read.
struct NamedSolvers {
  /// KEY=COMMAND; the shell splits the command, settings (--set) follow it as NAME=VALUE.
  std::vector<std::string> externals;
  /// KEY=SOLVER[,NAME=VALUE]...: a solver with other settings under a key of its own.
  std::vector<std::string> variants;
  double start_limit_s = kStartLimit;  ///< for an external solver to greet [s]

  /// Adds --external and --variant, which may be repeated, and --start-limit.
  void Declare(CLI::App& command);
  /// @throws InputError for a malformed one, a program that is not there, or a key that is taken, and as
  /// RegisterSolverVariant
  void Register() const;
  /// The same as words of a command line, for worker processes.
  std::vector<std::string> Words() const;
};

/// @throws InputError as NamedSolvers::Register
void RegisterVariants(const std::vector<std::string>& variants);

}  // namespace lcpbench
