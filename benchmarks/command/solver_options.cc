#include "benchmarks/command/solver_options.h"

#include <sstream>
#include <utility>

#include "benchmarks/measure/slowed_solver.h"
#include "solvers/registry.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

// One a flag, so that arguments may follow it.
void AddRepeated(CLI::App& command, const char* name, std::vector<std::string>* values, const char* description) {
  command.add_option(name, *values, description)->allow_extra_args(false);
}

// What stands before and after the first '='; neither is empty.
std::pair<std::string, std::string> Divided(const std::string& pair, const char* option, const char* expected) {
  const auto equals = pair.find('=');
  if (equals == std::string::npos || equals == 0 || equals + 1 == pair.size()) {
    throw InputError(std::string(option) + ": expected " + expected + ", found '" + pair + "'");
  }
  return {pair.substr(0, equals), pair.substr(equals + 1)};
}

constexpr const char* kSlowdown = "slowdown";
constexpr double kMostSlowdown = 100;

// Registers a solver that is `base`, slowed.
void RegisterSlowed(const std::string& key, const std::string& base, const std::string& slowdown) {
  const Settings settings{{kSlowdown, slowdown}};
  SettingsReader reader(key, settings);
  const double factor = reader.Number(kSlowdown, 1, 1, kMostSlowdown);
  SolverEntry entry = FindSolver(base);
  if (!entry.available) throw InputError("solver '" + base + "' is not in this build");
  if (entry.origin != SolverOrigin::kOwn) {
    throw InputError("--variant " + key + ": expected one of our own solvers to slow down, found '" + base + "'");
  }
  entry.base = entry.base.empty() ? entry.key : entry.base;
  entry.key = key;
  entry.settings[kSlowdown] = slowdown;
  entry.make = [make = entry.make, factor](const Settings& more) -> std::unique_ptr<LcpSolver> {
    return std::make_unique<SlowedSolver>(make(more), factor);
  };
  RegisterSolver(std::move(entry));
}

}  // namespace

std::shared_ptr<std::vector<std::string>> AddSettingsOption(CLI::App& command) {
  auto pairs = std::make_shared<std::vector<std::string>>();
  AddRepeated(command, "--set", pairs.get(), "Option of the solver itself, NAME=VALUE; may be repeated");
  return pairs;
}

Settings ParseSettings(const std::vector<std::string>& pairs) {
  Settings settings;
  for (const std::string& pair : pairs) {
    const auto equals = pair.find('=');
    if (equals == std::string::npos || equals == 0) {
      throw InputError("--set: expected NAME=VALUE, found '" + pair + "'");
    }
    settings[pair.substr(0, equals)] = pair.substr(equals + 1);
  }
  return settings;
}

std::shared_ptr<NamedSolvers> AddNamedSolverOptions(CLI::App& command) {
  auto solvers = std::make_shared<NamedSolvers>();
  AddRepeated(command, "--external", &solvers->externals,
              "A solver of your own: KEY=COMMAND, a program that speaks the protocol of "
              "solvers/peers/protocol/protocol.h; may be repeated");
  AddRepeated(command, "--variant", &solvers->variants,
              "KEY=SOLVER[,NAME=VALUE]...: a solver with other settings, or one of ours slowed on purpose "
              "(slowdown=1.1), under a key of its own; may be repeated");
  return solvers;
}

void NamedSolvers::Register() const {
  for (const std::string& external : externals) {
    const auto [key, program] = Divided(external, "--external", "KEY=COMMAND");
    // "$@" hands on the settings.
    RegisterExternalSolver(key, {"/bin/sh", "-c", "exec " + program + " \"$@\"", "lcpbench"});
  }
  RegisterVariants(variants);
}

std::vector<std::string> NamedSolvers::Words() const {
  std::vector<std::string> words;
  for (const std::string& external : externals) words.insert(words.end(), {"--external", external});
  for (const std::string& variant : variants) words.insert(words.end(), {"--variant", variant});
  return words;
}

void RegisterVariants(const std::vector<std::string>& variants) {
  for (const std::string& variant : variants) {
    const auto [key, rest] = Divided(variant, "--variant", "KEY=SOLVER[,NAME=VALUE]...");
    std::istringstream parts(rest);
    std::string base;
    std::getline(parts, base, ',');
    std::vector<std::string> pairs;
    for (std::string pair; std::getline(parts, pair, ',');) pairs.push_back(pair);
    Settings settings = ParseSettings(pairs);
    const auto slowdown = settings.extract(kSlowdown);
    if (slowdown.empty()) {
      RegisterSolverVariant(key, base, settings);
    } else if (settings.empty()) {
      RegisterSlowed(key, base, slowdown.mapped());
    } else {
      throw InputError("--variant " + key + ": expected slowdown alone, or a variant of a variant");
    }
  }
}

}  // namespace lcpbench
