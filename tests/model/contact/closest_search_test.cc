#include "model/contact/closest_points.h"

#include "tests/model/contact/random_contacts.h"

namespace lcpbench::testing {
namespace {

constexpr int kSearches = 25;
constexpr double kRoundingOfSearch = 1e-13;

std::vector<PairKind> GeneralPairKinds() {
  return PairKindsWhere([](const PairKind& kind) { return kind.is_general(); });
}

class EverySearch : public ::testing::TestWithParam<PairKind> {};

TEST_P(EverySearch, WithoutAnyStartFindsStationaryPointsOnceEachAndMeansTheMinimumNextToTheNominalGap) {
  OverRandomContacts(GetParam(), kSearches, 1, [](const ContactCase& c, Random*) {
    const StationaryPoints found = SearchStationaryPoints(c.Placed1(), c.Placed2(), {});
    const bool is_there = std::any_of(found.points.begin(), found.points.end(), [&](const ClosestPoints& p) {
      return std::abs(p.d - c.d) < kRoundingOfSearch && Norm(p.n - c.n) < 1e-11;
    });
    EXPECT_TRUE(is_there) << found.points.size() << " other points found; " << found.failure;
    for (const ClosestPoints& p : found.points) {
      EXPECT_NEAR(Norm(p.n), 1, 1e-15);
      EXPECT_LE(Norm((c.body1.x + p.R1) - (c.body2.x + p.R2) - p.d * p.n), 1e-13);
      for (const ClosestPoints& q : found.points) {
        EXPECT_TRUE(&p == &q || Norm(p.R1 - q.R1) + Norm(p.R2 - q.R2) > 1e-8);
      }
      for (const double nominal : {c.d, -1.0, 0.5}) {
        const double d = c.Closest({{}, {}, nominal}).d;
        EXPECT_TRUE(p.D() <= 1e-6 || std::abs(p.d - nominal) >= std::abs(d - nominal) - kRoundingOfSearch);
      }
    }
  });
}

TEST_P(EverySearch, DoesNotDependOnWhereItStartsNearby) {
  OverRandomContacts(GetParam(), kSearches, 3, [](const ContactCase& c, Random* random) {
    const ClosestPoints p = c.Closest();
    const auto near = [&](std::optional<double> s) {
      return s ? std::optional<double>(*s + random->Uniform(-0.02, 0.02)) : s;
    };
    const ClosestPoints q = c.Closest({near(c.s1), near(c.s2), 0});
    EXPECT_NEAR(p.d, q.d, 1e-16);
    EXPECT_LE(Norm(p.n - q.n), 1e-15);
    EXPECT_LE(Norm(p.R1 - q.R1), 1e-14);
    EXPECT_NEAR(p.curvature1.s, q.curvature1.s, 1e-14 * std::abs(p.curvature1.s));
    EXPECT_NEAR(p.curvature2.s, q.curvature2.s, 1e-14 * std::abs(p.curvature2.s));
    // Its own result is a start, too, whatever multiple of a turn was added to it.
    const auto turned = [&](const Feature& feature, std::optional<double> s) {
      return s && !std::holds_alternative<BezierEdge>(feature) ? std::optional<double>(*s + 4 * kPi) : s;
    };
    const ClosestPoints r = c.Closest({turned(c.feature1, p.s1), turned(c.feature2, p.s2), 0});
    EXPECT_NEAR(p.d, r.d, 1e-16);
  });
}

TEST_P(EverySearch, OneStartOfTwoIsEnough) {
  OverRandomContacts(GetParam(), kSearches, 4, [](const ContactCase& c, Random*) {
    for (const SearchStart& start : {SearchStart{c.s1, {}, c.d}, SearchStart{{}, c.s2, c.d}}) {
      if (!start.s1 && !start.s2) continue;
      EXPECT_NEAR(c.Closest(start).d, c.d, kRoundingOfSearch);
    }
  });
}

INSTANTIATE_TEST_SUITE_P(Search, EverySearch, ::testing::ValuesIn(GeneralPairKinds()),
                         ::testing::PrintToStringParamName());

// The evolute of an ellipse parts the plane: four normals to the ellipse pass through a point inside it, two outside.
TEST(Search, FindsAllFourNormalsFromAPointWithinTheEvolute) {
  Random random(8);
  for (int i = 0; i < 500; ++i) {
    const double a = random.Uniform(0.5, 2);
    const double b = random.Uniform(0.5, 2);
    const Feature ellipse = EllipseEdge{{0, 0}, a, b, 0, Side::kConvex};
    const Vec2 q = {random.Uniform(-1, 1), random.Uniform(-1, 1)};
    const double astroid = std::cbrt(a * a * q.x * q.x) + std::cbrt(b * b * q.y * q.y);
    const double evolute = std::cbrt((a * a - b * b) * (a * a - b * b));
    if (std::abs(astroid / evolute - 1) < 0.02) continue;
    const Feature vertex = Vertex{q};
    const StationaryPoints found = SearchStationaryPoints({vertex, {0, 0}, {}}, {ellipse, {0, 0}, {}}, {});
    EXPECT_EQ(found.points.size(), astroid < evolute ? 4U : 2U);
  }
}

TEST(Search, EllipsesOfAspectRatioAMillionKeepEveryDigit) {
  Random random(9);
  for (int i = 0; i < 200; ++i) {
    // Where the gap is known: the flat side (curvature b/a^2) and the tip (curvature a/b^2) lie on the axes.
    const double b = 1e-6;
    const Feature thin = EllipseEdge{{0, 0}, 1, b, 0, Side::kConvex};
    const double x = random.Uniform(-0.5, 0.5);
    const Feature above = Vertex{{0, 0.25}};
    const ClosestPoints side = FindClosestPoints({above, {0, 0}, {}}, {thin, {0, 0}, {}}, {{}, {}, 0.25});
    EXPECT_EQ(side.n.y, 1);
    EXPECT_NEAR(side.d, 0.25 - b, 1e-17);
    EXPECT_NEAR(side.curvature2.s, b, 1e-15 * b);
    const Feature beside = Vertex{{1.25, 0}};
    const ClosestPoints tip = FindClosestPoints({beside, {0, 0}, {}}, {thin, {0, 0}, {}}, {{}, {}, 0.25});
    EXPECT_EQ(tip.n.x, 1);
    EXPECT_EQ(tip.d, 0.25);
    EXPECT_NEAR(tip.curvature2.s, 1e12, 1e-3);
    // Anywhere: the vertex at distance d along the normal of a point of the ellipse.
    const EdgePoint at = EvaluateEdge(thin, std::acos(x));
    const Feature off = Vertex{at.c + 0.125 * at.N};
    const ClosestPoints p = FindClosestPoints({off, {0, 0}, {}}, {thin, {0, 0}, {}}, {{}, {}, 0.125});
    EXPECT_NEAR(p.d, 0.125, 1e-15);
    EXPECT_NEAR(Norm(p.n - at.N), 0, 1e-15);
  }
}

void ExpectRefusal(const std::string& condition, const Feature& feature1, const Feature& feature2,
                   const SearchStart& start = {}, Regularity required = Regularity::kLocalMinimum) {
  for (const bool swap : {false, true}) {
    const std::string error = swap ? RefusalOf(feature2, feature1, {start.s2, start.s1, start.nominal_gap}, required)
                                   : RefusalOf(feature1, feature2, start, required);
    EXPECT_NE(error.find(condition), std::string::npos) << condition << ": " << error;
    EXPECT_NE(error.find(Describe(feature1)), std::string::npos) << error;
    EXPECT_NE(error.find(Describe(feature2)), std::string::npos) << error;
    EXPECT_EQ(error.find('\n'), std::string::npos);
  }
}

const EllipseEdge kEllipse{{0, 0}, 2, 1, 0, Side::kConvex};
const SuperellipseEdge kOval{{0, 0}, 2, 1, 4, 0, Side::kConvex};

// No tangent of it is vertical.
const BezierEdge kBend{{Vec2{0, 0}, Vec2{1, 0}, Vec2{2, 0.5}, Vec2{3, 1}}};

TEST(Search, RefusesWhatIsNoContactNamingTheConditionAndBothFeatures) {
  EllipseEdge hole = kEllipse;
  hole.side = Side::kConcave;
  const StraightEdge floor{{1, -1}, {-1, -1}};
  const StraightEdge upright{{0, 0}, {0, 1}};
  const BezierEdge beyond{{Vec2{0, 0}, Vec2{1, 0}, Vec2{2, 0.5}, Vec2{3, 2}}};
  // The centre of curvature of the tip (2, 0), of radius 1/2, and of the side (0, 1), of radius 4.
  ExpectRefusal("centre of curvature", Vertex{{1.5, 0}}, kEllipse, {{}, 0.0, 0});
  ExpectRefusal("centre of curvature", Vertex{{0, -3}}, kEllipse, {{}, kPi / 2, 0}, Regularity::kNonzeroD);
  ExpectRefusal("curvature match", ArcEdge{{1.5, 0}, 0.5, Side::kConcave}, kEllipse, {{}, 0.0, 0});
  ExpectRefusal("curvature match", kEllipse, hole, {0.0, 0.0, 0});
  ExpectRefusal("curvature match", kOval, floor, {-kPi / 2, {}, 0});
  // A disc within the ellipse's concave counterpart, too large for the tip; a vertex at the centre, whose distance to
  // the tips is greatest.
  ExpectRefusal("no local minimum", ArcEdge{{1.2, 0}, 0.8, Side::kConvex}, hole, {{}, 0.0, 0});
  ExpectRefusal("no local minimum", StraightEdge{{-1, -1}, {1, -1}}, hole, {{}, -1.5, 0});
  ExpectRefusal("no local minimum", Vertex{{0, 0}}, kEllipse, {{}, 0.0, 0});
  ExpectRefusal("beyond the end", Vertex{{-0.2, -1}}, beyond, {{}, 0.1, 0});
  ExpectRefusal("not finite", Vertex{{3, 0}}, kEllipse, {{}, kNaN, 0});
  ExpectRefusal("not finite", kOval, kEllipse, {kInfinity, 1, 0});
  ExpectRefusal("does not converge", upright, kBend, {{}, 0.5, 0});
  ExpectRefusal("no stationary point", upright, kBend);
  EXPECT_NE(RefusalOf(Vertex{{-1, -1}}, beyond), "");
  // The end itself belongs to the curve, and a path joint may be where no contact is.
  EXPECT_EQ(RefusalOf(Vertex{{0, -1}}, beyond, {{}, 0.1, 0}), "");
  EXPECT_EQ(RefusalOf(Vertex{{0, -1}}, beyond), "");
  EXPECT_EQ(RefusalOf(Vertex{{0, 0}}, kEllipse, {{}, 0.0, 0}, Regularity::kNonzeroD), "");
  const BezierEdge straight{{Vec2{0, 0}, Vec2{1, 0}, Vec2{2, 0}, Vec2{3, 0}}};
  EXPECT_NE(RefusalOf(straight, floor), "");
  EXPECT_NE(RefusalOf(straight, floor, {0.5, {}, 0}), "");
}

TEST(Search, RefusesTheFlatSideOfASuperellipseOnAStraightEdgeButNotOnAVertexOrArc) {
  const StraightEdge floor{{1, -1}, {-1, -1}};
  for (const double s : {-kPi / 2, -1.57, -1.5, -1.0}) {
    EXPECT_NE(RefusalOf(kOval, floor, {s, {}, 0}), "") << s;
  }
  EXPECT_NE(RefusalOf(kOval, floor), "");
  EXPECT_NE(RefusalOf(StraightEdge{{-2, 1}, {-2, -1}}, kOval), "");
  const ClosestPoints vertex = FindClosestPoints({Vertex{{0, -1.25}}, {0, 0}, {}}, {kOval, {0, 0}, {}}, {{}, -1.6, 0});
  EXPECT_EQ(vertex.d, 0.25);
  EXPECT_NEAR(vertex.curvature2.s, 0, 1e-25);
  const ArcEdge disc{{0, -1.25}, 0.125, Side::kConvex};
  EXPECT_EQ(FindClosestPoints({disc, {0, 0}, {}}, {kOval, {0, 0}, {}}, {{}, -1.6, 0}).d, 0.125);
  EXPECT_EQ(FindClosestPoints({disc, {0, 0}, {}}, {kOval, {0, 0}, {}}, {{}, {}, 0.125}).d, 0.125);
}

// A bad start may fail, but must not be answered with a point that is none.
TEST(Search, FromAnyStartEndsInAStationaryPointOrARefusal) {
  Random random(10);
  int found = 0;
  int refused = 0;
  for (const PairKind& kind : GeneralPairKinds()) {
    for (int i = 0; i < 40; ++i) {
      const ContactCase c = RandomContact(kind, &random);
      const auto anywhere = [&](const Feature& feature) {
        return std::holds_alternative<BezierEdge>(feature) ? random.Uniform(0, 1) : random.Uniform(-4, 4);
      };
      try {
        const ClosestPoints p = c.Closest({anywhere(c.feature1), anywhere(c.feature2), 0});
        EXPECT_LE(Norm((c.body1.x + p.R1) - (c.body2.x + p.R2) - p.d * p.n), 1e-13);
        EXPECT_GT(p.D(), 0);
        ++found;
      } catch (const InputError&) {
        ++refused;
      }
    }
  }
  EXPECT_GT(found, 1000);
  RecordProperty("refused", refused);
}

TEST(Search, PathJointTakesEitherSideOfACurveAndOppositeSidesGiveOppositeNormals) {
  Random random(11);
  for (int i = 0; i < 200; ++i) {
    Feature edge = kEllipse;
    if (i % 2 == 0) edge = ArcEdge{{0, 0}, 1, Side::kConvex};
    const double s = random.Uniform(-3, 3);
    const EdgePoint at = EvaluateEdge(edge, s);
    const Feature vertex = Vertex{at.c + random.Uniform(-0.2, 0.2) * at.N};
    const auto on = [&](Side side) {
      std::visit(
          [side](auto& e) {
            if constexpr (requires { e.side; }) e.side = side;
          },
          edge);
      return FindClosestPoints({vertex, {0, 0}, {}}, {edge, {0, 0}, {}}, {{}, s, 0}, Regularity::kNonzeroD);
    };
    const ClosestPoints outside = on(Side::kConvex);
    const ClosestPoints inside = on(Side::kConcave);
    EXPECT_EQ(outside.n.x, -inside.n.x);
    EXPECT_EQ(outside.d, -inside.d);
    EXPECT_EQ(outside.D(), inside.D());
  }
}

}  // namespace
}  // namespace lcpbench::testing
