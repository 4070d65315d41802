#include <gtest/gtest.h>

#include <string>

#include "solvers/registry.h"

namespace lcpbench {
namespace {

TEST(SizeLimits, ALimitIsTheLargestSizeThatIsRunAndSaysWhy) {
  for (const SolverEntry& entry : AllSolvers()) {
    SCOPED_TRACE(entry.key);
    const std::optional<SizeLimit> limit = SizeLimitOf(entry.method_class);
    EXPECT_EQ(SizeRefusal(entry, limit ? limit->largest : 1'000'000), "");
    if (!limit) continue;
    const std::string rule = SizeRefusal(entry, limit->largest + 1);
    EXPECT_EQ(rule, "not above n = " + std::to_string(limit->largest) + ": " + std::string(limit->reason));
  }
}

TEST(SizeLimits, DenseCodesStopAtFiveThousandRowsExactArithmeticAtThirty) {
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

TEST(SizeLimits, AVariantIsOfItsBasesClass) {
  RegisterSolverVariant("dantzig-for-exclusion", "dantzig", {});
  EXPECT_NE(SizeRefusal(FindSolver("dantzig-for-exclusion"), 5001), "");
}

}  // namespace
}  // namespace lcpbench
