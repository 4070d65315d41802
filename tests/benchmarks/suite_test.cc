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
    EXPECT_FALSE(problems.empty());
    EXPECT_LE(problems.size(), suite.families.size() * suite.sizes.size() * suite.seeds.size());
    std::set<std::string> ids;
    for (const SuiteProblem& problem : problems) ids.insert(problem.id);
    EXPECT_EQ(ids.size(), problems.size());
  }
}

TEST(Suite, EverySolverAndFamilyTakesPartInTheDefaultSuite) {
  const Suite suite = FindSuite("default");
  EXPECT_EQ(suite.solvers.size(), AllSolvers().size());
  EXPECT_EQ(suite.families.size(), AllScenes().size());
  EXPECT_GE(suite.families.size(), 16u);
  EXPECT_GE(suite.sizes.back(), 1000);
  // Every family up to 300 rows, at least seven at every size up to 1000.
  for (const int size : suite.sizes) {
    std::set<std::string> families;
    for (const SuiteProblem& problem : ProblemsOf(suite)) {
      if (problem.size == size) families.insert(problem.family);
    }
    if (size <= 300) {
      EXPECT_EQ(families.size(), suite.families.size()) << size;
    }
    if (size <= 1000) {
      EXPECT_GE(families.size(), 7u) << size;
    }
    EXPECT_FALSE(families.empty()) << size;
  }
}

TEST(Suite, SizeRulesTakeTheFirstSeedsAndTheNamedFamilies) {
  Suite suite = FindSuite("quick");
  suite.families = {"disc-pile", "rockers"};
  suite.sizes = {5, 20, 50};
  suite.seeds = {4, 7, 9};
  suite.size_rules = {{5, 2, {}, {}}, {20, 1, {"rockers"}, {}}};
  std::vector<std::string> ids;
  for (const SuiteProblem& problem : ProblemsOf(suite)) ids.push_back(problem.id);
  const std::vector<std::string> expected = {
      "disc-pile-n5-s4", "disc-pile-n5-s7", "disc-pile-n5-s9", "disc-pile-n20-s4", "disc-pile-n20-s7", "rockers-n5-s4",
      "rockers-n5-s7",   "rockers-n5-s9",   "rockers-n20-s4",  "rockers-n20-s7",   "rockers-n50-s4"};
  EXPECT_EQ(ids, expected);
}

TEST(Suite, TheTimeLimitGrowsWithTheProblemWithinItsBounds) {
  Suite suite = FindSuite("quick");
  suite.time_limit_s = 2;
  suite.time_limit_per_row_s = 0;
  EXPECT_EQ(TimeLimit(suite, 1), 2);
  suite.time_limit_per_row_s = 1e-3;
  EXPECT_EQ(TimeLimit(suite, 1), kLeastTimeLimit);
  EXPECT_EQ(TimeLimit(suite, 1500), 1.5);
  EXPECT_EQ(TimeLimit(suite, 5000), 2);
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

TEST(Suite, OwnSolversAreRunOnAllThatTheyAreMadeForInTheDefaultSuite) {
  const Suite suite = FindSuite("default");
  for (const SolverEntry& entry : AllSolvers()) {
    if (entry.origin != SolverOrigin::kOwn) continue;
    for (const int size : suite.sizes) {
      if (size > 1000) continue;
      for (const double tier : suite.tiers) EXPECT_EQ(ExclusionRule(suite, entry, size, tier), "") << entry.key;
    }
  }
}

TEST(Suite, ExclusionsAreByRuleAndEveryRuleSaysWhy) {
  Suite suite = FindSuite("default");
  for (const SizeLimit& limit : SizeLimits()) {
    EXPECT_FALSE(limit.reason.empty()) << limit.solver;
    EXPECT_GE(limit.largest, 10) << limit.solver;
    bool named = false;
    for (const SolverEntry& entry : AllSolvers()) named = named || entry.key.starts_with(limit.solver);
    EXPECT_TRUE(named) << limit.solver;
  }
  const std::string rule = ExclusionRule(suite, FindSolver("dantzig"), 1'000'000, 1e-9);
  EXPECT_NE(rule.find("not above n = "), std::string::npos);
  EXPECT_NE(rule.find("dense"), std::string::npos);
  // A key does not stand for others that begin alike, but for its variants.
  EXPECT_NE(ExclusionRule(suite, FindSolver("clp-default"), 1'000'000, 1e-6), "");
  EXPECT_EQ(ExclusionRule(suite, FindSolver("pgs"), 1'000'000, 1e-6), "");

  suite.size_rules = {{100, 1, {}, {1e-6}}};
  EXPECT_EQ(ExclusionRule(suite, FindSolver("pgs"), 101, 1e-6), "");
  EXPECT_NE(ExclusionRule(suite, FindSolver("pgs"), 101, 1e-3), "");
  EXPECT_EQ(ExclusionRule(suite, FindSolver("pgs"), 100, 1e-3), "");
  // A direct method's one run is judged at every tier.
  EXPECT_EQ(ExclusionRule(suite, FindSolver("dantzig"), 101, 1e-9), "");
}

TEST(Suite, TiersAreRunLoosestFirst) {
  Suite suite = FindSuite("quick");
  suite.tiers = {1e-9, 1e-3, 1e-6};
  EXPECT_EQ(TiersToRun(suite, FindSolver("pgs")), (std::vector<double>{1e-3, 1e-6, 1e-9}));
}

}  // namespace
}  // namespace lcpbench
