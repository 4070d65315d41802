// The table of what a tier means to each peer: its form, and that what it promises of passing still holds.

#include "solvers/peers/tier_settings.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>

#include "solvers/lcp/verify.h"
#include "solvers/peers/peer_table.h"
#include "tests/solvers/test_problems.h"

namespace lcpbench {
namespace {

TEST(TierSettings, EveryRowNamesATunedPeerOnceAndItsReason) {
  std::set<std::pair<std::string_view, std::string_view>> seen;
  for (const TierOption& row : TierTable()) {
    SCOPED_TRACE(std::string(row.key) + ", " + std::string(row.option));
    EXPECT_TRUE(std::any_of(AllPeers().begin(), AllPeers().end(),
                            [&](const PeerEntry& peer) { return peer.key == row.key && peer.uses_tolerance; }));
    EXPECT_FALSE(row.key.ends_with("-default"));
    EXPECT_FALSE(row.reason.empty());
    EXPECT_TRUE(seen.emplace(row.key, row.option).second);
  }
}

TEST(TierSettings, ATierIsReadFromItsColumnAndWhatLiesBetweenFromTheStricterOne) {
  for (const TierOption& row : TierTable()) {
    EXPECT_EQ(TierValue(row.key, row.option, 1e-3), row.values[0]);
    EXPECT_EQ(TierValue(row.key, row.option, 1e-6), row.values[1]);
    EXPECT_EQ(TierValue(row.key, row.option, 1e-9), row.values[2]);
    EXPECT_EQ(TierValue(row.key, row.option, 1e-2), row.values[0]);
    EXPECT_EQ(TierValue(row.key, row.option, 1e-4), row.values[1]);
    EXPECT_EQ(TierValue(row.key, row.option, 1e-7), row.values[2]);
    EXPECT_EQ(TierValue(row.key, row.option, 1e-12), row.values[2]);
  }
  EXPECT_THROW(TierValue("dart-pgs", "no such option", 1e-6), std::logic_error);
}

// Keys whose tuning reached the rule's 95 %.
class TunedPeer : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(ReachTheRule, TunedPeer,
                         testing::Values("dart-pgs", "clp", "siconos-pgs", "siconos-nsgs-sbm", "tao-bntr"));

TEST_P(TunedPeer, PassesEveryTierOnNearlyAllGeneratedProblems) {
  const auto peer = std::find_if(AllPeers().begin(), AllPeers().end(),
                                 [](const PeerEntry& entry) { return entry.key == GetParam(); });
  ASSERT_NE(peer, AllPeers().end());
  if (!peer->available) GTEST_SKIP() << peer->key << " is not in this build";
  const auto solver = MakePeer(*peer, {});
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
