#include "benchmarks/exclusion_rules.h"

#include <gtest/gtest.h>

namespace lcpbench {
namespace {

TEST(ExclusionRules, EveryLimitNamesASolverAndSaysWhy) {
  for (const SizeLimit& limit : SizeLimits()) {
    EXPECT_FALSE(limit.reason.empty()) << limit.solver;
    EXPECT_GE(limit.largest, 10) << limit.solver;
    bool named = false;
    for (const SolverEntry& entry : AllSolvers()) named = named || entry.key.starts_with(limit.solver);
    EXPECT_TRUE(named) << limit.solver;
  }
  const std::string rule = SizeRefusal(FindSolver("dantzig"), 1'000'000);
  EXPECT_NE(rule.find("not above n = "), std::string::npos) << rule;
  EXPECT_NE(rule.find("dense"), std::string::npos) << rule;
}

TEST(ExclusionRules, ALimitIsTheLargestSizeThatIsRun) {
  for (const SizeLimit& limit : SizeLimits()) {
    for (const SolverEntry& entry : AllSolvers()) {
      if (entry.key != limit.solver) continue;
      EXPECT_EQ(SizeRefusal(entry, limit.largest), "") << entry.key;
      EXPECT_NE(SizeRefusal(entry, limit.largest + 1), "") << entry.key;
    }
  }
}

TEST(ExclusionRules, AKeyStandsForItsVariantsAndNotForOthersThatBeginAlike) {
  EXPECT_NE(SizeRefusal(FindSolver("clp-default"), 1'000'000), "");
  EXPECT_EQ(SizeRefusal(FindSolver("pgs"), 1'000'000), "");
  SolverEntry variant = FindSolver("pgs");
  variant.key = "dantzigs";
  EXPECT_EQ(SizeRefusal(variant, 1'000'000), "");
  variant.key = "mine";
  variant.base = "dantzig";
  EXPECT_NE(SizeRefusal(variant, 1'000'000), "");
}

TEST(ExclusionRules, OwnSolversAreGivenEverythingUpToAThousandRows) {
  for (const SolverEntry& entry : AllSolvers()) {
    if (entry.origin != SolverOrigin::kOwn) continue;
    EXPECT_EQ(SizeRefusal(entry, 1000), "") << entry.key;
  }
}

}  // namespace
}  // namespace lcpbench
