#include "benchmarks/campaign/campaign.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <limits>
#include <map>
#include <memory>
#include <set>
#include <tuple>
#include <utility>
#include <vector>

#include "benchmarks/campaign/campaign_file.h"
#include "benchmarks/campaign/exclusion_rules.h"
#include "benchmarks/campaign/journal.h"
#include "benchmarks/campaign/problem_file.h"
#include "benchmarks/campaign/sequences/sequence_campaign.h"
#include "benchmarks/campaign/sequences/sequence_plan.h"
#include "benchmarks/campaign/worker_process.h"
#include "benchmarks/measure/interrupt.h"
#include "benchmarks/measure/progress.h"
#include "solvers/registry.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

namespace fs = std::filesystem;

constexpr const char* kCampaignFile = "campaign.json";
constexpr const char* kStreamsFile = "streams.jsonl";
constexpr const char* kProblemsFile = "problems.jsonl";
constexpr const char* kStepsFile = "steps.jsonl";

std::string In(const std::string& folder, const char* file) { return (fs::path(folder) / file).string(); }

WorkerOptions WorkerFor(const CampaignPlan& plan, const CampaignOptions& options) {
  WorkerOptions worker;
  worker.memory_bytes = plan.memory_bytes;
  worker.cpu = options.cpu;
  worker.solver_arguments = options.solver_arguments;
  return worker;
}

std::vector<Task> TasksOfShard(const CampaignPlan& plan, const CampaignOptions& options,
                               const std::vector<PlannedProblem>& problems) {
  std::vector<Task> tasks;
  for (Task& task : PlanTasks(plan, problems)) {
    const std::string about = std::string(problems[task.begin].size_class->key) + "|" + std::to_string(task.first);
    if (IsInShard(about, task.solver, options.shard, options.shards)) tasks.push_back(std::move(task));
  }
  return tasks;
}

class Campaign {
 public:
  Campaign(const CampaignPlan& plan, const CampaignOptions& options, const std::vector<PlannedProblem>& problems,
           std::string environment_hash)
      : plan_(plan),
        problems_(problems),
        environment_hash_(std::move(environment_hash)),
        journal_(In(options.folder, kStreamsFile)),
        worker_(WorkerFor(plan, options)),
        tasks_(TasksOfShard(plan, options, problems)) {}

  // False where it was interrupted. The caller keeps the Interruption.
  bool Run() {
    if (tasks_.empty()) return true;
    for (int round = 0; round <= plan_.passes; ++round) {
      ProgressBar bar(round == 0 ? "judging" : "pass " + std::to_string(round), static_cast<double>(tasks_.size()));
      for (const std::size_t k : OrderOfRound(tasks_, plan_.seed, round)) {
        const Task& task = tasks_[k];
        if (Interruption::Requested()) return false;
        if (round == 0) {
          Judge(task);
        } else {
          Time(task, PassKind::kFresh, round);
          if (round == 1) Time(task, PassKind::kParts, round);
          if (round == 1) Time(task, PassKind::kAgain, round);
        }
        bar.Advance(1, Summary());
      }
    }
    return !Interruption::Requested();
  }

 private:
  const PlannedProblem& ProblemOf(const Task& task, std::size_t place) const { return problems_[task.begin + place]; }
  ProblemName NameOf(const Task& task, std::size_t place) const {
    const PlannedProblem& problem = ProblemOf(task, place);
    return {plan_.manifests[problem.manifest], problem.entry->id};
  }
  double LimitOf(const Task& task, std::size_t place) const {
    return TimeLimitOf(plan_, ProblemOf(task, place).entry->properties.rows);
  }
  std::string ClassOf(const Task& task) const { return std::string(problems_[task.begin].size_class->key); }
  TaskKey KeyOf(const Task& task, double tier) const { return {task, ClassOf(task), tier}; }

  // The rule by which a problem of a task is not tried: declared beforehand. "" for none.
  std::string RuleFor(const Task& task, std::size_t place) const {
    std::string refusal = SizeRefusal(FindSolver(task.solver), ProblemOf(task, place).entry->properties.rows);
    if (!refusal.empty()) return refusal;
    for (const double tier : plan_.tiers) {
      if (tier <= task.tier) continue;
      const Journal::Judgement* looser = journal_.Find(KeyOf(task, tier));
      if (looser != nullptr && looser->out_of_time.count(place) > 0) return OutOfTimeRule(tier);
    }
    return {};
  }

