#include "benchmarks/campaign/campaign.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <limits>
#include <map>
#include <memory>
#include <set>
#include <utility>
#include <vector>

#include "benchmarks/campaign/campaign_file.h"
#include "benchmarks/campaign/journal.h"
#include "benchmarks/campaign/problem_file.h"
#include "benchmarks/campaign/sequence_campaign.h"
#include "benchmarks/campaign/sequence_plan.h"
#include "benchmarks/campaign/worker_process.h"
#include "benchmarks/exclusion_rules.h"
#include "benchmarks/interrupt.h"
#include "benchmarks/progress.h"
#include "solvers/lcp/input_error.h"
#include "solvers/registry.h"

namespace lcpbench {
namespace {

namespace fs = std::filesystem;

constexpr const char* kCampaignFile = "campaign.json";
constexpr const char* kCellsFile = "cells.jsonl";
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

std::vector<PlannedCell> CellsOfShard(const CampaignPlan& plan, const CampaignOptions& options,
                                      const std::vector<Manifest>& manifests) {
  std::vector<PlannedCell> cells;
  for (PlannedCell& cell : PlanCells(plan, manifests)) {
    const std::string& id = manifests[cell.manifest].problems[cell.entry].id;
    if (IsInShard(id, cell.solver, options.shard, options.shards)) cells.push_back(std::move(cell));
  }
  return cells;
}

class Campaign {
 public:
  Campaign(const CampaignPlan& plan, const CampaignOptions& options, const std::vector<Manifest>& manifests,
           std::string environment_hash)
      : plan_(plan),
        manifests_(manifests),
        environment_hash_(std::move(environment_hash)),
        journal_(In(options.folder, kCellsFile)),
        worker_(WorkerFor(plan, options)),
        cells_(CellsOfShard(plan, options, manifests)) {}

  const std::vector<PlannedCell>& cells() const { return cells_; }

  // False where it was interrupted. The caller keeps the Interruption.
  bool Run() {
    if (cells_.empty()) return true;
    ProgressBar bar("campaign", static_cast<double>(cells_.size()) * plan_.rounds);
    for (int round = 0; round < plan_.rounds; ++round) {
      for (const std::size_t k : OrderOfRound(cells_, plan_.seed, round)) {
        if (Interruption::Requested()) return false;
        RunCell(cells_[k], round);
        bar.Advance(1, Summary());
      }
    }
    return RunExtraRounds();
  }

 private:
  // Of cells whose median time is not known well enough yet.
  bool RunExtraRounds() {
    for (int round = plan_.rounds; round < plan_.most_rounds; ++round) {
      std::vector<std::size_t> wide;
      for (const std::size_t k : OrderOfRound(cells_, plan_.seed, round)) {
        if (DeservesRound(cells_[k], plan_.tight)) wide.push_back(k);
      }
      if (wide.empty()) return true;
      ProgressBar bar("round " + std::to_string(round + 1), static_cast<double>(wide.size()));
      for (const std::size_t k : wide) {
        if (Interruption::Requested()) return false;
        RunCell(cells_[k], round);
        bar.Advance(1, Summary());
      }
    }
    return true;
  }

  const ManifestEntry& Entry(const PlannedCell& cell) const { return manifests_[cell.manifest].problems[cell.entry]; }

  CellKey KeyOf(const PlannedCell& cell, double tier) const { return {Entry(cell).id, cell.solver, tier, cell.mode}; }

  std::vector<double> TiersOf(const PlannedCell& cell) const { return TiersOfRun(plan_, cell); }

  // Declared beforehand: after a looser tier ran out of time stricter ones are not tried.
  std::string RuleFromLooserTier(const PlannedCell& cell) const {
    for (const double tier : plan_.tiers) {
      if (tier > cell.tier && journal_.RanOutOfTime(KeyOf(cell, tier))) return OutOfTimeRule(tier);
    }
    return {};
  }

