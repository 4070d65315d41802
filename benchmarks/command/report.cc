#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include "benchmarks/command/commands.h"
#include "build_info.h"
#include "support/input_error.h"
#include "support/python_program.h"

namespace lcpbench {
namespace {

// Commands of report/report.py, which knows their options and says what is wrong with them.
struct ReportCommand {
  const char* name;
  const char* description;
};
constexpr ReportCommand kCommands[] = {
    {"report", "Makes a report of campaigns: an interactive page, figures, tables, a summary"},
    {"analyse", "Writes the statistics of a campaign's folder as CSV tables"},
    {"compare",
     "Which answers of two campaigns differ, and how far times and ratios moved, as Markdown; exit status 1 for a lost "
     "answer, a new false success, or a value that moved"},
    {"tune", "Tunes all solvers with one budget, for lcpbench run --tuned"},
};

// Goes on as a command of report/report.py, in the place of this program. @throws InputError where it does not start
int RunReportCommand(const std::string& name, const std::vector<std::string>& words) {
  std::vector<std::string> command = PythonCommand(kReportScriptFromProgram, kReportScript);
  command.push_back(name);
  if (name == "tune") {
    const std::string self = std::filesystem::read_symlink("/proc/self/exe").string();
    command.insert(command.end(), {"--lcpbench", self, "--data", kDataFolder});
  }
  command.insert(command.end(), words.begin(), words.end());
  std::vector<char*> arguments;
  for (std::string& word : command) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  execvp(arguments[0], arguments.data());
  throw InputError(name + ": '" + command[0] + "' cannot be started: " + std::strerror(errno) +
                   " (set LCPBENCH_PYTHON to a Python 3 interpreter)");
}

}  // namespace

void AddReportCommands(CLI::App& app, CommandRun& run) {
  for (const ReportCommand& of : kCommands) {
    CLI::App* command = app.add_subcommand(of.name, of.description)->prefix_command();
    command->set_help_flag();
    command->callback(
        [command, &run] { run = [command] { return RunReportCommand(command->get_name(), command->remaining()); }; });
  }
}

}  // namespace lcpbench
