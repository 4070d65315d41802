#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <memory>

#include "benchmarks/commands.h"
#include "build_info.h"
#include "solvers/lcp/input_error.h"

namespace lcpbench {
namespace {

struct ReportArguments {
  std::string results;
  std::string output = "build/report/index.html";
};

// Debian's pandas, matplotlib and Jinja2 belong to Debian's interpreter, which need not be the first on PATH.
std::string Interpreter() {
  if (const char* chosen = std::getenv("LCPBENCH_PYTHON")) return chosen;
  return "/usr/bin/python3";
}

std::string ReportScript() {
  for (const char* path : {kReportScript, kInstalledReportScript}) {
    if (std::filesystem::exists(path)) return path;
  }
  throw InputError(std::string("report: the generator is neither at ") + kReportScript + " nor at " +
                   kInstalledReportScript);
}

int Report(const ReportArguments& arguments) {
  if (!std::filesystem::is_directory(arguments.results)) {
    throw InputError(arguments.results + ": expected a folder of result files (lcpbench run writes one)");
  }
  std::string interpreter = Interpreter();
  std::string script = ReportScript();
  std::string results = arguments.results;
  std::string flag = "-o";
  std::string output = arguments.output;
  char* const argv[] = {interpreter.data(), script.data(), results.data(), flag.data(), output.data(), nullptr};
  const pid_t child = fork();
  if (child == 0) {
    execv(argv[0], argv);
    _exit(127);
  }
  int status = 0;
  if (child < 0 || waitpid(child, &status, 0) != child) throw InputError("report: cannot start " + interpreter);
  if (!WIFEXITED(status) || WEXITSTATUS(status) == 127) {
    throw InputError("report: cannot run " + interpreter + " (set LCPBENCH_PYTHON to a Python 3 interpreter)");
  }
  return WEXITSTATUS(status);
}

}  // namespace

void AddReportCommand(CLI::App& app, CommandRun& run) {
  auto arguments = std::make_shared<ReportArguments>();
  CLI::App* report = app.add_subcommand("report", "Makes one self-contained HTML page of a folder of result files");
  report->add_option("RESULTS", arguments->results, "Folder written by lcpbench run")->required();
  report->add_option("-o,--output", arguments->output, "The page")->capture_default_str();
  report->callback([arguments, &run] { run = [arguments] { return Report(*arguments); }; });
}

}  // namespace lcpbench
