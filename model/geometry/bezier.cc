#include "model/geometry/bezier.h"

#include <boost/math/quadrature/gauss.hpp>
#include <limits>
#include <utility>

#include "model/geometry/double_double.h"

namespace lcpbench {
namespace {

// The differences of control points: a third of c' at the ends.
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

// Where |c'| can vanish on [0, 1]: at zeros of c'_x and c'_y, or, where one of them only grazes zero, at its extremum.
bool IsRegular(const BezierEdge& edge) {
  constexpr double kLeastSpeed = 1e-10;
  const std::array<Vec2, 3> e = Steps(edge.P);
  const double largest = std::max({Largest(e[0]), Largest(e[1]), Largest(e[2])});
  if (!(largest > 0)) return false;
  const auto speed = [&](double s) {
    const double r = 1 - s;
    return Norm((r * r / largest) * e[0] + (2 * r * s / largest) * e[1] + (s * s / largest) * e[2]);
  };
  std::vector<double> places = {0, 1};
  for (double Vec2::*axis : {&Vec2::x, &Vec2::y}) {
    const double a = (e[0].*axis - 2 * (e[1].*axis) + e[2].*axis) / largest;
    const double b = 2 * (e[1].*axis - e[0].*axis) / largest;
    const double c = e[0].*axis / largest;
    places.push_back(-b / (2 * a));
    const double root = std::sqrt(std::max(b * b - 4 * a * c, 0.0));
    const double q = -(b + std::copysign(root, b)) / 2;
    places.push_back(q / a);
    places.push_back(c / q);
  }
  return std::all_of(places.begin(), places.end(),
                     [&](double s) { return !(s >= 0 && s <= 1) || speed(s) > kLeastSpeed; });
}

// Appends the ends of parts of s0..s1 whose control polygons turn by less than 90 degrees, after `least` halvings or
// more. A cubic's derivative is zero only at a cusp, around which no part turns by so little.
// @return false, with `least` > 0 at once, where the halvings came to their end
bool Halve(const BezierEdge& edge, double s0, double s1, int depth, int least, std::vector<double>* ends) {
  constexpr int kMaxDepth = 24;
  const std::array<Vec2, 3> legs = Steps(BezierPiece(edge, s0, s1));
  const bool turns_little = Dot(legs[0], legs[1]) > 0 && Dot(legs[1], legs[2]) > 0 && Dot(legs[0], legs[2]) > 0;
  if ((turns_little && depth >= least) || depth == kMaxDepth) {
    ends->push_back(s1);
    return turns_little;
  }
  const double middle = s0 + (s1 - s0) / 2;
  const bool first = Halve(edge, s0, middle, depth + 1, least, ends);
  return (first || least == 0) && Halve(edge, middle, s1, depth + 1, least, ends) && first;
}

}  // namespace

std::string BezierEdge::WhyInvalid() const {
  const double largest = std::max({Largest(P[0]), Largest(P[1]), Largest(P[2]), Largest(P[3])});
  if (!std::isfinite(largest * largest)) return "the control points' distance overflows";
  return IsRegular(*this) ? "" : "the derivative vanishes, speed |c'| = 0, on the curve";
}

double BezierEdge::Reach(double /*angle*/) const {
  return std::max({Largest(P[0]), Largest(P[1]), Largest(P[2]), Largest(P[3])});
}

Vec2 BezierEdge::Point(double s) const {
  const double t = 1 - s;
  return (t * t * t) * P[0] + (3 * t * t * s) * P[1] + (3 * t * s * s) * P[2] + (s * s * s) * P[3];
}

Vec2 BezierEdge::Direction(double s) const {
  const double t = 1 - s;
  return (t * t) * (P[1] - P[0]) + (2 * t * s) * (P[2] - P[1]) + (s * s) * (P[3] - P[2]);
}

SpanPoint BezierEdge::AtNormal(Vec2 n, const TurnedPiece& piece) const {
  // c'.n = 0 is quadratic in s; of its roots the one on the piece, or nearest to it.
  const auto [e0, e1, e2] = Steps(P);
  const double k0 = Dot(e0, n);
  const double k1 = Dot(e1, n);
  const double k2 = Dot(e2, n);
  const double a = k0 - 2 * k1 + k2;
  const double half_b = k1 - k0;
  const double discriminant = half_b * half_b - a * k0;
  const double q = -(half_b + std::copysign(std::sqrt(std::max(discriminant, 0.0)), half_b));
  double s = piece.s_begin;
  double least = std::numeric_limits<double>::infinity();
  for (const double root : {q / a, k0 / q}) {
    if (!std::isfinite(root)) continue;
    const double held = std::clamp(root, piece.s_begin, piece.s_end);
    if (std::abs(root - held) < least) {
      least = std::abs(root - held);
      s = held;
    }
  }
  const Vec2 d1 = 3 * Direction(s);
  const Vec2 d2 = 6 * ((1 - s) * (e1 - e0) + s * (e2 - e1));
  return {Point(s), {1, Cross(d1, d2) / Cubed(Norm(d1))}, {s, 0}};
}

std::vector<double> BezierEdge::NormalCuts(double s_begin, double s_end) const {
  // A part no longer than this [of s] would have control points that coincide but for rounding: what rounding makes of
  // the inflection at an end of vanishing curvature.
  constexpr double kShortest = 1e-9;
  std::vector<double> cuts = {s_begin};
  double last = s_begin;
  std::vector<double> ends = Inflections();
  ends.push_back(s_end);
  for (std::size_t k = 0; k < ends.size(); ++k) {
    const bool is_end = k + 1 == ends.size();
    if (!is_end && !(ends[k] > last + kShortest && ends[k] < s_end - kShortest)) continue;
    Halve(*this, last, ends[k], 0, 0, &cuts);
    last = ends[k];
  }
  return cuts;
}

std::vector<double> BezierEdge::EnclosedCuts(double s_begin, double s_end) const {
  std::vector<double> cuts = {s_begin};
  if (!Halve(*this, s_begin, s_end, 0, 1, &cuts)) cuts.clear();
  return cuts;
}

Enclosure BezierEdge::Enclose(double s_begin, double s_end, Vec2 begin, Vec2 end) const {
  const auto piece = BezierPiece(*this, s_begin, s_end);
  const auto legs = Steps(piece);
  Enclosure enclosure{std::max(DistanceToSegment(piece[1], begin, end), DistanceToSegment(piece[2], begin, end)),
                      UnitOrZero(legs[0]), UnitOrZero(legs[0])};
  // The cone of the control polygon's legs contains every tangent.
  for (const Vec2 leg : {legs[1], legs[2]}) {
    const Vec2 u = UnitOrZero(leg);
    if (InCone(u, enclosure.first, enclosure.second)) continue;
    // Widens the cone (ordered counter-clockwise) on the side on which the leg lies.
    (Cross(enclosure.first, u) < 0 ? enclosure.first : enclosure.second) = u;
  }
  return enclosure;
}

void BezierEdge::AppendMoments(double s_begin, double s_end, Vec2 begin, std::vector<Segment>* segments) const {
  // The integrands have degree 10 at most; n points are exact up to degree 2n - 1.
  using Gauss = boost::math::quadrature::gauss<double, 7>;
  const auto piece = BezierPiece(*this, s_begin, s_end);
  const Vec2 q1 = piece[1] - piece[0];
  const Vec2 q2 = piece[2] - piece[0];
  const Vec2 q3 = piece[3] - piece[0];
  const auto at = [&](double t) {
    const double r = 1 - t;
    return std::pair((3 * r * r * t) * q1 + (3 * r * t * t) * q2 + (t * t * t) * q3,
                     (3 * r * r) * q1 + (6 * r * t) * (q2 - q1) + (3 * t * t) * (q3 - q2));
  };
  const auto integrate = [](const auto& f) { return Gauss::integrate(f, 0.0, 1.0); };
  segments->push_back({begin, ConeMoments(integrate, at), Segment::Base::kBegin});
}

std::vector<double> BezierEdge::Inflections() const {
  // c' x c'' is quadratic in s; so it is known from its values at 0, 1/2 and 1.
  const auto bend = [&](double s) {
    const CurveJet<double> jet = Jet(P, s);
    return Cross(jet.d1, jet.d2);
  };
  const double at_0 = bend(0);
  const double at_half = bend(0.5);
  const double at_1 = bend(1);
  std::vector<double> ends = {0};
  for (const double s : QuadraticRoots(2 * (at_0 - 2 * at_half + at_1), 4 * at_half - 3 * at_0 - at_1, at_0)) {
    if (s > 0 && s < 1) ends.push_back(s);
  }
  ends.push_back(1);
  return ends;
}

std::vector<double> BezierEdge::WithNormal(Vec2 n, double slack) const {
  // c'.n = 0 is quadratic in s.
  const auto [e0, e1, e2] = Steps(P);
  const double k0 = Dot(e0, n);
  const double k1 = Dot(e1, n);
  const double k2 = Dot(e2, n);
  std::vector<double> found;
  for (const double s : QuadraticRoots(k0 - 2 * k1 + k2, 2 * (k1 - k0), k0)) {
    if (s < -slack || s > 1 + slack) continue;
    if (Dot(Jet(P, s).N, n) > 0) found.push_back(s);
  }
  return found;
}

template <class T>
CurveJet<T> BezierEdge::Jet(const std::array<VecOf<T>, 4>& P, T s) {
  const std::array<VecOf<T>, 3> e = Steps(P);
  const T r = T(1) - s;
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
template CurveJet<double> BezierEdge::Jet(const std::array<VecOf<double>, 4>& P, double s);
template CurveJet<DoubleDouble> BezierEdge::Jet(const std::array<VecOf<DoubleDouble>, 4>& P, DoubleDouble s);

std::array<Vec2, 4> BezierPiece(const BezierEdge& edge, double s0, double s1) {
  // The blossom: each of the three steps of de Casteljau's algorithm with its own parameter.
  const auto blossom = [&edge](double u, double v, double w) {
    const auto mix = [](Vec2 p, Vec2 q, double t) { return (1 - t) * p + t * q; };
    const auto& P = edge.P;
    const Vec2 a = mix(P[0], P[1], u);
    const Vec2 b = mix(P[1], P[2], u);
    const Vec2 c = mix(P[2], P[3], u);
    return mix(mix(a, b, v), mix(b, c, v), w);
  };
  return {blossom(s0, s0, s0), blossom(s0, s0, s1), blossom(s0, s1, s1), blossom(s1, s1, s1)};
}

}  // namespace lcpbench
