#include "model/contact_row.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "tests/model/random_contacts.h"

namespace lcpbench::testing {
namespace {

constexpr int kCases = 300;
constexpr double kRounding = 1e-12;

// Scaled as the reference data are: |x - y| / (1 + |y|).
void ExpectClose(double x, double y, double tolerance, const char* what) {
  EXPECT_LE(std::abs(x - y), tolerance * (1 + std::abs(y))) << what << ": " << x << " against " << y;
}

ContactRow RowOf(const ContactCase& c) { return ComputeContactRow(c.Closest(), c.body1, c.body2); }

// The gap of section 2 in long double along a smooth random motion: independent of the code under test, which also has
// other arms, another order of evaluation and no time.
struct LongVec {
  long double x = 0;
  long double y = 0;
};
LongVec operator+(LongVec a, LongVec b) { return {a.x + b.x, a.y + b.y}; }
LongVec operator-(LongVec a, LongVec b) { return {a.x - b.x, a.y - b.y}; }
long double Dot(LongVec a, LongVec b) { return a.x * b.x + a.y * b.y; }
LongVec Long(Vec2 a) { return {static_cast<long double>(a.x), static_cast<long double>(a.y)}; }

struct Acceleration {
  Vec2 a;
  double alpha = 0;
  Vec2 jerk;
  double angular_jerk = 0;
};

struct LongPose {
  LongVec x;
  long double theta = 0;

