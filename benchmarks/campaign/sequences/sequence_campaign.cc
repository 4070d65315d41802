#include "benchmarks/campaign/sequences/sequence_campaign.h"

#include <algorithm>
#include <filesystem>
#include <set>
#include <utility>

#include "benchmarks/campaign/exclusion_rules.h"
#include "benchmarks/campaign/sequences/sequence_file.h"
#include "benchmarks/campaign/sequences/sequence_journal.h"
#include "benchmarks/campaign/sequences/sequence_plan.h"
#include "benchmarks/measure/interrupt.h"
#include "benchmarks/measure/progress.h"

namespace lcpbench {
namespace {

namespace fs = std::filesystem;

constexpr const char* kStepsFile = "steps.jsonl";

std::vector<PlannedPass> PassesOfShard(const CampaignPlan& plan, const CampaignOptions& options,
                                       const std::vector<Manifest>& manifests) {
  std::vector<PlannedPass> passes;
  for (PlannedPass& pass : PlanPasses(plan, manifests)) {
    const std::string& id = manifests[pass.manifest].sequences[pass.entry].id;
    if (IsInShard(id, pass.solver, options.shard, options.shards)) passes.push_back(std::move(pass));
  }
  return passes;
}

class SequenceCampaign {
 public:
  SequenceCampaign(const CampaignPlan& plan, const CampaignOptions& options, const std::vector<Manifest>& manifests,
                   const WorkerOptions& worker, std::string environment_hash)
      : plan_(plan),
        folder_(options.folder),
        manifests_(manifests),
        environment_hash_(std::move(environment_hash)),
        journal_((fs::path(options.folder) / kStepsFile).string()),
        worker_(worker),
        passes_(PassesOfShard(plan, options, manifests)) {}

  bool Run() {
    if (passes_.empty()) return true;
    if (!MakeFiles()) return false;
    ProgressBar bar("passes", static_cast<double>(passes_.size()) * plan_.passes);
    for (int round = 0; round < plan_.passes; ++round) {
      for (const std::size_t k : OrderOfRound(passes_, plan_.seed, round)) {
        if (Interruption::Requested()) return false;
        RunPass(passes_[k], round);
        bar.Advance(1, std::to_string(unfinished_) + " not completed");
      }
    }
    return true;
  }

 private:
  const SequenceEntry& Entry(const PlannedPass& pass) const { return manifests_[pass.manifest].sequences[pass.entry]; }

  // All that are needed, before the first solve: those that are there are checked, the others made.
  bool MakeFiles() {
    std::vector<const SequenceEntry*> missing;
    std::set<std::string> ids;
    double weight = 0;
    for (const PlannedPass& pass : passes_) {
      const SequenceEntry& entry = Entry(pass);
      if (!pass.excluded.empty() || !ids.insert(entry.id).second) continue;
      const std::string path = SequencePath(folder_, entry.id);
      if (fs::exists(path)) {
        ReadSequenceFile(path, entry.sha256);
      } else {
        missing.push_back(&entry);
        weight += WeightOf(entry);
      }
    }
    if (missing.empty()) return true;
    ProgressBar bar("sequences", weight);
    for (const SequenceEntry* entry : missing) {
      try {
        WriteSequenceFile(*entry, SequencePath(folder_, entry->id));
      } catch (const Interrupted&) {
        return false;
      }
      bar.Advance(WeightOf(*entry), entry->id);
    }
    return true;
  }

  // Exact solves cost about the square of the rows.
  static double WeightOf(const SequenceEntry& entry) {
    return static_cast<double>(entry.problems * entry.most_rows * entry.most_rows);
  }

  // Declared beforehand: after a looser tier ran out of time stricter ones are not tried.
  std::string RuleFromLooserTier(const PlannedPass& pass) const {
    PlannedPass looser = pass;
    for (const double tier : plan_.tiers) {
      if (tier <= pass.tier || pass.deadline_s > 0) continue;
      looser.tier = tier;
      const std::string outcome = journal_.FirstOutcome(Entry(pass).id, looser);
      if (outcome == "budget" || outcome == "killed") return OutOfTimeRule(tier);
    }
    return {};
  }

  void RunPass(const PlannedPass& planned, int round) {
    const SequenceEntry& entry = Entry(planned);
    if (journal_.Has(entry.id, planned, round)) return;
    PlannedPass pass = planned;
    if (pass.excluded.empty()) pass.excluded = RuleFromLooserTier(pass);
    if (!pass.excluded.empty()) {
      if (round == 0) journal_.WriteExcluded(entry, pass);
      return;
    }
    if (round > 0 && journal_.FirstOutcome(entry.id, pass) != "completed") return;
    SequenceRequest request;
    request.sequence = entry.id;
    request.file = SequencePath(folder_, entry.id);
    request.sha256 = entry.sha256;
    request.solver = pass.solver;
    request.tier = pass.tier;
    request.judged = pass.judged;
    request.warm = pass.warm;
    request.deadline_s = pass.deadline_s;
    request.time_per_row_s = plan_.time_per_row_s;
    request.least_s = plan_.least_s;
    request.most_s = plan_.most_s;
    request.budget_s = plan_.pass_budget_s;
    const SequenceReply reply = worker_.Run(request);
    if (reply.outcome != "completed") ++unfinished_;
    journal_.Write(entry, pass, round, reply, environment_hash_);
  }

  const CampaignPlan& plan_;
  std::string folder_;
  const std::vector<Manifest>& manifests_;
  std::string environment_hash_;
  SequenceJournal journal_;
  WorkerProcess worker_;
  std::vector<PlannedPass> passes_;
  int unfinished_ = 0;
};

}  // namespace

bool HasSequences(const std::vector<Manifest>& manifests) {
  return std::any_of(manifests.begin(), manifests.end(),
                     [](const Manifest& manifest) { return !manifest.sequences.empty(); });
}

void DescribeSequences(const CampaignPlan& plan, const std::vector<Manifest>& manifests,
                       nlohmann::ordered_json* campaign) {
  if (!HasSequences(manifests)) return;
  nlohmann::ordered_json& sequences = (*campaign)["sequences"] = nlohmann::ordered_json::array();
  for (const Manifest& manifest : manifests) {
    for (const SequenceEntry& entry : manifest.sequences) {
      sequences.push_back({{"sequence", entry.id},
                           {"set", manifest.name},
                           {"family", entry.family},
                           {"rows", entry.start.rows},
                           {"most_rows", entry.most_rows},
                           {"steps", entry.problems}});
    }
  }
  (*campaign)["deadlines_s"] = plan.deadlines_s;
  (*campaign)["pass_budget_s"] = plan.pass_budget_s;
}

std::vector<std::string> PassNames(const CampaignPlan& plan, const CampaignOptions& options,
                                   const std::vector<Manifest>& manifests) {
  std::vector<std::string> names;
  for (const PlannedPass& pass : PassesOfShard(plan, options, manifests)) {
    names.push_back(PassName(manifests[pass.manifest].sequences[pass.entry].id, pass.solver, pass.tier, pass.mode));
  }
  return names;
}

bool RunSequences(const CampaignPlan& plan, const CampaignOptions& options, const std::vector<Manifest>& manifests,
                  const WorkerOptions& worker, const std::string& environment_hash) {
  if (!HasSequences(manifests)) return true;
  return SequenceCampaign(plan, options, manifests, worker, environment_hash).Run();
}

}  // namespace lcpbench
