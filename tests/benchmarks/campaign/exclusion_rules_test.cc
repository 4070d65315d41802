#include "benchmarks/campaign/exclusion_rules.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

namespace lcpbench {
namespace {

TEST(ExclusionRules, ALimitIsTheLargestSizeThatIsRunAndSaysWhy) {
  const std::vector<SizeLimit> limits = SizeLimits();
  EXPECT_FALSE(limits.empty());
  for (const SizeLimit& limit : limits) {
    SCOPED_TRACE(limit.solver);
    const SolverEntry& entry = FindSolver(limit.solver);
    EXPECT_FALSE(limit.reason.empty());
    EXPECT_EQ(SizeRefusal(entry, limit.largest), "");
    const std::string rule = SizeRefusal(entry, limit.largest + 1);
    EXPECT_NE(rule.find("not above n = " + std::to_string(limit.largest)), std::string::npos) << rule;
    EXPECT_NE(rule.find(limit.reason), std::string::npos) << rule;
  }
}

// Whoever wrote the solver.
TEST(ExclusionRules, SolversOfOneClassAreGivenTheSameSizes) {
  for (const SolverEntry& one : AllSolvers()) {
    for (const SolverEntry& other : AllSolvers()) {
      if (one.method_class != other.method_class) continue;
      for (const Index size : {1, 30, 31, 1000, 5000, 5001, 1'000'000}) {
        EXPECT_EQ(SizeRefusal(one, size), SizeRefusal(other, size)) << one.key << " " << other.key << " " << size;
      }
    }
  }
}

TEST(ExclusionRules, DenseCodesStopAtFiveThousandRowsExactArithmeticAtThirty) {
  for (const char* key : {"dantzig", "lemke", "ode-dantzig", "bullet-lemke", "dart-pgs-default", "siconos-avi"}) {
    EXPECT_EQ(SizeRefusal(FindSolver(key), 5000), "") << key;
    EXPECT_NE(SizeRefusal(FindSolver(key), 5001), "") << key;
  }
  EXPECT_EQ(SizeRefusal(FindSolver("cgal-qp"), 30), "");
  EXPECT_NE(SizeRefusal(FindSolver("cgal-qp"), 31), "");
  for (const char* key : {"auto", "pgs", "clp", "petsc-rsls", "siconos-nsgs-sbm"}) {
    EXPECT_EQ(SizeRefusal(FindSolver(key), 1'000'000), "") << key;
  }
}

TEST(ExclusionRules, AVariantIsOfItsBasesClass) {
  RegisterSolverVariant("dantzig-for-exclusion", "dantzig", {});
  EXPECT_NE(SizeRefusal(FindSolver("dantzig-for-exclusion"), 5001), "");
}

}  // namespace
}  // namespace lcpbench
