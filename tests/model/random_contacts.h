#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <ostream>
#include <random>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "model/contact/assembly.h"
#include "model/contact/body.h"
#include "model/contact/closest_points.h"
#include "model/contact/system.h"
#include "model/geometry/curve.h"
#include "model/geometry/feature.h"
#include "model/geometry/trig.h"
#include "support/input_error.h"

namespace lcpbench::testing {

/// What touches what: body 1's feature, then body 2's; `swapped` exchanges the bodies, so that every kind is met with
/// either body owning the normal.
enum class Shape {
  kVertex,
  kStraight,
  kConvexArc,
  kConcaveArc,
  kConvexEllipse,
  kConcaveEllipse,
  kConvexSuperellipse,
  kConcaveSuperellipse,
  kConvexBezier,
  kConcaveBezier,
};

inline const char* NameOf(Shape shape) {
  constexpr std::array kNames = {"Vertex",        "Straight",       "ConvexArc",          "ConcaveArc",
                                 "ConvexEllipse", "ConcaveEllipse", "ConvexSuperellipse", "ConcaveSuperellipse",
                                 "ConvexBezier",  "ConcaveBezier"};
  return kNames.at(static_cast<size_t>(shape));
}

/// Whether closest points with the shape have no closed form.
inline bool IsGeneral(Shape shape) { return shape >= Shape::kConvexEllipse; }

inline bool IsConcave(Shape shape) {
  return shape == Shape::kConcaveArc || shape == Shape::kConcaveEllipse || shape == Shape::kConcaveSuperellipse ||
         shape == Shape::kConcaveBezier;
}

struct PairKind {
  std::string name;
  Shape shape1;
  Shape shape2;

  bool is_general() const { return IsGeneral(shape1) || IsGeneral(shape2); }
};

/// Kinds with a closed form.
inline const std::vector<PairKind>& ClosedPairKinds() {
  static const std::vector<PairKind> kinds = {
      {"VertexOnStraight", Shape::kVertex, Shape::kStraight},
      {"VertexOnConvexArc", Shape::kVertex, Shape::kConvexArc},
      {"VertexOnConcaveArc", Shape::kVertex, Shape::kConcaveArc},
      {"ConvexArcOnStraight", Shape::kConvexArc, Shape::kStraight},
      {"ConvexArcOnConvexArc", Shape::kConvexArc, Shape::kConvexArc},
      {"ConvexArcInConcaveArc", Shape::kConvexArc, Shape::kConcaveArc},
      {"StraightOnVertex", Shape::kStraight, Shape::kVertex},
      {"ConvexArcOnVertex", Shape::kConvexArc, Shape::kVertex},
      {"ConcaveArcOnVertex", Shape::kConcaveArc, Shape::kVertex},
      {"StraightOnConvexArc", Shape::kStraight, Shape::kConvexArc},
      {"ConcaveArcAroundConvexArc", Shape::kConcaveArc, Shape::kConvexArc},
  };
  return kinds;
}

/// The kinds above, and every pair that has a general curve and can touch: both ways round.
inline const std::vector<PairKind>& AllPairKinds() {
  static const std::vector<PairKind> kinds = [] {
    std::vector<PairKind> all = ClosedPairKinds();
    constexpr int kShapes = static_cast<int>(Shape::kConcaveBezier) + 1;
    for (int i = 0; i < kShapes; ++i) {
      for (int j = 0; j < kShapes; ++j) {
        const auto shape1 = static_cast<Shape>(i);
        const auto shape2 = static_cast<Shape>(j);
        if (!IsGeneral(shape1) && !IsGeneral(shape2)) continue;
        const auto round_or_vertex = [](Shape shape) { return !IsConcave(shape) && shape != Shape::kStraight; };
        const bool can_touch = (round_or_vertex(shape1) || round_or_vertex(shape2)) &&
                               (!IsConcave(shape1) || round_or_vertex(shape2)) &&
                               (!IsConcave(shape2) || round_or_vertex(shape1));
        if (can_touch) all.push_back({std::string(NameOf(shape1)) + "And" + NameOf(shape2), shape1, shape2});
      }
    }
    return all;
  }();
  return kinds;
}

inline std::ostream& operator<<(std::ostream& out, const PairKind& kind) { return out << kind.name; }

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double Uniform(double low, double high) { return low + (high - low) * (static_cast<double>(engine_()) / 0x1p32); }
  Vec2 Vector(double size) { return {Uniform(-size, size), Uniform(-size, size)}; }

 private:
  std::mt19937 engine_;
};

/// A pair of bodies whose features have gap d at a known place, with random velocities.
struct ContactCase {
  Body body1;
  Body body2;
  Feature feature1;
  Feature feature2;
  // As constructed, in the world frame.
  Vec2 n;
  Vec2 p1;
  Vec2 p2;
  double d = 0;
  // Of general curves: the parameters of p1 and p2.
  std::optional<double> s1;
  std::optional<double> s2;

