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

struct CompareArguments {
  std::string old_campaign;
  std::string new_campaign;
  std::string output;  // "" for standard output
};

int Compare(const CompareArguments& arguments) {
  for (const std::string& folder : {arguments.old_campaign, arguments.new_campaign}) {
    if (!std::filesystem::is_directory(folder)) {
      throw InputError(folder + ": expected a campaign's folder, found none");
    }
  }
  std::vector<std::string> words = {arguments.old_campaign, arguments.new_campaign};
  if (!arguments.output.empty()) words.insert(words.end(), {"--output", arguments.output});
  return RunPythonScript("compare", {kCompareScript, kInstalledCompareScript}, words);
}

}  // namespace

void AddCompareCommand(CLI::App& app, CommandRun& run) {
  auto arguments = std::make_shared<CompareArguments>();
  CLI::App* compare = app.add_subcommand(
      "compare", "What changed between two campaigns of one plan, as Markdown; exit status 1 for a regression");
  compare->add_option("OLD", arguments->old_campaign, "A campaign's folder")->required();
  compare->add_option("NEW", arguments->new_campaign, "That of a later one")->required();
  compare->add_option("-o,--output", arguments->output, "A file instead of standard output");
  compare->callback([arguments, &run] { run = [arguments] { return Compare(*arguments); }; });
}

}  // namespace lcpbench
