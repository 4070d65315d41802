#include "benchmarks/campaign/campaign.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <limits>
#include <map>
#include <memory>
#include <set>
#include <tuple>
#include <utility>
#include <vector>

#include "benchmarks/campaign/campaign_file.h"
#include "benchmarks/campaign/journal.h"
#include "benchmarks/campaign/result_fields.h"
#include "benchmarks/campaign/sequence_file.h"
#include "benchmarks/campaign/worker_process.h"
#include "benchmarks/measure/progress.h"
#include "benchmarks/measure/quantile.h"
#include "benchmarks/measure/text_table.h"
#include "solvers/registry.h"
#include "support/clock.h"
#include "support/file_lock.h"
#include "support/input_error.h"
#include "support/number_text.h"
#include "support/text_file.h"

namespace lcpbench {
namespace {

namespace fs = std::filesystem;

// To a tenth.
double SecondsSince1970() {
  const std::chrono::duration<double> now = std::chrono::system_clock::now().time_since_epoch();
  return std::round(10 * now.count()) / 10;
}

std::string In(const std::string& folder, const char* file) { return (fs::path(folder) / file).string(); }

class Campaign {
 public:
  /// @param problems, manifests  must outlive the object
  Campaign(const CampaignPlan& plan, const CampaignOptions& options, const std::vector<PlannedProblem>& problems,
           const std::vector<Manifest>& manifests, const std::string& environment_hash)
      : plan_(plan),
        options_(options),
        problems_(problems),
        tasks_(TasksOfShard(PlanTasks(plan, problems), options.shard)),
        passes_(TasksOfShard(PlanPasses(plan, manifests), options.shard)),
        journal_(options.folder, PlanTasks(plan, problems), PlanPasses(plan, manifests), plan.launches, plan.rounds,
                 environment_hash) {}

  // False where it was interrupted. The caller keeps the Interruption.
  bool Run() {
    const bool done = RunTasks();
    journal_.Synchronise();
    return done;
  }

 private:
  bool RunTasks() {
    const Launches& launches = plan_.launches;
    StartWorker();
    if (!VisitAll(tasks_, 0, "judging", [&](const Task& task) { Judge(task); })) return false;
    std::vector<Task> timed = tasks_;
    for (int launch = 1; launch <= launches.near + launches.repeats; ++launch) {
      if (launch == launches.others + 1 && launch <= launches.near) timed = NearTasks();
      const std::vector<Task> repeated = launch > launches.near ? TasksToRepeat(timed, launch) : std::vector<Task>();
      const auto time = [&](const Task& task) { Time(task, PassKind::kFresh, launch); };
      const std::string title = (launch > launches.near ? "repeated round " : "launch ") + std::to_string(launch);
      if (!VisitAll(launch > launches.near ? repeated : timed, launch, title, time)) return false;
      if (launch == 1) PrintStandings();
    }
    const auto explain = [&](const Task& task) {
      Time(task, PassKind::kParts, 1);
      Time(task, PassKind::kAgain, 1);
    };
    if (launches.parts && !VisitAll(timed, launches.near + 1, "parts", explain)) return false;
    StartWorker();  // with all its memory
    for (int round = 0; round < plan_.rounds; ++round) {
      const std::string title = "sequences, round " + std::to_string(round);
      if (!VisitAll(passes_, round, title, [&](const Task& pass) { RunTimedTask(pass, round); })) return false;
    }
    return !Interruption::Requested();
  }

  void StartWorker() {
    WorkerOptions worker;
    worker.memory_bytes = plan_.memory_bytes;
    worker.cpu = options_.cpu;
    worker.solver_arguments = options_.solver_arguments;
    worker_ = std::make_unique<WorkerProcess>(worker);
  }

  // Every task once, in another order each round. False where it was interrupted.
  template <typename Visit>
  bool VisitAll(const std::vector<Task>& tasks, int round, const std::string& title, const Visit& visit) {
    if (tasks.empty()) return true;
    ProgressBar bar(title, static_cast<double>(tasks.size()));
    for (const std::size_t k : OrderOfRound(plan_, tasks, round)) {
      if (Interruption::Requested()) return false;
      visit(tasks[k]);
      bar.Advance(1, Summary());
    }
    return true;
  }

