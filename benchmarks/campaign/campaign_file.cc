#include "benchmarks/campaign/campaign_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <set>
#include <system_error>

#include "benchmarks/campaign/journal.h"
#include "benchmarks/campaign/result_fields.h"
#include "benchmarks/collection/content_hash.h"
#include "benchmarks/measure/environment.h"
#include "benchmarks/measure/oracle.h"
#include "benchmarks/measure/progress.h"
#include "solvers/registry.h"
#include "support/append_only_file.h"
#include "support/input_error.h"
#include "support/json_field.h"
#include "support/text_file.h"

namespace lcpbench {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kSchema = "lcpbench-campaign/2";
constexpr std::array kOrigins = {"own", "peer", "external"};  // SolverOrigin

// What a key stands for. Only peers whose stopping options were chosen by the rule of peer_table.h run tuned under
// their own key; our solvers, and peers without such options, run as they are.
const char* SettingOf(const SolverEntry& solver) {
  if (!solver.base.empty()) return "variant";
  return solver.origin == SolverOrigin::kPeer && solver.uses_tolerance ? "tuned" : "default";
}

// UTC, ISO 8601.
std::string Now() {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&now, &utc);
  std::array<char, sizeof "2026-01-01T00:00:00Z"> text{};
  std::strftime(text.data(), text.size(), "%FT%TZ", &utc);
  return text.data();
}

Json DescribeSolver(const SolverEntry& entry) {
  return {{"key", entry.key},
          {"method", entry.method},
          {"setting", SettingOf(entry)},
          {"base", entry.base},
          {"settings", entry.settings},
          {"origin", kOrigins.at(static_cast<std::size_t>(entry.origin))},
          {"uses_tolerance", entry.uses_tolerance},
          {"tolerance", entry.tolerance()},
          {"shifted", entry.shifted},
          {"available", entry.available},
          {"licence", entry.licence},
          {"library_version", entry.available ? WorkerVersion(entry.key) : ""}};
}

// Adds what is said of sequences, where the campaign has any.
void DescribeSequences(const CampaignPlan& plan, const std::vector<Manifest>& manifests, Json* json) {
  std::set<const SequenceEntry*> planned;
  for (const Task& pass : PlanPasses(plan, manifests)) planned.insert(pass.sequence);
  for (const Manifest& manifest : manifests) {
    for (const SequenceEntry& entry : manifest.sequences) {
      if (!planned.contains(&entry)) continue;
      (*json)["sequences"].push_back({{"sequence", entry.id},
                                      {"set", manifest.name},
                                      {"family", entry.family},
                                      {"rows", SizeOf(entry)},
                                      {"most_rows", entry.most_rows},
                                      {"steps", entry.problems}});
    }
  }
  if (planned.empty()) return;
  json->update({{"rounds", plan.rounds}, {"deadlines_s", plan.deadlines_s}, {"pass_budget_s", plan.pass_budget_s}});
}

// That a line of problems.jsonl says what the plan says; what was measured need only be a measurement.
void RequireDescribes(const nlohmann::json& line, const std::string& set, const PlannedProblem& planned) {
  const LcpProblem none = LcpProblem::FromDense("none", Eigen::MatrixXd(0, 0), Eigen::VectorXd(0));
  // As a file has it: without infinite numbers.
  const std::string text = RecordOf<DescribedProblem>(ProblemFields(), {set, planned, none}).dump();
  auto expected = nlohmann::json::parse(text);
  expected["rows"] = planned.entry->properties.rows;
  for (const char* measured : {"bilateral", "oracle_s", "check_s", "floor"}) {
    if (line.contains(measured)) expected[measured] = line[measured];
  }
  for (const auto& [field, value] : expected.items()) {
    const auto found = line.find(field);  // RequireFields knows what may be missing
    if (found != line.end() && *found != value) throw InputError(field + " " + found->dump());
  }
}

}  // namespace