  // Pass 0: every problem by itself, with its limits, as far as the budget goes.
  void Judge(const Task& task) {
    if (journal_.Has(KeyOf(task, task.judged.back()), "judge", 0)) return;
    if (!task.excluded.empty()) {
      journal_.WriteExcluded(task, ClassOf(task), environment_hash_);
      return;
    }
    std::vector<Judged> judged;
    double spent = 0;
    for (std::size_t place = 0; place < task.end - task.begin && spent <= plan_.budgets.judge_s; ++place) {
      Judged one;
      one.excluded = RuleFor(task, place);
      if (one.excluded.empty()) {
        const double start = SteadyNow();
        one.reply =
            worker_.Run(JudgeRequest{NameOf(task, place), task.solver, task.tier, task.judged, LimitOf(task, place)});
        spent += one.reply.fresh_s ? *one.reply.fresh_s : SteadyNow() - start;
        // A job scheduler that has asked for the end and waited kills all processes at once: no outcome of the
        // solver's.
        if (Interruption::Requested() && one.reply.claim == "crashed") return;
        Count(one.reply);
      }
      judged.push_back(std::move(one));
    }
    journal_.WriteJudged(task, ClassOf(task), judged, environment_hash_);
  }

  // What is timed in a pass, and what the solver object and the processor are warmed with before: other problems than
  // those that are timed, other ones in every pass.
  PassRequest PassOf(const Task& task, const Journal::Judgement& judgement, PassKind kind, int pass) const {
    constexpr double kLeastInterval = 2e-6;  // s
    constexpr std::uint32_t kMostTogether = 8;
    constexpr std::size_t kMostWarmUps = 16;
    constexpr std::size_t kOneIn = 8;
    PassRequest request;
    request.kind = kind;
    request.tolerance = task.tier;
    std::vector<std::size_t> verified;
    const Journal::Judgement& loosest = *journal_.Find(KeyOf(task, task.judged.front()));
    for (std::size_t place = 0; place < loosest.attempted; ++place) {
      if (loosest.unverified.count(place) > 0) continue;
      verified.push_back(place);
      request.time_limit_s = std::max(request.time_limit_s, LimitOf(task, place));
    }
    if (verified.empty()) return request;
    const std::size_t count = verified.size();
    const std::size_t warm = count < 2 ? 0 : std::clamp<std::size_t>(count / kOneIn, 1, kMostWarmUps);
    std::vector<bool> warms(count, false);
    const std::vector<std::size_t> fixed = ShuffleGroups(verified, plan_.seed + task.first, 0);
    for (std::size_t k = 0; k < warm; ++k) {
      const std::size_t chosen = fixed[(static_cast<std::size_t>(pass - 1) * warm + k) % count];
      warms[chosen] = true;
      request.warm_up.push_back(static_cast<std::uint32_t>(verified[chosen]));
    }
    for (const std::size_t k : ShuffleGroups(verified, plan_.seed + task.first, pass)) {
      if (!warms[k]) request.order.push_back(static_cast<std::uint32_t>(verified[k]));
    }
    if (kind == PassKind::kFresh && task.is_stream && judgement.median_s > 0) {
      request.group = static_cast<std::uint32_t>(
          std::clamp(std::ceil(kLeastInterval / judgement.median_s), 1.0, static_cast<double>(kMostTogether)));
    }
    return request;
  }

  void Time(const Task& task, PassKind kind, int pass) {
    const TaskKey key = KeyOf(task, task.judged.back());
    const Journal::Judgement* judgement = journal_.Find(key);
    if (judgement == nullptr || journal_.Has(key, KindKey(kind), pass)) return;
    TimedRequest request;
    request.pass = PassOf(task, *judgement, kind, pass);
    if (request.pass.order.empty()) return;
    const TaskBudgets& budgets = plan_.budgets;
    request.pass.budget_s = kind == PassKind::kFresh   ? budgets.timed_s - judgement->timed_s
                            : kind == PassKind::kParts ? budgets.parts_s
                                                       : budgets.again_s;
    if (request.pass.budget_s <= 0) return;
    for (std::size_t place = 0; place < task.end - task.begin; ++place) request.stream.push_back(NameOf(task, place));
    request.solver = task.solver;
    request.judged = task.judged;
    request.other_b_seed = plan_.seed;
    int reruns = 0;
    bool disturbed = false;
    const TimedReply reply = RunUndisturbed(request, &reruns, &disturbed);
    if (Interruption::Requested() && reply.outcome != "completed") return;
    journal_.WriteTimed(task, ClassOf(task), kind, pass, request.pass.group, reply, reruns, disturbed,
                        environment_hash_);
  }

