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

TEST(TierSettings, ATierIsReadFromItsColumnAndWhatLiesBetweenFromTheStricterOne) {
  for (const PeerEntry& peer : AllPeers()) {
    if (!peer.tiers) continue;
    EXPECT_FALSE(peer.has_library_defaults()) << peer.key;
    for (const auto& [tolerance, column] :
         {std::pair{1e-2, 0}, {1e-3, 0}, {1e-4, 1}, {1e-6, 1}, {1e-7, 2}, {1e-12, 2}}) {
      EXPECT_EQ(TierTolerance(peer.key, tolerance), peer.tiers->tolerances[static_cast<size_t>(column)]) << peer.key;
    }
  }
  EXPECT_THROW(TierTolerance("dart-dantzig", 1e-6), std::logic_error);
}

TEST(TierSettings, AStricterTierHasNoLooserTolerance) {
  for (const PeerEntry& peer : AllPeers()) {
    if (!peer.tiers) continue;
    const auto& [loose, usual, strict] = peer.tiers->tolerances;
    EXPECT_GE(loose, usual) << peer.key;
    EXPECT_GE(usual, strict) << peer.key;
    EXPECT_GT(strict, 0) << peer.key;
    EXPECT_GE(peer.tiers->most_iterations, 0) << peer.key;
  }
}

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