  // Whether a cell is timed again: one that passed and has not had its time; with `width` > 0 one whose median is not
  // known so well.
  bool DeservesRound(const PlannedCell& cell, double width) const {
    const std::vector<double> tiers = TiersOf(cell);
    return std::any_of(tiers.begin(), tiers.end(), [&](double tier) {
      const CellKey key = KeyOf(cell, tier);
      if (!journal_.Passed(key) || journal_.TimeSpent(key) > plan_.cell_budget_s) return false;
      return width <= 0 || !journal_.IsTight(key, width);
    });
  }

  void RunCell(const PlannedCell& planned, int round) {
    const ManifestEntry& entry = Entry(planned);
    if (journal_.Has(KeyOf(planned, planned.tier), round)) return;
    PlannedCell cell = planned;
    if (cell.excluded.empty()) cell.excluded = RuleFromLooserTier(cell);
    if (!cell.excluded.empty()) {
      if (round == 0) journal_.WriteExcluded(entry, cell, TiersOf(cell));
      return;
    }
    if (round > 0 && !DeservesRound(cell, 0)) return;
    CellRequest request;
    request.manifest = plan_.manifests[cell.manifest];
    request.problem = entry.id;
    request.solver = cell.solver;
    request.mode = cell.mode;
    request.tier = cell.tier;
    request.judged = TiersOf(cell);
    request.time_limit_s = cell.time_limit_s;
    request.repetitions = plan_.repetitions;
    request.min_time_s = plan_.min_time_s;
    request.budget_s = plan_.budget_s;
    CellReply reply = RunUndisturbed(request);
    // A job scheduler that has asked for the end and waited kills all processes at once: no outcome of the solver's.
    if (Interruption::Requested() && reply.claim == "crashed") return;
    if (reply.verdicts.empty()) {
      for (const double tier : TiersOf(cell)) {
        CellVerdict failed;
        failed.tier = tier;
        failed.reason = reply.detail;
        reply.verdicts.push_back(failed);
      }
    }
    journal_.Write(entry, cell, round, reply, environment_hash_);
    Count(reply);
  }

  // Again where the machine disturbed it; of several runs the one that was disturbed least, whatever came out.
  CellReply RunUndisturbed(const CellRequest& request) {
    CellReply best;
    double least = std::numeric_limits<double>::infinity();
    for (int run = 0; run <= plan_.noise.most_reruns; ++run) {
      CellReply reply = worker_.Run(request);
      if (!reply.disturbance) return reply;
      const double fast_s = std::min(journal_.FastProbe(), reply.disturbance->probe_s);
      const double found = DisturbanceOf(plan_.noise, *reply.disturbance, fast_s);
      if (found < least) {
        least = found;
        best = std::move(reply);
      }
      best.reruns = run;
      best.disturbed = least > 0;
      if (!best.disturbed) break;
    }
    if (best.disturbed) ++disturbed_;
    return best;
  }

  void Count(const CellReply& reply) {
    const auto strictest = std::min_element(reply.verdicts.begin(), reply.verdicts.end(),
                                            [](const auto& a, const auto& b) { return a.tier < b.tier; });
    if (!strictest->passes) ++failures_;
    if (strictest->false_success) ++false_successes_;
  }

  std::string Summary() const {
    return std::to_string(failures_) + " failures, " + std::to_string(false_successes_) + " false successes, " +
           std::to_string(disturbed_) + " disturbed";
  }

