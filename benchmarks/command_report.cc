#include <filesystem>
#include <memory>

#include "benchmarks/commands.h"
#include "benchmarks/python_script.h"
#include "build_info.h"
#include "solvers/lcp/input_error.h"

namespace lcpbench {
namespace {

struct ReportArguments {
  std::string results;
  std::string output = "build/report/index.html";
};

int Report(const ReportArguments& arguments) {
  if (!std::filesystem::is_directory(arguments.results)) {
    throw InputError(arguments.results + ": expected a folder of result files (lcpbench run writes one)");
  }
  return RunPythonScript("report", {kReportScript, kInstalledReportScript},
                         {arguments.results, "-o", arguments.output});
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
