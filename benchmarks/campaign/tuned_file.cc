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
  root["schema"].Choice<bool>({{"lcpbench-tuned/1", true}});
  TunedFile file;
  file.source = {std::filesystem::path(path).filename().string(), TextHash(text),
                 root["budget"].IndexBelow(std::numeric_limits<int>::max())};
  for (const JsonField& solver : root["solvers"].Items()) {
    auto& [key, settings] = file.chosen.emplace_back();
    key = solver["solver"].String();
    for (const auto& [name, value] : solver["chosen"].Members()) settings[name] = value.String();
  }
  return file;
}

}  // namespace lcpbench
