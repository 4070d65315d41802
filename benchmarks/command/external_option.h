#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <string>
#include <vector>

namespace lcpbench {

/// Adds --external KEY=COMMAND to a command that takes solver keys. The list is to be registered before keys are read.
std::shared_ptr<std::vector<std::string>> AddExternalOption(CLI::App& command);

/// Registers each KEY=COMMAND; the shell splits the command, settings (--set) follow it as NAME=VALUE.
/// @throws InputError for a malformed pair or a key that is taken
void RegisterExternals(const std::vector<std::string>& pairs);

}  // namespace lcpbench
