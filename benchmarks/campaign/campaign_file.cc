#include "benchmarks/campaign/campaign_file.h"

#include <algorithm>
#include <array>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <optional>
#include <system_error>

#include "benchmarks/collection/content_hash.h"
#include "benchmarks/measure/environment.h"
#include "solvers/peers/tier_settings.h"
#include "solvers/registry.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kSchema = "lcpbench-campaign/2";
constexpr std::array kOrigins = {"own", "peer", "external"};  // SolverOrigin

// What a key stands for. Only peers whose stopping options were chosen by the rule of tier_settings.h run tuned under
// their own key; our solvers, and peers without such options, run as they are.
const char* SettingOf(const SolverEntry& solver) {
  if (!solver.base.empty()) return "variant";
  const auto table = TierTable();
  const bool tuned =
      std::any_of(table.begin(), table.end(), [&solver](const TierSettings& row) { return row.key == solver.key; });
  return tuned ? "tuned" : "default";
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

}  // namespace

Json DescribeCampaign(const CampaignPlan& plan, const std::vector<Manifest>& manifests,
                      const std::vector<PlannedProblem>& problems) {
  Json json;
  json["schema"] = kSchema;
  json["name"] = plan.name;
  json["manifests"] = Json::array();
  for (const Manifest& manifest : manifests) {
    json["manifests"].push_back(
        {{"name", manifest.name}, {"version", manifest.version}, {"sha256", ManifestHash(manifest)}});
  }
  json["solvers"] = Json::array();
  for (const std::string& key : plan.solvers) {
    const SolverEntry& entry = FindSolver(key);
    json["solvers"].push_back({{"key", entry.key},
                               {"method", entry.method},
                               {"setting", SettingOf(entry)},
                               {"base", entry.base},
                               {"settings", entry.settings},
                               {"origin", kOrigins.at(static_cast<std::size_t>(entry.origin))},
                               {"uses_tolerance", entry.uses_tolerance},
                               {"tolerance", entry.tolerance()},
                               {"ablation", entry.ablation},
                               {"available", entry.available},
                               {"licence", entry.licence},
                               {"library_version", entry.available ? WorkerVersion(entry.key) : ""}});
  }
  if (!plan.tuning.file.empty()) {
    json["tuning"] = {{"file", plan.tuning.file}, {"sha256", plan.tuning.sha256}, {"budget", plan.tuning.budget}};
  }
  json["tiers"] = plan.tiers;
  json["filter"] = plan.filter;
  json["most_rows"] = plan.most_rows;
  json["fills"] = plan.fills;
  json["seed"] = plan.seed;
  json["size_classes"] = Json::array();
  for (const SizeClass& size_class : kSizeClasses) {
    json["size_classes"].push_back(
        {{"key", size_class.key},
         {"least", size_class.least},
         {"most", &size_class == &kSizeClasses.back() ? Json(nullptr) : Json(size_class.most)},
         {"stream", size_class.stream}});
  }
  json["passes"] = plan.passes;
  json["budgets_s"] = {{"judge", plan.budgets.judge_s},
                       {"timed", plan.budgets.timed_s},
                       {"parts", plan.budgets.parts_s},
                       {"again", plan.budgets.again_s}};
  json["limits"] = {{"time_per_row_s", plan.time_per_row_s},
                    {"least_s", plan.least_s},
                    {"most_s", plan.most_s},
                    {"memory_bytes", plan.memory_bytes}};
  json["noise"] = {{"slower_clock", plan.noise.slower_clock},
                   {"least_cpu_share", plan.noise.least_cpu_share},
                   {"most_reruns", plan.noise.most_reruns}};
  json["size_limits"] = Json::array();
  for (const SolverEntry& solver : AllSolvers()) {
    const std::optional<SizeLimit> limit = SizeLimitOf(solver.method_class);
    if (!limit) continue;
    json["size_limits"].push_back({{"solver", solver.key}, {"largest", limit->largest}, {"reason", limit->reason}});
  }
  json["lines"] = 0;
  for (const Task& task : PlanTasks(plan, problems)) {
    json["lines"] = json["lines"].get<std::size_t>() + task.judged.size();
  }
  for (const Manifest& manifest : manifests) {
    for (const SequenceEntry& entry : manifest.sequences) {
      json["sequences"].push_back({{"sequence", entry.id},
                                   {"set", manifest.name},
                                   {"family", entry.family},
                                   {"rows", entry.start.rows},
                                   {"most_rows", entry.most_rows},
                                   {"steps", entry.problems}});
    }
  }
  if (json.contains("sequences")) {
    json["deadlines_s"] = plan.deadlines_s;
    json["pass_budget_s"] = plan.pass_budget_s;
  }
  json["started"] = Now();
  json["environment"] = DescribeEnvironment();
  json["environment_hash"] = TextHash(json["environment"].dump()).substr(0, 16);
  return json;
}

bool SameCampaign(const Json& a, const Json& b) {
  const auto stripped = [](Json json) {
    json.erase("started");
    json.erase("environment");
    json.erase("environment_hash");
    return json;
  };
  return stripped(a) == stripped(b);
}

Json ReadCampaignFile(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw InputError(path + ": cannot be opened for reading");
  try {
    Json json = Json::parse(file);
    if (json.at("schema") != kSchema) throw InputError(path + ": expected schema " + std::string(kSchema));
    return json;
  } catch (const Json::exception&) {
    throw InputError(path + ": expected the JSON object of a campaign");
  }
}

void WriteCampaignFile(const std::string& path, const Json& campaign) {
  // Renamed when it is whole: what is killed here must not leave a file that --resume cannot read.
  const std::string part = path + ".part";
  std::ofstream file(part);
  file << campaign.dump(1) << '\n';
  file.close();
  std::error_code error;
  if (file) std::filesystem::rename(part, path, error);
  if (!file || error) throw InputError(path + ": cannot be written");
}

}  // namespace lcpbench
