// The law of a campaign's files on the seed corpus and on seeded changes of it, for builds without libFuzzer.

#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

#include "model/scenes/random.h"
#include "tests/fuzz/corpus.h"
#include "tests/fuzz/laws.h"
#include "tests/fuzz/scene_mutation.h"

namespace lcpbench {
namespace {

TEST(JournalLaw, HoldsForTheCorpusAndItsChanges) {
  const std::vector<std::string> corpus = Corpus("journal_corpus");
  ASSERT_GE(corpus.size(), 5U);
  for (const std::string& text : corpus) EXPECT_EQ(BrokenJournalLaw(text), "") << text;
  constexpr int kChanges = 2000;  // each is a file
  std::mt19937 random(1);
  Random of_trees(1);
  for (int k = 0; k < kChanges; ++k) {
    const std::string& text = corpus[static_cast<size_t>(k) % corpus.size()];
    for (const std::string& changed : {ChangedBytes(text, corpus, &random), MutatedLine(text, &of_trees)}) {
      ASSERT_EQ(BrokenJournalLaw(changed), "") << changed;
    }
  }
}

}  // namespace
}  // namespace lcpbench
