// Which problems a campaign has, in what order, and what each of them counts.

#include "benchmarks/campaign/campaign_plan.h"

#include <gtest/gtest.h>

#include <map>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "benchmarks/collection/manifest.h"
#include "benchmarks/collection/plan.h"

namespace lcpbench {
namespace {

constexpr const char* kOrigins[] = {"placed", "motion", "recorded", "literature"};

ManifestEntry Entry(const std::string& id, const std::string& base, const std::string& origin, Index rows, bool fill) {
  ManifestEntry entry;
  entry.id = id;
  entry.base = base;
  entry.origin = origin;
  entry.fill = fill;
  entry.properties.rows = rows;
  return entry;
}

// Origins of very different numbers of problems, some of which share a base.
std::vector<Manifest> RandomManifests(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<Manifest> manifests(2);
  manifests[0].name = "standard";
  manifests[1].name = kNonsymmetricTier;
  int number = 0;
  for (const char* origin : kOrigins) {
    const int bases = 1 + static_cast<int>(random() % 20);
    for (int b = 0; b < bases; ++b) {
      const std::string base = std::string(origin) + std::to_string(b);
      const int variants = 1 + static_cast<int>(random() % 5);
      for (int v = 0; v < variants; ++v) {
        const Index rows = 1 + static_cast<Index>(random() % 60);
        manifests[0].problems.push_back(Entry("p" + std::to_string(number++), base, origin, rows, false));
      }
    }
  }
  for (int k = 0; k < 30; ++k) {
    const std::string id = "fill" + std::to_string(k);
    manifests[0].fill.push_back(Entry(id, id, "placed", 1 + static_cast<Index>(random() % 60), true));
    const std::string hard = "hard" + std::to_string(k);
    manifests[1].problems.push_back(Entry(hard, hard, "placed", 8, false));
  }
  return manifests;
}

class CampaignProblems : public testing::TestWithParam<int> {};

TEST_P(CampaignProblems, OfASizeClassWeighTheSameByOrigin) {
  const std::vector<Manifest> manifests = RandomManifests(static_cast<std::uint64_t>(GetParam()));
  const std::vector<PlannedProblem> problems = PlanProblems({}, manifests);
  std::map<std::string, double> variants;
  for (const PlannedProblem& problem : problems) variants[problem.entry->base] += 1;
  std::map<const SizeClass*, std::map<std::string, double>> weight;
  std::map<const SizeClass*, double> bases;
  for (const PlannedProblem& problem : problems) {
    if (problem.manifest == 1) {
      EXPECT_EQ(problem.weight, 1) << problem.entry->id;
      continue;
    }
    weight[problem.size_class][problem.entry->origin] += problem.weight;
    bases[problem.size_class] += 1 / variants[problem.entry->base];
  }
  for (const auto& [size_class, by_origin] : weight) {
    for (const auto& [origin, sum] : by_origin) {
      EXPECT_NEAR(sum * static_cast<double>(by_origin.size()), bases[size_class], 1e-12 * bases[size_class])
          << size_class->key << " " << origin;
    }
  }
}

TEST_P(CampaignProblems, ComeByTurnsOfTheOrigins) {
  const std::vector<Manifest> manifests = RandomManifests(static_cast<std::uint64_t>(GetParam()));
  const std::vector<PlannedProblem> problems = PlanProblems({}, manifests);
  std::map<const SizeClass*, std::map<std::string, int>> left;
  for (const PlannedProblem& problem : problems) {
    if (!problem.entry->fill) ++left[problem.size_class][problem.entry->origin];
  }
  // Between two problems of one origin there is one of every other that has not run out.
  std::map<const SizeClass*, std::set<std::string>> round;
  for (const PlannedProblem& problem : problems) {
    if (problem.entry->fill) continue;
    auto& seen = round[problem.size_class];
    auto& of_class = left[problem.size_class];
    if (seen.contains(problem.entry->origin)) {
      for (const auto& [origin, count] : of_class) EXPECT_TRUE(count == 0 || seen.contains(origin)) << origin;
      seen.clear();
    }
    seen.insert(problem.entry->origin);
    --of_class[problem.entry->origin];
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, CampaignProblems, testing::Range(1, 21));

}  // namespace
}  // namespace lcpbench
