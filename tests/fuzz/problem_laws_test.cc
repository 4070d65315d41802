// The readers' laws on the seed corpus and on seeded changes of it, for builds without libFuzzer.

#include "tests/fuzz/problem_laws.h"

#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

#include "tests/fuzz/corpus.h"

namespace lcpbench {
namespace {

// Bytes changed, cut out, doubled, and pieces of another text put in.
std::string Changed(std::string text, const std::vector<std::string>& corpus, std::mt19937* random) {
  const auto below = [random](size_t n) { return n == 0 ? size_t{0} : (*random)() % n; };
  constexpr char kBytes[] = "0123456789-+.eE/%,:[]{}\" \n\r\tnaif";
  for (size_t changes = 1 + below(4); changes > 0; --changes) {
    const size_t at = below(text.size() + 1);
    switch (below(5)) {
      case 0:
        if (at < text.size()) text[at] = static_cast<char>((*random)());
        break;
      case 1:
        text.insert(at, 1, kBytes[below(sizeof kBytes - 1)]);
        break;
      case 2:
        text.erase(at, 1 + below(8));
        break;
      case 3:
        text.insert(at, text.substr(below(text.size() + 1), below(24)));
        break;
      default: {
        const std::string& other = corpus[below(corpus.size())];
        text.insert(at, other.substr(below(other.size() + 1), below(24)));
        break;
      }
    }
  }
  return text;
}

struct Reader {
  const char* corpus;
  std::string (*law)(const std::string& text);
};

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
    const std::string text = Changed(corpus[static_cast<size_t>(k) % corpus.size()], corpus, &random);
    ASSERT_EQ(GetParam().law(text), "") << text;
  }
}

}  // namespace
}  // namespace lcpbench
