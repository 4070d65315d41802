#include "benchmarks/recommend/rules.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>

#include "solvers/registry.h"
#include "support/input_error.h"
#include "support/json_field.h"

namespace lcpbench {
namespace {

using Json = nlohmann::json;

constexpr const char* kSchema = "lcpbench-recommendation/1";
// Tiers are equal that were written as the same number.
constexpr double kSameTier = 1 + 1e-6;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

double NumberWithin(const JsonField& field, double least, double most) {
  const double value = field.Number();
  if (value >= least && value <= most) return value;
  field.Mismatch("a number of " + Json(least).dump() + " to " + Json(most).dump());
}

std::string SolverKey(const JsonField& field) {
  std::string key = field.String();
  const auto all = AllSolvers();
  const bool known = std::any_of(all.begin(), all.end(), [&](const SolverEntry& entry) { return entry.key == key; });
  if (!known) field.Mismatch("the key of a solver");
  return key;
}

std::vector<std::string> SolverKeys(const JsonField& field) {
  std::vector<std::string> keys;
  for (const JsonField& element : field.Items()) keys.push_back(SolverKey(element));
  return keys;
}

RecommendationRegion ParseRegion(const JsonField& field) {
  RecommendationRegion region;
  region.tier = NumberWithin(field["tier"], std::numeric_limits<double>::min(), 1);
  for (const auto& [name, ends] : field["where"].Members()) {
    const auto features = AllFeatures();
    const auto known = std::find_if(features.begin(), features.end(),
                                    [&key = name](const auto& feature) { return feature.name == key; });
    if (known == features.end()) ends.Mismatch("a feature's name, not '" + name + "'");
    const std::vector<JsonField> pair = ends.Items(2);
    region.where.push_back({*known, pair[0].Number(), pair[1].NumberOrNull().value_or(kInfinity)});
  }
  region.problems = static_cast<int>(NumberWithin(field["problems"], 0, 1e9));
  region.candidates = SolverKeys(field["candidates"]);
  if (region.candidates.empty()) field["candidates"].Mismatch("one solver or more");
  region.peers = SolverKeys(field["peers"]);
  for (const JsonField& solver : field["solvers"].Items()) {
    region.solvers.push_back(
        {SolverKey(solver["solver"]), NumberWithin(solver["verified"], 0, 1), NumberWithin(solver["within"], 0, 1)});
  }
  return region;
}

std::string ParseCampaign(const JsonField& field) {
  constexpr size_t kShortHash = 12;
  return field["name"].String() + " (commit " + field["commit"].String().substr(0, kShortHash) + ", " +
         field["cpu"].String() + ")";
}

bool Contains(const RecommendationRegion& region, const ProblemFeatures& features) {
  for (const auto& [feature, least, end] : region.where) {
    const std::optional<double> value = features.*feature.value;
    if (value && !(*value >= least && *value < end)) return false;
  }
  return true;
}

}  // namespace

RecommendationRules ReadRecommendationRules(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw InputError(path + ": cannot be opened for reading");
  const std::string text(std::istreambuf_iterator<char>(file), {});
  const Json json = ParseJsonObject(text, path);
  const JsonField root(json, path);
  if (root["schema"].String() != kSchema) root["schema"].Mismatch(std::string("\"") + kSchema + "\"");
  RecommendationRules rules;
  rules.file = path;
  for (const JsonField& campaign : root["campaigns"].Items()) {
    rules.made_of += (rules.made_of.empty() ? "" : ", ") + ParseCampaign(campaign);
  }
  for (const JsonField& region : root["regions"].Items()) rules.regions.push_back(ParseRegion(region));
  if (rules.regions.empty()) root["regions"].Mismatch("one region or more");
  return rules;
}

const RecommendationRegion& FindRegion(const RecommendationRules& rules, const ProblemFeatures& features,
                                       double tolerance) {
  double tier = 0;
  double strictest = kInfinity;
  for (const RecommendationRegion& region : rules.regions) {
    if (region.tier <= tolerance * kSameTier) tier = std::max(tier, region.tier);
    strictest = std::min(strictest, region.tier);
  }
  if (tier == 0) tier = strictest;
  for (const RecommendationRegion& region : rules.regions) {
    if (region.tier == tier && Contains(region, features)) return region;
  }
  std::ostringstream text;
  text << rules.file << ": regions: expected one for tier " << tier << " and " << Describe(features).dump()
       << ", found none";
  throw InputError(text.str());
}

}  // namespace lcpbench
