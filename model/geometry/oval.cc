#include "model/geometry/oval.h"

#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <limits>
#include <numbers>
#include <utility>

#include "model/geometry/double_double.h"
#include "support/number_text.h"

namespace lcpbench {
namespace {

// The m-th root of value. From above (Bernoulli's inequality) Newton's iteration falls until rounding stops it.
double RootFromAbove(double root, double value, int m) {
  for (;;) {
    const double power = IntegerPower(root, m - 1);
    const double next = root - (root * power - value) / (m * power);
    if (!(next < root)) return root;
    root = next;
  }
}

double Root(double h, int m) { return RootFromAbove(1 + (h - 1) / m, h, m); }

DoubleDouble Root(DoubleDouble h, int m) {
  DoubleDouble root = Root(h.hi, m);
  // Each step doubles the digits; the second takes up what a large m lost in the first.
  for (int i = 0; i < 2; ++i) {
    const DoubleDouble power = IntegerPower(root, m - 1);
    root = root - (root * power - h) / (DoubleDouble(m) * power);
  }
  return root;
}

// The unit superellipse in polar form, r(tau) = (cos^m tau + sin^m tau)^(-1/m), and its derivatives.
template <class T>
struct Radius {
  T r{1};
  T d1{0};
  T d2{0};
};

template <class T>
Radius<T> UnitRadius(T cosine, T sine, int m) {
  if (m == 2) return {};
  // Powers of cos and sin relative to the greater of them: nothing underflows that matters, whatever m.
  const T u = Absolute(cosine);
  const T v = Absolute(sine);
  const T greatest = u < v ? v : u;
  const T p = IntegerPower(T(u / greatest), m - 2);
  const T q = IntegerPower(T(v / greatest), m - 2);
  const T greatest_squared = greatest * greatest;
  const T h = p * (u * u / greatest_squared) + q * (v * v / greatest_squared);
  const T p_over_h = p / (greatest_squared * h);
  const T q_over_h = q / (greatest_squared * h);
  const T difference = q_over_h - p_over_h;
  // With h = cos^m + sin^m: w = h'/(m h) = -r'/r, and r''/r = (1 + m) w^2 - h''/(m h).
  const T w = cosine * sine * difference;
  const T second =
      (cosine * cosine - sine * sine) * difference + T(m - 2) * (q_over_h * cosine * cosine + p_over_h * sine * sine);
  Radius<T> radius;
  radius.r = T(1) / (greatest * Root(h, m));
  radius.d1 = -radius.r * w;
  radius.d2 = radius.r * (T(m + 1) * w * w - second);
  return radius;
}

// Half of one side of the unit superellipse x^m + y^m = 1: the side that the x axis meets, turned by quarter_turns; q
// = y / x is the slope of the polar ray, within -1..0 or 0..1, so that x and y are monotone.
struct Octant {
  int quarter_turns = 0;
  double q_begin = 0;
  double q_end = 0;
};

Vec2 QuarterTurned(Vec2 p, int turns) {
  for (int k = 0; k < turns; ++k) p = Perp(p);
  return p;
}

Vec2 OctantPoint(double q, int m, int turns) {
  const double x = 1 / RootOfOnePlusPower(q, m);
  return QuarterTurned({x, q * x}, turns);
}

// Where the ray at polar angle s lies on the superellipse scaled to a = b = 1.
struct RaySlope {
  int octant = 0;  // 0..7 counter-clockwise; octant k is the half [-1, 0] (k odd) or [0, 1] (k even) of a side
  double q = 0;
};

RaySlope SlopeAt(const SuperellipseEdge& e, double s) {
  const Rotation u = SinCos(s);
  Vec2 ray{u.cos / e.a, u.sin / e.b};
  int turns = 0;
  while (!(ray.x > 0 && std::abs(ray.y) <= ray.x) && turns < 3) {
    ray = -Perp(ray);
    ++turns;
  }
  RaySlope slope;
  slope.q = ray.y / ray.x;
  slope.octant = (2 * turns + (slope.q < 0 ? 7 : 0)) % 8;
  return slope;
}

// The octants from s_low counter-clockwise to s_high.
std::vector<Octant> OctantsBetween(const SuperellipseEdge& e, double s_low, double s_high) {
  constexpr int kOctants = 8;
  const RaySlope low = SlopeAt(e, s_low);
  RaySlope high = SlopeAt(e, s_high);
  // A full turn, whose end is off its begin by the rounding of 2 pi: that matters for slender shapes, whose polar angle
  // runs very fast at their ends.
  const double magnitude = std::max(std::abs(s_low), std::abs(s_high));
  const double rounding = 4 * std::numeric_limits<double>::epsilon() * magnitude;
  if (std::abs(s_high - s_low - 2 * std::numbers::pi) <= rounding) high = low;
  int steps = (high.octant - low.octant + kOctants) % kOctants;
  // Half turns are half turns in either angle: what begins and ends in the same or the next octant yet is longer than
  // that has run all the way round. What ends an octant earlier yet is shorter has, but for rounding, not moved at all.
  const bool beyond_half = s_high - s_low > std::numbers::pi;
  if (beyond_half && steps <= 1) steps += kOctants;
  std::vector<Octant> octants;
  if (!beyond_half && steps == kOctants - 1) return octants;
  for (int k = 0; k <= steps; ++k) {
    const int octant = (low.octant + k) % kOctants;
    Octant part;
    part.quarter_turns = (octant + 1) / 2 % 4;
    const double first = octant % 2 == 0 ? 0 : -1;
    part.q_begin = k == 0 ? low.q : first;
    part.q_end = k == steps ? high.q : first + 1;
    if (part.q_begin != part.q_end) octants.push_back(part);
  }
  return octants;
}

// Adaptive quadrature: halves the range until the estimated error is below kTolerance of the integral or below `noise`,
// what rounding of the integrand amounts to.
template <class Integrand>
double Integrate(const Integrand& f, double from, double to, double noise, int depth) {
  using Kronrod = boost::math::quadrature::gauss_kronrod<double, 61>;
  constexpr double kTolerance = 1e-14;
  constexpr int kMaxDepth = 15;  // resolves the corner of the largest exponent with room to spare
  double error = 0;
  const double integral = Kronrod::integrate(f, from, to, 0, kTolerance, &error);
  // The error is estimated before scaling with half the range.
  error *= std::abs(to - from) / 2;
  if (error <= std::max(kTolerance * std::abs(integral), noise) || depth == kMaxDepth) return integral;
  const double middle = from + (to - from) / 2;
  return Integrate(f, from, middle, noise / 2, depth + 1) + Integrate(f, middle, to, noise / 2, depth + 1);
}

AreaMoments OctantMoments(const Octant& octant, int m) {
  const Vec2 origin = OctantPoint(octant.q_begin, m, 0);
  // The cone's integrand is a product of lengths that cancel: good to a few epsilon of their product.
  constexpr double kNoise = 8 * std::numeric_limits<double>::epsilon();
  const double length = std::abs(octant.q_end - octant.q_begin);
  const AreaMoments moments =
      ConeMoments([&](const auto& f) { return Integrate(f, octant.q_begin, octant.q_end, kNoise * length, 0); },
                  [&](double q) {
                    const double x = 1 / RootOfOnePlusPower(q, m);
                    const double slope_power = IntegerPower(q, m - 1);
                    const double dx = -slope_power * x / (1 + slope_power * q);
                    return std::pair(Vec2{x, q * x} - origin, Vec2{dx, x + q * dx});
                  });
  return Mapped(moments, QuarterTurned({1, 0}, octant.quarter_turns), QuarterTurned({0, 1}, octant.quarter_turns));
}

}  // namespace

double RootOfOnePlusPower(double q, int m) {
  const double excess = IntegerPower(q, m);
  return m == 2 ? std::sqrt(1 + excess) : RootFromAbove(1 + excess / m, 1 + excess, m);
}

std::string OvalShape::WhyInvalid() const {
  if (!(a > 0 && b > 0)) return "the semi-axes must be > 0";
  const double greater = std::max(a, b);
  const double less = std::min(a, b);
  if (!std::isfinite(greater / less / less)) return "the curvature overflows";
  if (!(less / greater / greater > 0)) return "the curvature underflows";
  if (greater / kMaxAspectRatio <= less) return "";
  return "aspect ratio " + NumberText(greater / less) + ", at most 1e6 is accepted";
}

double OvalShape::Reach(double angle) const {
  return Largest(center) + std::max(angle, std::abs(phi)) * std::max(a, b);
}

std::vector<double> OvalShape::NormalCuts(double s_begin, double s_end) {
  constexpr double kQuarter = std::numbers::pi / 2;
  constexpr double kShortest = 1e-9;  // [rad]: no span of its own for what rounding leaves beyond an axis
  const double low = std::min(s_begin, s_end);
  const double high = std::max(s_begin, s_end);
  std::vector<double> cuts = {low};
  for (double k = std::ceil(low / kQuarter); k * kQuarter < high; ++k) {
    const double cut = k * kQuarter;
    if (cut > low + kShortest && cut < high - kShortest) cuts.push_back(cut);
  }
  cuts.push_back(high);
  if (s_begin > s_end) std::reverse(cuts.begin(), cuts.end());
  return cuts;
}

SpanPoint OvalShape::AtNormal(Vec2 n, const TurnedPiece& piece) const {
  const double sign = SignOf(side);
  const Vec2 local = RotateBack(piece.turn, sign * n);
  if (m == 2) {
    // The normal at (a cos s, b sin s) is parallel to (cos s / a, sin s / b).
    const Vec2 u = Unit(Vec2{a * local.x, b * local.y});
    const Vec2 p = {a * u.x, b * u.y};
    const double speed = Norm({a * u.y, b * u.x});
    const double kappa = sign * ((a / speed) * (b / speed)) / speed;
    return {center + Rotate(piece.turn, p), {1, kappa}, by_polar_angle ? p : u};
  }
  // X^(m-1) : Y^(m-1) = a |n_x| : b |n_y|; a start for the search, so that the library's pow will do.
  const double x_power = a * std::abs(local.x);
  const double y_power = b * std::abs(local.y);
  const bool x_leads = x_power >= y_power;
  const double q = std::pow(x_leads ? y_power / x_power : x_power / y_power, 1.0 / (m - 1));
  const double large = 1 / RootOfOnePlusPower(q, m);
  const double small = q * large;
  const double X = x_leads ? large : small;
  const double Y = x_leads ? small : large;
  const Vec2 p = {std::copysign(a * X, local.x), std::copysign(b * Y, local.y)};
  const double X_power = IntegerPower(X, m - 2);
  const double Y_power = IntegerPower(Y, m - 2);
  const double gradient = Norm({X * X_power / a, Y * Y_power / b});
  const double kappa = sign * (m - 1) * (X_power / (a * gradient)) * (Y_power / (b * gradient)) / (a * b * gradient);
  return {center + Rotate(piece.turn, p), {1, kappa}, p};
}

double OvalShape::TauWithNormal(Vec2 n) const {
  // The gradient of X^m + Y^m is parallel to the normal: X^(m-1)/a : Y^(m-1)/b = |n_x| : |n_y|.
  const double size = std::max(a, b);
  const auto power = [&](double value) { return m == 2 ? value : std::pow(value, 1.0 / (m - 1)); };
  const double x = std::copysign(power(a / size * std::abs(n.x)), n.x);
  const double y = std::copysign(power(b / size * std::abs(n.y)), n.y);
  return std::atan2(y, x);
}

template <class T>
CurveJet<T> OvalShape::Jet(VecOf<T> turn, VecOf<T> offset, VecOf<T> place) const {
  const T cosine = place.x;
  const T sine = place.y;
  const Radius<T> radius = UnitRadius(cosine, sine, m);
  const T wide_a(a);
  const T wide_b(b);
  const T x = radius.r * cosine;
  const T y = radius.r * sine;
  const VecOf<T> d1 = {wide_a * (radius.d1 * cosine - y), wide_b * (radius.d1 * sine + x)};
  const T inward = radius.d2 - radius.r;
  const T along = radius.d1 + radius.d1;
  const VecOf<T> d2 = {wide_a * (inward * cosine - along * sine), wide_b * (inward * sine + along * cosine)};
  CurveJet<T> jet;
  jet.c = offset + Turn(turn, VecOf<T>{wide_a * x, wide_b * y});
  jet.d1 = Turn(turn, d1);
  jet.d2 = Turn(turn, d2);
  const T sign(SignOf(side));
  jet.N = -(sign * Perp(Unit(jet.d1)));
  if (m == 2) {
    jet.kappa = sign * wide_a * wide_b / Cubed(Norm(d1));
    return jet;
  }
  const T X = Absolute(x);
  const T Y = Absolute(y);
  const T X_power = IntegerPower(X, m - 2);
  const T Y_power = IntegerPower(Y, m - 2);
  const T gradient = Norm(VecOf<T>{X * X_power / wide_a, Y * Y_power / wide_b});
  jet.kappa = sign * T(m - 1) * (X_power / (wide_a * gradient)) * (Y_power / (wide_b * gradient)) /
              (wide_a * wide_b * gradient);
  return jet;
}
template CurveJet<double> OvalShape::Jet(VecOf<double> turn, VecOf<double> offset, VecOf<double> place) const;
template CurveJet<DoubleDouble> OvalShape::Jet(VecOf<DoubleDouble> turn, VecOf<DoubleDouble> offset,
                                               VecOf<DoubleDouble> place) const;

Vec2 EllipseEdge::Point(double s) const {
  const Rotation u = SinCos(s);
  return center + Rotate(SinCos(phi), {a * u.cos, b * u.sin});
}

Vec2 EllipseEdge::Direction(double s) const {
  const Rotation u = SinCos(s);
  return Rotate(SinCos(phi), {-a * u.sin, b * u.cos});
}

std::string SuperellipseEdge::WhyInvalid() const {
  std::string why = Shape().WhyInvalid();
  if (!why.empty() || (m >= 2 && m % 2 == 0 && m <= kMaxSuperellipseExponent)) return why;
  return "the exponent m must be even and >= 2, and at most " + std::to_string(kMaxSuperellipseExponent);
}

Vec2 SuperellipseEdge::Point(double s) const {
  const Rotation u = SinCos(s);
  const double c = u.cos / a;
  const double d = u.sin / b;
  // The larger term is taken out of the sum, so that no power over- or underflows harmfully.
  const double large = std::max(std::abs(c), std::abs(d));
  const double small = std::min(std::abs(c), std::abs(d));
  const double r = 1 / (large * RootOfOnePlusPower(small / large, m));
  return center + Rotate(SinCos(phi), {r * u.cos, r * u.sin});
}

Vec2 SuperellipseEdge::Direction(double s) const {
  // Perpendicular to the gradient (c^(m-1) / a, d^(m-1) / b) of c^m + d^m, c = cos s / a, d = sin s / b.
  const Rotation u = SinCos(s);
  const double c = u.cos / a;
  const double d = u.sin / b;
  const double large = std::max(std::abs(c), std::abs(d));
  const double scale = std::max(a, b);
  return Rotate(SinCos(phi), {-IntegerPower(d / large, m - 1) * (scale / b),  //
                              IntegerPower(c / large, m - 1) * (scale / a)});
}

void SuperellipseEdge::AppendMoments(double s_begin, double s_end, Vec2 begin, std::vector<Segment>* segments) const {
  std::vector<Octant> octants = OctantsBetween(*this, std::min(s_begin, s_end), std::max(s_begin, s_end));
  if (!(s_begin < s_end)) {
    std::reverse(octants.begin(), octants.end());
    for (Octant& octant : octants) std::swap(octant.q_begin, octant.q_end);
  }
  const Rotation tilt = SinCos(phi);
  const Vec2 u = Rotate(tilt, {a, 0});
  const Vec2 v = Rotate(tilt, {0, b});
  for (std::size_t k = 0; k < octants.size(); ++k) {
    const Vec2 unit = OctantPoint(octants[k].q_begin, m, octants[k].quarter_turns);
    const Vec2 vertex = k == 0 ? begin : center + unit.x * u + unit.y * v;
    const AreaMoments scaled = Mapped(OctantMoments(octants[k], m), {a, 0}, {0, b});
    segments->push_back({vertex, Rotated(scaled, phi), Segment::Base::kBegin});
  }
}

}  // namespace lcpbench
