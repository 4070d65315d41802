#include <iostream>

#include "benchmarks/collection/problem_formats.h"
#include "benchmarks/command/commands.h"
#include "model/records/records.h"
#include "model/records/replay.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

struct Assemble {
  std::vector<std::string> files;

  void Declare(CLI::App& app) { app.add_option("FILE", files, "JSON lines; - for standard input")->required(); }

  int Run() const {
    return ForEachLine(files, [](const std::string& line, const std::string& where) {
      std::cout << AssembleRecord(line, where) << std::endl;
    });
  }
};

ReplayResult ReplayLine(const ReplayRecord& record, const std::string& where) {
  try {
    return Replay(record);
  } catch (const InputError& error) {
    throw InputError(where + ": " + error.what());
  }
}

struct ReplayRecords {
  std::vector<std::string> files;
  bool json = false;

  void Declare(CLI::App& app) {
    app.add_option("FILE", files, "JSON lines, plain or gzip; - for standard input")->required();
    app.add_flag("--json", json, "One JSON object instead of tables");
  }

  int Run() const {
    constexpr int kDisagreement = 1;
    ReplaySummary summary;
    const int status = ForEachLine(files, [&](const std::string& line, const std::string& where) {
      const ReplayRecord record = ParseReplayRecord(line, where);
      summary.Add(record, ReplayLine(record, where), where);
    });
    if (json) {
      std::cout << summary.Json() << std::endl;
    } else if (summary.records() > 0) {
      std::cout << summary.Table() << std::flush;
    }
    return status != 0 || summary.AllAgree() ? status : kDisagreement;
  }
};

}  // namespace

void AddRecordCommands(CLI::App& app, CommandRun& run) {
  AddCommand<Assemble>(app, run, "assemble",
                       "Assembles J, gamma, A and b of contact records (JSON lines in, JSON lines out)");
  AddCommand<ReplayRecords>(
      app, run, "replay",
      "Assembles contact problems recorded from the paper's software and compares A and b (status 1: differ)");
}

}  // namespace lcpbench
