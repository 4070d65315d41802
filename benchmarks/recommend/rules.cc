#include "benchmarks/recommend/rules.h"

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>
#include <vector>

#include "solvers/linear_algebra/islands.h"
#include "solvers/registry.h"
#include "support/input_error.h"
#include "support/json_field.h"
#include "support/text_file.h"

namespace lcpbench {
namespace {

constexpr NamedFeature kFeatures[] = {
    {"rows", &ProblemFeatures::rows},
    {"bilateral", &ProblemFeatures::bilateral},
    {"couplings", &ProblemFeatures::couplings},
    {"diagonal_spread", &ProblemFeatures::diagonal_spread},
    {"islands", &ProblemFeatures::islands},
    {"largest_island", &ProblemFeatures::largest_island},
    {"mass_spread", &ProblemFeatures::mass_spread},
    {"redundancy", &ProblemFeatures::redundancy},
};

// A column of J counts in a row where it contributes more than this to the diagonal entry of A: a normal through the
// centre of mass leaves an arm of rounding errors.
constexpr double kCarriesShare = 1e-20;

constexpr Index kBodyColumns = 3;

template <typename Values>
double SpreadOf(const Values& values) {
  double least = std::numeric_limits<double>::infinity();
  double most = 0;
  for (const double value : values) {
    if (value <= 0) continue;
    least = std::min(least, value);
    most = std::max(most, value);
  }
  return most > 0 ? most / least : 1;
}

void MeasureFactors(const LcpProblem& problem, const Islands& islands, ProblemFeatures* features) {
  const SparseMatrix& J = problem.J();
  const Eigen::VectorXd& inverse_mass = problem.inverse_mass();
  const Eigen::VectorXd& D = problem.DiagonalA();
  std::vector<bool> seen(static_cast<size_t>(J.cols()), false);
  std::vector<double> masses;
  Index redundant = 0;
  for (Index island = 0; island < islands.count(); ++island) {
    auto surplus = static_cast<Index>(islands.rows(island).size());  // rows without columns of their own
    for (const Index row : islands.rows(island)) {
      for (SparseMatrix::InnerIterator entry(J, row); entry; ++entry) {
        const Index column = entry.col();
        const double contributes = entry.value() * entry.value() * inverse_mass[column];
        if (seen[static_cast<size_t>(column)] || !(contributes > kCarriesShare * D[row])) continue;
        seen[static_cast<size_t>(column)] = true;
        --surplus;
        // The first two columns of a body are its centre of mass, the third one is its turning.
        if (column % kBodyColumns != kBodyColumns - 1) masses.push_back(1 / inverse_mass[column]);
      }
    }
    redundant += std::max<Index>(0, surplus);
  }
  features->redundancy = static_cast<double>(redundant) / static_cast<double>(J.rows());
  if (!masses.empty()) features->mass_spread = SpreadOf(masses);
}

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

ProblemFeatures MeasureFeatures(const LcpProblem& problem) {
  ProblemFeatures features;
  const auto n = static_cast<double>(problem.size());
  features.rows = n;
  if (n == 0) return features;
  features.bilateral = static_cast<double>(problem.bilateral_rows().size()) / n;
  const SparseMatrix& A = problem.SparseA();
  features.couplings = static_cast<double>(A.nonZeros()) / n;
  features.diagonal_spread = SpreadOf(problem.DiagonalA());
  Islands islands;
  islands.Find(A, std::vector<char>(static_cast<size_t>(problem.size()), 1));
  features.islands = static_cast<double>(islands.count());
  features.largest_island = static_cast<double>(islands.largest()) / n;
  if (problem.has_factors()) {
    MeasureFactors(problem, islands, &features);
  } else if (problem.facts().rank) {
    features.redundancy = 1 - static_cast<double>(*problem.facts().rank) / n;
  }
  return features;
}

std::span<const NamedFeature> AllFeatures() { return kFeatures; }

nlohmann::ordered_json Describe(const ProblemFeatures& features) {
  nlohmann::ordered_json json;
  for (const NamedFeature& feature : kFeatures) {
    const std::optional<double> value = features.*feature.value;
    json[feature.name] = value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json(nullptr);
  }
  return json;
}

RecommendationRules ReadRecommendationRules(const std::string& path) {
  const Json json = ParseJsonObject(ReadTextFile(path), path);
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
