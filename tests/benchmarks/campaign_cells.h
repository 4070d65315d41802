#pragma once

#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace lcpbench {

inline std::vector<nlohmann::json> JsonLines(const std::filesystem::path& path) {
  std::vector<nlohmann::json> lines;
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) lines.push_back(nlohmann::json::parse(line));
  return lines;
}

/// A campaign's folder problem by problem: an object per problem, solver and tier with what streams.jsonl says of it in
/// arrays, in the order of the tasks, and its times `fresh_s` of all passes.
inline std::vector<nlohmann::json> CellsOf(const std::filesystem::path& folder) {
  using Json = nlohmann::json;
  std::map<std::string, std::vector<std::string>> problems;
  for (const Json& line : JsonLines(folder / "problems.jsonl")) problems[line["size_class"]].push_back(line["problem"]);
  std::vector<Json> cells;
  std::map<std::string, std::size_t> places;
  const auto key = [](const Json& line, const std::string& problem) {
    return problem + "|" + line["solver"].get<std::string>() + "|" + line["tier"].dump();
  };
  for (const Json& line : JsonLines(folder / "streams.jsonl")) {
    const std::vector<std::string>& names = problems.at(line["size_class"]);
    const auto first = line["first"].get<std::size_t>();
    if (line["kind"] == "judge") {
      const bool excluded = !line["excluded"].get<std::string>().empty();
      const auto count = line[excluded ? "count" : "attempted"].get<std::size_t>();
      std::map<std::size_t, Json> exceptions;
      if (!excluded) {
        for (const Json& exception : line["exceptions"]) exceptions[exception["at"].get<std::size_t>()] = exception;
      }
      for (std::size_t k = 0; k < count; ++k) {
        Json cell = {{"problem", names.at(first + k)},
                     {"solver", line["solver"]},
                     {"tier", line["tier"]},
                     {"excluded", line["excluded"]},
                     {"claim", "solved"},
                     {"passes", !excluded},
                     {"at_floor", false},
                     {"false_success", false},
                     {"reason", ""},
                     {"detail", ""},
                     {"fresh_s", Json::array()}};
        if (!excluded) {
          for (const char* field : {"rho", "backward_error", "w_error", "f_error", "iterations", "first_s",
                                    "factor_share", "allocations"}) {
            cell[field] = line[field][k];
          }
          if (exceptions.count(k) > 0) cell.update(exceptions[k]);
          if (cell["claim"] == "excluded") cell["excluded"] = cell["reason"];
        }
        places[key(line, names.at(first + k))] = cells.size();
        cells.push_back(std::move(cell));
      }
    } else if (line["kind"] == "fresh") {
      for (std::size_t k = 0; k < line["fresh_s"].size(); ++k) {
        if (line["fresh_s"][k].is_number()) {
          cells.at(places.at(key(line, names.at(first + k))))["fresh_s"].push_back(line["fresh_s"][k]);
        }
      }
    }
  }
  return cells;
}

}  // namespace lcpbench
