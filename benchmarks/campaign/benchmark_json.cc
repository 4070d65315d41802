#include "benchmarks/campaign/benchmark_json.h"

#include <benchmark/benchmark.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <vector>

#include "benchmarks/campaign/campaign_plan.h"
#include "solvers/lcp/input_error.h"

namespace lcpbench {
namespace {

struct Times {
  std::vector<double> solve_s;
  std::string failure;
};

std::map<std::string, Times> TimesByName(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw InputError(path + ": cannot be opened for reading");
  std::map<std::string, Times> cells;
  std::string line;
  while (std::getline(file, line) && !file.eof()) {
    const nlohmann::json cell = nlohmann::json::parse(line);
    if (!cell.at("excluded").get<std::string>().empty()) continue;
    Times& times = cells[CellName(cell.at("problem").get<std::string>(), cell.at("solver").get<std::string>(),
                                  cell.at("tier").get<double>(), cell.at("mode").get<std::string>())];
    if (cell.at("passes").get<bool>()) {
      for (const double time : cell.at("solve_s")) times.solve_s.push_back(time);
    } else if (times.failure.empty()) {
      times.failure = cell.at("claim").get<std::string>() + ": " + cell.at("reason").get<std::string>();
    }
  }
  return cells;
}

}  // namespace

void WriteBenchmarkJson(const std::string& folder, const std::string& path) {
  using Run = benchmark::BenchmarkReporter::Run;
  const auto cells = TimesByName((std::filesystem::path(folder) / "cells.jsonl").string());
  std::ofstream out(path);
  if (!out) throw InputError(path + ": cannot be written");
  benchmark::JSONReporter reporter;
  reporter.SetOutputStream(&out);
  reporter.SetErrorStream(&out);
  reporter.ReportContext(benchmark::BenchmarkReporter::Context());
  std::int64_t index = 0;
  for (const auto& [name, times] : cells) {
    Run run;
    run.run_name.function_name = name;
    run.family_index = index++;
    run.per_family_instance_index = 0;
    run.statistics = nullptr;
    run.time_unit = benchmark::kNanosecond;
    run.iterations = 1;
    run.repetitions = static_cast<std::int64_t>(times.solve_s.size());
    std::vector<Run> runs;
    for (const double time : times.solve_s) {
      run.repetition_index = static_cast<std::int64_t>(runs.size());
      run.real_accumulated_time = time;
      run.cpu_accumulated_time = time;
      runs.push_back(run);
    }
    if (runs.empty()) {
      run.repetition_index = 0;
      run.repetitions = 1;
      run.error_occurred = true;
      run.error_message = times.failure;
      runs.push_back(run);
    }
    reporter.ReportRuns(runs);
  }
  reporter.Finalize();
  out.close();
  if (!out) throw InputError(path + ": cannot be written");
}

}  // namespace lcpbench
