#include "benchmarks/drawing/svg_text.h"

#include <array>
#include <charconv>
#include <cmath>

namespace lcpbench {
namespace {

/// Fixed notation without trailing zeros.
std::string Number(double value, int decimals) {
  std::array<char, 64> buffer{};
  if (std::abs(value) > 1e15) return "0";
  const auto end =
      std::to_chars(buffer.data(), buffer.data() + buffer.size(), value, std::chars_format::fixed, decimals);
  std::string text(buffer.data(), end.ptr);
  if (text.find('.') != std::string::npos) {
    while (text.back() == '0') text.pop_back();
    if (text.back() == '.') text.pop_back();
  }
  return text == "-0" ? "0" : text;
}

}  // namespace

std::string Px(double value) { return Number(value, 2); }

std::string Px(Vec2 p) { return Px(p.x) + " " + Px(p.y); }

std::string Short(double value) {
  const double size = std::abs(value);
  if (size == 0) return "0";
  if (size < 1e-3 || size >= 1e6) {
    std::array<char, 64> buffer{};
    const auto end =
        std::to_chars(buffer.data(), buffer.data() + buffer.size(), value, std::chars_format::scientific, 2);
    return {buffer.data(), end.ptr};
  }
  int decimals = 2;
  for (double limit = 10; size >= limit && decimals > 0; limit *= 10) --decimals;
  for (double limit = 1; size < limit; limit /= 10) ++decimals;
  return Number(value, decimals);
}

double RoundDown(double value) {
  double decade = 1;
  while (decade > value && decade > 1e-300) decade /= 10;
  while (decade * 10 <= value && decade < 1e300) decade *= 10;
  for (const double step : {5.0, 2.0}) {
    if (step * decade <= value) return step * decade;
  }
  return decade;
}

std::string Escape(std::string_view text) {
  std::string escaped;
  for (const char c : text) {
    switch (c) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      default:
        escaped += c;
    }
  }
  return escaped;
}

std::string Identifier(std::string_view text) {
  std::string id = "s";
  for (const char c : text) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    id += plain ? c : '-';
  }
  return id;
}

}  // namespace lcpbench
