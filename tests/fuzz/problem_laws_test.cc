// The readers' laws on the seed corpus and on seeded changes of it, for builds without libFuzzer.

#include "tests/fuzz/laws.h"

#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

#include "tests/fuzz/corpus.h"

namespace lcpbench {
namespace {

struct Reader {
  const char* corpus;
  std::string (*law)(const std::string& text);
};

std::ostream& operator<<(std::ostream& out, const Reader& reader) { return out << reader.corpus; }

class ProblemLaws : public testing::TestWithParam<Reader> {};

INSTANTIATE_TEST_SUITE_P(Formats, ProblemLaws,
                         testing::Values(Reader{"json_lines_corpus", BrokenJsonLineLaw},
                                         Reader{"matrix_market_corpus", BrokenMatrixMarketLaw},
                                         Reader{"siconos_text_corpus", BrokenSiconosLaw}),
                         [](const auto& test) { return std::string(test.param.corpus); });

TEST_P(ProblemLaws, HoldForTheCorpusAndItsChanges) {
  const std::vector<std::string> corpus = Corpus(GetParam().corpus);
  ASSERT_GE(corpus.size(), 5U);
  for (const std::string& text : corpus) EXPECT_EQ(GetParam().law(text), "") << text;
  constexpr int kChanges = 20000;
  std::mt19937 random(1);
  for (int k = 0; k < kChanges; ++k) {
    const std::string text = ChangedBytes(corpus[static_cast<size_t>(k) % corpus.size()], corpus, &random);
    ASSERT_EQ(GetParam().law(text), "") << text;
  }
}

}  // namespace
}  // namespace lcpbench
