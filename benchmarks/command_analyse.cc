#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "benchmarks/commands.h"
#include "benchmarks/python_script.h"
#include "build_info.h"
#include "solvers/lcp/input_error.h"

namespace lcpbench {
namespace {

int Analyse(const std::string& campaign, bool repetitions) {
  if (!std::filesystem::is_directory(campaign)) {
    throw InputError(campaign + ": expected a campaign's folder, found none");
  }
  std::vector<std::string> arguments = {campaign};
  if (repetitions) arguments.emplace_back("--repetitions");
  return RunPythonScript("analyse", {kAnalyseScript, kInstalledAnalyseScript}, arguments);
}

}  // namespace

void AddAnalyseCommand(CLI::App& app, CommandRun& run) {
  auto campaign = std::make_shared<std::string>();
  CLI::App* analyse = app.add_subcommand("analyse", "Writes the statistics of a campaign's folder as CSV tables");
  analyse->add_option("DIR", *campaign, "The campaign's folder; the tables go into DIR/analysis")->required();
  auto repetitions = std::make_shared<bool>(false);
  analyse->add_flag("--repetitions", *repetitions, "Also write every repetition as a row, repetitions.csv.gz");
  analyse->callback(
      [campaign, repetitions, &run] { run = [campaign, repetitions] { return Analyse(*campaign, *repetitions); }; });
}

}  // namespace lcpbench
