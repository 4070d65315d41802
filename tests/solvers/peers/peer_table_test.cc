// What a tier means to each peer: how the table is read, and that what it promises of passing still holds.

#include "solvers/peers/peer_table.h"

#include <gtest/gtest.h>

#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "solvers/lcp/verify.h"
#include "solvers/registry.h"
#include "tests/solvers/solve_with.h"
#include "tests/solvers/test_problems.h"

namespace lcpbench {
namespace {

TEST(SolversOfThisBuild, AreAllOfThem) {
  std::string missing;
  for (const SolverEntry& entry : AllSolvers()) {
    if (entry.origin == SolverOrigin::kOwn && !entry.available) missing += ", " + entry.key;
  }
  std::set<std::string_view> told;  // libraries
  for (const PeerEntry& peer : AllPeers()) {
    if (FindSolver(peer.key).available) told.insert(peer.project.library);
  }
  for (const PeerEntry& peer : AllPeers()) {
    const std::string_view library = peer.project.library;
    if (told.insert(library).second) missing += ", " + std::string(library);
  }
  if (!missing.empty()) GTEST_SKIP() << "not in this build: " << missing.substr(2);
}

// Keys whose tuning reached the rule's 95 %.
std::vector<std::string> TunedKeys() {
  std::vector<std::string> keys = {"dart-pgs",      "clp",         "siconos-pgs",    "siconos-nsgs-sbm", "tao-bntr",
                                   "bullet-si",     "mujoco-pgs",  "alglib-quickqp", "simbody-pgs",      "siconos-cpg",
                                   "proxqp-primal", "osqp-primal", "highs-primal"};
  std::erase_if(keys, [](const std::string& key) { return !FindSolver(key).available; });
  return keys;
}

class TunedPeer : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(ReachTheRule, TunedPeer, testing::ValuesIn(TunedKeys()));
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(TunedPeer);

TEST_P(TunedPeer, PassesEveryTierOnNearlyAllGeneratedProblems) {
  const auto solver = MakeSolver(GetParam());
  for (const double tier : kTiers) {
    int taken = 0;
    int passed = 0;
    for (const TestProblem& test : GeneratedProblems()) {
      const LcpResult result = SolveWith(solver.get(), test.problem, {.tolerance = tier, .time_limit_s = 2});
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
