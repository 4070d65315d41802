#include <iostream>
#include <memory>

#include "benchmarks/collection/gzip_file.h"
#include "benchmarks/command/commands.h"
#include "model/records/replay.h"
#include "model/records/replay_record.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

struct ReplayArguments {
  std::vector<std::string> files;
  bool json = false;
};

ReplayResult ReplayLine(const ReplayRecord& record, const std::string& where) {
  try {
    return Replay(record);
  } catch (const InputError& error) {
    throw InputError(where + ": " + error.what());
  }
}

int RunReplay(const ReplayArguments& arguments) {
  constexpr int kDisagreement = 1;
  ReplaySummary summary;
  const int status = ForEachLine(arguments.files, [&](const std::string& line, const std::string& where) {
    const ReplayRecord record = ParseReplayRecord(line, where);
    summary.Add(record, ReplayLine(record, where), where);
  });
  if (arguments.json) {
    std::cout << summary.Json() << std::endl;
  } else if (summary.records() > 0) {
    std::cout << summary.Table() << std::flush;
  }
  if (status != 0) return status;
  return summary.AllAgree() ? 0 : kDisagreement;
}

}  // namespace

void AddReplayCommand(CLI::App& app, CommandRun& run) {
  auto arguments = std::make_shared<ReplayArguments>();
  CLI::App* replay = app.add_subcommand(
      "replay",
      "Assembles contact problems recorded from the paper's software and compares A and b (status 1: differ)");
  replay->add_option("FILE", arguments->files, "JSON lines, plain or gzip; - for standard input")->required();
  replay->add_flag("--json", arguments->json, "One JSON object instead of tables");
  replay->callback([arguments, &run] { run = [arguments] { return RunReplay(*arguments); }; });
}

}  // namespace lcpbench
