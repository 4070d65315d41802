#include "benchmarks/campaign/tuned_file.h"

#include <filesystem>
#include <limits>

#include "benchmarks/collection/content_hash.h"
#include "support/json_field.h"
#include "support/text_file.h"

namespace lcpbench {

TunedFile ReadTunedFile(const std::string& path) {
  const std::string text = ReadTextFile(path);
  const nlohmann::json json = ParseJsonObject(text, path);
  const JsonField root(json, path);
  root["schema"].Choice<bool>({{"lcpbench-tuned/2", true}});
  TunedFile file;
  file.source = {std::filesystem::path(path).filename().string(), TextHash(text),
                 root["budget"].IndexBelow(std::numeric_limits<int>::max())};
  for (const JsonField& choice : root["solvers"].Items()) {
    const Index rows = choice["rows"].IndexBelow(std::numeric_limits<int>::max());
    if (rows == 0) choice["rows"].Mismatch("an integer >= 1");
    const auto [settings, is_new] = file.chosen[choice["solver"].String()].try_emplace(rows);
    if (!is_new) choice["rows"].Mismatch("other rows than before");
    for (const auto& [name, value] : choice["chosen"].Members()) settings->second[name] = value.String();
  }
  return file;
}

std::map<std::string, std::vector<std::string>> ReadPortfolio(const std::string& path) {
  const nlohmann::json json = ParseJsonObject(ReadTextFile(path), path);
  const JsonField root(json, path);
  root["schema"].Choice<bool>({{"lcpbench-portfolio/1", true}});
  std::map<std::string, std::vector<std::string>> classes;
  for (const auto& [size_class, keys] : root["classes"].Members()) {
    for (const JsonField& key : keys.Items()) classes[size_class].push_back(key.String());
  }
  return classes;
}

}  // namespace lcpbench