  const PlannedProblem& ProblemOf(const Task& task, std::size_t place) const { return problems_[task.begin + place]; }
  ProblemName NameOf(const Task& task, std::size_t place) const {
    const PlannedProblem& problem = ProblemOf(task, place);
    return {plan_.manifests[problem.manifest], problem.entry->id};
  }
  double LimitOf(const Task& task, std::size_t place) const {
    return plan_.limits.Of(ProblemOf(task, place).entry->properties.rows);
  }

  // The measured time is beyond the limit, whatever the answer is.
  bool IsLate(const Task& task, std::size_t place, double seconds) const {
    return std::isfinite(seconds) && seconds > LimitOf(task, place);
  }
  bool RanOutOfTime(const Task& task, std::size_t place, const Journal::Judgement& found) const {
    return found.out_of_time.contains(place) ||
           (place < found.first_s.size() && IsLate(task, place, found.first_s[place]));
  }

  // The judged solve took so long that no launch times the problem (Launches::longest_s).
  bool IsLong(const Journal::Judgement& found, std::size_t place) const {
    return std::isfinite(found.first_s.at(place)) && found.first_s[place] > plan_.launches.longest_s;
  }

  // Declared beforehand: what ran out of time at a looser tier is not tried at stricter ones. "" for no rule.
  std::string RuleFor(const Task& task, std::size_t place) const {
    for (const double tier : plan_.tiers) {
      if (tier <= task.tier) continue;
      const Journal::Judgement* looser = journal_.Find(TaskKey(task, tier));
      const bool is_late = looser != nullptr && (task.sequence != nullptr ? looser->out_of_time.contains(place)
                                                                          : RanOutOfTime(task, place, *looser));
      if (is_late) return OutOfTimeRule(tier);
    }
    return {};
  }

  // Whether the solver has a place in the portfolio of the task's size class.
  bool IsInPortfolio(const Task& task) const {
    const auto codes = plan_.portfolio.find(task.about);
    return codes != plan_.portfolio.end() && std::ranges::find(codes->second, task.solver) != codes->second.end();
  }

  // Pass 0: every problem by itself, with its limits.
  void Judge(const Task& task) {
    if (journal_.Has(TaskKey(task, task.judged.back()), "judge", 0)) return;
    if (!task.excluded.empty()) return journal_.WriteExcluded(task);
    std::vector<Judged> judged;
    auto [tried, late] = LateBefore(task);
    const double start = SteadyNow();
    for (std::size_t place = 0; place < task.count(); ++place) {
      if (place > 0 && SteadyNow() - start > plan_.limits.class_s && !IsInPortfolio(task)) break;
      const ProblemProperties& properties = ProblemOf(task, place).entry->properties;
      Judged one;
      one.not_taken = NotTaken(FindSolver(task.solver), properties);
      if (!one.not_taken.empty()) {
        judged.push_back(std::move(one));
        continue;
      }
      one.excluded = SizeRefusal(FindSolver(task.solver), properties.rows);
      if (one.excluded.empty()) one.excluded = RuleFor(task, place);
      if (one.excluded.empty() && late >= plan_.limits.most_late && 2 * late >= tried)
        one.excluded = OutOfTimeRule(plan_.limits);
      if (one.excluded.empty()) {
        one.reply = RunJudged({NameOf(task, place), task.runs, task.tier, task.judged, LimitOf(task, place)});
        const std::vector<nlohmann::json>& records = one.reply.records;
        // A job scheduler that has asked for the end and waited kills all processes at once: no outcome of the
        // solver's.
        if (Interruption::Requested() && one.reply.outcome == "crashed") return;
        // The last is of the strictest tier.
        const bool not_asked = !records.empty() && records.back()["claim"] == ToString(LcpStatus::kUnsupported);
        if (!not_asked && (records.empty() || records.back()["passes"] != true)) ++failures_;
        if (!records.empty() && records.back()["false_success"] == true) ++false_successes_;
        ++tried;
        if (EndedLate(task, place, one.reply)) ++late;
      }
      judged.push_back(std::move(one));
    }
    journal_.WriteJudged(task, judged);
  }

