#pragma once

#include <string>
#include <string_view>

#include "model/geometry/vec2.h"

namespace lcpbench {

// Numbers and names as SVG takes them; independent of the locale.

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

}  // namespace lcpbench
