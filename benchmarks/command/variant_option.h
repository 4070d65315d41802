#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <string>
#include <vector>

namespace lcpbench {

/// Adds --variant KEY=SOLVER[,NAME=VALUE]..., which may be repeated: a solver with other settings under a key of its
/// own. The name `slowdown` is ours: the solve then takes that many times as long (slowed_solver.h).
std::shared_ptr<std::vector<std::string>> AddVariantOption(CLI::App& command);

/// @throws InputError for what is no variant, and as RegisterSolverVariant
void RegisterVariants(const std::vector<std::string>& variants);

}  // namespace lcpbench
