#pragma once

#include <CLI/CLI.hpp>
#include <cstdio>
#include <functional>
#include <string>
#include <vector>

#include "solvers/lcp/input_error.h"
#include "solvers/registry.h"

/// What the drivers share that compare own solvers apart from the lcpbench command.
namespace lcpbench {

/// Keys of the own solvers of this build, in the registry's order.
inline std::vector<std::string> AvailableOwnSolvers() {
  std::vector<std::string> keys;
  for (const SolverEntry& entry : AllSolvers()) {
    if (entry.available && entry.origin == SolverOrigin::kOwn) keys.push_back(entry.key);
  }
  return keys;
}

/// Parses and runs. Exit status 2 and one line on standard error for a user's mistake, as the command does.
inline int RunStudy(CLI::App* app, int argc, char** argv, const std::function<void()>& run) {
  constexpr int kMisuse = 2;
  try {
    app->parse(argc, argv);
    run();
  } catch (const CLI::ParseError& error) {
    return app->exit(error) == 0 ? 0 : kMisuse;
  } catch (const InputError& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return kMisuse;
  }
  return 0;
}

}  // namespace lcpbench
