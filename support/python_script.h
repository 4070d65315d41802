#pragma once

#include <string>
#include <vector>

namespace lcpbench {

/// Runs a Python script of report/ in a process of its own and waits for its end.
///
/// The interpreter is $LCPBENCH_PYTHON, else /usr/bin/python3.
///
/// @param command    subcommand that asks for it, for messages
/// @param places     files to look for the script at, the first that exists is run
/// @param arguments  of the script
/// @returns the script's exit status
/// @throws InputError if there is no such script, or the interpreter cannot be run or does not end by itself
int RunPythonScript(const std::string& command, const std::vector<std::string>& places,
                    const std::vector<std::string>& arguments);

}  // namespace lcpbench
