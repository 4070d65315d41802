#pragma once

#include <array>
#include <charconv>
#include <optional>
#include <string>
#include <string_view>

namespace lcpbench {

/// The shortest text that reads back as the same double.
inline std::string NumberText(double value) {
  std::array<char, 32> text{};
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value).ptr};
}

/// As printf writes it. @param format  of one double
std::string FormatNumber(double value, const char* format);

/// The double nearest to the decimal number that the whole word is, whatever the locale: what is too small for a double
/// is 0 (1e-400), as in JSON. Nothing where the word is not a number, infinite, or beyond the largest double (1e400).
std::optional<double> ParseNumber(std::string_view word);

}  // namespace lcpbench