  // How many problems of the class the earlier tasks of this solver tried, and how many of these ran out of time.
  std::pair<std::size_t, std::size_t> LateBefore(const Task& task) const {
    std::size_t tried = 0;
    std::size_t late = 0;
    for (const Task& other : tasks_) {
      const bool is_before = other.about == task.about && other.first < task.first;
      if (!is_before || other.solver != task.solver || other.tier != task.tier) continue;
      const Journal::Judgement* found = journal_.Find(TaskKey(other, other.judged.back()));
      if (found == nullptr) continue;
      for (std::size_t place = 0; place < found->attempted; ++place) {
        if (found->not_run.contains(place)) continue;
        ++tried;
        if (RanOutOfTime(other, place, *found)) ++late;
      }
    }
    return {tried, late};
  }

  // Once more where the answer passes and came late: the machine may have been elsewhere.
  JudgeReply RunJudged(const JudgeRequest& request) {
    const auto late_s = [&](const JudgeReply& reply) {
      if (reply.records.empty() || reply.records.front()["passes"] != true) return 0.0;
      const nlohmann::json& first_s = reply.records.front()["first_s"];
      return first_s.is_number() && first_s.get<double>() > request.time_limit_s ? first_s.get<double>() : 0.0;
    };
    JudgeReply reply = worker_->Run(request);
    const double took_s = late_s(reply);
    if (took_s == 0 || Interruption::Requested()) return reply;
    JudgeReply again = worker_->Run(request);
    const bool is_better = !again.records.empty() && again.records.front()["passes"] == true && late_s(again) < took_s;
    return is_better ? again : reply;
  }

  bool EndedLate(const Task& task, std::size_t place, const JudgeReply& reply) const {
    if (reply.records.empty()) return reply.outcome == "killed";
    const nlohmann::json& record = reply.records.back();
    const nlohmann::json& first_s = record["first_s"];
    return record["claim"] == ToString(LcpStatus::kTimeLimit) ||
           (first_s.is_number() && IsLate(task, place, first_s.get<double>()));
  }

  PassRequest PassOf(const Task& task, PassKind kind, int launch) const {
    std::vector<std::size_t> verified;
    double time_limit_s = 0;
    double longest_s = 0;
    const Journal::Judgement& loosest = *journal_.Find(TaskKey(task, task.judged.front()));
    for (std::size_t place = 0; place < loosest.attempted; ++place) {
      if (loosest.unverified.contains(place) || IsLong(loosest, place) || RanOutOfTime(task, place, loosest)) continue;
      verified.push_back(place);
      time_limit_s = std::max(time_limit_s, LimitOf(task, place));
      if (std::isfinite(loosest.first_s[place])) longest_s = std::max(longest_s, loosest.first_s[place]);
    }
    PassRequest request = PlanPass(verified, kind, plan_.seed + task.first, launch);
    request.tolerance = task.tier;
    request.time_limit_s = time_limit_s;
    request.longest_s = longest_s;
    if (kind == PassKind::kFresh) request.settle_s = plan_.launches.settle_s;
    return request;
  }

  struct Standing {
    double median_s = std::numeric_limits<double>::infinity();  // by weight, failures infinite
    double weight = 0;
    double right = 0;  // of the weight
  };
  // By tier and first problem, then by solver.
  using Standings = std::map<std::pair<double, std::size_t>, std::map<std::string, Standing>>;

  // Infinite where a launch warmed up on it.
  double MeasuredTime(const Journal::Judgement& found, std::size_t place) const {
    if (place < found.first_s.size() && IsLong(found, place)) return found.first_s[place];
    return place < found.quickest_s.size() ? found.quickest_s[place] : std::numeric_limits<double>::infinity();
  }