  PlacedFeature Placed1() const { return {feature1, body1.x, SinCos(body1.theta), body1.theta}; }
  PlacedFeature Placed2() const { return {feature2, body2.x, SinCos(body2.theta), body2.theta}; }

  /// The parameters as a search is started: to two decimals.
  SearchStart Start() const {
    const auto rounded = [](std::optional<double> s) {
      return s ? std::optional<double>(std::round(*s * 100) / 100) : std::nullopt;
    };
    return {rounded(s1), rounded(s2), d};
  }

  ClosestPoints Closest(Regularity required = Regularity::kLocalMinimum) const { return Closest(Start(), required); }

  ClosestPoints Closest(const SearchStart& start, Regularity required = Regularity::kLocalMinimum) const {
    return FindClosestPoints(Placed1(), Placed2(), start, required);
  }

  /// Bodies 1 and 2 exchanged.
  ContactCase Swapped() const {
    ContactCase swapped = *this;
    std::swap(swapped.body1, swapped.body2);
    std::swap(swapped.feature1, swapped.feature2);
    std::swap(swapped.p1, swapped.p2);
    std::swap(swapped.s1, swapped.s2);
    swapped.n = -n;
    return swapped;
  }
};

inline Body RandomBody(Random* random) {
  Body body;
  body.mass = random->Uniform(0.5, 5);
  body.inertia = random->Uniform(0.5, 5);
  body.x = random->Vector(3);
  body.theta = random->Uniform(-7, 7);
  body.v = random->Vector(2);
  body.omega = random->Uniform(-3, 3);
  body.force = random->Vector(5);
  body.torque = random->Uniform(-4, 4);
  return body;
}

inline Vec2 ToBody(const Body& body, Vec2 world) {
  const Rotation r = SinCos(body.theta);
  return Rotate({r.cos, -r.sin}, world - body.x);
}

inline Vec2 ToWorld(const Body& body, Vec2 c) { return body.x + Rotate(SinCos(body.theta), c); }

/// The feature with all its lengths times `scale`.
inline Feature Scaled(const Feature& feature, double scale) {
  if (const auto* arc = std::get_if<ArcEdge>(&feature)) {
    return ArcEdge{scale * arc->center, scale * arc->radius, arc->side};
  }
  if (const auto* edge = std::get_if<StraightEdge>(&feature)) return StraightEdge{scale * edge->a, scale * edge->b};
  if (const auto* e = std::get_if<EllipseEdge>(&feature)) {
    return EllipseEdge{scale * e->center, scale * e->a, scale * e->b, e->phi, e->side};
  }
  if (const auto* e = std::get_if<SuperellipseEdge>(&feature)) {
    return SuperellipseEdge{scale * e->center, scale * e->a, scale * e->b, e->m, e->phi, e->side};
  }
  if (const auto* e = std::get_if<BezierEdge>(&feature)) {
    return BezierEdge{{scale * e->P[0], scale * e->P[1], scale * e->P[2], scale * e->P[3]}};
  }
  return Vertex{scale * std::get<Vertex>(feature).p};
}

/// The general curve, turned by r and then moved.
inline Feature Moved(const Feature& feature, Rotation r, Vec2 shift) {
  const double angle = std::atan2(r.sin, r.cos);
  if (const auto* e = std::get_if<EllipseEdge>(&feature)) {
    return EllipseEdge{Rotate(r, e->center) + shift, e->a, e->b, e->phi + angle, e->side};
  }
  if (const auto* e = std::get_if<SuperellipseEdge>(&feature)) {
    return SuperellipseEdge{Rotate(r, e->center) + shift, e->a, e->b, e->m, e->phi + angle, e->side};
  }
  BezierEdge bezier = std::get<BezierEdge>(feature);
  for (Vec2& p : bezier.P) p = Rotate(r, p) + shift;
  return bezier;
}

