#pragma once

#include <array>
#include <charconv>
#include <string>

namespace lcpbench {

/// The shortest text that reads back as the same double.
inline std::string NumberText(double value) {
  std::array<char, 32> text{};
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value).ptr};
}

}  // namespace lcpbench
