#pragma once

#include <cmath>

namespace lcpbench {

/// A vector of the plane. Plain double arithmetic in a fixed order, so that the model gives the same bits everywhere.
struct Vec2 {
  double x = 0;
  double y = 0;
};

constexpr Vec2 operator+(Vec2 a, Vec2 b) { return {a.x + b.x, a.y + b.y}; }
constexpr Vec2 operator-(Vec2 a, Vec2 b) { return {a.x - b.x, a.y - b.y}; }
constexpr Vec2 operator-(Vec2 a) { return {-a.x, -a.y}; }
constexpr Vec2 operator*(double s, Vec2 a) { return {s * a.x, s * a.y}; }
constexpr double Dot(Vec2 a, Vec2 b) { return a.x * b.x + a.y * b.y; }
/// The scalar a_x b_y - a_y b_x.
constexpr double Cross(Vec2 a, Vec2 b) { return a.x * b.y - a.y * b.x; }
/// z-hat x a: a turned by +90 degrees.
constexpr Vec2 Perp(Vec2 a) { return {-a.y, a.x}; }
/// sqrt, not hypot: correctly rounded on every machine.
inline double Norm(Vec2 a) { return std::sqrt(a.x * a.x + a.y * a.y); }
inline bool IsFinite(Vec2 a) { return std::isfinite(a.x) && std::isfinite(a.y); }

}  // namespace lcpbench
