#include "model/contact/closest_points.h"

#include <boost/multiprecision/cpp_bin_float.hpp>

#include "tests/model/contact/random_contacts.h"

namespace lcpbench::testing {
namespace {

constexpr int kCases = 500;
constexpr int kGeneralCases = 60;  // of each of the many kinds with a general curve
constexpr double kRoundingOfPoints = 1e-13;
// The world point of an edge's parameter, by the definition in feature.h.
Vec2 PointAt(const Feature& feature, const Body& body, std::optional<double> s) {
  EXPECT_EQ(s.has_value(), !std::holds_alternative<Vertex>(feature)) << "every edge has a parameter, a vertex none";
  const LongVec c = LongPoint(feature, static_cast<long double>(s.value_or(0)));
  return ToWorld(body, {static_cast<double>(c.x), static_cast<double>(c.y)});
}

class EveryPair : public ::testing::TestWithParam<PairKind> {
 protected:
  template <class Check>
  void OverCases(unsigned seed, const Check& check) {
    OverRandomContacts(GetParam(), GetParam().is_general() ? kGeneralCases : kCases, seed,
                       [&](const ContactCase& c, Random* random) { check(c, c.Closest(), random); });
  }
};

TEST_P(EveryPair, FindsTheContactItWasBuiltWith) {
  OverCases(1, [](const ContactCase& c, const ClosestPoints& p, Random*) {
    EXPECT_NEAR(p.d, c.d, kRoundingOfPoints);
    EXPECT_NEAR(Norm(p.n - c.n), 0, kRoundingOfPoints);
    EXPECT_GT(p.D(), 0);
    const auto check = [](const Feature& feature, const Body& body, Vec2 built, Vec2 arm, const CurvaturePair& pair,
                          std::optional<double> s) {
      EXPECT_NEAR(Norm(body.x + arm - built), 0, kRoundingOfPoints);
      EXPECT_NEAR(Norm(PointAt(feature, body, s) - built), 0, kRoundingOfPoints);
      EXPECT_EQ(pair.r, std::holds_alternative<Vertex>(feature) ? 0 : 1);
      const double rho = SignedRadius(feature, s);
      const double expected = pair.is_vertex() ? 1 : rho == 0 ? 0 : 1 / rho;
      // A general curve's parameter is rounded; an arc's does not matter.
      EXPECT_NEAR(pair.s, expected, std::holds_alternative<ArcEdge>(feature) ? 0 : 1e-11 * std::abs(expected));
    };
    check(c.feature1, c.body1, c.p1, p.R1, p.curvature1, p.s1);
    check(c.feature2, c.body2, c.p2, p.R2, p.curvature2, p.s2);
  });
}

TEST_P(EveryPair, ScalingAllLengthsByAPowerOfTwoScalesTheResultExactly) {
  OverCases(6, [](const ContactCase& c, const ClosestPoints& p, Random*) {
    for (const double scale : {0x1p-40, 0x1p40}) {
      ContactCase big = c;
      big.body1.x = scale * c.body1.x;
      big.body2.x = scale * c.body2.x;
      big.feature1 = Scaled(c.feature1, scale);
      big.feature2 = Scaled(c.feature2, scale);
      const ClosestPoints q = big.Closest();
      EXPECT_EQ(q.d, scale * p.d);
      EXPECT_EQ(q.n.x, p.n.x);
      EXPECT_EQ(q.n.y, p.n.y);
      EXPECT_EQ(q.moment1, scale * p.moment1);
      EXPECT_EQ(q.moment2, scale * p.moment2);
    }
  });
}

TEST_P(EveryPair, LosesNothingFarFromTheWorldsOrigin) {
  OverCases(7, [](const ContactCase& c, const ClosestPoints& p, Random*) {
    // Positions are rounded at this distance; their difference, once rounded, is all that counts.
    const Vec2 far = {0x1p30, -0x1p30};
    ContactCase moved = c;
    moved.body1.x = c.body1.x + far;
    moved.body2.x = c.body2.x + far;
    ContactCase rounded = c;
    rounded.body1.x = moved.body1.x - far;
    rounded.body2.x = moved.body2.x - far;
    const ClosestPoints q = moved.Closest();
    const ClosestPoints r = rounded.Closest();
    EXPECT_EQ(q.d, r.d);
    EXPECT_EQ(q.moment1, r.moment1);
    EXPECT_EQ(q.moment2, r.moment2);
    EXPECT_NEAR(q.d, p.d, 1e-5);
  });
}

INSTANTIATE_TEST_SUITE_P(Geometry, EveryPair, ::testing::ValuesIn(AllPairKinds()), ::testing::PrintToStringParamName());

struct RefusedPair {
  const char* condition;  // what the error has to name
  Feature feature1;
  Feature feature2;
};

std::vector<RefusedPair> RefusedPairs() {
  const auto convex = [](double y, double radius) { return ArcEdge{{0, y}, radius, Side::kConvex}; };
  const auto concave = [](double y, double radius) { return ArcEdge{{0, y}, radius, Side::kConcave}; };
  const StraightEdge floor{{1, 0}, {-1, 0}};
  const StraightEdge wall{{0, 1}, {0, -1}};
  return {
      {"equal radius", convex(0, 2), concave(0, 2)},
      {"equal radius", convex(0.25, 2), concave(0, 2)},
      {"equal radius", concave(0, 2), convex(-0.25, 2)},
      {"curvature match", convex(0, 2), concave(1e-11, 2.00000000001)},
      {"centre of curvature", Vertex{{0, 0}}, convex(0, 0.5)},
      {"centre of curvature", Vertex{{0, 0}}, concave(0, 0.5)},
      {"centre of curvature", Vertex{{0.4e-10, 0}}, concave(0, 0.5)},
      {"centres of two arcs coincide", convex(1, 2), convex(1, 3)},
      {"no local minimum", convex(0.5, 1.5), concave(0, 1)},
      {"no local minimum", concave(0, 1), convex(0.5, 1.5)},
      {"no local minimum", floor, concave(1, 1)},
      {"no local minimum", concave(0.5, 3), floor},
      {"no local minimum", concave(0, 1), concave(3, 1)},
      {"straight edges", floor, StraightEdge{{-1, 0}, {1, 0}}},
      {"straight edges", floor, wall},
      {"vertex against vertex", Vertex{{0, 0}}, Vertex{{0, 0}}},
      {"vertex against vertex", Vertex{{0, 1}}, Vertex{{0, 0}}},
      {"zero-length edge", Vertex{{0, 1}}, StraightEdge{{1, 2}, {1, 2}}},
      {"radius must be > 0", Vertex{{0, 1}}, convex(0, 0)},
      {"radius must be > 0", Vertex{{0, 1}}, concave(0, -1)},
      {"not finite", Vertex{{0, 1}}, convex(0, kNaN)},
      {"not finite", Vertex{{0, 1}}, convex(0, kInfinity)},
      {"not finite", Vertex{{0, kNaN}}, floor},
      {"not finite", Vertex{{0, 1}}, StraightEdge{{kInfinity, 0}, {0, 0}}},
      {"not finite", Vertex{{0, 1}}, convex(-kInfinity, 1)},
      {"curvature 1/radius overflows", Vertex{{0, 1}}, convex(0, 1e-310)},
      {"not a unit vector", Vertex{{0, 1}}, StraightEdge{{0, 0}, {1e-161, 1e-161}}},
      {"not a unit vector", Vertex{{0, 1e-161}}, convex(0, 1e-160)},
      {"length overflows", Vertex{{0, 1}}, StraightEdge{{-1e200, 0}, {1e200, 0}}},
  };
}

TEST(ClosestPoints, RefuseSingularAndInvalidPairsNamingConditionAndFeature) {
  for (const RefusedPair& pair : RefusedPairs()) {
    const std::string error = RefusalOf(pair.feature1, pair.feature2);
    EXPECT_NE(error.find(pair.condition), std::string::npos) << pair.condition << ": " << error;
    const bool names_a_feature = error.find(Describe(pair.feature1)) != std::string::npos ||
                                 error.find(Describe(pair.feature2)) != std::string::npos;
    EXPECT_TRUE(names_a_feature) << error;
    EXPECT_EQ(error.find('\n'), std::string::npos);
    if (std::string(pair.condition) == "no local minimum") continue;
    EXPECT_NE(RefusalOf(pair.feature1, pair.feature2, {}, Regularity::kNonzeroD), "") << "as a path joint";
  }
}

TEST(ClosestPoints, ThresholdOfDIsRelativeToTheRadius) {
  for (const double radius : {1e-6, 1.0, 1e6}) {
    for (const Side side : {Side::kConvex, Side::kConcave}) {
      const ArcEdge arc{{0, 0}, radius, side};
      EXPECT_NE(RefusalOf(Vertex{{0.9e-10 * radius, 0}}, arc), "");
      EXPECT_EQ(RefusalOf(Vertex{{1e-9 * radius, 0}}, arc), "");
    }
    // A disc in a track that is barely larger, lying against it.
    const auto disc_in_track = [&](double excess) {
      const ArcEdge track{{0, 0}, (1 + excess) * radius, Side::kConcave};
      return RefusalOf(ArcEdge{{0, -excess * radius}, radius, Side::kConvex}, track);
    };
    EXPECT_NE(disc_in_track(1e-11), "");
    EXPECT_EQ(disc_in_track(1e-9), "");
    EXPECT_EQ(disc_in_track(1e-3), "");
  }
}

TEST(SinCos, IsCorrectlyRoundedAndItsPartsAddUpToThirtyTwoDigits) {
  using Exact = boost::multiprecision::cpp_bin_float_100;
  EXPECT_EQ(SinCos(0).cos, 1);
  EXPECT_EQ(SinCos(0).sin, 0);
  Random random(9);
  std::vector<double> angles = {kPi, kPi / 2, -kPi / 2, 3 * kPi, 1e-300, 5e-324, -1e-9, 1e4, 99999.5, 1e5, 1e9, -3e15};
  for (int i = 0; i < 3000; ++i) angles.push_back(random.Uniform(-7, 7));
  for (int i = 0; i < 300; ++i) angles.push_back(random.Uniform(-1e6, 1e6));
  for (int i = 0; i < 300; ++i) angles.push_back(random.Uniform(-1e-5, 1e-5));
  for (const double theta : angles) {
    const Rotation r = SinCos(theta);
    const Exact sine = sin(Exact(theta));
    const Exact cosine = cos(Exact(theta));
    EXPECT_EQ(r.sin, static_cast<double>(sine)) << theta;
    EXPECT_EQ(r.cos, static_cast<double>(cosine)) << theta;
    if (std::abs(theta) > 10) continue;
    const RotationParts parts = SinCosParts(theta);
    EXPECT_EQ(parts.high.cos, r.cos);
    EXPECT_EQ(parts.high.sin, r.sin);
    EXPECT_LE(abs(Exact(parts.high.cos) + Exact(parts.low.cos) - cosine), 2e-32);
    EXPECT_LE(abs(Exact(parts.high.sin) + Exact(parts.low.sin) - sine), 2e-32);
  }
}

TEST(SinCos, IsNotANumberForAnglesThatAreNotFinite) {
  for (const double theta : {kInfinity, -kInfinity, kNaN}) {
    EXPECT_TRUE(std::isnan(SinCos(theta).sin));
    EXPECT_TRUE(std::isnan(SinCos(theta).cos));
  }
}

}  // namespace
}  // namespace lcpbench::testing
