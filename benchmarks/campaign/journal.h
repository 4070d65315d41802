#pragma once

#include <compare>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "benchmarks/campaign/campaign_plan.h"
#include "benchmarks/campaign/task_messages.h"
#include "support/append_only_file.h"

namespace lcpbench {

/// A tier as text: equal numbers are equal whatever they were read from.
std::string TierText(double tier);

/// What a line of streams.jsonl is of.
struct TaskKey {
  TaskKey(const Task& task, const std::string& size_class, double of_tier);
  explicit TaskKey(const nlohmann::json& line);

  std::string solver;
  std::string size_class;
  std::size_t first;
  std::string tier;

  // NOLINTNEXTLINE(modernize-use-nullptr): the checker takes the comparison with 0 inside for a pointer's
  auto operator<=>(const TaskKey&) const = default;
};

/// A problem's judgement within a task, or the rule by which it was not tried.
struct Judged {
  JudgeReply reply;
  std::string excluded;
};

/// What has been run of a campaign: streams.jsonl (RESULTS.md). Every line is written before the next task begins
/// (append_only_file.h).
class Journal {
 public:
  /// Opens or creates the file and reads what it has.
  /// @throws InputError where it cannot be written, or has a line of something else
  explicit Journal(const std::string& path);

  bool Has(const TaskKey& key, const std::string& kind, int pass) const;

  /// Of a task that was judged, by the place of its problems; at the tiers of its key.
  struct Judgement {
    std::size_t attempted = 0;
    std::set<std::size_t> unverified;   ///< of those that were attempted
    std::set<std::size_t> out_of_time;  ///< stopped, or killed, at the time limit
    double median_s = 0;                ///< of the observed times of verified answers; of timed passes, once there are
    double timed_s = 0;                 ///< spent in timed passes so far
  };
  /// Null where the task was not judged, or is excluded.
  const Judgement* Find(const TaskKey& key) const;

  /// The probe of the clock rate that one in ten so far went below; infinite before the first. The shortest of all
  /// says little: a processor may boost its clock for a moment.
  double FastProbe() const;

  /// A line per tier that the task is judged at. @param judged  of the problems that had their turn, in order
  void WriteJudged(const Task& task, const std::string& size_class, const std::vector<Judged>& judged,
                   const std::string& environment_hash);
  void WriteExcluded(const Task& task, const std::string& size_class, const std::string& environment_hash);
  /// @param pass   from 1
  /// @param reruns  how often it was run again because the machine disturbed it, and whether it still did
  void WriteTimed(const Task& task, const std::string& size_class, PassKind kind, int pass, std::uint32_t group,
                  const TimedReply& reply, int reruns, bool disturbed, const std::string& environment_hash);

 private:
  void Note(const nlohmann::json& line);
  void Append(const std::vector<nlohmann::ordered_json>& lines);

  std::vector<double> probes_;  // ascending
  std::set<std::tuple<TaskKey, std::string, int>> done_;
  std::map<TaskKey, Judgement> judged_;
  AppendOnlyFile file_;  // last: it tells the others what it has
};

/// "fresh", "parts" or "again".
const char* KindKey(PassKind kind);

}  // namespace lcpbench
