#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/benchmarks/command_fixture.h"

namespace lcpbench {

/// A campaign's folder problem by problem: an object per problem, solver and tier with what streams.jsonl says of it in
/// arrays, in the order of the tasks, and its times `fresh_s` of all passes.
inline std::vector<nlohmann::json> CellsOf(const std::filesystem::path& folder) {
  using Json = nlohmann::json;
  std::map<std::string, std::vector<std::string>> problems;
  for (const Json& line : JsonLines(folder / "problems.jsonl")) problems[line["size_class"]].push_back(line["problem"]);
  std::vector<Json> cells;
  std::map<std::string, std::size_t> places;
  for (const Json& line : JsonLines(folder / "streams.jsonl")) {
    const auto place = [&](std::size_t k) -> std::size_t& {
      const std::string problem = problems.at(line["size_class"]).at(line["first"].get<std::size_t>() + k);
      return places[problem + "|" + line["solver"].get<std::string>() + "|" + line["tier"].dump()];
    };
    if (line["kind"] == "fresh") {
      for (std::size_t k = 0; k < line["fresh_s"].size(); ++k) {
        if (line["fresh_s"][k].is_number()) cells.at(place(k))["fresh_s"].push_back(line["fresh_s"][k]);
      }
    }
    if (line["kind"] != "judge") continue;
    const bool excluded = line["excluded"] != "";
    for (std::size_t k = 0; k < line[excluded ? "count" : "attempted"]; ++k) {
      Json cell = {{"problem", problems.at(line["size_class"]).at(line["first"].get<std::size_t>() + k)},
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
      for (const auto& [field, values] : line.items()) {
        if (values.is_array() && field != "exceptions") cell[field] = values[k];
      }
      for (const Json& exception : line.value("exceptions", Json::array())) {
        if (exception["at"] == k) cell.update(exception);
      }
      if (cell["claim"] == "excluded") cell["excluded"] = cell["reason"];
      place(k) = cells.size();
      cells.push_back(std::move(cell));
    }
  }
  return cells;
}

}  // namespace lcpbench
