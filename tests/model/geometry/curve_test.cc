#include "model/geometry/smooth_curve.h"

#include <boost/math/constants/constants.hpp>
#include <boost/multiprecision/cpp_bin_float.hpp>

#include "tests/model/contact/random_contacts.h"

namespace lcpbench::testing {
namespace {

using Exact = boost::multiprecision::cpp_bin_float_100;

constexpr int kCases = 200;
constexpr int kFirstGeneral = static_cast<int>(Shape::kConvexEllipse);

// The point, its derivatives by central differences (60 digits are left), N and kappa by their definitions.
EdgePoint Reference(const Feature& feature, double s) {
  const Exact h("1e-20");
  const auto at = ReferencePoint(feature, Exact(s));
  const auto after = ReferencePoint(feature, Exact(s + h));
  const auto before = ReferencePoint(feature, Exact(s - h));
  const VecOf<Exact> d1 = Exact(1 / (2 * h)) * (after - before);
  const VecOf<Exact> d2 = Exact(1 / (h * h)) * ((after - at) - (at - before));
  const Exact speed = sqrt(Dot(d1, d1));
  const Exact side = MaterialSide(feature);
  const auto round = [](const VecOf<Exact>& a) { return Vec2{static_cast<double>(a.x), static_cast<double>(a.y)}; };
  return {round(at), round(d1), round(d2), round(Exact(-side / speed) * Perp(d1)),
          static_cast<double>(side * Cross(d1, d2) / (speed * speed * speed))};
}

void ExpectMatches(const EdgePoint& found, const EdgePoint& expected, double tolerance) {
  EXPECT_LE(Norm(found.c - expected.c), tolerance * (1 + Norm(expected.c)));
  EXPECT_LE(Norm(found.d1 - expected.d1), tolerance * (1 + Norm(expected.d1)));
  EXPECT_LE(Norm(found.d2 - expected.d2), tolerance * (1 + Norm(expected.d2)));
  EXPECT_LE(Norm(found.N - expected.N), tolerance);
  EXPECT_LE(std::abs(found.kappa - expected.kappa), tolerance * std::abs(expected.kappa) + 1e-30);
}

TEST(Curve, PointsDerivativesNormalsAndCurvaturesFollowTheDefinitionsToTheLastDigits) {
  Random random(1);
  for (int i = 0; i < 8 * kCases; ++i) {
    const int kind = i % 8;
    const Side side = i % 16 < 8 ? Side::kConvex : Side::kConcave;
    const Feature curve = kind == 0   ? Feature(ArcEdge{random.Vector(2), random.Uniform(0.1, 3), side})
                          : kind == 1 ? Feature(StraightEdge{random.Vector(2), random.Vector(2)})
                                      : RandomCurve(static_cast<Shape>(kFirstGeneral + kind - 2), &random).first;
    const double s = std::holds_alternative<BezierEdge>(curve) ? random.Uniform(0, 1) : random.Uniform(-7, 7);
    ExpectMatches(EvaluateEdge(curve, s), Reference(curve, s), 2e-15);
    ASSERT_FALSE(HasFailure()) << Describe(curve) << " at " << s;
  }
}

TEST(Curve, CurvatureOfSuperellipseVanishesOnItsAxesAndIsNeverNoise) {
  for (const int m : {4, 6, 10, 50, 1000}) {
    const SuperellipseEdge edge{{0.1, 0.2}, 1.5, 0.7, m, 0.3, Side::kConvex};
    EXPECT_EQ(EvaluateEdge(edge, 0).kappa, 0);
    for (int k = -4; k <= 4; ++k) {
      // A multiple of pi/2 is off the axis by its rounding.
      const EdgePoint at = EvaluateEdge(edge, k * kPi / 2);
      EXPECT_TRUE(IsFinite(at.c) && IsFinite(at.d1) && IsFinite(at.d2) && std::isfinite(at.kappa));
      EXPECT_NEAR(Norm(at.N), 1, 1e-15);
      EXPECT_GE(at.kappa, 0);
      EXPECT_LE(at.kappa, 1e-28);
    }
    double last = 0;
    for (double s = 1e-12; s < 0.05; s *= 10) {
      const double kappa = EvaluateEdge(edge, s).kappa;
      EXPECT_GE(kappa, last) << "grows off the axis";
      last = kappa;
    }
  }
}

TEST(Curve, AspectRatiosOfAMillionKeepTheirDigits) {
  Random random(5);
  for (int i = 0; i < kCases; ++i) {
    const double b = i % 2 == 0 ? 1e-6 : 1e6;
    const EllipseEdge ellipse{{0, 0}, 1, b, 0, Side::kConvex};
    const SuperellipseEdge oval{{0, 0}, 1, b, 4, 0, Side::kConvex};
    for (const double s : {random.Uniform(-4, 4), random.Uniform(-1e-5, 1e-5), kPi / 2 + random.Uniform(-1e-5, 1e-5)}) {
      const EdgePoint e = EvaluateEdge(ellipse, s);
      const EdgePoint r = Reference(ellipse, s);
      EXPECT_NEAR(e.kappa, r.kappa, 1e-10 * r.kappa);
      const EdgePoint f = EvaluateEdge(oval, s);
      const EdgePoint g = Reference(oval, s);
      EXPECT_LE(Norm(f.c - g.c), 1e-15 * Norm(g.c) + 1e-15);
      // cos s, rounded, is off by 1e-16 and decides by its ratio to 1e-6 here.
      EXPECT_NEAR(f.kappa, g.kappa, 1e-9 * g.kappa);
    }
  }
}

TEST(Curve, BezierCurveOfCollinearPointsIsStraight) {
  const BezierEdge bezier{{Vec2{0, 0}, Vec2{0.5, 0.25}, Vec2{1, 0.5}, Vec2{2, 1}}};
  for (const double s : {0.0, 0.3, 1.0}) {
    const EdgePoint at = EvaluateEdge(bezier, s);
    EXPECT_EQ(at.kappa, 0);
    EXPECT_NEAR(Norm(at.N - EvaluateEdge(StraightEdge{{0, 0}, {2, 1}}, s).N), 0, 1e-15);
  }
}

std::string Refusal(const Feature& feature) {
  return lcpbench::RefusalOf([&] { RequireValid(feature); });
}

TEST(Curve, InvalidOnesAreRefusedNamingConditionAndCurve) {
  const auto ellipse = [](double a, double b, double phi = 0, double x = 0) {
    return EllipseEdge{{x, 0}, a, b, phi, Side::kConvex};
  };
  const auto oval = [](double a, double b, int m, double phi = 0) {
    return SuperellipseEdge{{0, 0}, a, b, m, phi, Side::kConvex};
  };
  const auto bezier = [](Vec2 p0, Vec2 p1, Vec2 p2, Vec2 p3) { return BezierEdge{{p0, p1, p2, p3}}; };
  const std::vector<std::pair<Feature, std::string>> cases = {
      {ellipse(0, 1), "must be > 0"},
      {ellipse(1, -1), "must be > 0"},
      {ellipse(kNaN, 1), "not finite"},
      {ellipse(1, kInfinity), "not finite"},
      {ellipse(1, 1, kNaN), "not finite"},
      {ellipse(1, 1, 0, kInfinity), "not finite"},
      {ellipse(1e200, 1e-200), "overflows"},
      {oval(1, 0, 4), "must be > 0"},
      {oval(1, 1, 3), "even and >= 2, and at most 1000"},
      {oval(1, 1, 0), "even and >= 2, and at most 1000"},
      {oval(1, 1, -4), "even and >= 2, and at most 1000"},
      {oval(1, 1, 1002), "even and >= 2, and at most 1000"},
      {oval(1, 1, 4, kNaN), "not finite"},
      {oval(1.1e6, 1, 4), "aspect ratio"},
      {ellipse(1, 0.9e-6), "aspect ratio"},
      {bezier({0, 0}, {0, 0}, {0, 0}, {0, 0}), "derivative vanishes"},
      {bezier({0, 0}, {0, 0}, {1, 0}, {1, 1}), "derivative vanishes"},
      {bezier({0, 0}, {1, 0}, {1, 1}, {1, 1}), "derivative vanishes"},
      {bezier({0, 0}, {1, 1}, {0, 1}, {1, 0}), "derivative vanishes"},   // a cusp at 1/2
      {bezier({0, 0}, {2, 0}, {-1, 0}, {1, 0}), "derivative vanishes"},  // there and back
      {bezier({0, kNaN}, {1, 0}, {1, 1}, {1, 2}), "not finite"},
      {bezier({-1e200, 0}, {1e200, 0}, {1, 1}, {1, 2}), "overflows"},
  };
  for (const auto& [feature, condition] : cases) {
    for (const std::string& words : {condition, Describe(feature)}) {
      ExpectRefused([&feature = feature] { RequireValid(feature); }, words);
    }
  }
  EXPECT_EQ(Refusal(ellipse(1, 1e-6)), "");
  EXPECT_EQ(Refusal(oval(1e-6, 1, 100)), "");
  EXPECT_EQ(Refusal(oval(1, 1, 1000)), "");
  EXPECT_EQ(Refusal(bezier({0, 0}, {1, 0}, {1, 1}, {0, 1})), "");
  EXPECT_EQ(Refusal(bezier({0, 0}, {1, 1}, {2, 2}, {3, 3})), "");
}

TEST(Curve, CuspsInAnyDirectionAreFound) {
  Random random(6);
  for (int i = 0; i < kCases; ++i) {
    // c' = (s - s0) times a linear function: the differences of its control points.
    const double s0 = random.Uniform(0, 1);
    const Vec2 p = random.Vector(2);
    const Vec2 q = random.Vector(2);
    const auto first = -s0 * p;
    const auto last = (1 - s0) * q;
    const auto middle = 0.5 * ((1 - s0) * p - s0 * q);
    const Vec2 start = random.Vector(2);
    const BezierEdge edge{{start, start + first, start + first + middle, start + first + middle + last}};
    EXPECT_NE(Refusal(edge), "") << Describe(edge);
  }
}

}  // namespace
}  // namespace lcpbench::testing
