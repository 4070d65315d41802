#include "model/geometry/smooth_curve.h"

#include <algorithm>
#include <cmath>
#include <type_traits>
#include <variant>

namespace lcpbench {
namespace {

// x^n, n >= 0, by repeated squaring.
template <class T>
T Power(T x, int n) {
  T power(1);
  for (; n > 0; n /= 2) {
    if (n % 2 == 1) power = power * x;
    x = x * x;
  }
  return power;
}

// The m-th root of h in [1, 2]. Newton's method from above descends until rounding stops it.
double Root(double h, int m) {
  constexpr int kMostSteps = 60;
  double root = 1 + (h - 1) / m;
  for (int i = 0; i < kMostSteps; ++i) {
    const double power = Power(root, m - 1);
    const double next = root - (root * power - h) / (m * power);
    if (!(next < root)) break;
    root = next;
  }
  return root;
}

DoubleDouble Root(DoubleDouble h, int m) {
  DoubleDouble root = Root(h.hi, m);
  // Each step doubles the digits; the second takes up what a large m lost in the first.
  for (int i = 0; i < 2; ++i) {
    const DoubleDouble power = Power(root, m - 1);
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
  const T p = Power(T(u / greatest), m - 2);
  const T q = Power(T(v / greatest), m - 2);
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

template <class T>
T Cubed(T x) {
  return x * x * x;
}

// The differences of a Bezier curve's control points: a third of c' at the ends.
template <class T>
std::array<VecOf<T>, 3> Steps(const std::array<VecOf<T>, 4>& P) {
  return {P[1] - P[0], P[2] - P[1], P[3] - P[2]};
}

// The real roots of a s^2 + b s + c, ascending; those that overflow are none.
std::vector<double> QuadraticRoots(double a, double b, double c) {
  std::vector<double> roots;
  const double discriminant = b * b - 4 * a * c;
  if (discriminant < 0) return roots;
  const double q = -(b + std::copysign(std::sqrt(discriminant), b)) / 2;
  for (const double root : {q / a, c / q}) {
    if (std::isfinite(root)) roots.push_back(root);
  }
  std::sort(roots.begin(), roots.end());
  return roots;
}

}  // namespace

bool SmoothCurve::Holds(const Feature& feature) {
  return std::holds_alternative<EllipseEdge>(feature) || std::holds_alternative<SuperellipseEdge>(feature) ||
         std::holds_alternative<BezierEdge>(feature);
}

template <class T>
void SmoothCurve::Frame<T>::Set(const PlacedFeature& placed, Angles angles) {
  const VecOf<T> body = TurnOf<T>(placed, angles);
  std::visit(
      [&](const auto& edge) {
        using Edge = std::decay_t<decltype(edge)>;
        if constexpr (std::is_same_v<Edge, EllipseEdge> || std::is_same_v<Edge, SuperellipseEdge>) {
          const Vertex origin;
          turn = Turn(body, TurnOf<T>({origin, {}, SinCos(edge.phi), edge.phi}, angles));
          offset = Turn(body, Lift<T>(edge.center));
        } else if constexpr (std::is_same_v<Edge, BezierEdge>) {
          for (size_t i = 0; i < P.size(); ++i) P[i] = Turn(body, Lift<T>(edge.P[i]));
        }
      },
      placed.feature);
}

SmoothCurve::SmoothCurve(const PlacedFeature& placed, Angles angles) {
  const Feature& feature = placed.feature;
  frame_.Set(placed, angles);
  wide_frame_.Set(placed, angles);
  if (const auto* ellipse = std::get_if<EllipseEdge>(&feature)) {
    a_ = ellipse->a;
    b_ = ellipse->b;
    sign_ = ellipse->side == Side::kConvex ? 1 : -1;
  } else if (const auto* superellipse = std::get_if<SuperellipseEdge>(&feature)) {
    a_ = superellipse->a;
    b_ = superellipse->b;
    m_ = superellipse->m;
    by_polar_angle_ = true;
    sign_ = superellipse->side == Side::kConvex ? 1 : -1;
  } else {
    is_oval_ = false;
  }
  if (is_oval_) {
    size_ = std::max(a_, b_);
    // The least curvature of the ellipse with these semi-axes.
    if (m_ > 2) curvature_floor_ = std::min(a_, b_) / (size_ * size_);
    return;
  }
  const std::array<VecOf<double>, 3> e = Steps(frame_.P);
  size_ = Norm(e[0]) + Norm(e[1]) + Norm(e[2]);
  curvature_floor_ = 1 / size_;
  // c' x c'' is quadratic in s; so it is known from its values at 0, 1/2 and 1.
  const auto bend = [&](double s) {
    const CurveJet<double> jet = BezierAt<double>(s);
    return Cross(jet.d1, jet.d2);
  };
  const double at_0 = bend(0);
  const double at_half = bend(0.5);
  const double at_1 = bend(1);
  ends_.push_back(0);
  for (const double s : QuadraticRoots(2 * (at_0 - 2 * at_half + at_1), 4 * at_half - 3 * at_0 - at_1, at_0)) {
    if (s > 0 && s < 1) ends_.push_back(s);
  }
  ends_.push_back(1);
}

template <>
const SmoothCurve::Frame<double>& SmoothCurve::FrameOf<double>() const {
  return frame_;
}
template <>
const SmoothCurve::Frame<DoubleDouble>& SmoothCurve::FrameOf<DoubleDouble>() const {
  return wide_frame_;
}

template <class T>
CurveJet<T> SmoothCurve::OvalAt(const CurvePlace<T>& place) const {
  const T cosine = place.x;
  const T sine = place.y;
  const Radius<T> radius = UnitRadius(cosine, sine, m_);
  const T a(a_);
  const T b(b_);
  const T x = radius.r * cosine;
  const T y = radius.r * sine;
  const VecOf<T> d1 = {a * (radius.d1 * cosine - y), b * (radius.d1 * sine + x)};
  const T inward = radius.d2 - radius.r;
  const T along = radius.d1 + radius.d1;
  const VecOf<T> d2 = {a * (inward * cosine - along * sine), b * (inward * sine + along * cosine)};
  const Frame<T>& frame = FrameOf<T>();
  CurveJet<T> jet;
  jet.c = frame.offset + Turn(frame.turn, VecOf<T>{a * x, b * y});
  jet.d1 = Turn(frame.turn, d1);
  jet.d2 = Turn(frame.turn, d2);
  const T sign(sign_);
  jet.N = -(sign * Perp(Unit(jet.d1)));
  if (m_ == 2) {
    jet.kappa = sign * a * b / Cubed(Norm(d1));
    return jet;
  }
  const T X = Absolute(x);
  const T Y = Absolute(y);
  const T X_power = Power(X, m_ - 2);
  const T Y_power = Power(Y, m_ - 2);
  const T gradient = Norm(VecOf<T>{X * X_power / a, Y * Y_power / b});
  jet.kappa = sign * T(m_ - 1) * (X_power / (a * gradient)) * (Y_power / (b * gradient)) / (a * b * gradient);
  return jet;
}

template <class T>
CurveJet<T> SmoothCurve::BezierAt(T s) const {
  const std::array<VecOf<T>, 4>& P = FrameOf<T>().P;
  const std::array<VecOf<T>, 3> e = Steps(P);
  const T r = T(1) - s;
  // De Casteljau's scheme, of the points and of their differences.
  const auto mix = [&](VecOf<T> p, VecOf<T> q) { return r * p + s * q; };
  CurveJet<T> jet;
  const VecOf<T> middle = mix(P[1], P[2]);
  jet.c = mix(mix(mix(P[0], P[1]), middle), mix(middle, mix(P[2], P[3])));
  jet.d1 = T(3) * mix(mix(e[0], e[1]), mix(e[1], e[2]));
  jet.d2 = T(6) * mix(e[1] - e[0], e[2] - e[1]);
  const T speed = Norm(jet.d1);
  jet.N = -Perp(Unit(jet.d1));
  jet.kappa = Cross(jet.d1, jet.d2) / Cubed(speed);
  return jet;
}

template <class T>
CurveJet<T> SmoothCurve::At(const CurvePlace<T>& place) const {
  return is_oval_ ? OvalAt(place) : BezierAt(place.x);
}
template CurveJet<double> SmoothCurve::At(const CurvePlace<double>& place) const;
template CurveJet<DoubleDouble> SmoothCurve::At(const CurvePlace<DoubleDouble>& place) const;

CurvePlace<DoubleDouble> SmoothCurve::FromParameter(double s) const {
  if (!is_oval_) return {s, 0.0};
  const Rotation r = SinCos(s);
  if (!by_polar_angle_) {
    const VecOf<DoubleDouble> unit = LiftRotation<DoubleDouble>(r);
    return {unit.x, unit.y};
  }
  const VecOf<DoubleDouble> unit = Unit(VecOf<DoubleDouble>{TwoProduct(b_, r.cos), TwoProduct(a_, r.sin)});
  return {unit.x, unit.y};
}

double SmoothCurve::Parameter(const CurvePlace<DoubleDouble>& place) const {
  if (!is_oval_) return place.x.hi;
  return by_polar_angle_ ? std::atan2(b_ * place.y.hi, a_ * place.x.hi) : std::atan2(place.y.hi, place.x.hi);
}

CurvePlace<double> SmoothCurve::Place(double tau) const {
  if (!is_oval_) return {tau, 0};
  const Rotation r = SinCos(tau);
  return {r.cos, r.sin};
}

CurvePlace<DoubleDouble> SmoothCurve::Moved(const CurvePlace<DoubleDouble>& place, DoubleDouble step) const {
  if (!is_oval_) {
    const DoubleDouble s = place.x + step;
    if (s < -kBezierMargin) return {-kBezierMargin, 0.0};
    if (s > 1 + kBezierMargin) return {1 + kBezierMargin, 0.0};
    return {s, 0.0};
  }
  const DoubleDouble half = DoubleDouble(0.5) * step;
  const DoubleDouble square = half * half;
  const DoubleDouble norm = DoubleDouble(1) + square;
  const VecOf<DoubleDouble> turn = {(DoubleDouble(1) - square) / norm, step / norm};
  const VecOf<DoubleDouble> moved = Turn(turn, VecOf<DoubleDouble>{place.x, place.y});
  return {moved.x, moved.y};
}

std::vector<double> SmoothCurve::WithNormal(Vec2 n) const {
  if (is_oval_) {
    const Vec2 local = Rotate({frame_.turn.x, -frame_.turn.y}, sign_ * n);
    // The gradient of X^m + Y^m is parallel to the normal: X^(m-1)/a : Y^(m-1)/b = |n_x| : |n_y|.
    const auto power = [&](double value) { return m_ == 2 ? value : std::pow(value, 1.0 / (m_ - 1)); };
    const double x = std::copysign(power(a_ / size_ * std::abs(local.x)), local.x);
    const double y = std::copysign(power(b_ / size_ * std::abs(local.y)), local.y);
    return {std::atan2(y, x)};
  }
  // c'.n = 0 is quadratic in s.
  const std::array<VecOf<double>, 3> e = Steps(frame_.P);
  const VecOf<double> normal = Lift<double>(n);
  const double k0 = Dot(e[0], normal);
  const double k1 = Dot(e[1], normal);
  const double k2 = Dot(e[2], normal);
  std::vector<double> found;
  for (const double s : QuadraticRoots(k0 - 2 * k1 + k2, 2 * (k1 - k0), k0)) {
    if (s < -kEndSlack || s > 1 + kEndSlack) continue;
    if (Dot(BezierAt<double>(s).N, normal) > 0) found.push_back(s);
  }
  return found;
}

int SmoothCurve::Piece(double tau) const {
  int piece = 0;
  for (size_t i = 1; i + 1 < ends_.size(); ++i) piece += tau > ends_[i] ? 1 : 0;
  return piece;
}

}  // namespace lcpbench
