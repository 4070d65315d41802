#include "benchmarks/campaign/journal.h"

#include <algorithm>
#include <cstdio>
#include <numeric>
#include <utility>

#include "benchmarks/campaign/median_interval.h"

namespace lcpbench {
namespace {

using Json = nlohmann::ordered_json;

Json CellMembers(const std::string& problem, const PlannedCell& cell, double tier, int round) {
  Json line;
  line["problem"] = problem;
  line["solver"] = cell.solver;
  line["tier"] = tier;
  line["round"] = round;
  line["mode"] = cell.mode;
  return line;
}

Json OrNull(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }

// The rounded tier, so that a number read back is the same key.
std::string TierText(double tier) {
  char text[16];
  std::snprintf(text, sizeof text, "%.3e", tier);
  return text;
}

}  // namespace

CellKey::CellKey(std::string of_problem, std::string of_solver, double of_tier, std::string of_mode)
    : problem(std::move(of_problem)), solver(std::move(of_solver)), tier(TierText(of_tier)), mode(std::move(of_mode)) {}

Journal::Journal(const std::string& path)
    : file_(path, "a cell of a campaign", [this](const nlohmann::json& line) { Note(line); }) {}

bool Journal::Has(const CellKey& key, int round) const { return done_.count({key, round}) > 0; }
bool Journal::RanOutOfTime(const CellKey& key) const { return out_of_time_.count(key) > 0; }
bool Journal::Passed(const CellKey& key) const { return passed_.count(key) > 0; }

bool Journal::IsTight(const CellKey& key, double width) const {
  const auto times = times_.find(key);
  return times != times_.end() && IntervalOfRounds(times->second.round_medians).relative_width() <= width;
}

double Journal::FastProbe() const {
  constexpr std::size_t kOneIn = 10;
  return probes_.empty() ? std::numeric_limits<double>::infinity() : probes_[probes_.size() / kOneIn];
}

double Journal::TimeSpent(const CellKey& key) const {
  const auto times = times_.find(key);
  return times == times_.end() ? 0 : times->second.spent_s;
}

void Journal::Note(const nlohmann::json& line) {
  const CellKey key(line.at("problem").get<std::string>(), line.at("solver").get<std::string>(),
                    line.at("tier").get<double>(), line.at("mode").get<std::string>());
  const int round = line.at("round").get<int>();
  done_.insert({key, round});
  if (!line.at("excluded").get<std::string>().empty()) return;
  if (line.at("passes").get<bool>()) {
    const auto solve_s = line.at("solve_s").get<std::vector<double>>();
    Times& times = times_[key];
    times.round_medians.push_back(MedianOf(solve_s));
    times.spent_s += std::accumulate(solve_s.begin(), solve_s.end(), 0.0);
  }
  const nlohmann::json& disturbance = line.at("disturbance");
  if (!disturbance.is_null()) {
    const auto probe_s = disturbance.at("probe_s").get<double>();
    probes_.insert(std::upper_bound(probes_.begin(), probes_.end(), probe_s), probe_s);
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
    if (Has({problem.id, cell.solver, verdict.tier, cell.mode}, round)) continue;
    Json line = CellMembers(problem.id, cell, verdict.tier, round);
    line["excluded"] = "";
    line["claim"] = reply.claim;
    line["passes"] = verdict.passes;
    line["best_tier"] = verdict.best_tier ? Json(*verdict.best_tier) : Json(nullptr);
    line["at_floor"] = verdict.at_floor;
    line["false_success"] = verdict.false_success;
    line["false_infeasible"] = verdict.false_infeasible;
    line["proved_infeasible"] = verdict.proved_infeasible;
    line["iterations"] = reply.iterations;
    line["reason"] = verdict.reason;
    line["detail"] = reply.detail;
    line["metrics"] = reply.metrics;
    line["time_limit_s"] = cell.time_limit_s;
    line["setup_s"] = reply.setup_s;
    line["first_s"] = OrNull(reply.first_s);
    line["solve_s"] = reply.solve_s;
    line["convert_s"] = reply.convert_s.empty() ? Json(nullptr) : Json(reply.convert_s);
    line["factor_s"] = OrNull(reply.factor_s);
    line["factor_of_s"] = OrNull(reply.factor_of_s);
    line["peak_bytes"] = OrNull(reply.peak_bytes);
    line["allocations"] = nullptr;
    if (reply.allocations) {
      line["allocations"] = {{"first", reply.allocations->first},
                             {"first_bytes", reply.allocations->first_bytes},
                             {"later", reply.allocations->later ? Json(*reply.allocations->later) : Json(nullptr)}};
    }
    line["counters"] = reply.counters;
    line["disturbance"] = nullptr;
    if (reply.disturbance) {
      line["disturbance"] = {{"probe_s", reply.disturbance->probe_s},
                             {"cpu_share", reply.disturbance->cpu_share},
                             {"switches", reply.disturbance->switches},
                             {"reruns", reply.reruns},
                             {"disturbed", reply.disturbed}};
    }
    line["environment"] = environment_hash;
    lines.push_back(std::move(line));
  }
  Append(lines);
}

void Journal::WriteExcluded(const ManifestEntry& problem, const PlannedCell& cell, const std::vector<double>& tiers) {
  std::vector<Json> lines;
  for (const double tier : tiers) {
    if (Has({problem.id, cell.solver, tier, cell.mode}, 0)) continue;
    lines.push_back(CellMembers(problem.id, cell, tier, 0));
    lines.back()["excluded"] = cell.excluded;
  }
  Append(lines);
}

}  // namespace lcpbench
