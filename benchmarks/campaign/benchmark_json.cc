#include "benchmarks/campaign/benchmark_json.h"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <vector>

#include "benchmarks/campaign/campaign_plan.h"
#include "support/append_only_file.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

struct Times {
  std::vector<double> fresh_s;
  std::string failure;
};

std::map<std::string, Times> TimesByName(const std::filesystem::path& folder) {
  std::map<std::string, std::vector<std::string>> problems;  // by size class
  ReadJsonLines(folder / "problems.jsonl", "a problem", [&](const nlohmann::json& line, const std::string&) {
    problems[line.at("size_class").get<std::string>()].push_back(line.at("problem").get<std::string>());
  });
  std::map<std::string, Times> cells;
  ReadJsonLines(folder / "streams.jsonl", "a pass", [&](const nlohmann::json& line, const std::string&) {
    if (!line.at("excluded").get<std::string>().empty()) return;
    const std::vector<std::string>& names = problems.at(line.at("size_class").get<std::string>());
    const auto first = line.at("first").get<std::size_t>();
    const auto cell = [&](std::size_t at) -> Times& {
      return cells[CellName(names.at(first + at), line.at("solver").get<std::string>(), line.at("tier").get<double>())];
    };
    if (line.at("kind") == "judge") {
      for (const nlohmann::json& exception : line.at("exceptions")) {
        if (exception.at("passes").get<bool>() || exception.at("claim") == "excluded") continue;
        cell(exception.at("at").get<std::size_t>()).failure =
            exception.at("claim").get<std::string>() + ": " + exception.at("reason").get<std::string>();
      }
    } else if (line.at("kind") == "fresh") {
      const nlohmann::json& times = line.at("fresh_s");
      for (std::size_t at = 0; at < times.size(); ++at) {
        if (times[at].is_number()) cell(at).fresh_s.push_back(times[at].get<double>());
      }
    }
  });
  return cells;
}

}  // namespace

void WriteBenchmarkJson(const std::string& folder, const std::string& path) {
  using Run = benchmark::BenchmarkReporter::Run;
  const auto cells = TimesByName(folder);
  std::ofstream out(path);
  if (!out) throw InputError(path + ": cannot be written");
  benchmark::JSONReporter reporter;
  reporter.SetOutputStream(&out);
  reporter.SetErrorStream(&out);
  reporter.ReportContext(benchmark::BenchmarkReporter::Context());
  std::int64_t index = 0;
  for (const auto& [name, times] : cells) {
    if (times.fresh_s.empty() && times.failure.empty()) continue;  // verified, and not timed
    std::vector<Run> runs(std::max<std::size_t>(times.fresh_s.size(), 1));
    for (std::size_t k = 0; k < runs.size(); ++k) {
      Run& run = runs[k];
      run.run_name.function_name = name;
      run.family_index = index;
      run.per_family_instance_index = 0;
      run.repetitions = static_cast<std::int64_t>(runs.size());
      run.repetition_index = static_cast<std::int64_t>(k);
      run.iterations = 1;
      run.error_occurred = times.fresh_s.empty();
      run.error_message = run.error_occurred ? times.failure : "";
      run.real_accumulated_time = run.cpu_accumulated_time = run.error_occurred ? 0 : times.fresh_s[k];
      run.statistics = nullptr;
      run.time_unit = benchmark::kNanosecond;
    }
    ++index;
    reporter.ReportRuns(runs);
  }
  reporter.Finalize();
  out.close();
  if (!out) throw InputError(path + ": cannot be written");
}

}  // namespace lcpbench
