#include "benchmarks/command/settings_option.h"

#include "support/input_error.h"

namespace lcpbench {

std::shared_ptr<std::vector<std::string>> AddSettingsOption(CLI::App& command) {
  auto pairs = std::make_shared<std::vector<std::string>>();
  command.add_option("--set", *pairs, "Option of the solver itself, NAME=VALUE; may be repeated")
      ->allow_extra_args(false);  // one a flag, so that arguments may follow it
  return pairs;
}

Settings ParseSettings(const std::vector<std::string>& pairs) {
  Settings settings;
  for (const std::string& pair : pairs) {
    const auto equals = pair.find('=');
    if (equals == std::string::npos || equals == 0) {
      throw InputError("--set: expected NAME=VALUE, found '" + pair + "'");
    }
    settings[pair.substr(0, equals)] = pair.substr(equals + 1);
  }
  return settings;
}

}  // namespace lcpbench
