#pragma once

#include <compare>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "benchmarks/campaign/campaign_plan.h"
#include "benchmarks/campaign/messages.h"
#include "support/append_only_file.h"

namespace lcpbench {

/// What a line of streams.jsonl or steps.jsonl is of.
struct TaskKey {
  /// @param tier  of those that the task is judged at; of a sequence the one asked for
  TaskKey(const Task& task, double tier);
  explicit TaskKey(const nlohmann::json& line);

  std::string solver;
  std::string about;  ///< size class or sequence
  std::size_t first;  ///< 0 of sequences
  std::string tier;   ///< as text: equal numbers are equal whatever they were read from
  std::string mode;   ///< "" of problems

  // NOLINTNEXTLINE(modernize-use-nullptr): the checker takes the comparison with 0 inside for a pointer's
  auto operator<=>(const TaskKey&) const = default;
};

/// A line: its task, its kind ("" of sequences), and the number of its pass or round.
using LineKey = std::tuple<TaskKey, std::string, int>;
LineKey KeyOfLine(const nlohmann::json& line);

/// A problem's judgement within a task, or the rule by which it was not tried.
struct Judged {
  JudgeReply reply;
  std::string excluded;   ///< the rule by which it was not run, "" for none
  std::string not_taken;  ///< the kind of rows for which the solver was not asked (NotTaken), "" for none
};

/// A timed pass, how often it was run again because the machine disturbed it, and whether it still did.
struct TimedRun {
  TimedReply reply;
  double began_s = 0;  ///< of the run that counts, since 1970
  int reruns = 0;
  bool disturbed = false;
};

/// What has been run of a campaign: streams.jsonl and, where it has sequences, steps.jsonl (RESULTS.md). Every line is
/// written before the next task begins (append_only_file.h).
class Journal {
 public:
  /// Opens or creates the files and reads what they have.
  /// @param tasks, sequences  of the whole campaign, whatever the shard
  /// @param launches, rounds  of CampaignPlan: how many there are at most
  /// @throws InputError where one cannot be written; naming file and line where one has a line twice, or one that is
  ///         not of these tasks, sequences and passes
  Journal(const std::string& folder, const std::vector<Task>& tasks, const std::vector<Task>& sequences,
          const Launches& launches, int rounds, std::string environment_hash);

  bool Has(const TaskKey& key, const std::string& kind, int pass) const;

  /// What a judged task found, by the place of its problems, at the tier of its key; for a sequence from its round 0.
  struct Judgement {
    std::size_t attempted = 0;
    std::set<std::size_t> unverified;   ///< of those that were attempted
    std::set<std::size_t> changed;      ///< not verified in one of the first launches (Launches::others)
    std::set<std::size_t> not_run;      ///< by a rule, or because the solver does not take the problem
    std::set<std::size_t> out_of_time;  ///< stopped, or killed, at the time limit; of a sequence 0 where that ended it
    std::vector<double> first_s;        ///< what each took when it was judged; infinite where that is not known
    std::vector<double> quickest_s;     ///< the least time of each place in the first launches; infinite without one
    std::map<int, std::vector<double>> launches;  ///< by number: the time of each place, infinite without one
    bool completed = false;                       ///< of a sequence
  };
  /// Null where the task was not judged, or is excluded.
  const Judgement* Find(const TaskKey& key) const;

  /// A launch is off where its level, the median over the problems of its time over their median in all launches, is
  /// farther than kOff from 1. False where it was not run, and with fewer than three launches. Repeated rounds do not
  /// count.
  bool IsOff(const Judgement& judged, int launch) const;
  static constexpr double kOff = 0.1;

  /// The probe of the clock rate that one in ten so far went below; infinite before the first. The shortest of all
  /// says little: a processor may boost its clock for a moment.
  double FastProbe() const;

  /// A line per tier that the task is judged at. @param judged  of the problems that had their turn, in order
  void WriteJudged(const Task& task, const std::vector<Judged>& judged);
  /// Nothing of it is run, by its rule.
  void WriteExcluded(const Task& task);
  /// @param launch  from 1
  void WriteTimed(const Task& task, PassKind kind, int launch, const TimedRun& run);
  void WritePass(const Task& task, int round, const SequenceReply& reply);
  /// Waits until the disk has all lines. @throws OutputError
  void Synchronise();

 private:
  // Checks that a line that is read belongs to the plan, and was not read before.
  void RequireNew(const nlohmann::json& line) const;
  void Note(const nlohmann::json& line);
  // The missing lines of a task, at every tier that it is judged at; `complete(k, &line)` adds to
  // the one of the k-th tier.
  template <typename Complete>
  void WriteByTier(const Task& task, const char* kind, int pass, const Complete& complete);
  void Append(AppendOnlyFile* file, const std::vector<nlohmann::ordered_json>& lines);

  std::string environment_hash_;
  std::map<TaskKey, std::size_t> planned_;  // with the count of problems
  Launches launches_;
  int rounds_;
  std::vector<double> probes_;  // ascending
  std::set<LineKey> done_;
  std::map<TaskKey, Judgement> judged_;
  std::unique_ptr<AppendOnlyFile> streams_;
  std::unique_ptr<AppendOnlyFile> steps_;
};

/// "fresh", "parts" or "again".
const char* KindKey(PassKind kind);

inline constexpr const char* kStreamsFile = "streams.jsonl";
inline constexpr const char* kStepsFile = "steps.jsonl";

}  // namespace lcpbench
