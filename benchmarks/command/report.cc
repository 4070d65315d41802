#include <filesystem>
#include <string>
#include <vector>

#include "benchmarks/command/commands.h"
#include "build_info.h"
#include "support/python_script.h"

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
    {"compare", "What changed between two campaigns of one plan, as Markdown; exit status 1 for a regression"},
    {"tune", "Tunes all solvers with one budget, for lcpbench run --tuned"},
};

int RunReportCommand(const std::string& name, const std::vector<std::string>& words) {
  std::vector<std::string> arguments = {name};
  if (name == "tune") {
    const std::string self = std::filesystem::read_symlink("/proc/self/exe").string();
    arguments.insert(arguments.end(), {"--lcpbench", self, "--data", kDataFolder});
  }
  arguments.insert(arguments.end(), words.begin(), words.end());
  return RunPythonScript(name, {kReportScript, kInstalledReportScript}, arguments);
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