  // What is known so far. @param whole  of whole size classes, also where every problem is a task of its own
  Standings FindStandings(bool whole) const {
    Standings standings;
    std::map<Standing*, std::vector<std::pair<double, double>>> times;  // with weights
    for (const Task& task : tasks_) {
      for (const double tier : task.judged) {
        const Journal::Judgement* found = journal_.Find(TaskKey(task, tier));
        if (found == nullptr || found->first_s.empty()) continue;
        Standing& standing = standings[{tier, task.begin - (whole ? task.first : 0)}][task.solver];
        for (std::size_t place = 0; place < found->attempted; ++place) {
          const ManifestEntry& entry = *ProblemOf(task, place).entry;
          const bool has_solution = entry.reference.status != "infeasible";
          if (!has_solution || !NotTaken(FindSolver(task.solver), entry.properties).empty()) continue;
          const double own = ProblemOf(task, place).weight;
          const double measured_s = MeasuredTime(*found, place);
          const bool fails = found->unverified.contains(place) || found->changed.contains(place) ||
                             RanOutOfTime(task, place, *found) || IsLate(task, place, measured_s);
          const double time_s = fails ? std::numeric_limits<double>::infinity() : measured_s;
          standing.weight += own;
          if (!fails) standing.right += own;
          // What a launch warms up on it does not time.
          if (fails || std::isfinite(time_s)) times[&standing].emplace_back(time_s, own);
        }
      }
    }
    for (auto& [standing, of_problems] : times) standing->median_s = WeightedQuantile(std::move(of_problems), 0.5);
    // Who takes none of the problems has no place among the others.
    for (auto& [of, solvers] : standings)
      std::erase_if(solvers, [](const auto& one) { return one.second.weight == 0; });
    return standings;
  }

  static std::vector<std::string> FrontOfPeers(const std::map<std::string, Standing>& solvers) {
    std::vector<std::pair<std::pair<double, double>, std::string>> peers;  // time, share that is wrong
    for (const auto& [solver, standing] : solvers) {
      const bool is_peer = FindSolver(solver).origin == SolverOrigin::kPeer;
      if (is_peer && std::isfinite(standing.median_s)) {
        peers.push_back({{standing.median_s, 1 - standing.right / standing.weight}, solver});
      }
    }
    std::ranges::sort(peers);
    std::vector<std::string> front;
    double least_wrong = 1;
    for (const auto& [of, solver] : peers) {
      if (of.second >= least_wrong) continue;
      least_wrong = of.second;
      front.push_back(solver);
    }
    return front;
  }

  // Near are those within Launches::within times the least median of those that verify Launches::right of the class's
  // weight, or of all where nobody does; peers that no other peer is both faster and more often right than, and those
  // of the class's portfolio. Where nobody solves half of a class at a tier, nobody is near there.
  std::vector<Task> NearTasks() const {
    std::set<std::pair<std::size_t, std::string>> near;  // class and solver
    for (const auto& [of, solvers] : FindStandings(false)) {
      const auto is_right = [&](const auto& solver) {
        return solver.second.right >= plan_.launches.right * solver.second.weight;
      };
      const bool any_right = std::ranges::any_of(solvers, is_right);
      double best = std::numeric_limits<double>::infinity();
      for (const auto& solver : solvers) {
        if (is_right(solver) || !any_right) best = std::min(best, solver.second.median_s);
      }
      for (const auto& [solver, standing] : solvers) {
        const bool is_near = std::isfinite(best) && standing.median_s <= plan_.launches.within * best;
        if (is_near) near.emplace(of.second, solver);
      }
      for (const std::string& peer : FrontOfPeers(solvers)) near.emplace(of.second, peer);
    }
    std::vector<Task> tasks = tasks_;
    std::erase_if(tasks, [&](const Task& task) {
      return !near.contains({task.begin, task.solver}) && !IsInPortfolio(task);
    });
    return tasks;
  }

  // A round with a launch that is off is repeated as a whole, under a number of its own: the k-th such round of a class
  // and tier by launch near + k.
  std::vector<Task> TasksToRepeat(const std::vector<Task>& tasks, int launch) const {
    std::map<std::pair<std::size_t, double>, std::set<int>> off;
    for (const Task& task : tasks) {
      const Journal::Judgement* found = journal_.Find(TaskKey(task, task.judged.back()));
      for (int round = plan_.launches.others + 1; found != nullptr && round <= plan_.launches.near; ++round) {
        if (journal_.IsOff(*found, round)) off[RoundOf(plan_, task)].insert(round);
      }
    }
    std::vector<Task> repeated = tasks;
    std::erase_if(repeated, [&](const Task& task) {
      return std::ssize(off[RoundOf(plan_, task)]) < launch - plan_.launches.near;
    });
    return repeated;
  }

