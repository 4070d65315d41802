#pragma once

#include <map>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "benchmarks/campaign/append_only_file.h"
#include "benchmarks/campaign/campaign_plan.h"
#include "benchmarks/campaign/cell.h"

namespace lcpbench {

/// What has been run of a campaign: cells.jsonl (RESULTS.md). Every line is written before the next cell begins
/// (append_only_file.h).
class Journal {
 public:
  /// Opens or creates the file and reads which cells it has.
  /// @throws InputError where it cannot be written, or has a line that is no cell
  explicit Journal(const std::string& path);

  bool Has(const std::string& problem, const std::string& solver, double tier, int round) const;
  /// What the tiers' first round found, for the rules that depend on it.
  bool RanOutOfTime(const std::string& problem, const std::string& solver, double tier) const;
  /// Whether round 0 passed: only then do more rounds make sense.
  bool Passed(const std::string& problem, const std::string& solver, double tier) const;

  /// Whether the median of all times so far is known to `width`, MedianInterval::relative_width.
  bool IsTight(const std::string& problem, const std::string& solver, double tier, double width) const;

  /// A line per verdict of the reply, or one for what is excluded by rule.
  void Write(const ManifestEntry& problem, const PlannedCell& cell, int round, const CellReply& reply,
             const std::string& environment_hash);
  void WriteExcluded(const ManifestEntry& problem, const PlannedCell& cell, const std::vector<double>& tiers);

 private:
  using Key = std::tuple<std::string, std::string, std::string>;  // problem, solver, tier
  static Key KeyOf(const std::string& problem, const std::string& solver, double tier);
  void Note(const nlohmann::json& line);
  void Append(const std::vector<nlohmann::ordered_json>& lines);

  std::set<std::pair<Key, int>> done_;
  std::set<Key> out_of_time_;
  std::set<Key> passed_;
  std::map<Key, std::vector<double>> times_;
  AppendOnlyFile file_;  // last: it tells the others what it has
};

}  // namespace lcpbench
