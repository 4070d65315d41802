#include "model/shape/shapes.h"

#include <cmath>
#include <initializer_list>
#include <numbers>
#include <string>
#include <utility>

#include "support/input_error.h"

namespace lcpbench {
namespace {

constexpr double kPi = std::numbers::pi;

void Require(bool holds, const char* shape, const std::string& condition) {
  if (!holds) throw InputError(std::string(shape) + ": " + condition);
}

void RequirePositive(const char* shape, std::initializer_list<std::pair<const char*, double>> parameters) {
  for (const auto& [name, value] : parameters) {
    Require(value > 0 && std::isfinite(value), shape, name + std::string(" must be finite and > 0"));
  }
}

OutlinePiece Straight(Vec2 a, Vec2 b) { return {StraightEdge{a, b}, 0, 1}; }

// Convex where it runs counter-clockwise.
OutlinePiece Arc(Vec2 center, double radius, double s_begin, double s_end) {
  return {ArcEdge{center, radius, s_begin < s_end ? Side::kConvex : Side::kConcave}, s_begin, s_end};
}

Vec2 Polar(double radius, double angle) {
  const Rotation u = SinCos(angle);
  return {radius * u.cos, radius * u.sin};
}

// Parameters that are allowed one by one may still ask for too much together.
Outline Checked(Outline outline) {
  RequireValid(outline);
  return outline;
}

// The convex arc from p to q, less than a half circle.
OutlinePiece ArcThrough(Vec2 p, Vec2 q, double radius) {
  const Vec2 half = 0.5 * (q - p);
  const double height = std::sqrt(radius * radius - Dot(half, half));
  const Vec2 center = p + half + (height / Norm(half)) * Perp(half);
  const double s_begin = AngleOf(p - center);
  double s_end = AngleOf(q - center);
  if (s_end < s_begin) s_end += 2 * kPi;
  return Arc(center, radius, s_begin, s_end);
}

}  // namespace

Outline Disc(double radius) {
  RequirePositive("disc", {{"the radius", radius}});
  return Checked({"disc", {{Arc({}, radius, 0, 2 * kPi)}}});
}

Outline Box(double width, double height) {
  RequirePositive("box", {{"the width", width}, {"the height", height}});
  const double x = width / 2;
  const double y = height / 2;
  return Checked({"box",
                  {{Straight({-x, -y}, {x, -y}), Straight({x, -y}, {x, y}), Straight({x, y}, {-x, y}),
                    Straight({-x, y}, {-x, -y})}}});
}

Outline RoundedBox(double width, double height, double corner_radius) {
  RequirePositive("rounded box", {{"the width", width}, {"the height", height}, {"the corner radius", corner_radius}});
  const double r = corner_radius;
  const double x = width / 2;
  const double y = height / 2;
  Require(r < x && r < y, "rounded box", "twice the corner radius must be below width and height");
  const double cx = x - r;
  const double cy = y - r;
  return Checked({"rounded box",
                  {{Straight({-cx, -y}, {cx, -y}), Arc({cx, -cy}, r, -kPi / 2, 0), Straight({x, -cy}, {x, cy}),
                    Arc({cx, cy}, r, 0, kPi / 2), Straight({cx, y}, {-cx, y}), Arc({-cx, cy}, r, kPi / 2, kPi),
                    Straight({-x, cy}, {-x, -cy}), Arc({-cx, -cy}, r, kPi, 3 * kPi / 2)}}});
}

Outline Capsule(double length, double radius) {
  RequirePositive("capsule", {{"the length", length}, {"the radius", radius}});
  const double x = length / 2;
  const double r = radius;
  return Checked({"capsule",
                  {{Straight({-x, -r}, {x, -r}), Arc({x, 0}, r, -kPi / 2, kPi / 2), Straight({x, r}, {-x, r}),
                    Arc({-x, 0}, r, kPi / 2, 3 * kPi / 2)}}});
}

Outline HalfDisc(double radius) {
  RequirePositive("half disc", {{"the radius", radius}});
  return Checked({"half disc", {{Straight({-radius, 0}, {radius, 0}), Arc({}, radius, 0, kPi)}}});
}

Outline DShape(double straight, double radius) {
  RequirePositive("D-shape", {{"the straight part", straight}, {"the radius", radius}});
  const double x = -straight;
  const double r = radius;
  return Checked({"D-shape",
                  {{Straight({x, -r}, {0, -r}), Arc({}, r, -kPi / 2, kPi / 2), Straight({0, r}, {x, r}),
                    Straight({x, r}, {x, -r})}}});
}

Outline Ring(double outer_radius, double inner_radius) {
  RequirePositive("ring", {{"the outer radius", outer_radius}, {"the inner radius", inner_radius}});
  Require(inner_radius < outer_radius, "ring", "the inner radius must be below the outer");
  return Checked({"ring", {{Arc({}, outer_radius, 0, 2 * kPi)}, {Arc({}, inner_radius, 2 * kPi, 0)}}});
}

Outline Ellipse(double a, double b) {
  RequirePositive("ellipse", {{"the semi-axis a", a}, {"the semi-axis b", b}});
  return Checked({"ellipse", {{OutlinePiece{EllipseEdge{{}, a, b, 0, Side::kConvex}, 0, 2 * kPi}}}});
}

Outline Superellipse(double a, double b, int m) {
  RequirePositive("superellipse", {{"the semi-axis a", a}, {"the semi-axis b", b}});
  return Checked({"superellipse", {{OutlinePiece{SuperellipseEdge{{}, a, b, m, 0, Side::kConvex}, 0, 2 * kPi}}}});
}

Outline Gear(const GearShape& shape) {
  constexpr int kMinTeeth = 3;
  Require(shape.teeth >= kMinTeeth, "gear", "expected at least 3 teeth");
  RequirePositive("gear", {{"the root radius", shape.root_radius},
                           {"the tip radius", shape.tip_radius},
                           {"the flank radius", shape.flank_radius}});
  Require(shape.root_radius < shape.tip_radius, "gear", "the root radius must be below the tip radius");
  Require(shape.tip_share > 0 && shape.tip_share <= shape.foot_share && shape.foot_share < 1, "gear",
          "expected 0 < tip share <= foot share < 1");
  const double pitch = 2 * kPi / shape.teeth;
  const double tip = shape.tip_share * pitch / 2;
  const double foot = shape.foot_share * pitch / 2;
  const double chord = Norm(Polar(shape.tip_radius, tip) - Polar(shape.root_radius, foot));
  Require(chord <= shape.flank_radius, "gear", "the flank radius must be at least the length of the flank's chord");
  Outline gear{"gear", {{}}};
  for (int tooth = 0; tooth < shape.teeth; ++tooth) {
    const double middle = tooth * pitch;
    const double next = (tooth + 1) * pitch;
    const auto root_point = [&](double angle) { return Polar(shape.root_radius, angle); };
    const auto tip_point = [&](double angle) { return Polar(shape.tip_radius, angle); };
    gear.loops[0].push_back(ArcThrough(root_point(middle - foot), tip_point(middle - tip), shape.flank_radius));
    gear.loops[0].push_back(Arc({}, shape.tip_radius, middle - tip, middle + tip));
    gear.loops[0].push_back(ArcThrough(tip_point(middle + tip), root_point(middle + foot), shape.flank_radius));
    gear.loops[0].push_back(Arc({}, shape.root_radius, middle + foot, next - foot));
  }
  return Checked(gear);
}

Outline Cam(double base_radius, double nose_radius, double distance) {
  RequirePositive("cam",
                  {{"the base radius", base_radius}, {"the nose radius", nose_radius}, {"the distance", distance}});
  Require(nose_radius <= base_radius, "cam", "the nose radius must not exceed the base radius");
  const double c = (base_radius - nose_radius) / distance;
  Require(c < 1, "cam", "the distance must exceed the difference of the radii");
  // The normal shared by both circles where the upper tangent touches them.
  const double s = std::sqrt((1 - c) * (1 + c));
  const double angle = AngleOf({c, s});
  const Vec2 nose{distance, 0};
  const Vec2 upper{c, s};
  const Vec2 lower{c, -s};
  return Checked(
      {"cam",
       {{Arc(nose, nose_radius, -angle, angle), Straight(nose + nose_radius * upper, base_radius * upper),
         Arc({}, base_radius, angle, 2 * kPi - angle), Straight(base_radius * lower, nose + nose_radius * lower)}}});
}

Outline Bowl(double outer_radius, double inner_radius, double half_opening) {
  RequirePositive("bowl", {{"the outer radius", outer_radius},
                           {"the inner radius", inner_radius},
                           {"half the opening angle", half_opening}});
  Require(inner_radius < outer_radius, "bowl", "the inner radius must be below the outer");
  Require(half_opening < kPi, "bowl", "half the opening angle must be below pi");
  const double lip = outer_radius / 2 - inner_radius / 2;
  const double middle = inner_radius + lip;
  Require(half_opening > kPi / 2 || SinCos(half_opening).sin * middle > lip, "bowl",
          "the opening must be wider than the lips");
  const double left = kPi / 2 + half_opening;
  const double right = 5 * kPi / 2 - half_opening;
  return Checked({"bowl",
                  {{Arc({}, outer_radius, left, right), Arc(Polar(middle, right), lip, right, right + kPi),
                    Arc({}, inner_radius, right, left), Arc(Polar(middle, left), lip, left + kPi, left + 2 * kPi)}}});
}

Outline Centered(const Outline& outline) { return Transformed(outline, 0, -ComputeMassProperties(outline, 1).center); }

Body MakeBody(const Outline& outline, double density) {
  RequireValid(outline);
  const MassProperties properties = ComputeMassProperties(outline, density);
  Body body;
  body.name = outline.name;
  body.mass = properties.mass;
  body.inertia = properties.inertia;
  body.x = properties.center;
  body.outline = AllPieces(Centered(outline));
  return body;
}

}  // namespace lcpbench
