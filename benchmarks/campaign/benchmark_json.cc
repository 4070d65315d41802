#include "benchmarks/campaign/benchmark_json.h"

#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <vector>

#include "benchmarks/campaign/campaign_file.h"
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
  using Json = nlohmann::ordered_json;
  Json benchmarks = Json::array();
  for (const auto& [name, times] : TimesByName(folder)) {
    const auto add = [&, &of = name](std::size_t repetitions, double seconds) -> Json& {
      const double nanoseconds = 1e9 * seconds;
      benchmarks.push_back({{"name", of},
                            {"run_name", of},
                            {"run_type", "iteration"},
                            {"repetitions", repetitions},
                            {"iterations", 1},
                            {"real_time", nanoseconds},
                            {"cpu_time", nanoseconds},
                            {"time_unit", "ns"}});
      return benchmarks.back();
    };
    for (std::size_t k = 0; k < times.fresh_s.size(); ++k) {
      add(times.fresh_s.size(), times.fresh_s[k])["repetition_index"] = k;
    }
    if (!times.fresh_s.empty() || times.failure.empty()) continue;  // without either: verified, and not timed
    add(1, 0).update({{"error_occurred", true}, {"error_message", times.failure}});
  }
  const Json campaign = ReadCampaignFile((std::filesystem::path(folder) / "campaign.json").string());
  std::ofstream out(path);
  out << Json{{"context", campaign.at("environment")}, {"benchmarks", benchmarks}}.dump(2) << '\n';
  out.close();
  if (!out) throw InputError(path + ": cannot be written");
}

}  // namespace lcpbench
