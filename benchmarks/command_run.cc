#include <memory>

#include "benchmarks/campaign_command.h"
#include "benchmarks/commands.h"
#include "benchmarks/external_option.h"
#include "benchmarks/variant_option.h"

namespace lcpbench {

void AddRunCommand(CLI::App& app, CommandRun& run) {
  auto arguments = std::make_shared<CampaignArguments>();
  CLI::App* command = app.add_subcommand(
      "run", "Runs a campaign: solves and judges every cell, and times what passed, in rounds, into a folder");
  command->add_option("--suite", arguments->suite, CampaignNames() + ", or a manifest's path")->capture_default_str();
  command->add_option("-o,--output", arguments->output, "The campaign's folder [default: build/results/NAME]");
  command->add_flag("--resume", arguments->resume, "Go on with the campaign that the folder has");
  command->add_option("--solvers", arguments->solvers, "Only these solvers")->delimiter(',');
  command->add_option("--tiers", arguments->tiers, "Tolerances [default: the campaign's]")->delimiter(',');
  command
      ->add_option("--filter,--benchmark_filter", arguments->filter,
                   "Of the campaign's cells solve/PROBLEM/SOLVER/TIER and steps/SEQUENCE/SOLVER/TIER/MODE only those "
                   "that match this regular expression")
      ->take_last();
  command
      ->add_option("--modes", arguments->modes,
                   "cold (with warm caches), cold-cache (caches emptied before every solve) [default: cold]")
      ->delimiter(',');
  command->add_option("--time-limit", arguments->time_limit_s, "Seconds per solve, whatever its size");
  command->add_option("--rounds", arguments->rounds, "How often every cell is visited");
  command->add_option("--most-rounds", arguments->most_rounds,
                      "How often at most, while its time is uncertain by more than 5 % [default: a third more]");
  command
      ->add_option("--repetitions,--benchmark_repetitions", arguments->repetitions,
                   "Repetitions of a timing in a round, at most")
      ->take_last();
  command->add_option("--min-time,--benchmark_min_time", arguments->min_time_s, "Seconds per repetition of a timing")
      ->take_last();
  command->add_option("--cpu", arguments->cpu, "The processor that solves are kept on");
  command->add_option("--shard", arguments->shard, "k/N, the k-th of N parts; see lcpbench merge")
      ->capture_default_str();
  command->add_option("--tuned", arguments->tuned,
                      "Adds KEY-tuned for every solver that `lcpbench tune` chose settings for, data/tuned.json");
  command->add_flag("--benchmark_list_tests", arguments->list, "Prints the cells' names, and runs none");
  command->add_option("--benchmark_out", arguments->benchmark_json, "File for the times in Google Benchmark's JSON");
  // The only one; taken so that calls of Google Benchmark's tools are.
  command->add_option("--benchmark_out_format")->check(CLI::IsMember({"json"}))->group("");
  const auto externals = AddExternalOption(*command);
  const auto variants = AddVariantOption(*command);
  command->callback([arguments, externals, variants, &run] {
    run = [arguments, externals, variants] {
      RegisterExternals(*externals);
      RegisterVariants(*variants);
      arguments->externals = *externals;
      arguments->variants = *variants;
      return RunCampaignCommand(*arguments);
    };
  });
}

}  // namespace lcpbench
