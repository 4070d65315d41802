#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <optional>
#include <string>

namespace lcpbench {

// What the programs with a command line of ours have in common, the command and the studies.

/// Runs a program: standard output is checked, children end with it, and an exception becomes one line on standard
/// error, after `name`.
/// @param run  the program; its value is the exit status
/// @return the exit status (support/exit_status.h)
int RunProgram(const std::string& name, const std::function<int()>& run);

/// Reads a command line; a mistake becomes one line, as everywhere else. From here on libraries keep to one thread:
/// one solve, one thread, for every backend alike. Where OpenBLAS chose kernels with narrower registers than the
/// processor has, and OPENBLAS_CORETYPE is not set, the program first starts itself anew with wider ones.
/// @return the exit status where the program ends here: --help, --version, or a mistake
std::optional<int> ParseCommandLine(CLI::App& app, int argc, char** argv);

}  // namespace lcpbench
