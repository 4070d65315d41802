#include "model/shape/shapes.h"
#include "tests/model/shape/random_outlines.h"

namespace lcpbench::testing {
namespace {

constexpr double kExact = 1e-14;
constexpr double kAccurate = 1e-13;

// Area, centre of mass and inertia about it for density 1, as a closed form gives them.
struct Expected {
  double area;
  Vec2 center;
  double inertia;

  Expected operator-() const { return {-area, center, -inertia}; }
};

// Two parts together, by Steiner's theorem.
Expected operator+(const Expected& a, const Expected& b) {
  const double area = a.area + b.area;
  const Vec2 apart = a.center - b.center;
  const Vec2 center = (a.area / area) * a.center + (b.area / area) * b.center;
  return {area, center, a.inertia + b.inertia + a.area * b.area / area * Dot(apart, apart)};
}

Expected DiscAt(Vec2 at, double r) { return {kPi * r * r, at, kPi * r * r * r * r / 2}; }
Expected BoxAt(Vec2 at, double w, double h) { return {w * h, at, w * h * (w * w + h * h) / 12}; }
// The half of a disc about `at` that lies in a direction: its centroid is 4r/3pi away.
Expected HalfDiscAt(Vec2 at, Vec2 direction, double r) {
  const double half = kPi * r * r / 2;
  const double arm = 4 * r / (3 * kPi);
  return {half, at + arm * direction, half * r * r / 2 - half * arm * arm};
}
// The quarter in the directions of two unit vectors along the axes.
Expected QuarterDiscAt(Vec2 at, Vec2 directions, double r) {
  const double quarter = kPi * r * r / 4;
  const double arm = 4 * r / (3 * kPi);
  return {quarter, at + arm * directions, quarter * r * r / 2 - quarter * 2 * arm * arm};
}

// Lengths are compared in units of the gyradius.
void ExpectSame(const MassProperties& p, const MassProperties& q, double tolerance) {
  EXPECT_NEAR(p.area / q.area, 1, tolerance);
  EXPECT_NEAR(p.mass / q.mass, 1, tolerance);
  EXPECT_NEAR(p.inertia / q.inertia, 1, tolerance);
  EXPECT_NEAR(Norm(p.center - q.center) / std::sqrt(q.inertia / q.mass), 0, tolerance);
}

void ExpectProperties(const Outline& outline, const Expected& expected, double tolerance = kAccurate) {
  SCOPED_TRACE(outline.name);
  const double density = 3.5;
  ExpectSame(ComputeMassProperties(outline, density),
             {{}, expected.area, density * expected.area, expected.center, density * expected.inertia}, tolerance);
}

AreaMoments MomentsOf(const Outline& outline) {
  AreaMoments sum;
  for (const OutlineLoop& loop : outline.loops) sum = sum + LoopMoments(loop, {});
  return sum;
}

// Every piece cut at a random parameter.
Outline Subdivided(const Outline& outline, Random* random) {
  Outline cut{outline.name, {}};
  for (const OutlineLoop& loop : outline.loops) {
    cut.loops.emplace_back();
    for (const OutlinePiece& piece : loop) {
      const double middle = piece.s_begin + random->Uniform(0.1, 0.9) * (piece.s_end - piece.s_begin);
      cut.loops.back().push_back({piece.edge, piece.s_begin, middle});
      cut.loops.back().push_back({piece.edge, middle, piece.s_end});
    }
  }
  return cut;
}

TEST(MassProperties, DiscsAndDifferencesOfTwoHaveClosedForms) {
  for (const double r : {1e-6, 0.3, 1.0, 7e5}) ExpectProperties(Disc(r), DiscAt({}, r), kExact);
  for (const auto& [R, r] : {std::pair(1.0, 0.5), std::pair(2.0, 1.9), std::pair(3.0, 0.001)}) {
    ExpectProperties(Ring(R, r), DiscAt({}, R) + -DiscAt({}, r));
  }
  Outline eccentric = Disc(2);
  eccentric.loops.push_back({Arc({0.7, -0.4}, 0.5, 2 * kPi, 0)});
  ExpectProperties(eccentric, DiscAt({}, 2) + -DiscAt({0.7, -0.4}, 0.5));
}

TEST(MassProperties, EllipseHasClosedForm) {
  for (const auto& [a, b] : {std::pair(2.0, 1.0), std::pair(1.0, 5.0), std::pair(1e6, 1.0), std::pair(1.0, 1e6)}) {
    const Expected expected{kPi * a * b, {}, kPi * a * b * (a * a + b * b) / 4};
    ExpectProperties(Ellipse(a, b), expected, kExact);
    ExpectProperties(Transformed(Ellipse(a, b), 0.7, {}), expected, kExact);
  }
}

TEST(MassProperties, ShapesOfBoxesAndArcsAreTheSumsOfTheirParts) {
  for (const auto& [w, h] : {std::pair(2.0, 1.0), std::pair(1e6, 1.0), std::pair(1.0, 1.0)}) {
    ExpectProperties(Box(w, h), BoxAt({}, w, h), kExact);
  }
  const double w = 3;
  const double h = 2;
  for (const double r : {1e-3, 0.4, 0.999}) {
    Expected rounded = BoxAt({}, w - 2 * r, h);
    for (const double side : {-1.0, 1.0}) {
      rounded = rounded + BoxAt({side * (w - r) / 2, 0}, r, h - 2 * r);
      for (const double end : {-1.0, 1.0}) {
        rounded = rounded + QuarterDiscAt({side * (w / 2 - r), end * (h / 2 - r)}, {side, end}, r);
      }
    }
    ExpectProperties(RoundedBox(w, h, r), rounded);
  }
  ExpectProperties(HalfDisc(1.7), HalfDiscAt({}, {0, 1}, 1.7));
  ExpectProperties(DShape(0.9, 1.7), HalfDiscAt({}, {1, 0}, 1.7) + BoxAt({-0.45, 0}, 0.9, 3.4));
  for (const auto& [l, r] : {std::pair(2.0, 0.5), std::pair(1e-3, 1.0), std::pair(1e5, 1.0)}) {
    const Expected ends = HalfDiscAt({l / 2, 0}, {1, 0}, r) + HalfDiscAt({-l / 2, 0}, {-1, 0}, r);
    ExpectProperties(Capsule(l, r), ends + BoxAt({}, l, 2 * r));
  }
}

TEST(MassProperties, TriangleHasItsCentroidAndSumOfSquaredSides) {
  Random random(1);
  for (int k = 0; k < 500; ++k) {
    Vec2 a = random.Vector(2);
    Vec2 b = random.Vector(2);
    const Vec2 c = random.Vector(2);
    if (Cross(b - a, c - a) < 0) std::swap(a, b);
    const double area = Cross(b - a, c - a) / 2;
    if (area < 0.1) continue;
    const double squares = Dot(b - a, b - a) + Dot(c - b, c - b) + Dot(a - c, a - c);
    ExpectProperties(Polygon({a, b, c}), {area, (1.0 / 3) * (a + b + c), area * squares / 36});
  }
}

TEST(MassProperties, SuperellipseHasTheGammaFunctionForm) {
  // The integral of x^(p-1) y^(q-1) over a quadrant of x^m + y^m <= 1 [Dirichlet].
  const auto dirichlet = [](double p, double q, double m) {
    return std::exp(std::lgamma(p / m) + std::lgamma(q / m) - std::lgamma(1 + (p + q) / m)) / (m * m);
  };
  for (const int m : {2, 4, 6, 10, 50, 1000}) {
    for (const auto& [a, b] : {std::pair(1.0, 1.0), std::pair(2.0, 0.3), std::pair(1.0, 1e6), std::pair(1e6, 1.0)}) {
      SCOPED_TRACE(std::to_string(m) + " " + std::to_string(a));
      const double area = 4 * a * b * dirichlet(1, 1, m);
      const double inertia = 4 * a * b * (a * a + b * b) * dirichlet(3, 1, m);
      ExpectProperties(Superellipse(a, b, m), {area, {}, inertia}, kAccurate);
    }
  }
}

TEST(MassProperties, BezierParabolaHasClosedForm) {
  // y = 1 - x^2 over the x axis: area 4/3, centroid 2/5, integral of x^2 4/15, of y^2 32/105.
  const Vec2 left{-1, 0};
  const Vec2 right{1, 0};
  const Vec2 apex{0, 2};
  const BezierEdge parabola{{right, (1.0 / 3) * right + (2.0 / 3) * apex, (1.0 / 3) * left + (2.0 / 3) * apex, left}};
  const Outline outline{"parabola", {{Line(left, right), {parabola, 0, 1}}}};
  ExpectProperties(outline, {4.0 / 3, {0, 0.4}, 4.0 / 15 + 32.0 / 105 - 4.0 / 3 * 0.16}, kExact);
}

TEST(MassProperties, NearlyStraightArcsKeepAllDigits) {
  for (const double R : {1e2, 1e4, 1e6, 1e9}) {
    SCOPED_TRACE(R);
    // A lens of two arcs of radius R over the chord from (-1, 0) to (1, 0). Half angle asin(1/R).
    const double alpha = std::asin(1 / R);
    const double drop = std::sqrt((R - 1) * (R + 1));
    const Outline lens{"lens",
                       {{Arc({0, drop}, R, -kPi / 2 - alpha, -kPi / 2 + alpha),
                         Arc({0, -drop}, R, kPi / 2 - alpha, kPi / 2 + alpha)}}};
    const MassProperties p = ComputeMassProperties(lens, 1);
    // Series of 2 (segment area) = R^2 (2 alpha - sin 2 alpha) and of the integral of x^2. The angles pi / 2 +- alpha
    // are rounded: relative to alpha by epsilon R.
    const double rounding = 8e-16 * R + 1e-13;
    EXPECT_NEAR(p.area * R / (4.0 / 3 * (1 + 0.3 / (R * R))), 1, 3 * rounding + 1 / (R * R * R));
    EXPECT_NEAR(p.inertia * R / (4.0 / 15), 1, 5 * rounding + 2 / (R * R));
    // The same arcs closing a box: what they add is tiny, and the box keeps its digits.
    const Outline box{"box",
                      {{Line({-1, -3}, {1, -3}), Line({1, -3}, {1, 0}),
                        Arc({0, -drop}, R, kPi / 2 - alpha, kPi / 2 + alpha), Line({-1, 0}, {-1, -3})}}};
    const MassProperties q = ComputeMassProperties(box, 1);
    EXPECT_NEAR(q.area, 6 + p.area / 2, 2e-14);
  }
}

TEST(MassProperties, AgreeWithFinePolygonsForEveryMixtureOfEdges) {
  Random random(3);
  for (int k = 0; k < 100; ++k) {
    const Outline outline = RandomOutline(&random);
    // Error of the polygon with steps h is C h^2 + ..: one Richardson step leaves h^4.
    const auto polygon = [&](int steps) {
      Outline flat{"flat", {}};
      for (const OutlineLoop& loop : outline.loops) {
        std::vector<Vec2> corners;
        for (const OutlinePiece& piece : loop) {
          for (int i = 0; i < steps; ++i) {
            const double t = static_cast<double>(i) / steps;
            corners.push_back(CurvePoint(piece.edge, piece.s_begin + t * (piece.s_end - piece.s_begin)));
          }
        }
        flat.loops.push_back(Polygon(corners).loops[0]);
      }
      return MomentsOf(flat);
    };
    const AreaMoments coarse = polygon(100);
    const AreaMoments fine = polygon(200);
    const AreaMoments exact = MomentsOf(outline);
    const auto extrapolate = [](double c, double f) { return f + (f - c) / 3; };
    EXPECT_NEAR(exact.area, extrapolate(coarse.area, fine.area), 1e-8);
    EXPECT_NEAR(exact.first.x, extrapolate(coarse.first.x, fine.first.x), 1e-8);
    EXPECT_NEAR(exact.first.y, extrapolate(coarse.first.y, fine.first.y), 1e-8);
    EXPECT_NEAR(exact.xx, extrapolate(coarse.xx, fine.xx), 1e-7);
    EXPECT_NEAR(exact.xy, extrapolate(coarse.xy, fine.xy), 1e-7);
    EXPECT_NEAR(exact.yy, extrapolate(coarse.yy, fine.yy), 1e-7);
  }
}

TEST(MassProperties, FollowTheOutlineWhereverItIsHoweverLargeAndCut) {
  Random random(4);
  for (int k = 0; k < 300; ++k) {
    SCOPED_TRACE(k);
    const Outline outline = RandomOutline(&random);
    const MassProperties p = ComputeMassProperties(outline, 2);
    const double angle = random.Uniform(-3, 3);
    const Vec2 shift = random.Vector(3);
    MassProperties expected = p;
    expected.center = Rotate(SinCos(angle), p.center) + shift;
    ExpectSame(ComputeMassProperties(Transformed(outline, angle, shift), 2), expected, kAccurate);
    ExpectSame(ComputeMassProperties(Subdivided(outline, &random), 2), p, kAccurate);
    const double scale = 0x1p20;
    const MassProperties scaled = ComputeMassProperties(Scaled(outline, scale), 2);
    EXPECT_EQ(scaled.area, scale * scale * p.area);
    EXPECT_EQ(scaled.inertia, scale * scale * scale * scale * p.inertia);
    EXPECT_EQ(scaled.center.x, scale * p.center.x);
    const Outline centered = Centered(outline);
    EXPECT_NO_THROW(RequireValid(centered));
    expected.center = {};
    ExpectSame(ComputeMassProperties(centered, 2), expected, kAccurate);
    const Body body = MakeBody(outline, 2);
    EXPECT_EQ(body.x, p.center);
    EXPECT_NEAR(body.inertia / p.inertia, 1, kAccurate);
    EXPECT_NEAR(body.mass / p.mass, 1, kAccurate);
  }
}

TEST(MassProperties, RefuseADensityThatIsNotPositiveAndFinite) {
  for (const double density : {0.0, -1.0, kNaN, kInfinity}) {
    EXPECT_THROW(ComputeMassProperties(Disc(1), density), InputError);
  }
  EXPECT_THROW(ComputeMassProperties(Outline{"none", {}}, 1), InputError);
}

}  // namespace
}  // namespace lcpbench::testing
