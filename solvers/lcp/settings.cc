#include "solvers/lcp/settings.h"

#include <algorithm>
#include <cstdio>

#include "support/input_error.h"
#include "support/number_text.h"

namespace lcpbench {

SettingsReader::SettingsReader(std::string_view owner, const Settings& settings) : owner_(owner), settings_(settings) {}

double SettingsReader::Number(const std::string& name, double fallback, double minimum, double maximum) {
  known_[name] = true;
  const auto found = settings_.find(name);
  if (found == settings_.end()) return fallback;
  const std::string& text = found->second;
  const std::optional<double> value = ParseNumber(text);
  if (!value || !(*value >= minimum && *value <= maximum)) {
    char range[64];
    std::snprintf(range, sizeof range, "[%g, %g]", minimum, maximum);
    throw InputError(owner_ + ": option " + name + " must be a number in " + range + ", found '" + text + "'");
  }
  return *value;
}

std::string SettingsReader::Choice(const std::string& name, std::string_view fallback,
                                   std::initializer_list<std::string_view> choices) {
  known_[name] = true;
  const auto found = settings_.find(name);
  if (found == settings_.end()) return std::string(fallback);
  if (std::find(choices.begin(), choices.end(), found->second) == choices.end()) {
    std::string list;
    for (const std::string_view choice : choices) list += (list.empty() ? "" : ", ") + std::string(choice);
    throw InputError(owner_ + ": option " + name + " must be one of " + list + ", found '" + found->second + "'");
  }
  return found->second;
}

bool SettingsReader::YesOrNo(const std::string& name, bool fallback) {
  return Choice(name, fallback ? "yes" : "no", {"yes", "no"}) == "yes";
}

void SettingsReader::Finish() const {
  for (const auto& [name, value] : settings_) {
    if (known_.contains(name)) continue;
    std::string list;
    for (const auto& [known, unused] : known_) list += (list.empty() ? "" : ", ") + known;
    throw InputError(owner_ + ": unknown option '" + name + "', expected " +
                     (list.empty() ? "none" : "one of " + list));
  }
}

}  // namespace lcpbench
