#pragma once

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

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
  for (const auto& path : CorpusFiles(folder)) {
    std::stringstream bytes;
    bytes << std::ifstream(path, std::ios::binary).rdbuf();
    contents.push_back(bytes.str());
  }
  return contents;
}

}  // namespace lcpbench
