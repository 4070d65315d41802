// What a tier means to each peer: how the table is read, and that what it promises of passing still holds.

#include "solvers/peers/peer_table.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "solvers/lcp/verify.h"
#include "solvers/registry.h"
#include "tests/solvers/test_problems.h"

namespace lcpbench {
namespace {

// Keys whose tuning reached the rule's 95 %.
class TunedPeer : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(ReachTheRule, TunedPeer,
                         testing::Values("dart-pgs", "clp", "siconos-pgs", "siconos-nsgs-sbm", "tao-bntr", "bullet-si",
                                         "mujoco-pgs", "alglib-quickqp", "simbody-pgs", "siconos-cpg", "proxqp-primal",
                                         "osqp-primal", "highs-primal"));

TEST_P(TunedPeer, PassesEveryTierOnNearlyAllGeneratedProblems) {
  if (!FindSolver(GetParam()).available) GTEST_SKIP() << GetParam() << " is not in this build";
  const auto solver = MakeSolver(GetParam());
  for (const double tier : kTiers) {
    int taken = 0;
    int passed = 0;
    for (const TestProblem& test : GeneratedProblems()) {
      LcpOptions options;
      options.tolerance = tier;
      options.time_limit_s = 2;
      LcpResult result;
      solver->Solve(test.problem, options, &result);
      if (result.status == LcpStatus::kUnsupported) continue;
      ++taken;
      if (Verify(test.problem, result, tier).passes) ++passed;
    }
    EXPECT_GE(passed, 0.95 * taken) << "tier " << tier;
    EXPECT_GT(taken, 0);
  }
}

}  // namespace
}  // namespace lcpbench
