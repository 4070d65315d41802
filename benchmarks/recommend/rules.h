#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "solvers/lcp/problem.h"

namespace lcpbench {

/// What can be said of a problem before it is solved, at the cost of forming A once; nothing where it is not known.
/// Which of it matters for the choice of a solver the reference results say (RecommendationRules).
struct ProblemFeatures {
  std::optional<double> rows;
  std::optional<double> bilateral;        ///< share of the rows
  std::optional<double> couplings;        ///< stored entries of A per row
  std::optional<double> diagonal_spread;  ///< largest over smallest of the positive diagonal entries of A
  std::optional<double> islands;          ///< sets of rows without any coupling between them
  std::optional<double> largest_island;   ///< share of the rows
  /// Of the movable bodies that the rows touch: largest over smallest mass. Not known without the factors of A.
  std::optional<double> mass_spread;
  /// Share of the rows that depend on others for sure: in every island rows beyond the columns of J that can move and
  /// carry more than rounding. Not known without the factors of A, unless the problem says its rank.
  std::optional<double> redundancy;
};

/// O(entries of A), plus what forming A costs.
ProblemFeatures MeasureFeatures(const LcpProblem& problem);

/// A feature by its name, as the member is called.
struct NamedFeature {
  const char* name;
  std::optional<double> ProblemFeatures::*value;
};
std::span<const NamedFeature> AllFeatures();

/// A member per feature, null where it is not known.
nlohmann::ordered_json Describe(const ProblemFeatures& features);

/// How a solver did on the reference problems of a region.
struct ReferenceRecord {
  std::string solver;
  double verified = 0;  ///< share of the problems
  double within = 0;    ///< share on which it was verified within 1.3 x the time of the best
};

/// A part of the space of features, at one tier, and which solvers are worth trying there.
struct RecommendationRegion {
  double tier = 0;
  struct Range {
    NamedFeature feature;
    double least = 0;
    double end = 0;  ///< less than this; may be infinite
  };
  std::vector<Range> where;
  int problems = 0;                      ///< reference problems there
  std::vector<std::string> candidates;   ///< registry keys, the most useful first
  std::vector<std::string> peers;        ///< the same, of other projects' solvers
  std::vector<ReferenceRecord> solvers;  ///< all own ones, best first
};

/// What data/recommendation.json says (RESULTS.md), made by report/report.py recommendation from campaigns.
struct RecommendationRules {
  std::string file;
  std::string made_of;  ///< the campaigns, with commit and processor, in words
  std::vector<RecommendationRegion> regions;
};

/// @throws InputError naming the file and the field, and what was expected
RecommendationRules ReadRecommendationRules(const std::string& path);

/// The first region that the features lie in, among those of the loosest tier that is no looser than `tolerance`, or of
/// the strictest tier. What is not known of a problem excludes no region.
/// @throws InputError naming the rules' file where there is none
const RecommendationRegion& FindRegion(const RecommendationRules& rules, const ProblemFeatures& features,
                                       double tolerance);

}  // namespace lcpbench
