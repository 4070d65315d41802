#pragma once

#include "tests/support/refusal.h"

namespace lcpbench {

/// The seeds of a fuzzer, in the order of their names.
inline std::vector<std::filesystem::path> CorpusFiles(const std::string& folder) {
  const std::filesystem::directory_iterator files(LCPBENCH_SOURCE_DIR "/tests/fuzz/" + folder);
  std::vector<std::filesystem::path> paths(begin(files), end(files));
  std::sort(paths.begin(), paths.end());
  return paths;
}

inline std::vector<std::string> Corpus(const std::string& folder) {
  std::vector<std::string> contents;
  for (const auto& path : CorpusFiles(folder)) contents.push_back(ReadFile(path));
  return contents;
}

/// Bytes changed, cut out, doubled, and pieces of another text put in.
inline std::string ChangedBytes(std::string text, const std::vector<std::string>& corpus, std::mt19937* random) {
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

/// The law (laws.h) holds for the seeds, and for so many changes(seed, corpus) of them: for builds without libFuzzer.
template <typename Changes>
void ExpectLawHolds(std::string (*broken)(const std::string&), const std::string& folder, int count, Changes changes) {
  const std::vector<std::string> corpus = Corpus(folder);
  ASSERT_GE(corpus.size(), 4U);
  for (const std::string& seed : corpus) EXPECT_EQ(broken(seed), "") << seed;
  for (int k = 0; k < count; ++k) {
    for (const std::string& changed : changes(corpus[static_cast<size_t>(k) % corpus.size()], corpus)) {
      ASSERT_EQ(broken(changed), "") << k << ": " << changed;
    }
  }
}

/// Changes a text's bytes by ChangedBytes.
inline auto ChangesOfText() {
  return [random = std::mt19937(1)](const std::string& text, const std::vector<std::string>& corpus) mutable {
    return std::vector<std::string>{ChangedBytes(text, corpus, &random)};
  };
}

}  // namespace lcpbench