  LongVec Turn(LongVec c) const {
    const long double cosine = std::cos(theta);
    const long double sine = std::sin(theta);
    return {cosine * c.x - sine * c.y, sine * c.x + cosine * c.y};
  }
  LongVec World(Vec2 c) const { return x + Turn(Long(c)); }
};

LongPose PoseAt(const Body& body, const Acceleration& acceleration, long double t) {
  const auto along = [t](double x0, double v, double a, double j) {
    return static_cast<long double>(x0) + t * (static_cast<long double>(v) + t * (static_cast<long double>(a) / 2 +
                                                                                  t * static_cast<long double>(j) / 6));
  };
  return {{along(body.x.x, body.v.x, acceleration.a.x, acceleration.jerk.x),
           along(body.x.y, body.v.y, acceleration.a.y, acceleration.jerk.y)},
          along(body.theta, body.omega, acceleration.alpha, acceleration.angular_jerk)};
}

long double LongGap(const Feature& feature1, const LongPose& pose1, const Feature& feature2, const LongPose& pose2) {
  if (IsStraight(feature1)) return LongGap(feature2, pose2, feature1, pose1);
  const LongVec c1 = pose1.World(Center(feature1));
  const auto rho1 = static_cast<long double>(SignedRadius(feature1));
  if (const auto* edge2 = std::get_if<StraightEdge>(&feature2)) {
    const LongVec along = pose2.Turn(Long(edge2->b) - Long(edge2->a));
    const long double length = std::sqrt(Dot(along, along));
    const LongVec outward = {along.y / length, -along.x / length};
    return Dot(outward, c1 - pose2.World(edge2->a)) - rho1;
  }
  const LongVec between = c1 - pose2.World(Center(feature2));
  const long double rho = rho1 + static_cast<long double>(SignedRadius(feature2));
  return (rho > 0 ? 1 : -1) * std::sqrt(Dot(between, between)) - rho;
}

struct Material {
  Vec2 velocity;
  Vec2 acceleration;
};

// Velocity and acceleration of the point fixed in a body at arm r. [MODEL.md section 1]
Material MaterialPoint(const Body& body, const Acceleration& acceleration, Vec2 r) {
  return {body.v + body.omega * Perp(r), acceleration.a + acceleration.alpha * Perp(r) - body.omega * body.omega * r};
}

Acceleration RandomAcceleration(Random* random) {
  return {random->Vector(3), random->Uniform(-3, 3), random->Vector(3), random->Uniform(-3, 3)};
}

double JTimesA(const ContactRow& row, const Acceleration& a1, const Acceleration& a2) {
  return row.J[0] * a1.a.x + row.J[1] * a1.a.y + row.J[2] * a1.alpha + row.J[3] * a2.a.x + row.J[4] * a2.a.y +
         row.J[5] * a2.alpha;
}

class EveryContactKind : public ::testing::TestWithParam<PairKind> {
 protected:
  // Calls check(case, random) over seeded random configurations.
  template <class Check>
  void OverCases(unsigned seed, const Check& check) {
    Random random(seed);
    for (int i = 0; i < kCases; ++i) {
      SCOPED_TRACE(i);
      const ContactCase c = RandomContact(GetParam(), &random);
      check(c, &random);
      if (HasFailure()) return;
    }
  }
};

class ContactKindWithCenters : public EveryContactKind {};
class ContactKindWithStraightEdge : public EveryContactKind {};

TEST_P(EveryContactKind, RowGivesTheDerivativesOfTheGapAlongAnyMotion) {
  OverCases(1, [](const ContactCase& c, Random* random) {
    const Acceleration a1 = RandomAcceleration(random);
    const Acceleration a2 = RandomAcceleration(random);
    const auto gap = [&](int k) {
      const long double t = static_cast<long double>(k) * 2e-5L;
      return LongGap(c.feature1, PoseAt(c.body1, a1, t), c.feature2, PoseAt(c.body2, a2, t));
    };
    const long double h = 2e-5L;
    const long double g0 = gap(0), p1 = gap(1), m1 = gap(-1), p2 = gap(2), m2 = gap(-2);
    const auto d_dot = static_cast<double>((8 * (p1 - m1) - (p2 - m2)) / (12 * h));
    const auto d_ddot = static_cast<double>((16 * (p1 + m1) - (p2 + m2) - 30 * g0) / (12 * h * h));
    const ClosestPoints closest = c.Closest();
    const ContactRow row = ComputeContactRow(closest, c.body1, c.body2);
    ExpectClose(closest.d, static_cast<double>(g0), 1e-14, "d");
    ExpectClose(row.d_dot, d_dot, 1e-8, "d'");
    ExpectClose(JTimesA(row, a1, a2) + row.gamma, d_ddot, 1e-7, "d''");
  });
}

TEST_P(EveryContactKind, NormalTurnsWithOmegaN) {
  OverCases(2, [](const ContactCase& c, Random*) {
    const double h = 1e-5;
    const auto normal = [&](double t) {
      ContactCase moved = c;
      moved.body1.x = c.body1.x + t * c.body1.v;
      moved.body1.theta = c.body1.theta + t * c.body1.omega;
      moved.body2.x = c.body2.x + t * c.body2.v;
      moved.body2.theta = c.body2.theta + t * c.body2.omega;
      return moved.Closest().n;
    };
    const Vec2 n_dot = (1 / (12 * h)) * (8 * (normal(h) - normal(-h)) - (normal(2 * h) - normal(-2 * h)));
    const double omega_n = RowOf(c).omega_n;
    const Vec2 expected = omega_n * Perp(c.Closest().n);
    ExpectClose(n_dot.x, expected.x, 1e-8, "n'_x");
    ExpectClose(n_dot.y, expected.y, 1e-8, "n'_y");
  });
}

TEST_P(EveryContactKind, SwappingBodiesGivesTheSwappedRowBitByBit) {
  OverCases(3, [](const ContactCase& c, Random*) {
    ContactCase swapped = c;
    std::swap(swapped.body1, swapped.body2);
    std::swap(swapped.feature1, swapped.feature2);
    const ClosestPoints p = c.Closest();
    const ClosestPoints q = swapped.Closest();
    const ContactRow row = ComputeContactRow(p, c.body1, c.body2);
    const ContactRow other = ComputeContactRow(q, swapped.body1, swapped.body2);
    EXPECT_EQ(p.d, q.d);
    EXPECT_EQ(p.n.x, -q.n.x);
    EXPECT_EQ(p.n.y, -q.n.y);
    EXPECT_EQ(row.d_dot, other.d_dot);
    EXPECT_EQ(row.gamma, other.gamma);
    EXPECT_EQ(row.slip, other.slip);
    EXPECT_EQ(row.omega_n, other.omega_n);
    for (size_t k = 0; k < 3; ++k) {
      EXPECT_EQ(row.J[k], other.J[k + 3]);
      EXPECT_EQ(row.J[k + 3], other.J[k]);
    }
  });
}

TEST_P(EveryContactKind, RowIsTheSameForArmsToContactPointsAndCenters) {
  OverCases(4, [](const ContactCase& c, Random*) {
    const ClosestPoints p = c.Closest();
    const ContactRow row = ComputeContactRow(p, c.body1, c.body2);
    const Vec2 p1 = c.body1.x + p.R1;
    const Vec2 p2 = c.body2.x + p.R2;
    ExpectClose(row.J[2], Cross(p.R1, p.n), kRounding, "arm to p1");
    ExpectClose(row.J[2], Cross(p2 - c.body1.x, p.n), kRounding, "arm to p2");
    ExpectClose(row.J[5], -Cross(p.R2, p.n), kRounding, "arm to p2");
    ExpectClose(row.J[5], -Cross(p1 - c.body2.x, p.n), kRounding, "arm to p1");
    if (!IsStraight(c.feature1)) {
      ExpectClose(row.J[2], Cross(ToWorld(c.body1, Center(c.feature1)) - c.body1.x, p.n), kRounding, "arm to c1");
    }
    if (!IsStraight(c.feature2)) {
      ExpectClose(row.J[5], -Cross(ToWorld(c.body2, Center(c.feature2)) - c.body2.x, p.n), kRounding, "arm to c2");
    }
  });
}

TEST_P(ContactKindWithCenters, CurvatureFormEqualsCenterForm) {
  OverCases(5, [](const ContactCase& c, Random*) {
    const ClosestPoints p = c.Closest();
    const ContactRow row = ComputeContactRow(p, c.body1, c.body2);
    const Vec2 U1 = ToWorld(c.body1, Center(c.feature1)) - c.body1.x;
    const Vec2 U2 = ToWorld(c.body2, Center(c.feature2)) - c.body2.x;
    const Vec2 t = Perp(p.n);
    const double L = SignedRadius(c.feature1) + SignedRadius(c.feature2) + p.d;
    const double turn = Dot(t, MaterialPoint(c.body1, {}, U1).velocity - MaterialPoint(c.body2, {}, U2).velocity);
    const double gamma =
        -c.body1.omega * c.body1.omega * Dot(p.n, U1) + c.body2.omega * c.body2.omega * Dot(p.n, U2) + turn * turn / L;
    ExpectClose(row.gamma, gamma, 1e-11, "gamma");
    ExpectClose(row.omega_n, turn / L, 1e-11, "omega_n");
  });
}

TEST_P(ContactKindWithStraightEdge, CurvatureFormEqualsAttachedNormalForm) {
  OverCases(6, [](const ContactCase& given, Random* random) {
    ContactCase c = given;
    if (IsStraight(c.feature1)) {
      std::swap(c.body1, c.body2);
      std::swap(c.feature1, c.feature2);
    }
    const Acceleration a1 = RandomAcceleration(random);
    const Acceleration a2 = RandomAcceleration(random);
    const auto edge = std::get<StraightEdge>(c.feature2);
    // Any material point of the edge's line, not only the foot of the centre.
    const Vec2 q = ToWorld(c.body2, edge.a + random->Uniform(-1, 2) * (edge.b - edge.a));
    const Vec2 c1 = ToWorld(c.body1, Center(c.feature1));
    const ClosestPoints p = c.Closest();
    const ContactRow row = ComputeContactRow(p, c.body1, c.body2);
    const Vec2 t = Perp(p.n);
    const Material center = MaterialPoint(c.body1, a1, c1 - c.body1.x);
    const Material point = MaterialPoint(c.body2, a2, q - c.body2.x);
    const double w2 = c.body2.omega;
    const double d_ddot = Dot(p.n, center.acceleration - point.acceleration) +
                          2 * w2 * Dot(t, center.velocity - point.velocity) - w2 * w2 * Dot(p.n, c1 - q) +
                          a2.alpha * Dot(t, c1 - q);
    ExpectClose(JTimesA(row, a1, a2) + row.gamma, d_ddot, 1e-11, "d''");
    ExpectClose(row.omega_n, w2, kRounding, "omega_n");
  });
}

TEST_P(EveryContactKind, GapRateIsJTimesV) {
  OverCases(7, [](const ContactCase& c, Random*) {
    const ContactRow row = RowOf(c);
    const double Jv = JTimesA(row, {c.body1.v, c.body1.omega, {}, 0}, {c.body2.v, c.body2.omega, {}, 0});
    ExpectClose(row.d_dot, Jv, kRounding, "d'");
  });
}

bool HasStraightEdge(const PairKind& kind) {
  return kind.shape1 == Shape::kStraight || kind.shape2 == Shape::kStraight;
}

std::vector<PairKind> PairKindsWhere(bool straight) {
  std::vector<PairKind> kinds;
  for (const PairKind& kind : AllPairKinds()) {
    if (HasStraightEdge(kind) == straight) kinds.push_back(kind);
  }
  return kinds;
}

std::string KindName(const ::testing::TestParamInfo<PairKind>& kind) { return kind.param.name; }

INSTANTIATE_TEST_SUITE_P(Law, EveryContactKind, ::testing::ValuesIn(AllPairKinds()), KindName);
INSTANTIATE_TEST_SUITE_P(Law, ContactKindWithCenters, ::testing::ValuesIn(PairKindsWhere(false)), KindName);
INSTANTIATE_TEST_SUITE_P(Law, ContactKindWithStraightEdge, ::testing::ValuesIn(PairKindsWhere(true)), KindName);

// Against a straight edge, a convex arc (or, for a vertex, also a concave one) of growing radius with the same contact
// point and normal.
TEST(ContactRow, ArcTendsToLineAsRadiusGrows) {
  Random random(8);
  for (const PairKind& kind : AllPairKinds()) {
    if (kind.shape2 != Shape::kStraight) continue;
    for (const Shape arc : {Shape::kConvexArc, Shape::kConcaveArc}) {
      for (int i = 0; i < kCases; ++i) {
        const ContactCase c = RandomContact(kind, &random);
        const ContactRow straight = RowOf(c);
        for (const double radius : {1e3, 1e5, 1e7}) {
          SCOPED_TRACE(radius);
          ContactCase curved = c;
          curved.feature2 = FeatureThrough(arc, c.body2, c.p2, c.n, radius, &random);
          const ContactRow row = RowOf(curved);
          // The terms in kappa are of order u^2 and (rho omega)^2; rounding of the centre is eps * radius.
          const double tolerance = 1e3 / radius + 1e-14 * radius;
          ExpectClose(row.gamma, straight.gamma, tolerance, "gamma");
          ExpectClose(row.d_dot, straight.d_dot, 1e-14 * radius, "d'");
          ExpectClose(row.omega_n, straight.omega_n, tolerance, "omega_n");
          for (size_t k = 0; k < 6; ++k) ExpectClose(row.J[k], straight.J[k], 1e-14 * radius, "J");
        }
        ASSERT_FALSE(HasFailure());
      }
    }
  }
}

TEST(ContactRow, DiscAboutItsCenterOfMassHasNoMomentAtAll) {
  Random random(9);
  for (int i = 0; i < kCases; ++i) {
    ContactCase c = RandomContact(AllPairKinds()[4], &random);
    std::get<ArcEdge>(c.feature1).center = {0, 0};
    EXPECT_EQ(RowOf(c).J[2], 0);
  }
}

// A vertex sliding at speed v along a fixed straight edge needs no acceleration; on a convex arc of radius R it leaves
// with v^2/R, in a concave one it is pressed in by v^2/R.
TEST(ContactRow, SlidingVertexFeelsTheCurvatureOfTheEdge) {
  const double speed = 3;
  const double radius = 2;
  Body slider;
  slider.v = {speed, 0};
  Body ground;
  ground.fixed = true;
  const auto gamma = [&](const Feature& edge) {
    const Feature vertex = Vertex{{0, 0}};
    return ComputeContactRow(FindClosestPoints({vertex, {0, 0}, {}}, {edge, {0, 0}, {}}), slider, ground).gamma;
  };
  EXPECT_EQ(gamma(StraightEdge{{1, 0}, {-1, 0}}), 0);
  EXPECT_DOUBLE_EQ(gamma(ArcEdge{{0, -radius}, radius, Side::kConvex}), speed * speed / radius);
  EXPECT_DOUBLE_EQ(gamma(ArcEdge{{0, radius}, radius, Side::kConcave}), -speed * speed / radius);
}

TEST(PinRows, GiveTheDerivativesOfTheGapAlongAnyMotion) {
  Random random(10);
  for (int i = 0; i < kCases; ++i) {
    const Body body1 = RandomBody(&random);
    const Body body2 = RandomBody(&random);
    const Vec2 c1 = random.Vector(2);
    const Vec2 c2 = random.Vector(2);
    const Acceleration a1 = RandomAcceleration(&random);
    const Acceleration a2 = RandomAcceleration(&random);
    const PinRows pin = ComputePinRows(c1, SinCos(body1.theta), body1, c2, SinCos(body2.theta), body2);
    const Material m1 = MaterialPoint(body1, a1, pin.R1);
    const Material m2 = MaterialPoint(body2, a2, pin.R2);
    const Vec2 g = ToWorld(body1, c1) - ToWorld(body2, c2);
    const Vec2 g_dot = m1.velocity - m2.velocity;
    const Vec2 g_ddot = m1.acceleration - m2.acceleration;
    const std::array<double, 6> v = {body1.v.x, body1.v.y, body1.omega, body2.v.x, body2.v.y, body2.omega};
    const std::array<double, 6> a = {a1.a.x, a1.a.y, a1.alpha, a2.a.x, a2.a.y, a2.alpha};
    const std::array<std::array<double, 3>, 2> expected = {{{g.x, g_dot.x, g_ddot.x}, {g.y, g_dot.y, g_ddot.y}}};
    for (size_t axis = 0; axis < 2; ++axis) {
      double Jv = 0;
      double Ja = 0;
      for (size_t k = 0; k < 6; ++k) {
        Jv += pin.J[axis][k] * v[k];
        Ja += pin.J[axis][k] * a[k];
      }
      ExpectClose(pin.g[axis], expected[axis][0], kRounding, "g");
      ExpectClose(pin.g_dot[axis], expected[axis][1], kRounding, "g'");
      ExpectClose(Jv, expected[axis][1], kRounding, "J v");
      ExpectClose(Ja + pin.gamma[axis], expected[axis][2], kRounding, "g''");
    }
  }
}

}  // namespace
}  // namespace lcpbench::testing
