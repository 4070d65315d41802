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

}  // namespace lcpbench
