#pragma once

#include <limits>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "benchmarks/campaign/append_only_file.h"
#include "benchmarks/campaign/campaign_plan.h"
#include "benchmarks/campaign/cell.h"

namespace lcpbench {

/// Problem, solver, tier and mode.
struct CellKey {
  CellKey(std::string of_problem, std::string of_solver, double of_tier, std::string of_mode);

  std::string problem;
  std::string solver;
  std::string tier;  ///< as text: equal numbers are equal whatever they were read from
  std::string mode;

  // NOLINTNEXTLINE(modernize-use-nullptr): the checker takes the comparison with 0 inside for a pointer's
  auto operator<=>(const CellKey&) const = default;
};

/// What has been run of a campaign: cells.jsonl (RESULTS.md). Every line is written before the next cell begins
/// (append_only_file.h).
class Journal {
 public:
  /// Opens or creates the file and reads which cells it has.
  /// @throws InputError where it cannot be written, or has a line that is no cell
  explicit Journal(const std::string& path);

  bool Has(const CellKey& key, int round) const;
  /// What the tiers' first round found, for the rules that depend on it.
  bool RanOutOfTime(const CellKey& key) const;
  /// Whether round 0 passed: only then do more rounds make sense.
  bool Passed(const CellKey& key) const;

  /// Whether its time is known to `width`, RoundInterval::relative_width.
  bool IsTight(const CellKey& key, double width) const;

  /// Of all its repetitions so far [s].
  double TimeSpent(const CellKey& key) const;

  /// The probe of the clock rate that one in ten so far went below; infinite before the first. The shortest of all
  /// says little: a processor may boost its clock for a moment.
  double FastProbe() const;

  /// A line per verdict of the reply, or one for what is excluded by rule.
  void Write(const ManifestEntry& problem, const PlannedCell& cell, int round, const CellReply& reply,
             const std::string& environment_hash);
  void WriteExcluded(const ManifestEntry& problem, const PlannedCell& cell, const std::vector<double>& tiers);

 private:
  void Note(const nlohmann::json& line);
  void Append(const std::vector<nlohmann::ordered_json>& lines);

  std::vector<double> probes_;  // ascending
  std::set<std::pair<CellKey, int>> done_;
  std::set<CellKey> out_of_time_;
  std::set<CellKey> passed_;
  struct Times {
    std::vector<double> round_medians;
    double spent_s = 0;
  };
  std::map<CellKey, Times> times_;
  AppendOnlyFile file_;  // last: it tells the others what it has
};

}  // namespace lcpbench