Json DescribeCampaign(const CampaignPlan& plan, const std::vector<Manifest>& manifests,
                      const std::vector<PlannedProblem>& problems) {
  Json json = {{"schema", kSchema}, {"name", plan.name}, {"manifests", Json::array()}, {"solvers", Json::array()}};
  for (const Manifest& manifest : manifests) {
    json["manifests"].push_back(
        {{"name", manifest.name}, {"version", manifest.version}, {"sha256", ManifestHash(manifest)}});
  }
  for (const std::string& key : plan.solvers) json["solvers"].push_back(DescribeSolver(FindSolver(key)));
  if (!plan.tuning.file.empty()) {
    json["tuning"] = {{"file", plan.tuning.file}, {"sha256", plan.tuning.sha256}, {"budget", plan.tuning.budget}};
  }
  json.update({{"tiers", plan.tiers},
               {"filter", plan.filter},
               {"most_rows", plan.most_rows},
               {"fills", plan.fills},
               {"most_of_side", plan.most_of_side},
               {"seed", plan.seed},
               {"sealed", plan.sealed.names()},
               {"portfolio", plan.portfolio},
               {"size_classes", Json::array()}});
  for (const SizeClass& size_class : kSizeClasses) {
    const bool is_last = &size_class == &kSizeClasses.back();
    json["size_classes"].push_back({{"key", size_class.key},
                                    {"least", size_class.least},
                                    {"most", is_last ? Json(nullptr) : Json(size_class.most)},
                                    {"stream", size_class.stream}});
  }
  std::size_t lines = 0;
  for (const Task& task : PlanTasks(plan, problems)) lines += task.judged.size();
  json["passes"] = plan.launches.near;
  json["launches"] = {{"others", plan.launches.others},       {"within", plan.launches.within},
                      {"right", plan.launches.right},         {"repeats", plan.launches.repeats},
                      {"longest_s", plan.launches.longest_s}, {"settle_s", plan.launches.settle_s},
                      {"parts", plan.launches.parts}};
  json["limits"] = {{"time_per_row_s", plan.limits.time_per_row_s},
                    {"least_s", plan.limits.least_s},
                    {"most_s", plan.limits.most_s},
                    {"most_late", plan.limits.most_late},
                    {"class_s", plan.limits.class_s},
                    {"memory_bytes", plan.memory_bytes}};
  json["noise"] = {{"slower_clock", plan.noise.slower_clock},
                   {"least_cpu_share", plan.noise.least_cpu_share},
                   {"most_reruns", plan.noise.most_reruns}};
  json["size_limits"] = Json::array();
  json["lines"] = lines;
  for (const std::string& key : plan.solvers) {
    const SolverEntry& solver = FindSolver(key);
    if (const std::optional<SizeLimit> limit = SizeLimitOf(solver.method_class)) {
      json["size_limits"].push_back({{"solver", solver.key}, {"largest", limit->largest}, {"reason", limit->reason}});
    }
  }
  DescribeSequences(plan, manifests, &json);
  json.update({{"started", Now()}, {"environment", DescribeEnvironment()}});
  json["environment_hash"] = TextHash(json["environment"].dump()).substr(0, 16);
  return json;
}

bool SameCampaign(Json a, Json b) {
  for (const char* of_the_run : {"started", "environment", "environment_hash"}) {
    a.erase(of_the_run);
    b.erase(of_the_run);
  }
  return a == b;
}

Json ReadCampaignFile(const std::string& path) {
  const std::string text = ReadTextFile(path);
  const nlohmann::json document = ParseJsonDocument(text, path);
  const JsonField campaign(document, path);
  campaign["schema"].Choice<bool>({{kSchema, true}});
  campaign["environment"].Members();
  for (const char* member : {"name", "environment_hash", "started"}) campaign[member].String();
  for (const JsonField& manifest : campaign["manifests"].Items()) {
    for (const char* member : {"name", "version", "sha256"}) manifest[member].String();
  }
  for (const JsonField& solver : campaign["solvers"].Items()) {
    for (const char* member : {"key", "setting", "base", "origin"}) solver[member].String();
    solver["available"].Boolean();
  }
  for (const JsonField& tier : campaign["tiers"].Items()) tier.Number();
  campaign["lines"].IndexBelow(std::numeric_limits<int>::max());
  return Json::parse(text);  // its members in their order
}

void WriteCampaignFile(const std::string& path, const Json& campaign) {
  TextOutput file(path);
  file.Write(campaign.dump(1) + "\n");
  file.Synchronise();
  file.Close();
}

ProblemSet::ProblemSet(const std::string& path)
    : manifest(ReadManifest(path)), source(FolderOf(path)), references(manifest, FolderOf(path)) {}

AppendOnlyFile OpenProblems(const std::string& path, const std::vector<Manifest>& manifests,
                            const std::vector<PlannedProblem>& problems, std::size_t* done) {
  *done = 0;
  return {path, "a problem of this campaign", [&](const nlohmann::json& line) {
            if (*done == problems.size()) throw InputError("more lines than the campaign has problems");
            const PlannedProblem& planned = problems[*done];
            RequireFields(line);
            RequireDescribes(line, manifests[planned.manifest].name, planned);
            ++*done;
          }};
}

void WriteProblems(const std::string& path, const CampaignPlan& plan, const std::vector<Manifest>& manifests,
                   const std::vector<PlannedProblem>& problems) {
  std::size_t done = 0;
  AppendOnlyFile file = OpenProblems(path, manifests, problems, &done);
  if (done == problems.size()) return;
  std::vector<std::unique_ptr<ProblemSet>> sets;
  for (const std::string& manifest : plan.manifests) sets.push_back(std::make_unique<ProblemSet>(manifest));
  ProgressBar bar("problems", static_cast<double>(problems.size() - done));
  for (; done < problems.size(); ++done) {
    const PlannedProblem& planned = problems[done];
    const ManifestEntry& entry = *planned.entry;
    ProblemSet& set = *sets[planned.manifest];
    const LcpProblem problem = set.source.Get(entry);
    DescribedProblem described{set.manifest.name, planned, problem};
    const std::optional<KnownAnswer> answer = set.references.Find(problem);
    if (answer && answer->f.size() > 0) {
      if (std::isfinite(*answer->reference.floor)) described.floor = answer->reference.floor;
      const bool is_factorizable = problem.is_plain() && problem.IsNumericallySymmetric() && answer->reference.w;
      const double oracle_s = is_factorizable ? TimeOracle(problem, answer->f, *answer->reference.w) : -1;
      if (oracle_s > 0) described.oracle_s = oracle_s;
      described.check_s = TimeCheck(problem, answer->f);
    }
    file.Append({RecordOf<DescribedProblem>(ProblemFields(), described)});
    bar.Advance(1, entry.id);
  }
  file.Synchronise();
}

}  // namespace lcpbench
