#include "support/python_program.h"

#include <cstdlib>
#include <filesystem>

#include "support/input_error.h"
#include "support/program_folder.h"

namespace lcpbench {

std::vector<std::string> PythonCommand(const std::string& from_program, const std::string& in_source) {
  const std::string installed = ProgramFolder() + "/" + from_program;
  const std::string program = std::filesystem::exists(installed) ? installed : in_source;
  if (!std::filesystem::exists(program)) {
    throw InputError("the Python program is neither at " + installed + " nor at " + in_source);
  }
  const char* chosen = std::getenv("LCPBENCH_PYTHON");
  return {chosen != nullptr ? chosen : "/usr/bin/python3", "-E", "-s", program};
}

}  // namespace lcpbench
