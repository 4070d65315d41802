// The fuzz target's laws (tests/fuzz) on seeded mutations of the examples, so that every compiler and every test run
// tries some: bytes changed, and values of the JSON tree replaced, removed, copied and renamed.

#include <gtest/gtest.h>

#include <random>
#include <string>
#include <utility>
#include <vector>

#include "model/scenes/random.h"
#include "tests/fuzz/corpus.h"
#include "tests/fuzz/laws.h"
#include "tests/fuzz/scene_mutation.h"

namespace lcpbench {
namespace {

TEST(SceneFileMutations, GiveAValidWorldOrOneLineOfError) {
  std::vector<std::string> seeds = Corpus("corpus");
  for (std::string& scene : Corpus("../../data/scenes")) seeds.push_back(std::move(scene));
  ASSERT_GE(seeds.size(), 8U);
  Random random(1);
  std::mt19937 bytes(1);
  constexpr int kRounds = 4000;
  for (int round = 0; round < kRounds; ++round) {
    const std::string& seed = seeds[Below(seeds.size(), &random)];
    const bool tree = random.Uniform() < 0.8;
    const std::string text = tree ? MutatedTree(seed, &random) : ChangedBytes(seed, seeds, &bytes);
    std::string broken;
    EXPECT_NO_THROW(broken = BrokenSceneLaw(text)) << text;
    EXPECT_EQ(broken, "") << text;
    if (HasFailure()) return;
  }
}

}  // namespace
}  // namespace lcpbench
