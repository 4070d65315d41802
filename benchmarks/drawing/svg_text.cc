#include "benchmarks/drawing/svg_text.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>

namespace lcpbench {
namespace {

std::string Text(double value, std::chars_format format, int decimals) {
  std::array<char, 64> buffer{};
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value, format, decimals);
  return {buffer.data(), end.ptr};
}

/// Fixed notation without trailing zeros.
std::string Number(double value, int decimals) {
  if (std::abs(value) > 1e15) return "0";
  std::string text = Text(value, std::chars_format::fixed, decimals);
  if (text.find('.') != std::string::npos) {
    text.erase(text.find_last_not_of('0') + 1);
    if (text.back() == '.') text.pop_back();
  }
  return text == "-0" ? "0" : text;
}

std::string Attributes(const Paint& paint) {
  std::string text = "\" fill=\"" + std::string(paint.fill) + '"';
  if (paint.width > 0) text += " stroke=\"" + std::string(paint.stroke) + "\" stroke-width=\"" + Px(paint.width) + '"';
  return text + std::string(paint.more) + "/>";
}

}  // namespace

std::string Px(double value) { return Number(value, 2); }

std::string Px(Vec2 p) { return Px(p.x) + " " + Px(p.y); }

std::string Short(double value) {
  const double size = std::abs(value);
  if (size == 0) return "0";
  if (size < 1e-3 || size >= 1e6) return Text(value, std::chars_format::scientific, 2);
  return Number(value, std::max(0, 2 - static_cast<int>(std::floor(std::log10(size)))));
}

double RoundDown(double value) {
  const double decade = std::pow(10, std::floor(std::log10(value)));
  return (value >= 5 * decade ? 5 : value >= 2 * decade ? 2 : 1) * decade;
}

std::string Escape(std::string_view text) {
  constexpr std::string_view kSpecial = "&<>\"";
  constexpr std::array kNames = {"&amp;", "&lt;", "&gt;", "&quot;"};
  std::string escaped;
  for (const char c : text) {
    const std::size_t at = kSpecial.find(c);
    escaped += at == std::string_view::npos ? std::string(1, c) : kNames[at];
  }
  return escaped;
}

std::string Identifier(std::string_view text) {
  std::string id = "s" + std::string(text);
  std::replace_if(
      id.begin(), id.end(), [](unsigned char c) { return c >= 0x80 || std::isalnum(c) == 0; }, '-');
  return id;
}

std::string SvgPath(const std::string& path, const Paint& paint) {
  return "<path d=\"" + path + Attributes(paint) + "\n";
}

std::string SvgCircle(Vec2 center, double radius, const Paint& paint) {
  return "<circle cx=\"" + Px(center.x) + "\" cy=\"" + Px(center.y) + "\" r=\"" + Px(radius) + Attributes(paint) + "\n";
}

std::string SvgArrow(Vec2 from, Vec2 to, double width, std::string_view color) {
  const double length = Norm(to - from);
  if (!(length > 0)) return "";
  const Vec2 unit = (1 / length) * (to - from);
  const double head = std::min(4 * width, 0.6 * length);
  const Vec2 neck = to - head * unit;
  const Vec2 side = (0.45 * head) * Perp(unit);
  return SvgPath("M" + Px(from) + "L" + Px(neck), {color, width, "none", " stroke-linecap=\"butt\""}) +
         SvgPath("M" + Px(to) + "L" + Px(neck + side) + "L" + Px(neck - side) + "Z", {.fill = color});
}

std::string SvgText(Vec2 at, double size, std::string_view text, std::string_view more) {
  return "<text x=\"" + Px(at.x) + "\" y=\"" + Px(at.y) + "\" font-size=\"" + Px(size) + '"' + std::string(more) + ">" +
         Escape(text) + "</text>\n";
}

}  // namespace lcpbench
