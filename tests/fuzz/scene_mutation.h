#pragma once

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "model/scenes/random.h"

namespace lcpbench {

// Mutations of scene files that stay JSON mostly, so that they reach the geometry behind the parser.

/// An index in [0, end), end > 0.
inline std::size_t Below(std::size_t end, Random* random) {
  return std::min(end - 1, static_cast<std::size_t>(random->Uniform() * static_cast<double>(end)));
}

inline nlohmann::json RandomValue(Random* random) {
  static const auto values =
      nlohmann::json::parse(R"([0, 1, -1, 2, 1000, -0.0, 1e-9, 1e-30, 1e30, 1e6, -1e30, 1e300, 0.5,
    true, null, "", "left", "right", "pin", [], {}, [0, 0], [1e30, 1e-30]])");
  return values[Below(values.size(), random)];
}

// All values of the tree, the root first.
inline void Collect(nlohmann::json* json, std::vector<nlohmann::json*>* all) {
  all->push_back(json);
  if (!json->is_structured()) return;
  for (nlohmann::json& child : *json) Collect(&child, all);
}

/// The document with one to three of its values replaced, scaled, removed, or copied from elsewhere in it. The text
/// itself if it is not JSON.
inline std::string MutatedTree(const std::string& text, Random* random) {
  nlohmann::json json = nlohmann::json::parse(text, nullptr, /*allow_exceptions=*/false);
  if (json.is_discarded()) return text;
  const std::size_t changes = 1 + Below(3, random);
  for (std::size_t k = 0; k < changes; ++k) {
    std::vector<nlohmann::json*> all;
    Collect(&json, &all);
    nlohmann::json& value = *all[Below(all.size(), random)];
    const std::size_t kind = Below(6, random);
    if (value.is_number() && kind < 4) {
      const double factor = random->Uniform(-2, 2);
      value = kind == 0 ? nlohmann::json(value.get<double>() * factor) : RandomValue(random);
    } else if (value.is_structured() && !value.empty() && kind < 3) {
      const auto step = static_cast<std::ptrdiff_t>(Below(value.size(), random));
      value.erase(std::next(value.begin(), step));
    } else if (kind < 5) {
      value = nlohmann::json(*all[Below(all.size(), random)]);
    } else {
      value = RandomValue(random);
    }
  }
  // Bytes of a mutated string may be no UTF-8 any more.
  return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

/// A text of lines, one of which is another line of it or mutated as a tree.
inline std::string MutatedLine(const std::string& text, Random* random) {
  const auto line_at = [&text](std::size_t at) {
    const std::size_t before = text.rfind('\n', at);
    const std::size_t begin = before == std::string::npos || at == 0 ? 0 : before + 1;
    return std::pair(begin, std::min(text.find('\n', begin), text.size()));
  };
  if (text.empty()) return text;
  const auto [begin, end] = line_at(Below(text.size(), random));
  const auto [other, other_end] = line_at(Below(text.size(), random));
  const bool is_copied = Below(5, random) == 0;
  const std::string line = is_copied ? text.substr(other, other_end - other) : text.substr(begin, end - begin);
  return text.substr(0, begin) + (is_copied ? line : MutatedTree(line, random)) + text.substr(end);
}

}  // namespace lcpbench
