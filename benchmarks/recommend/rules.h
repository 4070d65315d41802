#pragma once

#include <string>
#include <vector>

#include "benchmarks/recommend/features.h"

namespace lcpbench {

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