  // Again where the machine disturbed it; of several runs the one that was disturbed least, whatever came out.
  TimedReply RunUndisturbed(const TimedRequest& request, int* reruns, bool* disturbed) {
    TimedReply best;
    double least = std::numeric_limits<double>::infinity();
    for (int run = 0; run <= plan_.noise.most_reruns; ++run) {
      TimedReply reply = worker_.Run(request);
      if (reply.outcome != "completed" && request.pass.order.size() > 1) return RunOneByOne(request, reply);
      if (!reply.disturbance) return reply;
      const double fast_s = std::min(journal_.FastProbe(), reply.disturbance->probe_s);
      const double found = DisturbanceOf(plan_.noise, *reply.disturbance, fast_s);
      if (found < least) {
        least = found;
        best = std::move(reply);
      }
      *reruns = run;
      *disturbed = least > 0;
      if (!*disturbed) break;
    }
    if (*disturbed) ++disturbed_;
    return best;
  }

  // A process that ended in a pass does not say at which problem: it counts for the one at which it ends again.
  TimedReply RunOneByOne(const TimedRequest& request, const TimedReply& ended) {
    TimedReply all;
    all.outcome = ended.outcome;
    all.detail = ended.detail;
    all.seconds.resize(request.stream.size());
    all.failed.resize(request.judged.size());
    for (const std::uint32_t place : request.pass.order) {
      if (Interruption::Requested()) break;
      TimedRequest one = request;
      one.pass.order = {place};
      one.pass.group = 1;
      const TimedReply reply = worker_.Run(one);
      if (reply.outcome == "completed" && reply.seconds.size() == all.seconds.size()) {
        all.seconds[place] = reply.seconds[place];
      }
      for (std::size_t tier = 0; tier < all.failed.size(); ++tier) {
        if (reply.outcome != "completed") {
          all.failed[tier].push_back(place);
        } else {
          all.failed[tier].insert(all.failed[tier].end(), reply.failed[tier].begin(), reply.failed[tier].end());
        }
      }
    }
    return all;
  }

  void Count(const JudgeReply& reply) {
    const auto strictest = std::min_element(reply.verdicts.begin(), reply.verdicts.end(),
                                            [](const auto& a, const auto& b) { return a.tier < b.tier; });
    if (strictest == reply.verdicts.end() || !strictest->passes) ++failures_;
    if (strictest != reply.verdicts.end() && strictest->false_success) ++false_successes_;
  }

  std::string Summary() const {
    return std::to_string(failures_) + " failures, " + std::to_string(false_successes_) + " false successes, " +
           std::to_string(disturbed_) + " disturbed";
  }

  const CampaignPlan& plan_;
  const std::vector<PlannedProblem>& problems_;
  std::string environment_hash_;
  Journal journal_;
  WorkerProcess worker_;
  std::vector<Task> tasks_;
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

// The plan's file is there and says the same, or is not there yet.
std::string PrepareFolder(const CampaignOptions& options, const nlohmann::ordered_json& campaign) {
  std::error_code error;
  fs::create_directories(options.folder, error);
  if (error) throw InputError(options.folder + ": cannot be created: " + error.message());
  const std::string path = In(options.folder, kCampaignFile);
  if (!fs::exists(path)) {
    WriteCampaignFile(path, campaign);
  } else if (!options.resume) {
    throw InputError(options.folder + ": has a campaign already; --resume goes on with it");
  } else {
    const nlohmann::ordered_json begun = ReadCampaignFile(path);
    if (!SameCampaign(begun, campaign)) {
      throw InputError(options.folder + ": expected the campaign that is asked for, found another plan");
    }
    TellOfAnotherEnvironment(options.folder, begun, campaign);
  }
  return campaign.at("environment_hash").get<std::string>();
}

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

}  // namespace

std::vector<std::string> CampaignCells(const CampaignPlan& plan, const CampaignOptions& options) {
  RequireValid(plan);
  const std::vector<Manifest> manifests = ReadManifests(plan);
  const std::vector<PlannedProblem> problems = PlanProblems(plan, manifests);
  std::vector<std::string> names;
  for (const Task& task : TasksOfShard(plan, options, problems)) {
    for (std::size_t k = task.begin; k < task.end; ++k) {
      names.push_back(CellName(problems[k].entry->id, task.solver, task.tier));
    }
  }
  for (std::string& name : PassNames(plan, options, manifests)) names.push_back(std::move(name));
  return names;
}

