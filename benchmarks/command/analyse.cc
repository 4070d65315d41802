#include <filesystem>
#include <memory>
#include <string>

#include "benchmarks/command/commands.h"
#include "build_info.h"
#include "support/input_error.h"
#include "support/python_script.h"

namespace lcpbench {
namespace {

int Analyse(const std::string& campaign) {
  if (!std::filesystem::is_directory(campaign)) {
    throw InputError(campaign + ": expected a campaign's folder, found none");
  }
  return RunPythonScript("analyse", {kAnalyseScript, kInstalledAnalyseScript}, {campaign});
}

}  // namespace

void AddAnalyseCommand(CLI::App& app, CommandRun& run) {
  auto campaign = std::make_shared<std::string>();
  CLI::App* analyse = app.add_subcommand("analyse", "Writes the statistics of a campaign's folder as CSV tables");
  analyse->add_option("DIR", *campaign, "The campaign's folder; the tables go into DIR/analysis")->required();
  analyse->callback([campaign, &run] { run = [campaign] { return Analyse(*campaign); }; });
}

}  // namespace lcpbench