  const CampaignPlan& plan_;
  const std::vector<Manifest>& manifests_;
  std::string environment_hash_;
  Journal journal_;
  WorkerProcess worker_;
  std::vector<PlannedCell> cells_;
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
  std::vector<std::string> names;
  for (const PlannedCell& cell : CellsOfShard(plan, options, manifests)) {
    names.push_back(CellName(manifests[cell.manifest].problems[cell.entry].id, cell.solver, cell.tier, cell.mode));
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
  const std::string environment = PrepareFolder(options, DescribeCampaign(plan, manifests));
  Campaign campaign(plan, options, manifests, environment);
  if (options.on_start) options.on_start();
  std::vector<std::vector<bool>> wanted;
  wanted.reserve(manifests.size());
  for (const Manifest& manifest : manifests) wanted.emplace_back(manifest.problems.size(), false);
  for (const PlannedCell& cell : campaign.cells()) wanted[cell.manifest][cell.entry] = true;
  WriteProblems(In(options.folder, kProblemsFile), manifests, plan.manifests, wanted);
  const Interruption interruption;
  const bool done = campaign.Run() && RunSequences(plan, options, manifests, WorkerFor(plan, options), environment);
  return done ? 0 : Interruption::ExitStatus();
}

void MergeCampaigns(const std::vector<std::string>& folders, const std::string& output) {
  if (folders.empty()) throw InputError("merge: expected folders of campaigns");
  if (fs::exists(In(output, kCampaignFile))) throw InputError(output + ": has a campaign already");
  const nlohmann::ordered_json first = ReadCampaignFile(In(folders.front(), kCampaignFile));
  // By problem; by problem, solver, tier, round: sorted, so that the folders' order does not matter.
  std::map<std::string, std::string> problems;
  // By sequence, solver, tier, mode, round.
  std::map<std::tuple<std::string, std::string, double, std::string, int>, std::string> passes;
  bool has_passes = false;
  std::map<std::pair<CellKey, int>, std::string> cells;
  for (const std::string& folder : folders) {
    if (!SameCampaign(ReadCampaignFile(In(folder, kCampaignFile)), first)) {
      throw InputError(folder + ": expected the campaign of " + folders.front() + ", found another plan");
    }
    const auto for_each = [&folder](const char* file, const auto& take) {
      std::ifstream lines(In(folder, file));
      if (!lines) throw InputError(In(folder, file) + ": cannot be opened for reading");
      std::string line;
      while (std::getline(lines, line) && !lines.eof()) {
        try {
          take(nlohmann::json::parse(line), line);
        } catch (const nlohmann::json::exception&) {
          throw InputError(In(folder, file) + ": expected lines of a campaign, found another");
        }
      }
    };
    for_each(kProblemsFile, [&](const nlohmann::json& json, const std::string& line) {
      problems.emplace(json.at("problem").get<std::string>(), line);
    });
    for_each(kCellsFile, [&](const nlohmann::json& json, const std::string& line) {
      const auto tier = json.at("tier").get<double>();
      const CellKey key(json.at("problem").get<std::string>(), json.at("solver").get<std::string>(), tier,
                        json.at("mode").get<std::string>());
      if (!cells.emplace(std::pair(key, json.at("round").get<int>()), line).second) {
        throw InputError(folder + ": " + CellName(key.problem, key.solver, tier, key.mode) +
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
  const auto is_first = [](const auto& cell) { return cell.first.second == 0; };
  const auto found = static_cast<std::size_t>(std::count_if(cells.begin(), cells.end(), is_first));
  if (const auto planned = first.at("lines").get<std::size_t>(); found < planned) {
    std::cerr << "merge: note: " << found << " of " << planned << " cells: a shard is missing, or not at its end"
              << std::endl;
  }
  std::error_code error;
  fs::create_directories(output, error);
  if (error) throw InputError(output + ": cannot be created: " + error.message());
  const auto write = [&output](const char* file, const auto& lines) {
    std::ofstream out(In(output, file));
    for (const auto& [key, line] : lines) out << line << '\n';
    out.close();
    if (!out) throw InputError(In(output, file) + ": cannot be written");
  };
  WriteCampaignFile(In(output, kCampaignFile), first);
  write(kProblemsFile, problems);
  write(kCellsFile, cells);
  if (has_passes) write(kStepsFile, passes);
}

}  // namespace lcpbench
