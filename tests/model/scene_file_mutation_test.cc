// The fuzz target's laws (tests/fuzz) on seeded mutations of the examples, so that every compiler and every test run
// tries some: bytes changed, and values of the JSON tree replaced, removed, copied and renamed.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "model/scenes/random.h"
#include "tests/fuzz/scene_laws.h"
#include "tests/fuzz/scene_mutation.h"

namespace lcpbench {
namespace {

std::vector<std::string> Seeds() {
  std::vector<std::string> texts;
  for (const char* folder : {LCPBENCH_SOURCE_DIR "/data/scenes", LCPBENCH_SOURCE_DIR "/tests/fuzz/corpus"}) {
    std::vector<std::filesystem::path> paths;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
      if (entry.path().filename() != "scene.schema.json") paths.push_back(entry.path());
    }
    // Directories are listed in any order.
    std::sort(paths.begin(), paths.end());
    for (const auto& path : paths) {
      std::ostringstream text;
      text << std::ifstream(path).rdbuf();
      texts.push_back(text.str());
    }
  }
  return texts;
}

TEST(SceneFileMutations, GiveAValidWorldOrOneLineOfError) {
  const std::vector<std::string> seeds = Seeds();
  ASSERT_GE(seeds.size(), 8U);
  Random random(1);
  constexpr int kRounds = 4000;
  for (int round = 0; round < kRounds; ++round) {
    const std::string& seed = seeds[Below(seeds.size(), &random)];
    const bool tree = random.Uniform() < 0.8;
    const std::string text = tree ? MutatedTree(seed, &random) : MutatedBytes(seed, &random);
    std::string broken;
    EXPECT_NO_THROW(broken = BrokenSceneLaw(text)) << text;
    EXPECT_EQ(broken, "") << text;
    if (HasFailure()) return;
  }
}

}  // namespace
}  // namespace lcpbench
