// The reader's law on the seed corpus and on seeded changes of it, for builds without libFuzzer.

#include "tests/fuzz/fclib_law.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "solvers/io/fclib_file.h"
#include "tests/fuzz/hdf5_mutation.h"

namespace lcpbench {
namespace {

std::vector<std::filesystem::path> CorpusFiles() {
  std::vector<std::filesystem::path> paths;
  for (const auto& entry : std::filesystem::directory_iterator(LCPBENCH_SOURCE_DIR "/tests/fuzz/fclib_file_corpus")) {
    paths.push_back(entry.path());
  }
  std::sort(paths.begin(), paths.end());
  return paths;
}

std::vector<std::string> Corpus() {
  std::vector<std::string> files;
  for (const auto& path : CorpusFiles()) {
    std::ifstream file(path, std::ios::binary);
    std::stringstream bytes;
    bytes << file.rdbuf();
    files.push_back(bytes.str());
  }
  return files;
}

TEST(FclibLaw, TheCorpusIsOfFilesThatAreRead) {
  for (const auto& path : CorpusFiles()) EXPECT_NO_THROW(ReadFclibProblem(path.string())) << path;
}

TEST(FclibLaw, HoldsForTheCorpusAndItsChanges) {
  const std::vector<std::string> corpus = Corpus();
  ASSERT_GE(corpus.size(), 4U);
  for (size_t k = 0; k < corpus.size(); ++k) EXPECT_EQ(BrokenFclibLaw(corpus[k]), "") << k;
  constexpr int kChanges = 400;  // each is a process
  std::mt19937_64 random(1);
  for (int k = 0; k < kChanges; ++k) {
    const std::string bytes = OverwrittenBytes(corpus[static_cast<size_t>(k) % corpus.size()], &random);
    ASSERT_EQ(BrokenFclibLaw(bytes), "") << k;
  }
}

}  // namespace
}  // namespace lcpbench
