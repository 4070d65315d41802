// The reader's law on the seed corpus and on seeded changes of it, for builds without libFuzzer.

#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

#include "solvers/io/fclib_file.h"
#include "tests/fuzz/binary_mutation.h"
#include "tests/fuzz/corpus.h"
#include "tests/fuzz/laws.h"

namespace lcpbench {
namespace {

constexpr char kFolder[] = "fclib_file_corpus";

TEST(FclibLaw, TheCorpusIsOfFilesThatAreRead) {
  for (const auto& path : CorpusFiles(kFolder)) EXPECT_NO_THROW(ReadFclibProblem(path.string())) << path;
}

TEST(FclibLaw, HoldsForTheCorpusAndItsChanges) {
  const std::vector<std::string> corpus = Corpus(kFolder);
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