  // A first result while the other launches run.
  void PrintStandings() const {
    constexpr double kUsual = 1e-6;
    const bool is_asked = std::ranges::count(plan_.tiers, kUsual) > 0;
    const double told = is_asked ? kUsual : std::ranges::min(plan_.tiers);
    std::vector<std::vector<std::string>> rows{{"rows"}};
    for (const std::string& solver : plan_.solvers) rows.push_back({solver});
    for (const auto& [of, solvers] : FindStandings(true)) {
      if (of.first != told) continue;
      rows.front().emplace_back(problems_[of.second].size_class->key);
      for (auto row = rows.begin() + 1; row != rows.end(); ++row) {
        const auto found = solvers.find(row->front());
        row->push_back(found == solvers.end() ? "" : TextOf(found->second));
      }
    }
    std::erase_if(rows, [](const std::vector<std::string>& row) {
      return std::all_of(row.begin() + 1, row.end(), [](const std::string& cell) { return cell.empty(); });
    });
    if (rows.empty()) return;
    std::cout << "median times so far, asked for " << FormatNumber(told, "%g")
              << ", and how much is right where it is not all:\n"
              << FormatTable(rows) << std::flush;
  }

  static std::string TextOf(const Standing& standing) {
    const double share = standing.right / standing.weight;
    return TimeText(standing.median_s) + (share < 1 ? " " + FormatNumber(std::floor(100 * share), "%.0f") + " %" : "");
  }

  void Time(const Task& task, PassKind kind, int launch) {
    const TaskKey key(task, task.judged.back());
    if (journal_.Find(key) == nullptr || journal_.Has(key, KindKey(kind), launch)) return;
    TimedRequest request;
    request.pass = PassOf(task, kind, launch);
    if (request.pass.order.empty()) return;
    request.launch = kind == PassKind::kFresh ? launch : 0;
    for (std::size_t place = 0; place < task.count(); ++place) request.stream.push_back(NameOf(task, place));
    request.solver = task.runs;
    request.judged = task.judged;
    request.other_b_seed = plan_.seed;
    const TimedRun run = RunUndisturbed(request);
    if (Interruption::Requested() && run.reply.outcome != "completed") return;
    journal_.WriteTimed(task, kind, launch, run);
  }

  // Again where the machine disturbed it; of several runs the one that was disturbed least, whatever came out.
  TimedRun RunUndisturbed(TimedRequest request) {
    TimedRun best;
    std::string retried;
    double least = std::numeric_limits<double>::infinity();
    for (int run = 0; run <= plan_.noise.most_reruns; ++run) {
      request.run = run;
      const double began_s = SecondsSince1970();
      TimedReply reply = worker_->Run(request);
      // Who killed a worker is told, whichever run counts.
      if (!reply.retried.empty()) retried += (retried.empty() ? "" : "; ") + reply.retried;
      reply.retried = retried;
      if (reply.outcome != "completed") return {RunHalves(request, reply), began_s};
      if (!reply.disturbance) return {std::move(reply), began_s};
      const double fast_s = std::min(journal_.FastProbe(), reply.disturbance->probe_s);
      const double found = DisturbanceOf(plan_.noise, *reply.disturbance, fast_s);
      if (found < least) {
        least = found;
        best.reply = std::move(reply);
        best.began_s = began_s;
      }
      best.reruns = run;
      best.disturbed = least > 0;
      if (!best.disturbed) break;
    }
    if (best.disturbed) ++disturbed_;
    best.reply.retried = retried;
    return best;
  }

