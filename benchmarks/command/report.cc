#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "benchmarks/command/commands.h"
#include "build_info.h"
#include "support/input_error.h"
#include "support/python_script.h"

namespace lcpbench {
namespace {

struct ReportArguments {
  std::vector<std::string> campaigns;
  std::string output = "build/report/index.html";
  std::string motion;
  std::string precision;
  std::string pictures;
  std::string previous;
};

// The file, or what report/archive.py made of it.
void RequireFile(const std::string& folder, const std::string& file, const char* expected) {
  const std::filesystem::path path = std::filesystem::path(folder) / file;
  if (!std::filesystem::is_regular_file(path) && !std::filesystem::is_regular_file(path.string() + ".xz")) {
    throw InputError(folder + ": expected " + expected + ", found no " + file);
  }
}

int Report(const ReportArguments& arguments) {
  for (const std::string& campaign : arguments.campaigns) {
    RequireFile(campaign, "campaign.json", "a campaign's folder (lcpbench run writes one)");
  }
  std::vector<std::string> words = arguments.campaigns;
  words.insert(words.end(), {"-o", arguments.output});
  if (!arguments.motion.empty()) {
    RequireFile(arguments.motion, "motion.csv", "a folder that lcpbench motion wrote");
    words.insert(words.end(), {"--motion", arguments.motion});
  }
  if (!arguments.precision.empty()) {
    RequireFile(arguments.precision, "campaign.json", "a campaign's folder (lcpbench run --suite precision)");
    words.insert(words.end(), {"--precision", arguments.precision});
  }
  if (!arguments.pictures.empty()) words.insert(words.end(), {"--pictures", arguments.pictures});
  if (!arguments.previous.empty()) {
    RequireFile(arguments.previous, "campaign.json", "a campaign's folder (an earlier run of the first one)");
    words.insert(words.end(), {"--previous", arguments.previous});
  }
  return RunPythonScript("report", {kReportScript, kInstalledReportScript}, words);
}

}  // namespace

void AddReportCommand(CLI::App& app, CommandRun& run) {
  auto arguments = std::make_shared<ReportArguments>();
  CLI::App* report =
      app.add_subcommand("report", "Makes a report of campaigns: an interactive page, figures, tables, a summary");
  report->add_option("FOLDER", arguments->campaigns, "Written by lcpbench run")->required();
  report->add_option("-o,--output", arguments->output, "The page")->capture_default_str();
  report->add_option("--motion", arguments->motion, "Written by lcpbench motion: how solvers drive scenes");
  report->add_option("--precision", arguments->precision, "Written by lcpbench run --suite precision");
  report->add_option(
      "--pictures", arguments->pictures,
      "Pictures of the scene families, as make pictures draws them, and what lcpbench list scenes prints");
  report->add_option("--previous", arguments->previous,
                     "An earlier run of the first campaign: summary.md tells what became slower, faster or wrong");
  report->callback([arguments, &run] { run = [arguments] { return Report(*arguments); }; });
}

}  // namespace lcpbench
