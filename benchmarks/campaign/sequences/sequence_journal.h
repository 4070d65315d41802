#pragma once

#include <map>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "benchmarks/campaign/journal.h"
#include "benchmarks/campaign/sequences/sequence_cell.h"
#include "benchmarks/campaign/sequences/sequence_plan.h"
#include "support/append_only_file.h"

namespace lcpbench {

/// Which passes over sequences have been run of a campaign: steps.jsonl (RESULTS.md), a line per pass and round.
class SequenceJournal {
 public:
  /// Opens or creates the file and reads which passes it has.
  /// @throws InputError where it cannot be written, or has a line that is no pass
  explicit SequenceJournal(const std::string& path);

  bool Has(const std::string& sequence, const PlannedPass& pass, int round) const;
  /// How the pass's first round ended, SequenceReply::outcome; "" where it was excluded or not run.
  std::string FirstOutcome(const std::string& sequence, const PlannedPass& pass) const;

  void Write(const SequenceEntry& sequence, const PlannedPass& pass, int round, const SequenceReply& reply,
             const std::string& environment_hash);
  /// Of round 0, by rule.
  void WriteExcluded(const SequenceEntry& sequence, const PlannedPass& pass);

 private:
  void Note(const nlohmann::json& line);
  void Append(const nlohmann::ordered_json& line);

  // Sequence, solver, tier as text, mode.
  using Key = std::tuple<std::string, std::string, std::string, std::string>;
  static Key KeyOf(const std::string& sequence, const PlannedPass& pass);

  std::set<std::pair<Key, int>> done_;
  std::map<Key, std::string> first_outcomes_;
  AppendOnlyFile file_;  // last: it tells the others what it has
};

}  // namespace lcpbench
