#pragma once

#include "model/contact/assembly.h"
#include "model/contact/body.h"
#include "model/contact/closest_points.h"
#include "model/contact/system.h"
#include "model/geometry/smooth_curve.h"
#include "tests/support/refusal.h"

namespace lcpbench::testing {

inline constexpr double kPi = std::numbers::pi;
inline constexpr double kInfinity = std::numeric_limits<double>::infinity();
inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// An edge at one parameter: everything that contact needs of it, in the body frame.
struct EdgePoint {
  Vec2 c;            ///< c(s) [m]
  Vec2 d1;           ///< c'(s), by the edge's own parameter (feature.h)
  Vec2 d2;           ///< c''(s)
  Vec2 N;            ///< outward unit normal, away from the material
  double kappa = 0;  ///< signed curvature [1/m]: > 0 convex, 0 straight, < 0 concave
};

/// An edge at s: the model's evaluation of general curves (SmoothCurve) in 32 digits, and closed forms of the others.
///   N = (c'_y, -c'_x)/|c'|,  kappa = (c' x c'')/|c'|^3  for material on the left, as of straight edges, Bezier curves
///   and convex ovals; both change sign for concave ones.   [docs/model.md section 1]
/// @param edge  any feature but a vertex, valid (RequireValid)
/// @param s     finite; beyond the ends of a straight edge or Bezier curve: of the line, of the polynomials
inline EdgePoint EvaluateEdge(const Feature& edge, double s) {
  if (const auto* straight = std::get_if<StraightEdge>(&edge)) {
    const Vec2 along = straight->Direction(s);
    return {straight->Point(s), along, {0, 0}, -Perp(Unit(along)), 0};
  }
  if (const auto* arc = std::get_if<ArcEdge>(&edge)) {
    const Vec2 radial = LiftRotation<double>(SinCos(s));
    const double sign = SignOf(arc->side);
    return {arc->center + arc->radius * radial, arc->radius * Perp(radial), -arc->radius * radial, sign * radial,
            sign / arc->radius};
  }
  const SmoothCurve curve({edge, {}, {}});
  const CurvePlace<DoubleDouble> place = curve.FromParameter(s);
  CurveJet<DoubleDouble> jet = curve.At(place);
  if (const auto* oval = std::get_if<SuperellipseEdge>(&edge)) {
    // From derivatives by tau to derivatives by the polar angle s:
    // tan tau = (a/b) tan s, dtau/ds = (a/b) cos^2 tau + (b/a) sin^2 tau.
    const DoubleDouble a = oval->a;
    const DoubleDouble b = oval->b;
    const DoubleDouble rate = (a / b) * place.x * place.x + (b / a) * place.y * place.y;
    const DoubleDouble rate_by_tau = DoubleDouble(2) * (b / a - a / b) * place.x * place.y;
    jet.d2 = (rate * rate) * jet.d2 + (rate * rate_by_tau) * jet.d1;
    jet.d1 = rate * jet.d1;
  }
  return {ToVec2(jet.c), ToVec2(jet.d1), ToVec2(jet.d2), ToVec2(jet.N), ToDouble(jet.kappa)};
}

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

/// The kinds that fulfil a condition.
template <class Condition>
std::vector<PairKind> PairKindsWhere(const Condition& condition) {
  std::vector<PairKind> kinds = AllPairKinds();
  std::erase_if(kinds, [&](const PairKind& kind) { return !condition(kind); });
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

inline Vec2 UnitVector(double angle) { return LiftRotation<double>(SinCos(angle)); }

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
  // The parameters of p1 and p2 on general curves.
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

  ClosestPoints Closest() const { return Closest(Start()); }
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

inline Vec2 ToWorld(const Body& body, Vec2 c) { return body.x + Rotate(SinCos(body.theta), c); }

/// The feature or curve with all its lengths times `scale`.
template <class Variant>
Variant Scaled(Variant feature, double scale) {
  ForEachPoint(feature, [&](Vec2& p) { p = scale * p; });
  std::visit(
      [&](auto& e) {
        if constexpr (requires { e.radius; }) e.radius *= scale;
        if constexpr (requires { e.phi; }) {
          e.a *= scale;
          e.b *= scale;
        }
      },
      feature);
  return feature;
}

/// The general curve, turned by r and then moved.
inline Feature Moved(Feature feature, Rotation r, Vec2 shift) {
  ForEachPoint(feature, [&](Vec2& p) { p = Rotate(r, p) + shift; });
  std::visit(
      [&](auto& e) {
        if constexpr (requires { e.phi; }) e.phi += std::atan2(r.sin, r.cos);
      },
      feature);
  return feature;
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
  if (shape == Shape::kVertex) return Vertex{BodyPoint(body, p)};
  if (shape == Shape::kConvexArc) return ArcEdge{BodyPoint(body, p - radius * N), radius, Side::kConvex};
  if (shape == Shape::kConcaveArc) return ArcEdge{BodyPoint(body, p + radius * N), radius, Side::kConcave};
  if (shape == Shape::kStraight) {
    const Vec2 along = Perp(N);  // material on the left: N is on the right-hand side of `along`
    const Vec2 a = p - random->Uniform(0.2, 2) * along;
    const Vec2 b = p + random->Uniform(0.2, 2) * along;
    return StraightEdge{BodyPoint(body, a), BodyPoint(body, b)};
  }
  const auto [curve, parameter] = RandomCurve(shape, random);
  const double scale = radius * std::abs(EvaluateEdge(curve, parameter).kappa);
  const Feature scaled = Scaled(curve, scale);
  const EdgePoint at = EvaluateEdge(scaled, parameter);
  const Rotation body_turn = SinCos(body.theta);
  const Vec2 N_body = Rotate({body_turn.cos, -body_turn.sin}, N);
  const Rotation turn = {Dot(at.N, N_body), Cross(at.N, N_body)};
  if (s != nullptr) *s = parameter;
  return Moved(scaled, turn, BodyPoint(body, p) - Rotate(turn, at.c));
}

/// @param d  the gap; every third case is drawn with d = 0 by RandomContact(kind, random)
inline ContactCase RandomContact(const PairKind& kind, double d, Random* random) {
  ContactCase c;
  c.body1 = RandomBody(random);
  c.body2 = RandomBody(random);
  c.n = UnitVector(random->Uniform(-3.2, 3.2));
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
  const SearchStart start = c.Start();
  return {type, 0, 1, c.feature1, c.feature2, start.s1, start.s2, start.nominal_gap};
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

/// |x - y| / (1 + |y|) <= tolerance, as the reference data are scaled.
inline void ExpectClose(double x, double y, double tolerance, const std::string& what) {
  EXPECT_LE(std::abs(x - y), tolerance * (1 + std::abs(y))) << what << ": " << x << " against " << y;
}

/// J times velocities or accelerations, linear and angular, of bodies 1 and 2.
inline double RowTimes(const std::array<double, 6>& J, Vec2 v1, double omega1, Vec2 v2, double omega2) {
  return J[0] * v1.x + J[1] * v1.y + J[2] * omega1 + J[3] * v2.x + J[4] * v2.y + J[5] * omega2;
}

/// J of the bodies exchanged, bit by bit.
inline void ExpectExchanged(const std::array<double, 6>& J, const std::array<double, 6>& other) {
  for (size_t k = 0; k < 6; ++k) EXPECT_EQ(J[k], other[(k + 3) % 6]);
}

/// What assembly says of `system`; "" where it takes it.
inline std::string ErrorOf(const ContactSystem& system) {
  return lcpbench::RefusalOf([&] { AssembleContactLcp(system); });
}

/// What the search for closest points says of two features about the origin; "" where it finds them.
inline std::string RefusalOf(const Feature& feature1, const Feature& feature2, const SearchStart& start = {},
                             Regularity required = Regularity::kLocalMinimum) {
  return lcpbench::RefusalOf([&] { FindClosestPoints({feature1, {}, {}}, {feature2, {}, {}}, start, required); });
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

/// Vectors in long double, for references.
using LongVec = VecOf<long double>;
inline long double Norm(LongVec a) { return std::sqrt(Dot(a, a)); }
inline LongVec Long(Vec2 a) { return {static_cast<long double>(a.x), static_cast<long double>(a.y)}; }
inline LongVec Turned(LongVec a, long double angle) {
  const long double cosine = std::cos(angle);
  const long double sine = std::sin(angle);
  return {cosine * a.x - sine * a.y, sine * a.x + cosine * a.y};
}

/// A feature's point in the body frame, by the definitions of its curve, in the arithmetic of T; s does not matter for
/// a vertex.
template <class T>
VecOf<T> ReferencePoint(const Feature& feature, const T& s) {
  using std::cos, std::sin, std::pow;
  using Vec = VecOf<T>;
  const auto lift = [](Vec2 a) { return Vec{T(a.x), T(a.y)}; };
  const auto oval = [&](const auto& e, Vec local) {
    return lift(e.center) + Turn(Vec{T(cos(T(e.phi))), T(sin(T(e.phi)))}, local);
  };
  return std::visit(Overloaded{[&](const Vertex& v) { return lift(v.p); },
                               [&](const StraightEdge& e) { return lift(e.a) + s * (lift(e.b) - lift(e.a)); },
                               [&](const ArcEdge& e) {
                                 return lift(e.center) + T(e.radius) * Vec{T(cos(s)), T(sin(s))};
                               },
                               [&](const EllipseEdge& e) {
                                 return oval(e, {T(T(e.a) * cos(s)), T(T(e.b) * sin(s))});
                               },
                               [&](const SuperellipseEdge& e) {
                                 const T x = cos(s) / T(e.a);
                                 const T y = sin(s) / T(e.b);
                                 const T power = pow(T(x * x), e.m / 2) + pow(T(y * y), e.m / 2);
                                 const T radius = pow(power, T(T(-1) / T(e.m)));
                                 return oval(e, radius * Vec{T(cos(s)), T(sin(s))});
                               },
                               [&](const BezierEdge& e) {
                                 const T r = 1 - s;
                                 return T(r * r * r) * lift(e.P[0]) + T(3 * r * r * s) * lift(e.P[1]) +
                                        T(3 * r * s * s) * lift(e.P[2]) + T(s * s * s) * lift(e.P[3]);
                               }},
                    feature);
}

inline LongVec LongPoint(const Feature& feature, long double s) { return ReferencePoint(feature, s); }

/// +1 where the material is on the left of increasing s, -1 where it is on the right.
inline int MaterialSide(const Feature& feature) {
  return std::visit(
      [](const auto& e) {
        if constexpr (requires { e.side; }) return e.side == Side::kConvex ? 1 : -1;
        return 1;
      },
      feature);
}

inline bool IsStraight(const Feature& feature) { return std::holds_alternative<StraightEdge>(feature); }

}  // namespace lcpbench::testing