/// A general curve about its own origin and a parameter where it is well curved.
inline std::pair<Feature, double> RandomCurve(Shape shape, Random* random) {
  constexpr double kQuarter = 0.785398163397448310;
  const Side side = IsConcave(shape) ? Side::kConcave : Side::kConvex;
  const double a = random->Uniform(0.5, 1.5);
  const double b = random->Uniform(0.5, 1.5);
  if (shape == Shape::kConvexEllipse || shape == Shape::kConcaveEllipse) {
    return {EllipseEdge{random->Vector(0.3), a, b, random->Uniform(-4, 4), side}, random->Uniform(-3, 3)};
  }
  if (shape == Shape::kConvexSuperellipse || shape == Shape::kConcaveSuperellipse) {
    const int m = 2 + 2 * static_cast<int>(random->Uniform(0, 4));
    // Near a corner: on the sides the curve is nearly flat.
    const double tau = kQuarter * (1 + 2 * std::floor(random->Uniform(-2, 2))) + random->Uniform(-0.15, 0.15);
    return {SuperellipseEdge{random->Vector(0.3), a, b, m, random->Uniform(-4, 4), side},
            std::atan2(b * std::sin(tau), a * std::cos(tau))};
  }
  BezierEdge bezier{{Vec2{1, 0}, Vec2{1, 0.6}, Vec2{0.6, 1}, Vec2{0, 1}}};
  for (Vec2& p : bezier.P) p = p + random->Vector(0.1);
  const double s = random->Uniform(0.2, 0.8);
  if (side == Side::kConvex) return {bezier, s};
  return {BezierEdge{{bezier.P[3], bezier.P[2], bezier.P[1], bezier.P[0]}}, 1 - s};
}

/// The feature of `body` that passes through the world point p with outward normal N.
/// @param radius  of curvature there
/// @param s       receives the parameter of p on a general curve
inline Feature FeatureThrough(Shape shape, const Body& body, Vec2 p, Vec2 N, double radius, Random* random,
                              std::optional<double>* s = nullptr) {
  if (shape == Shape::kVertex) return Vertex{ToBody(body, p)};
  if (shape == Shape::kConvexArc) return ArcEdge{ToBody(body, p - radius * N), radius, Side::kConvex};
  if (shape == Shape::kConcaveArc) return ArcEdge{ToBody(body, p + radius * N), radius, Side::kConcave};
  if (shape == Shape::kStraight) {
    const Vec2 along = Perp(N);  // material on the left: N is on the right-hand side of `along`
    const Vec2 a = p - random->Uniform(0.2, 2) * along;
    const Vec2 b = p + random->Uniform(0.2, 2) * along;
    return StraightEdge{ToBody(body, a), ToBody(body, b)};
  }
  const auto [curve, parameter] = RandomCurve(shape, random);
  const double scale = radius * std::abs(EvaluateEdge(curve, parameter).kappa);
  const Feature scaled = Scaled(curve, scale);
  const EdgePoint at = EvaluateEdge(scaled, parameter);
  const Rotation body_turn = SinCos(body.theta);
  const Vec2 N_body = Rotate({body_turn.cos, -body_turn.sin}, N);
  const Rotation turn = {Dot(at.N, N_body), Cross(at.N, N_body)};
  if (s != nullptr) *s = parameter;
  return Moved(scaled, turn, ToBody(body, p) - Rotate(turn, at.c));
}

/// @param d  the gap; every third case is drawn with d = 0 by RandomContact(kind, random)
inline ContactCase RandomContact(const PairKind& kind, double d, Random* random) {
  ContactCase c;
  c.body1 = RandomBody(random);
  c.body2 = RandomBody(random);
  const double angle = random->Uniform(-3.2, 3.2);
  const Rotation r = SinCos(angle);
  c.n = {r.cos, r.sin};
  c.d = d;
  c.p2 = random->Vector(3);
  c.p1 = c.p2 + d * c.n;
  // Within a concave arc the convex one must be smaller, by a margin that keeps D away from 0.
  const auto radius = [&](Shape shape) {
    return IsConcave(shape) ? random->Uniform(1.5, 4) : random->Uniform(0.3, 1.2);
  };
  c.feature1 = FeatureThrough(kind.shape1, c.body1, c.p1, -c.n, radius(kind.shape1), random, &c.s1);
  c.feature2 = FeatureThrough(kind.shape2, c.body2, c.p2, c.n, radius(kind.shape2), random, &c.s2);
  return c;
}

inline ContactCase RandomContact(const PairKind& kind, Random* random) {
  const double choice = random->Uniform(0, 3);
  return RandomContact(kind, choice < 1 ? 0 : random->Uniform(-0.15, 0.15), random);
}

/// Between bodies 0 and 1.
inline Constraint ConstraintOf(const ContactCase& c, ConstraintType type = ConstraintType::kContact) {
  Constraint constraint;
  constraint.type = type;
  constraint.feature1 = c.feature1;
  constraint.feature2 = c.feature2;
  const SearchStart start = c.Start();
  constraint.s1 = start.s1;
  constraint.s2 = start.s2;
  constraint.nominal_gap = start.nominal_gap;
  return constraint;
}

inline ContactSystem SystemOf(const ContactCase& c, ConstraintType type = ConstraintType::kContact) {
  return {"pair", {c.body1, c.body2}, {ConstraintOf(c, type)}};
}

