// The law of the protocol's readers on recorded conversations and on seeded changes of them, for builds without
// libFuzzer.

#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

#include "tests/fuzz/binary_mutation.h"
#include "tests/fuzz/corpus.h"
#include "tests/fuzz/laws.h"

namespace lcpbench {
namespace {

TEST(ProtocolLaw, HoldsForTheCorpusAndItsChanges) {
  const std::vector<std::string> corpus = Corpus("protocol_corpus");
  ASSERT_GE(corpus.size(), 5U);
  for (size_t k = 0; k < corpus.size(); ++k) EXPECT_EQ(BrokenProtocolLaw(corpus[k]), "") << k;
  constexpr int kChanges = 20000;
  std::mt19937_64 random(1);
  std::mt19937 other(1);
  for (int k = 0; k < kChanges; ++k) {
    const std::string& bytes = corpus[static_cast<size_t>(k) % corpus.size()];
    ASSERT_EQ(BrokenProtocolLaw(OverwrittenBytes(bytes, &random)), "") << k;
    ASSERT_EQ(BrokenProtocolLaw(ChangedBytes(bytes, corpus, &other)), "") << k;
  }
}

}  // namespace
}  // namespace lcpbench