int RunCampaign(const CampaignPlan& plan, const CampaignOptions& options) {
  RequireValid(plan);
  if (options.shards < 1 || options.shard < 1 || options.shard > options.shards) {
    throw InputError("campaign: expected a shard k/N with k from 1 to N");
  }
  const std::vector<Manifest> manifests = ReadManifests(plan);
  const std::vector<PlannedProblem> problems = PlanProblems(plan, manifests);
  const std::string environment = PrepareFolder(options, DescribeCampaign(plan, manifests, problems));
  Campaign campaign(plan, options, problems, environment);
  if (options.on_start) options.on_start();
  WriteProblems(In(options.folder, kProblemsFile), manifests, plan.manifests, problems);
  const Interruption interruption;
  const bool done = campaign.Run() && RunSequences(plan, options, manifests, WorkerFor(plan, options), environment);
  return done ? 0 : Interruption::ExitStatus();
}

void MergeCampaigns(const std::vector<std::string>& folders, const std::string& output) {
  if (folders.empty()) throw InputError("merge: expected folders of campaigns");
  if (fs::exists(In(output, kCampaignFile))) throw InputError(output + ": has a campaign already");
  const nlohmann::ordered_json first = ReadCampaignFile(In(folders.front(), kCampaignFile));
  // Sorted, so that the folders' order does not matter. All folders have the same problems, in the same order.
  std::vector<std::string> problems;
  // By sequence, solver, tier, mode, round.
  std::map<std::tuple<std::string, std::string, double, std::string, int>, std::string> passes;
  bool has_passes = false;
  std::map<std::tuple<TaskKey, std::string, int>, std::string> lines;
  for (const std::string& folder : folders) {
    if (!SameCampaign(ReadCampaignFile(In(folder, kCampaignFile)), first)) {
      throw InputError(folder + ": expected the campaign of " + folders.front() + ", found another plan");
    }
    const auto for_each = [&folder](const char* file, const auto& take) {
      std::ifstream text(In(folder, file));
      if (!text) throw InputError(In(folder, file) + ": cannot be opened for reading");
      std::string line;
      while (std::getline(text, line) && !text.eof()) {
        try {
          take(nlohmann::json::parse(line), line);
        } catch (const nlohmann::json::exception&) {
          throw InputError(In(folder, file) + ": expected lines of a campaign, found another");
        }
      }
    };
    if (folder == folders.front()) {
      for_each(kProblemsFile, [&](const nlohmann::json&, const std::string& line) { problems.push_back(line); });
    }
    for_each(kStreamsFile, [&](const nlohmann::json& json, const std::string& line) {
      const TaskKey key(json);
      if (!lines.emplace(std::tuple(key, json.at("kind").get<std::string>(), json.at("pass").get<int>()), line)
               .second) {
        throw InputError(folder + ": " + key.solver + " on " + key.size_class + " rows at " + key.tier +
                         " is in another folder already");
      }
    });
    if (!fs::exists(In(folder, kStepsFile))) continue;  // of a campaign without sequences
    has_passes = true;
    for_each(kStepsFile, [&](const nlohmann::json& json, const std::string& line) {
      const std::tuple key(json.at("sequence").get<std::string>(), json.at("solver").get<std::string>(),
                           json.at("tier").get<double>(), json.at("mode").get<std::string>(),
                           json.at("round").get<int>());
      if (!passes.emplace(key, line).second) {
        throw InputError(folder + ": " +
                         PassName(std::get<0>(key), std::get<1>(key), std::get<2>(key), std::get<3>(key)) +
                         " is in another folder already");
      }
    });
  }
  const auto found = static_cast<std::size_t>(
      std::count_if(lines.begin(), lines.end(), [](const auto& line) { return std::get<1>(line.first) == "judge"; }));
  if (const auto planned = first.at("lines").get<std::size_t>(); found < planned) {
    std::cerr << "merge: note: " << found << " of " << planned << " tasks: a shard is missing, or not at its end"
              << std::endl;
  }
  std::error_code error;
  fs::create_directories(output, error);
  if (error) throw InputError(output + ": cannot be created: " + error.message());
  const auto write = [&output](const char* file, const auto& all, const auto& text_of) {
    std::ofstream out(In(output, file));
    for (const auto& line : all) out << text_of(line) << '\n';
    out.close();
    if (!out) throw InputError(In(output, file) + ": cannot be written");
  };
  const auto second = [](const auto& line) { return line.second; };
  WriteCampaignFile(In(output, kCampaignFile), first);
  write(kProblemsFile, problems, [](const std::string& line) { return line; });
  write(kStreamsFile, lines, second);
  if (has_passes) write(kStepsFile, passes, second);
}

}  // namespace lcpbench
