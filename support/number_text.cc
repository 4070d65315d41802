#include "support/number_text.h"

#include <clocale>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <system_error>

namespace lcpbench {

std::string FormatNumber(double value, const char* format) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), format, value);
  return text.data();
}

std::optional<double> ParseNumber(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error == std::errc::invalid_argument || end != word.data() + word.size()) return std::nullopt;
  if (error == std::errc::result_out_of_range) {  // which does not tell too small from too large
    static const locale_t kPlain = newlocale(LC_ALL_MASK, "C", nullptr);
    value = strtod_l(std::string(word).c_str(), nullptr, kPlain);
  }
  return std::isfinite(value) ? std::optional(value) : std::nullopt;
}

}  // namespace lcpbench
