#include "solvers/io/file_ending.h"

#include <algorithm>
#include <filesystem>

namespace lcpbench {
namespace {

// Cuts the last ending off. @return it in small letters
std::string CutEnding(std::string* name) {
  std::string ending = std::filesystem::path(*name).extension().string();
  name->resize(name->size() - ending.size());
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  return ending;
}

}  // namespace

FileEnding EndingOf(const std::string& path) {
  FileEnding found{path, "", "", false};
  found.format = CutEnding(&found.stem);
  found.is_gzip = found.format == ".gz";
  if (found.is_gzip) found.format = CutEnding(&found.stem);
  found.ending = path.substr(found.stem.size());
  return found;
}

std::string IdOfFile(const std::string& path) { return std::filesystem::path(EndingOf(path).stem).filename().string(); }

}  // namespace lcpbench