/// check(case, random) over seeded random configurations, until a test fails.
template <class Check>
void OverRandomContacts(const PairKind& kind, int cases, unsigned seed, const Check& check) {
  Random random(seed);
  for (int i = 0; i < cases; ++i) {
    SCOPED_TRACE(i);
    const ContactCase c = RandomContact(kind, &random);
    check(c, &random);
    if (::testing::Test::HasFailure()) return;
  }
}

/// What assembly says of `system`; "" where it takes it.
inline std::string ErrorOf(const ContactSystem& system) {
  try {
    AssembleContactLcp(system);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

/// Signed radius of curvature at s: 0 for a vertex, and for a straight edge, which has none.
inline double SignedRadius(const Feature& feature, std::optional<double> s) {
  if (const auto* arc = std::get_if<ArcEdge>(&feature)) return arc->side == Side::kConvex ? arc->radius : -arc->radius;
  if (std::holds_alternative<Vertex>(feature) || std::holds_alternative<StraightEdge>(feature)) return 0;
  return 1 / EvaluateEdge(feature, s.value()).kappa;
}

/// The vertex or the centre of curvature at s, in the body frame.
inline Vec2 Center(const Feature& feature, std::optional<double> s) {
  if (const auto* arc = std::get_if<ArcEdge>(&feature)) return arc->center;
  if (const auto* vertex = std::get_if<Vertex>(&feature)) return vertex->p;
  const EdgePoint at = EvaluateEdge(feature, s.value());
  return at.c - (1 / at.kappa) * at.N;
}

/// Vectors in long double, for references that share no code with the model.
struct LongVec {
  long double x = 0;
  long double y = 0;
};
inline LongVec operator+(LongVec a, LongVec b) { return {a.x + b.x, a.y + b.y}; }
inline LongVec operator-(LongVec a, LongVec b) { return {a.x - b.x, a.y - b.y}; }
inline LongVec operator*(long double s, LongVec a) { return {s * a.x, s * a.y}; }
inline long double Dot(LongVec a, LongVec b) { return a.x * b.x + a.y * b.y; }
inline long double Cross(LongVec a, LongVec b) { return a.x * b.y - a.y * b.x; }
inline long double Norm(LongVec a) { return std::sqrt(Dot(a, a)); }
inline LongVec Long(Vec2 a) { return {static_cast<long double>(a.x), static_cast<long double>(a.y)}; }
inline LongVec Turned(LongVec a, long double angle) {
  const long double cosine = std::cos(angle);
  const long double sine = std::sin(angle);
  return {cosine * a.x - sine * a.y, sine * a.x + cosine * a.y};
}

/// A feature's point in the body frame, by the definitions of feature.h; s does not matter for a vertex.
inline LongVec LongPoint(const Feature& feature, long double s) {
  const auto oval = [&](const auto& e, LongVec local) {
    return Long(e.center) + Turned(local, static_cast<long double>(e.phi));
  };
  if (const auto* arc = std::get_if<ArcEdge>(&feature)) {
    return Long(arc->center) + static_cast<long double>(arc->radius) * LongVec{std::cos(s), std::sin(s)};
  }
  if (const auto* edge = std::get_if<StraightEdge>(&feature))
    return Long(edge->a) + s * (Long(edge->b) - Long(edge->a));
  if (const auto* e = std::get_if<EllipseEdge>(&feature)) {
    return oval(*e, {static_cast<long double>(e->a) * std::cos(s), static_cast<long double>(e->b) * std::sin(s)});
  }
  if (const auto* e = std::get_if<SuperellipseEdge>(&feature)) {
    const auto m = static_cast<long double>(e->m);
    const long double x = std::abs(std::cos(s) / static_cast<long double>(e->a));
    const long double y = std::abs(std::sin(s) / static_cast<long double>(e->b));
    return oval(*e, std::pow(std::pow(x, m) + std::pow(y, m), -1 / m) * LongVec{std::cos(s), std::sin(s)});
  }
  if (const auto* e = std::get_if<BezierEdge>(&feature)) {
    const long double r = 1 - s;
    return r * r * r * Long(e->P[0]) + 3 * r * r * s * Long(e->P[1]) + 3 * r * s * s * Long(e->P[2]) +
           s * s * s * Long(e->P[3]);
  }
  return Long(std::get<Vertex>(feature).p);
}

/// +1 where the material is on the left of increasing s, -1 where it is on the right.
inline int MaterialSide(const Feature& feature) {
  const auto sign = [](Side side) { return side == Side::kConvex ? 1 : -1; };
  if (const auto* arc = std::get_if<ArcEdge>(&feature)) return sign(arc->side);
  if (const auto* e = std::get_if<EllipseEdge>(&feature)) return sign(e->side);
  if (const auto* e = std::get_if<SuperellipseEdge>(&feature)) return sign(e->side);
  return 1;
}

inline bool IsStraight(const Feature& feature) { return std::holds_alternative<StraightEdge>(feature); }

}  // namespace lcpbench::testing
