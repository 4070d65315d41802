#include "support/python_script.h"

#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <limits>
#include <stdexcept>
#include <utility>

#include "support/input_error.h"
#include "support/subprocess.h"

namespace lcpbench {
namespace {

// Debian's pandas, SciPy, matplotlib and Jinja2 belong to Debian's interpreter, which need not be the first on PATH.
std::string Interpreter() {
  if (const char* chosen = std::getenv("LCPBENCH_PYTHON")) return chosen;
  return "/usr/bin/python3";
}

std::string FindScript(const std::string& command, const std::vector<std::string>& places) {
  std::string names;
  for (const std::string& path : places) {
    if (std::filesystem::exists(path)) return path;
    names += (names.empty() ? "" : " nor at ") + path;
  }
  throw InputError(command + ": the script is neither at " + names);
}

}  // namespace

int RunPythonScript(const std::string& command, const std::vector<std::string>& places,
                    const std::vector<std::string>& arguments) {
  std::vector<std::string> words = {Interpreter(), FindScript(command, places)};
  words.insert(words.end(), arguments.begin(), arguments.end());
  SubprocessOptions options;
  options.command = std::move(words);
  options.own_streams = false;
  int status = 0;
  try {
    status = Subprocess(options).WaitOrKill(std::numeric_limits<double>::infinity());
  } catch (const std::runtime_error& error) {
    throw InputError(command + ": " + error.what() + " (set LCPBENCH_PYTHON to a Python 3 interpreter)");
  }
  if (!WIFEXITED(status)) throw InputError(command + ": the script " + DescribeEnd(status));
  return WEXITSTATUS(status);
}

}  // namespace lcpbench
