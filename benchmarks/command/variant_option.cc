#include "benchmarks/command/variant_option.h"

#include <sstream>
#include <utility>

#include "benchmarks/command/settings_option.h"
#include "benchmarks/measure/slowed_solver.h"
#include "solvers/registry.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

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

std::shared_ptr<std::vector<std::string>> AddVariantOption(CLI::App& command) {
  auto variants = std::make_shared<std::vector<std::string>>();
  command
      .add_option("--variant", *variants,
                  "KEY=SOLVER[,NAME=VALUE]...: a solver with other settings, or one of ours slowed on purpose "
                  "(slowdown=1.1), under a key of its own; may be repeated")
      ->allow_extra_args(false);
  return variants;
}

void RegisterVariants(const std::vector<std::string>& variants) {
  for (const std::string& variant : variants) {
    const auto equals = variant.find('=');
    if (equals == std::string::npos || equals == 0 || equals + 1 == variant.size()) {
      throw InputError("--variant: expected KEY=SOLVER[,NAME=VALUE]..., found '" + variant + "'");
    }
    const std::string key = variant.substr(0, equals);
    std::istringstream parts(variant.substr(equals + 1));
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
