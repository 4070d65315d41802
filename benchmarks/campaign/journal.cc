#include "benchmarks/campaign/journal.h"

#include <cstdio>

#include "benchmarks/campaign/median_interval.h"

namespace lcpbench {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kMode = "cold";

Json CellMembers(const std::string& problem, const std::string& solver, double tier, int round) {
  Json line;
  line["problem"] = problem;
  line["solver"] = solver;
  line["tier"] = tier;
  line["round"] = round;
  line["mode"] = kMode;
  return line;
}

}  // namespace

Journal::Key Journal::KeyOf(const std::string& problem, const std::string& solver, double tier) {
  char text[16];
  std::snprintf(text, sizeof text, "%.3e", tier);
  return {problem, solver, text};
}

Journal::Journal(const std::string& path)
    : file_(path, "a cell of a campaign", [this](const nlohmann::json& line) { Note(line); }) {}

bool Journal::Has(const std::string& problem, const std::string& solver, double tier, int round) const {
  return done_.count({KeyOf(problem, solver, tier), round}) > 0;
}

bool Journal::RanOutOfTime(const std::string& problem, const std::string& solver, double tier) const {
  return out_of_time_.count(KeyOf(problem, solver, tier)) > 0;
}

bool Journal::Passed(const std::string& problem, const std::string& solver, double tier) const {
  return passed_.count(KeyOf(problem, solver, tier)) > 0;
}

bool Journal::IsTight(const std::string& problem, const std::string& solver, double tier, double width) const {
  const auto times = times_.find(KeyOf(problem, solver, tier));
  return times != times_.end() && IntervalOfMedian(times->second).relative_width() <= width;
}

void Journal::Note(const nlohmann::json& line) {
  const Key key =
      KeyOf(line.at("problem").get<std::string>(), line.at("solver").get<std::string>(), line.at("tier").get<double>());
  const int round = line.at("round").get<int>();
  done_.insert({key, round});
  if (!line.at("excluded").get<std::string>().empty()) return;
  if (line.at("passes").get<bool>()) {
    std::vector<double>& times = times_[key];
    for (const double time : line.at("solve_s")) times.push_back(time);
  }
  if (round > 0) return;
  const auto claim = line.at("claim").get<std::string>();
  if (claim == "time_limit" || claim == "killed") out_of_time_.insert(key);
  if (line.at("passes").get<bool>()) passed_.insert(key);
}

void Journal::Append(const std::vector<Json>& lines) {
  file_.Append(lines);
  for (const Json& line : lines) Note(nlohmann::json(line));
}

void Journal::Write(const ManifestEntry& problem, const PlannedCell& cell, int round, const CellReply& reply,
                    const std::string& environment_hash) {
  std::vector<CellVerdict> verdicts = reply.verdicts;
  if (verdicts.empty()) {
    CellVerdict none;
    none.tier = cell.tier;
    none.reason = reply.detail;
    verdicts.push_back(none);
  }
  std::vector<Json> lines;
  for (const CellVerdict& verdict : verdicts) {
    // Of a direct method's lines some may have been written before the campaign was killed.
    if (Has(problem.id, cell.solver, verdict.tier, round)) continue;
    Json line = CellMembers(problem.id, cell.solver, verdict.tier, round);
    line["excluded"] = "";
    line["claim"] = reply.claim;
    line["passes"] = verdict.passes;
    line["best_tier"] = verdict.best_tier ? Json(*verdict.best_tier) : Json(nullptr);
    line["at_floor"] = verdict.at_floor;
    line["false_success"] = verdict.false_success;
    line["false_infeasible"] = verdict.false_infeasible;
    line["iterations"] = reply.iterations;
    line["reason"] = verdict.reason;
    line["detail"] = reply.detail;
    line["metrics"] = reply.metrics;
    line["time_limit_s"] = cell.time_limit_s;
    line["setup_s"] = reply.setup_s;
    line["solve_s"] = reply.solve_s;
    line["convert_s"] = reply.convert_s.empty() ? Json(nullptr) : Json(reply.convert_s);
    line["peak_bytes"] = reply.peak_bytes ? Json(*reply.peak_bytes) : Json(nullptr);
    line["environment"] = environment_hash;
    lines.push_back(std::move(line));
  }
  Append(lines);
}

void Journal::WriteExcluded(const ManifestEntry& problem, const PlannedCell& cell, const std::vector<double>& tiers) {
  std::vector<Json> lines;
  for (const double tier : tiers) {
    if (Has(problem.id, cell.solver, tier, 0)) continue;
    lines.push_back(CellMembers(problem.id, cell.solver, tier, 0));
    lines.back()["excluded"] = cell.excluded;
  }
  Append(lines);
}

}  // namespace lcpbench
