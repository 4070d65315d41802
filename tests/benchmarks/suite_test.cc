#include "benchmarks/suite.h"

#include <gtest/gtest.h>

#include <set>

#include "solvers/lcp/input_error.h"

namespace lcpbench {
namespace {

TEST(Suite, KnownSuitesAreValidAndTheirProblemsDistinct) {
  for (const char* name : {"default", "quick"}) {
    const Suite suite = FindSuite(name);
    EXPECT_NO_THROW(ValidateSuite(suite));
    const std::vector<SuiteProblem> problems = ProblemsOf(suite);
    EXPECT_EQ(problems.size(), suite.families.size() * suite.sizes.size() * suite.seeds.size());
    std::set<std::string> ids;
    for (const SuiteProblem& problem : problems) ids.insert(problem.id);
    EXPECT_EQ(ids.size(), problems.size());
  }
}

TEST(Suite, EverySolverAndFamilyTakesPartInTheDefaultSuite) {
  const Suite suite = FindSuite("default");
  EXPECT_EQ(suite.solvers.size(), AllSolvers().size());
  EXPECT_EQ(suite.families.size(), AllScenes().size());
  EXPECT_GE(suite.families.size(), 5u);
  EXPECT_GE(suite.sizes.back(), 1000);
}

TEST(Suite, WhatDoesNotFitIsRefused) {
  EXPECT_THROW(FindSuite("huge"), InputError);
  const auto refused = [](auto change) {
    Suite suite = FindSuite("quick");
    change(suite);
    EXPECT_THROW(ValidateSuite(suite), InputError);
  };
  refused([](Suite& s) { s.solvers = {"simplex"}; });
  refused([](Suite& s) { s.families = {"no-such-scene"}; });
  refused([](Suite& s) { s.sizes = {0}; });
  refused([](Suite& s) { s.tiers = {2.0}; });
  refused([](Suite& s) { s.seeds.clear(); });
  refused([](Suite& s) { s.time_limit_s = -1; });
  refused([](Suite& s) { s.repetitions = 0; });
}

TEST(Suite, DirectMethodsRunOnceAtTheStrictestTier) {
  const Suite suite = FindSuite("default");
  for (const SolverEntry& entry : AllSolvers()) {
    const std::vector<double> tiers = TiersToRun(suite, entry);
    if (entry.uses_tolerance) {
      EXPECT_EQ(tiers, suite.tiers);
    } else {
      EXPECT_EQ(tiers, std::vector<double>{1e-9});
    }
  }
}

TEST(Suite, ExclusionsAreByRuleAndNeverWithinTheDefaultSizes) {
  for (const SolverEntry& entry : AllSolvers()) {
    if (!entry.available) continue;
    for (const int size : FindSuite("default").sizes) EXPECT_EQ(ExclusionRule(entry, size, 1e-9), "");
  }
  EXPECT_NE(ExclusionRule(FindSolver("dantzig"), 1'000'000, 1e-9), "");
}

}  // namespace
}  // namespace lcpbench
