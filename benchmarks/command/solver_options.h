#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <string>
#include <vector>

#include "solvers/lcp/settings.h"

namespace lcpbench {

/// Adds --set NAME=VALUE, which may be repeated: options of the solver itself.
std::shared_ptr<std::vector<std::string>> AddSettingsOption(CLI::App& command);

/// @throws InputError for a pair that is not NAME=VALUE
Settings ParseSettings(const std::vector<std::string>& pairs);

/// Solvers that a command line names besides those of the registry. They are registered before keys are read.
struct NamedSolvers {
  /// KEY=COMMAND; the shell splits the command, settings (--set) follow it as NAME=VALUE.
  std::vector<std::string> externals;
  /// KEY=SOLVER[,NAME=VALUE]...: a solver with other settings under a key of its own. The name `slowdown` is ours: the
  /// solve then takes that many times as long (slowed_solver.h).
  std::vector<std::string> variants;

  /// @throws InputError for a malformed one or a key that is taken, and as RegisterSolverVariant
  void Register() const;
  /// The same as words of a command line, for worker processes.
  std::vector<std::string> Words() const;
};

/// Adds --external and --variant, which may be repeated, to a command that takes solver keys.
std::shared_ptr<NamedSolvers> AddNamedSolverOptions(CLI::App& command);

/// @throws InputError as NamedSolvers::Register
void RegisterVariants(const std::vector<std::string>& variants);

}  // namespace lcpbench
