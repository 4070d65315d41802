#include <filesystem>
#include <iostream>
#include <memory>

#include "benchmarks/accuracy_pass.h"
#include "benchmarks/campaign_command.h"
#include "benchmarks/commands.h"
#include "benchmarks/external_option.h"
#include "benchmarks/results.h"
#include "benchmarks/suite.h"
#include "benchmarks/timing_pass.h"
#include "benchmarks/variant_option.h"
#include "solvers/lcp/input_error.h"
#include "solvers/lcp/solver.h"

namespace lcpbench {
namespace {

struct RunArguments {
  std::string suite = "default";
  std::string output;  // "" stands for OutputOf
  std::vector<std::string> solvers;
  std::vector<std::string> families;
  std::vector<int> sizes;
  std::vector<std::uint64_t> seeds;
  std::vector<double> tiers;
  double time_limit_s = 0;
  double min_time_s = 0;
  int repetitions = 0;
  CampaignArguments campaign;
};

// The named suite with what the command line changes in it: what is asked for by name is run at every size.
Suite ChosenSuite(const RunArguments& arguments) {
  Suite suite;
  try {
    suite = FindSuite(arguments.suite);
  } catch (const InputError& error) {
    throw InputError(std::string(error.what()) + ", " + CampaignNames() + ", or a manifest's path");
  }
  if (!arguments.solvers.empty()) suite.solvers = arguments.solvers;
  if (!arguments.sizes.empty()) suite.sizes = arguments.sizes;
  if (!arguments.families.empty()) {
    suite.families = arguments.families;
    for (SizeRule& rule : suite.size_rules) rule.families.clear();
  }
  if (!arguments.seeds.empty()) {
    suite.seeds = arguments.seeds;
    for (SizeRule& rule : suite.size_rules) rule.seeds = arguments.seeds.size();
  }
  if (!arguments.tiers.empty()) {
    suite.tiers = arguments.tiers;
    for (SizeRule& rule : suite.size_rules) rule.tiers.clear();
  }
  if (arguments.time_limit_s != 0) {
    suite.time_limit_s = arguments.time_limit_s;
    suite.time_limit_per_row_s = 0;
  }
  if (arguments.min_time_s != 0) suite.min_time_s = arguments.min_time_s;
  if (arguments.repetitions != 0) suite.repetitions = arguments.repetitions;
  ValidateSuite(suite);
  return suite;
}

// One line for all of them: they have no cells.
void TellWhatIsMissing(const Suite& suite) {
  std::string missing;
  for (const std::string& key : suite.solvers) {
    if (!FindSolver(key).available) missing += (missing.empty() ? "" : ", ") + key;
  }
  if (!missing.empty()) std::cerr << "not in this build: " << missing << std::endl;
}

// Campaigns have folders of their own, so that they can be resumed.
std::string OutputOf(const RunArguments& arguments, const std::string& name) {
  return arguments.output.empty() ? "build/results/" + name : arguments.output;
}

CampaignPlan PlanOf(const RunArguments& arguments) {
  CampaignPlan plan = CampaignOf(arguments.suite);
  if (!arguments.solvers.empty()) plan.solvers = arguments.solvers;
  if (!arguments.tiers.empty()) plan.tiers = arguments.tiers;
  if (arguments.time_limit_s != 0) plan.least_s = plan.most_s = arguments.time_limit_s;
  if (arguments.min_time_s != 0) plan.min_time_s = arguments.min_time_s;
  if (arguments.repetitions != 0) plan.repetitions = arguments.repetitions;
  if (!arguments.families.empty() || !arguments.sizes.empty() || !arguments.seeds.empty()) {
    throw InputError("run: a campaign's problems are its manifest's; expected --filter to choose among them");
  }
  return plan;
}

int Run(RunArguments arguments, const std::vector<std::string>& extra_flags) {
  if (IsCampaign(arguments.suite)) {
    CampaignPlan plan = PlanOf(arguments);
    const BenchmarkFlags flags = TakeBenchmarkFlags(extra_flags, &plan, &arguments.campaign);
    return RunCampaignCommand(plan, arguments.campaign, flags, OutputOf(arguments, plan.name));
  }
  if (!arguments.campaign.tuned.empty())
    throw InputError("--tuned: expected a campaign, found suite " + arguments.suite);
  const Suite suite = ChosenSuite(arguments);
  for (const std::string& flag : extra_flags) {
    if (!flag.starts_with("--benchmark_")) throw InputError("run: unexpected argument '" + flag + "'");
  }
  const std::string output = OutputOf(arguments, "default");
  std::error_code error;
  std::filesystem::create_directories(output, error);
  if (error) throw InputError(output + ": cannot be created: " + error.message());

  TellWhatIsMissing(suite);
  const std::string started = UtcNow();
  const double start = SteadyNow();
  WriteRunFile(output, suite, started, -1);
  WritePictures(output, suite);
  const CellOutcomes outcomes = RunAccuracyPass(suite, output);
  RunTimingPass(suite, outcomes, output, extra_flags);
  WriteRunFile(output, suite, started, SteadyNow() - start);
  std::cout << "results: " << output << std::endl;
  return 0;
}

}  // namespace

void AddRunCommand(CLI::App& app, CommandRun& run) {
  auto arguments = std::make_shared<RunArguments>();
  CLI::App* command = app.add_subcommand("run", "Runs a suite: verifies, then times, and writes result files");
  command
      ->add_option("--suite", arguments->suite,
                   "default or quick; or a campaign: " + CampaignNames() + ", or a manifest's path")
      ->capture_default_str();
  command->add_option("-o,--output", arguments->output,
                      "Folder of the result files [default: build/results/default, of campaigns build/results/NAME]");
  command->add_option("--solvers", arguments->solvers, "Only these solvers")->delimiter(',');
  command->add_option("--scenes", arguments->families, "Only these scene families")->delimiter(',');
  command->add_option("--sizes", arguments->sizes, "Rows per problem")->delimiter(',');
  command->add_option("--seeds", arguments->seeds, "Seeds; the first one is timed")->delimiter(',');
  command->add_option("--tiers", arguments->tiers, "Tolerances")->delimiter(',');
  command->add_option("--time-limit", arguments->time_limit_s, "Seconds per solve");
  command->add_option("--min-time", arguments->min_time_s, "Seconds per repetition of a timing");
  command->add_option("--repetitions", arguments->repetitions, "Repetitions of a timing");
  AddCampaignOptions(*command, &arguments->campaign);
  command->allow_extras();
  command->footer(
      "Flags of Google Benchmark (--benchmark_filter=..., ...) are handed on to the timing pass; campaigns know "
      "--benchmark_filter, _repetitions, _min_time, _out (JSON) and _list_tests.");
  const auto externals = AddExternalOption(*command);
  const auto variants = AddVariantOption(*command);
  command->callback([arguments, externals, variants, command, &run] {
    run = [arguments, externals, variants, extras = command->remaining()] {
      RegisterExternals(*externals);
      RegisterVariants(*variants);
      arguments->campaign.externals = *externals;
      arguments->campaign.variants = *variants;
      return Run(*arguments, extras);
    };
  });
}

}  // namespace lcpbench