  // A process that ended in a pass does not say at which problem: each half of them gets a process of its own, and so
  // on down to single problems. A half that completes counts. What only explains is not asked for again.
  TimedReply RunHalves(const TimedRequest& request, const TimedReply& ended) {
    TimedReply all;
    all.outcome = ended.outcome;
    all.detail = ended.detail;
    all.retried = ended.retried;
    all.failed.resize(request.judged.size());
    for (const TimeField& field : TimeFields()) {
      if (field.kind == request.pass.kind) all.times[field.name].resize(request.stream.size());
    }
    using Places = std::vector<std::uint32_t>;
    std::vector<Places> open;
    if (request.pass.kind == PassKind::kFresh) {
      open.push_back(request.pass.order);
    } else {
      for (const std::uint32_t place : request.pass.order) Take(ended, place, &all);
    }
    while (!open.empty() && !Interruption::Requested()) {
      const Places places = std::move(open.back());
      open.pop_back();
      const auto middle = places.begin() + std::ssize(places) / 2;
      for (const Places& half : {Places(places.begin(), middle), Places(middle, places.end())}) {
        if (half.empty() || Interruption::Requested()) continue;
        TimedRequest part = request;
        part.pass.order = half;
        const TimedReply reply = worker_->Run(part);
        if (!reply.retried.empty()) all.retried += (all.retried.empty() ? "" : "; ") + reply.retried;
        if (reply.outcome != "completed" && half.size() > 1) {
          open.push_back(half);
          continue;
        }
        for (const std::uint32_t place : half) Take(reply, place, &all);
      }
    }
    return all;
  }

  // What a part of a pass says of one problem.
  static void Take(const TimedReply& reply, std::uint32_t place, TimedReply* all) {
    for (const auto& [field, seconds] : reply.times) all->times[field][place] = seconds.at(place);
    for (std::size_t tier = 0; tier < all->failed.size(); ++tier) {
      const auto failed = [&] {
        return std::ranges::find(reply.failed.at(tier), place) != reply.failed.at(tier).end();
      };
      if (reply.outcome != "completed" || failed()) all->failed[tier].push_back(place);
    }
  }

  // Makes the pass's sequence where the folder does not have it yet; what it has from a run before is checked once, and
  // made anew where it is damaged. False where it was interrupted.
  bool MakeSequence(const Task& pass) {
    const std::string path = SequencePath(options_.folder, pass.about);
    if (made_.contains(path)) return true;
    if (!IsSequenceFile(path, pass.sequence->sha256)) {
      try {
        WriteSequenceFile(*pass.sequence, FolderOf(plan_.manifests[pass.manifest]), path);
      } catch (const Interrupted&) {
        return false;
      }
    }
    made_.insert(path);
    return true;
  }

  // Passes that did not complete in round 0 are not visited again.
  void RunTimedTask(Task pass, int round) {
    const TaskKey key(pass, pass.tier);
    if (journal_.Has(key, "", round)) return;
    if (pass.excluded.empty()) pass.excluded = RuleFor(pass, 0);
    if (!pass.excluded.empty()) {
      if (round == 0) journal_.WriteExcluded(pass);
      return;
    }
    const Journal::Judgement* first = journal_.Find(key);
    if (round > 0 && (first == nullptr || !first->completed)) return;
    if (!MakeSequence(pass)) return;
    SequenceRequest request;
    request.file = SequencePath(options_.folder, pass.about);
    request.sha256 = pass.sequence->sha256;
    request.solver = pass.runs;
    request.tier = pass.tier;
    request.judged = pass.judged;
    request.warm = pass.warm;
    request.deadline_s = pass.deadline_s;
    request.limits = plan_.limits;
    request.budget_s = plan_.pass_budget_s;
    const SequenceReply reply = worker_->Run(request);
    if (Interruption::Requested() && reply.outcome == "crashed") return;
    if (reply.outcome != "completed") ++failures_;
    journal_.WritePass(pass, round, reply);
  }

  std::string Summary() const {
    return std::to_string(failures_) + " failures, " + std::to_string(false_successes_) + " false successes, " +
           std::to_string(disturbed_) + " disturbed";
  }

