#include <memory>

#include "benchmarks/command/campaign_command.h"
#include "benchmarks/command/commands.h"
#include "benchmarks/command/external_option.h"
#include "benchmarks/command/variant_option.h"
#include "solvers/registry.h"

namespace lcpbench {

void AddRunCommand(CLI::App& app, CommandRun& run) {
  auto arguments = std::make_shared<CampaignArguments>();
  CLI::App* command = app.add_subcommand(
      "run", "Runs a campaign: solves and judges every problem, and times what passed, fresh, into a folder");
  command->add_option("--suite", arguments->suite, CampaignNames() + ", or a manifest's path")->capture_default_str();
  command->add_option("-o,--output", arguments->output, "The campaign's folder [default: build/results/NAME]");
  command->add_flag("--resume", arguments->resume, "Go on with the campaign that the folder has");
  command->add_option("--solvers", arguments->solvers, "Only these solvers")->delimiter(',');
  command->add_option("--tiers", arguments->tiers, "Tolerances [default: the campaign's]")->delimiter(',');
  command
      ->add_option("--filter,--benchmark_filter", arguments->filter,
                   "Of the campaign's problems solve/PROBLEM/ and passes steps/SEQUENCE/SOLVER/TIER/MODE only those "
                   "that match this regular expression")
      ->take_last();
  command->add_option("--time-limit", arguments->time_limit_s, "Seconds per solve, whatever its size");
  command
      ->add_option("--passes,--benchmark_repetitions", arguments->passes,
                   "Timed passes over every stream of problems, at most [default: the campaign's]")
      ->take_last();
  command->add_option("--task-budget", arguments->task_budget_s,
                      "Seconds that a solver has for judging a size class at a tier, and as many for timing it");
  command->add_option("--most-rows", arguments->most_rows, "No larger problems");
  command->add_flag("--ablations", arguments->ablations,
                    "Adds our solvers without their own check, and peers with one: for the ablation table");
  command->add_flag("--no-fills", arguments->no_fills, "Only the manifests' own problems, without further seeds");
  command->add_option("--cpu", arguments->cpu, "The processor that solves are kept on");
  command->add_option("--shard", arguments->shard, "k/N, the k-th of N parts; see lcpbench merge")
      ->capture_default_str();
  command->add_option(
      "--tuned", arguments->tuned,
      "Adds KEY-tuned for every solver that `lcpbench tune` chose settings for [default of core and standard: "
      "data/tuned.json]");
  command->add_flag("--benchmark_list_tests", arguments->list,
                    "Prints the names of all that would be solved, and solves nothing");
  command->add_option("--benchmark_out", arguments->benchmark_json, "File for the times in Google Benchmark's JSON");
  // The only one; taken so that calls of Google Benchmark's tools are.
  command->add_option("--benchmark_out_format")->check(CLI::IsMember({"json"}))->group("");
  const auto externals = AddExternalOption(*command);
  const auto variants = AddVariantOption(*command);
  command->callback([arguments, externals, variants, &run] {
    run = [arguments, externals, variants] {
      RegisterExternals(*externals);
      RegisterVariants(*variants);
      if (arguments->ablations) RegisterAblations();
      arguments->externals = *externals;
      arguments->variants = *variants;
      return RunCampaignCommand(*arguments);
    };
  });
}

}  // namespace lcpbench
