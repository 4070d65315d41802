#include "benchmarks/recommend/rules.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>

#include "solvers/registry.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

using Json = nlohmann::json;

constexpr const char* kSchema = "lcpbench-recommendation/1";
// Tiers are equal that were written as the same number.
constexpr double kSameTier = 1 + 1e-6;

// A JSON value with the place it was found at, for messages.
class Field {
 public:
  Field(const Json& json, std::string place) : json_(json), place_(std::move(place)) {}

  Field At(const std::string& name) const {
    if (!json_.is_object() || !json_.contains(name)) Refuse("an object with the member '" + name + "'");
    return {json_.at(name), place_ + "/" + name};
  }
  std::vector<Field> Elements() const {
    if (!json_.is_array()) Refuse("a list");
    std::vector<Field> elements;
    for (size_t k = 0; k < json_.size(); ++k) elements.emplace_back(json_.at(k), place_ + "/" + std::to_string(k));
    return elements;
  }
  std::map<std::string, Field> Members() const {
    if (!json_.is_object()) Refuse("an object");
    std::map<std::string, Field> members;
    for (const auto& [name, value] : json_.items()) members.emplace(name, Field(value, place_ + "/" + name));
    return members;
  }
  std::string Text() const {
    if (!json_.is_string()) Refuse("a text");
    return json_.get<std::string>();
  }
  double Number(double least, double most) const {
    const auto text = [](double value) { return Json(value).dump(); };
    if (!json_.is_number()) Refuse("a number");
    const auto value = json_.get<double>();
    if (!(value >= least && value <= most)) Refuse("a number of " + text(least) + " to " + text(most));
    return value;
  }
  double Share() const { return Number(0, 1); }
  // Without an upper end, null.
  double End() const {
    if (json_.is_null()) return std::numeric_limits<double>::infinity();
    if (!json_.is_number()) Refuse("a number or null");
    return json_.get<double>();
  }
  std::string SolverKey() const {
    std::string key = Text();
    const auto all = AllSolvers();
    const bool known = std::any_of(all.begin(), all.end(), [&](const SolverEntry& entry) { return entry.key == key; });
    if (!known) Refuse("the key of a solver");
    return key;
  }
  std::vector<std::string> SolverKeys() const {
    std::vector<std::string> keys;
    for (const Field& element : Elements()) keys.push_back(element.SolverKey());
    return keys;
  }
  [[noreturn]] void Refuse(const std::string& expected) const {
    constexpr size_t kLongest = 60;
    std::string found = json_.dump(-1, ' ', false, Json::error_handler_t::replace);
    if (found.size() > kLongest) found = found.substr(0, kLongest) + "...";
    throw InputError(place_ + ": expected " + expected + ", found " + found);
  }

 private:
  const Json& json_;
  std::string place_;
};

RecommendationRegion ParseRegion(const Field& field) {
  RecommendationRegion region;
  region.tier = field.At("tier").Number(std::numeric_limits<double>::min(), 1);
  for (const auto& [name, ends] : field.At("where").Members()) {
    const auto& names = FeatureNames();
    if (std::find(names.begin(), names.end(), name) == names.end()) ends.Refuse("a feature's name, not '" + name + "'");
    const std::vector<Field> pair = ends.Elements();
    if (pair.size() != 2) ends.Refuse("two numbers, the second may be null");
    region.where[name] = {pair[0].End(), pair[1].End()};
  }
  region.problems = static_cast<int>(field.At("problems").Number(0, 1e9));
  region.candidates = field.At("candidates").SolverKeys();
  if (region.candidates.empty()) field.At("candidates").Refuse("one solver or more");
  region.peers = field.At("peers").SolverKeys();
  for (const Field& solver : field.At("solvers").Elements()) {
    region.solvers.push_back(
        {solver.At("solver").SolverKey(), solver.At("verified").Share(), solver.At("within").Share()});
  }
  return region;
}

std::string ParseCampaign(const Field& field) {
  constexpr size_t kShortHash = 12;
  return field.At("name").Text() + " (commit " + field.At("commit").Text().substr(0, kShortHash) + ", " +
         field.At("cpu").Text() + ")";
}

bool Contains(const RecommendationRegion& region, const ProblemFeatures& features) {
  for (const auto& [name, ends] : region.where) {
    const std::optional<double> value = FeatureNamed(features, name);
    if (value && !(*value >= ends.first && *value < ends.second)) return false;
  }
  return true;
}

}  // namespace

RecommendationRules ReadRecommendationRules(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw InputError(path + ": cannot be opened for reading");
  const std::string text(std::istreambuf_iterator<char>(file), {});
  Json json;
  try {
    json = Json::parse(text);
  } catch (const Json::exception& error) {
    throw InputError(path + ": expected the JSON that report/report.py recommendation writes, found " + error.what());
  }
  const Field root(json, path + ": ");
  const Field schema = root.At("schema");
  if (schema.Text() != kSchema) schema.Refuse(std::string("\"") + kSchema + "\"");
  RecommendationRules rules;
  rules.file = path;
  for (const Field& campaign : root.At("campaigns").Elements()) {
    rules.made_of += (rules.made_of.empty() ? "" : ", ") + ParseCampaign(campaign);
  }
  for (const Field& region : root.At("regions").Elements()) rules.regions.push_back(ParseRegion(region));
  if (rules.regions.empty()) root.At("regions").Refuse("one region or more");
  return rules;
}

const RecommendationRegion& FindRegion(const RecommendationRules& rules, const ProblemFeatures& features,
                                       double tolerance) {
  double tier = 0;
  double strictest = std::numeric_limits<double>::infinity();
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