  const CampaignPlan& plan_;
  const CampaignOptions& options_;
  const std::vector<PlannedProblem>& problems_;
  std::vector<Task> tasks_;
  std::vector<Task> passes_;    // over sequences
  std::set<std::string> made_;  // files of sequences that are known to be right
  Journal journal_;
  std::unique_ptr<WorkerProcess> worker_;
  std::int64_t failures_ = 0;
  std::int64_t false_successes_ = 0;
  std::int64_t disturbed_ = 0;
};

// What goes on elsewhere, or with another build, is allowed: every line names its environment. It should be no
// surprise.
void TellOfAnotherEnvironment(const std::string& folder, const nlohmann::ordered_json& begun,
                              const nlohmann::ordered_json& now) {
  if (begun.at("environment_hash") == now.at("environment_hash")) return;
  std::string what;
  for (const auto& [key, value] : now.at("environment").items()) {
    if (begun.at("environment").value(key, nlohmann::ordered_json()) != value) {
      what += (what.empty() ? "" : ", ") + key;
    }
  }
  std::cerr << folder << ": note: begun in another environment (" << what << ")" << std::endl;
}

// What is written into the folder stays in it, whoever made it.
void RequireNoLinks(const std::string& folder) {
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_symlink()) {
      throw InputError(entry.path().string() + ": is a symbolic link, expected files of the campaign's own");
    }
  }
}

// The plan's file is there and says the same, or is not there yet.
std::string PrepareFolder(const CampaignOptions& options, const nlohmann::ordered_json& campaign) {
  const std::string path = In(options.folder, kCampaignFile);
  if (!fs::exists(path)) {
    WriteCampaignFile(path, campaign);
  } else if (!options.resume) {
    throw InputError(options.folder + ": has a campaign already; --resume goes on with it");
  } else {
    const nlohmann::ordered_json begun = ReadCampaignFile(path);
    if (!SameCampaign(begun, campaign)) {
      throw InputError(options.folder + ": expected the requested campaign, found another plan");
    }
    TellOfAnotherEnvironment(options.folder, begun, campaign);
  }
  return campaign.at("environment_hash").get<std::string>();
}

// One line for all of them: they have no cells.
void TellWhatIsMissing(const CampaignPlan& plan) {
  std::string missing;
  for (const std::string& key : plan.solvers) {
    if (!FindSolver(key).available) missing += (missing.empty() ? "" : ", ") + key;
  }
  if (!missing.empty()) std::cerr << "not in this build: " << missing << std::endl;
}

// What a plan's manifests give.
struct Planned {
  std::vector<Manifest> manifests;
  std::vector<PlannedProblem> problems;  // point into `manifests`
};

std::vector<Manifest> ReadManifests(const CampaignPlan& plan) {
  std::vector<Manifest> manifests;
  for (const std::string& path : plan.manifests) manifests.push_back(ReadManifest(path));
  std::set<std::string> ids;
  for (std::size_t m = 0; m < manifests.size(); ++m) {
    const auto once = [&](const char* what, const std::string& id) {
      if (ids.insert(id).second) return;
      throw InputError(plan.manifests[m] + ": " + what + " '" + id + "' is in another manifest already");
    };
    for (const ManifestEntry& entry : manifests[m].problems) once("problem", entry.id);
    for (const SequenceEntry& entry : manifests[m].sequences) once("sequence", entry.id);
  }
  return manifests;
}

// A filter, or a size, that leaves nothing is a mistake.
Planned ReadPlanned(const CampaignPlan& plan) {
  RequireValid(plan);
  Planned planned{ReadManifests(plan), {}};
  planned.problems = PlanProblems(plan, planned.manifests);
  if (!PlanTasks(plan, planned.problems).empty() || !PlanPasses(plan, planned.manifests).empty()) return planned;
  const auto made_for_friction = [](const std::string& key) { return !FindSolver(key).takes_plain; };
  if (!planned.problems.empty() && std::ranges::all_of(plan.solvers, made_for_friction)) {
    throw InputError("campaign '" + plan.name +
                     "': nothing to solve: its problems are plain, its solvers for friction");
  }
  if (!planned.problems.empty()) return planned;  // its solvers are not in this build
  const std::string rows =
      plan.most_rows > 0 ? ", or no problem has at most " + std::to_string(plan.most_rows) + " rows" : "";
  throw InputError("campaign '" + plan.name + "': nothing to solve: " +
                   (plan.filter.empty() ? "no problems in the manifests" : "the filter matches nothing") + rows);
}

}  // namespace

