#include "support/python_script.h"

#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>

#include "support/input_error.h"

namespace lcpbench {
namespace {

constexpr int kCannotExecute = 127;  // as shells report it

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
  std::vector<char*> argv;
  argv.reserve(words.size() + 1);
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);

  const pid_t child = fork();
  if (child == 0) {
    execv(argv[0], argv.data());
    _exit(kCannotExecute);
  }
  int status = 0;
  if (child < 0 || waitpid(child, &status, 0) != child) throw InputError(command + ": cannot start " + words[0]);
  if (!WIFEXITED(status) || WEXITSTATUS(status) == kCannotExecute) {
    throw InputError(command + ": cannot run " + words[0] + " (set LCPBENCH_PYTHON to a Python 3 interpreter)");
  }
  return WEXITSTATUS(status);
}

}  // namespace lcpbench
