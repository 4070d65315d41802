#pragma once

#include <string>
#include <string_view>

#include "model/geometry/vec2.h"

namespace lcpbench {

// Numbers, names and elements as SVG takes them; independent of the locale.

/// Pixels, to 1/100.
std::string Px(double value);
/// "x y".
std::string Px(Vec2 p);
/// Three significant digits; without an exponent where that is readable.
std::string Short(double value);
/// The largest of 1, 2, 5 times a power of ten that is <= value > 0: lengths for scales.
double RoundDown(double value);
/// As XML character data or attribute value.
std::string Escape(std::string_view text);
/// Letters, digits and dashes: fit for an id and a url(#...).
std::string Identifier(std::string_view text);

/// How a shape is drawn.
struct Paint {
  std::string_view stroke = "none";
  double width = 0;  ///< of the stroke [px]
  std::string_view fill = "none";
  std::string_view more = "";  ///< further attributes
};
std::string SvgPath(const std::string& path, const Paint& paint);
std::string SvgCircle(Vec2 center, double radius, const Paint& paint);
/// An arrow with its head at `to`; nothing where it has no length.
std::string SvgArrow(Vec2 from, Vec2 to, double width, std::string_view color);
/// @param text  not escaped yet
/// @param more  further attributes
std::string SvgText(Vec2 at, double size, std::string_view text, std::string_view more);

}  // namespace lcpbench