std::vector<std::string> CampaignCells(const CampaignPlan& plan, const CampaignOptions& options) {
  const auto [manifests, problems] = ReadPlanned(plan);
  std::vector<std::string> names;
  for (const Task& task : TasksOfShard(PlanTasks(plan, problems), options.shard)) {
    for (std::size_t k = task.begin; k < task.end; ++k) {
      names.push_back(CellName(problems[k].entry->id, task.solver, task.tier));
    }
  }
  for (const Task& pass : TasksOfShard(PlanPasses(plan, manifests), options.shard)) {
    names.push_back(PassName(pass));
  }
  return names;
}

int RunCampaign(const CampaignPlan& plan, const CampaignOptions& options) {
  const auto [manifests, problems] = ReadPlanned(plan);
  const nlohmann::ordered_json described = DescribeCampaign(plan, manifests, problems);
  std::error_code error;
  fs::create_directories(options.folder, error);
  if (error) throw InputError(options.folder + ": cannot be created: " + error.message());
  RequireNoLinks(options.folder);
  const FileLock lock(In(options.folder, kLockFile));  // before anything is read: the other may be writing it
  RemoveUnfinished(options.folder);
  RemoveUnfinished(fs::path(SequencePath(options.folder, "")).parent_path().string());
  const std::string environment = PrepareFolder(options, described);
  Campaign campaign(plan, options, problems, manifests, environment);
  TellWhatIsMissing(plan);  // not before: of a user's mistake there is one line only
  WriteProblems(In(options.folder, kProblemsFile), plan, manifests, problems);
  const Interruption interruption;
  return campaign.Run() ? 0 : Interruption::ExitStatus();
}

void MergeCampaigns(const std::vector<std::string>& folders, const std::string& output) {
  if (folders.empty()) throw InputError("merge: expected folders of campaigns");
  if (fs::exists(In(output, kCampaignFile))) throw InputError(output + ": has a campaign already");
  const nlohmann::ordered_json first = ReadCampaignFile(In(folders.front(), kCampaignFile));
  // Sorted, so that the folders' order does not matter. All folders have the same problems, in the same order.
  std::map<std::string, std::map<LineKey, std::string>> lines;  // by file
  for (const std::string& folder : folders) {
    if (!SameCampaign(ReadCampaignFile(In(folder, kCampaignFile)), first)) {
      throw InputError(folder + ": expected the campaign of " + folders.front() + ", found another plan");
    }
    for (const char* file : {kStreamsFile, kStepsFile}) {
      if (file == kStepsFile && !fs::exists(In(folder, file))) continue;  // of a campaign without sequences
      std::map<LineKey, std::string>& merged = lines[file];
      ReadJsonLines(In(folder, file), "a line of a campaign", [&](const nlohmann::json& json, const std::string& line) {
        RequireFields(json);
        const LineKey key = KeyOfLine(json);
        if (merged.emplace(key, line).second) return;
        const TaskKey& task = std::get<TaskKey>(key);
        throw InputError(task.solver + " on " + task.about + " at " + task.tier + ": the line is there already");
      });
    }
  }
  const auto& streams = lines[kStreamsFile];
  const auto found = static_cast<std::size_t>(std::count_if(
      streams.begin(), streams.end(), [](const auto& line) { return std::get<std::string>(line.first) == "judge"; }));
  if (const auto planned = first.at("lines").get<std::size_t>(); found < planned) {
    std::cerr << "merge: note: " << found << " of " << planned << " tasks: a shard is missing or unfinished"
              << std::endl;
  }
  std::error_code error;
  if (fs::create_directories(output, error); !error) RequireNoLinks(output);
  fs::copy_file(In(folders.front(), kProblemsFile), In(output, kProblemsFile), error);
  if (error) throw InputError(output + ": cannot be created: " + error.message());
  WriteCampaignFile(In(output, kCampaignFile), first);
  for (const auto& [file, merged] : lines) {
    std::string text;
    for (const auto& [key, line] : merged) text += line + '\n';
    WriteTextFile(In(output, file.c_str()), text);
  }
}

}  // namespace lcpbench
