#include "model/contact/connector_row.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "model/contact/assembly.h"
#include "support/input_error.h"
#include "tests/model/random_contacts.h"

namespace lcpbench::testing {
namespace {

constexpr int kCases = 300;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

void ExpectClose(double x, double y, double tolerance, const char* what) {
  EXPECT_LE(std::abs(x - y), tolerance * (1 + std::abs(y))) << what << ": " << x << " against " << y;
}

struct Connector {
  Body body1;
  Body body2;
  Vec2 vertex1;
  Vec2 vertex2;
  double length = 1;

  ConnectorRow Row() const {
    return ComputeConnectorRow(vertex1, SinCos(body1.theta), body1, vertex2, SinCos(body2.theta), body2, length);
  }
  ContactSystem System(ConstraintType type) const {
    Constraint constraint;
    constraint.type = type;
    constraint.feature1 = Vertex{vertex1};
    constraint.feature2 = Vertex{vertex2};
    constraint.length = length;
    return {"connector", {body1, body2}, {constraint}};
  }
};

Connector RandomConnector(Random* random) {
  Connector connector;
  do {
    connector = {RandomBody(random), RandomBody(random), random->Vector(2), random->Vector(2), random->Uniform(0.5, 4)};
  } while (connector.Row().points.d < 0.3);
  return connector;
}

// One coordinate moving with constant third derivative, in long double.
long double Along(double x, double v, double a, double jerk, long double t) {
  return static_cast<long double>(x) + t * static_cast<long double>(v) + t * t / 2 * static_cast<long double>(a) +
         t * t * t / 6 * static_cast<long double>(jerk);
}

struct Motion {
  Vec2 a;
  double alpha = 0;
  Vec2 jerk;

  // The world coordinates of the body's point c at time t.
  std::pair<long double, long double> PointAt(const Body& body, Vec2 c, long double t) const {
    const long double theta = Along(body.theta, body.omega, alpha, 0, t);
    const auto cx = static_cast<long double>(c.x);
    const auto cy = static_cast<long double>(c.y);
    return {Along(body.x.x, body.v.x, a.x, jerk.x, t) + std::cos(theta) * cx - std::sin(theta) * cy,
            Along(body.x.y, body.v.y, a.y, jerk.y, t) + std::sin(theta) * cx + std::cos(theta) * cy};
  }
};

TEST(ConnectorRow, GivesTheDerivativesOfTheDistanceAlongAnyMotion) {
  Random random(1);
  for (int i = 0; i < kCases; ++i) {
    SCOPED_TRACE(i);
    const Connector c = RandomConnector(&random);
    const Motion motion1{random.Vector(3), random.Uniform(-3, 3), random.Vector(3)};
    const Motion motion2{random.Vector(3), random.Uniform(-3, 3), random.Vector(3)};
    const long double h = 2e-5L;
    const auto distance = [&](int k) {
      const auto [x1, y1] = motion1.PointAt(c.body1, c.vertex1, static_cast<long double>(k) * h);
      const auto [x2, y2] = motion2.PointAt(c.body2, c.vertex2, static_cast<long double>(k) * h);
      return std::sqrt((x1 - x2) * (x1 - x2) + (y1 - y2) * (y1 - y2));
    };
    const long double g0 = distance(0), p1 = distance(1), m1 = distance(-1), p2 = distance(2), m2 = distance(-2);
    const ConnectorRow connector = c.Row();
    const ContactRow& row = connector.row;
    const double Ja = row.J[0] * motion1.a.x + row.J[1] * motion1.a.y + row.J[2] * motion1.alpha +
                      row.J[3] * motion2.a.x + row.J[4] * motion2.a.y + row.J[5] * motion2.alpha;
    ExpectClose(connector.points.d, static_cast<double>(g0), 1e-14, "d");
    ExpectClose(row.d_dot, static_cast<double>((8 * (p1 - m1) - (p2 - m2)) / (12 * h)), 1e-8, "d'");
    ExpectClose(Ja + row.gamma, static_cast<double>((16 * (p1 + m1) - (p2 + m2) - 30 * g0) / (12 * h * h)), 1e-7,
                "d''");
  }
}

TEST(ConnectorRow, SwappingBodiesGivesTheSwappedRowBitByBit) {
  Random random(2);
  for (int i = 0; i < kCases; ++i) {
    const Connector c = RandomConnector(&random);
    const ConnectorRow row = c.Row();
    const ConnectorRow swapped = Connector{c.body2, c.body1, c.vertex2, c.vertex1, c.length}.Row();
    EXPECT_EQ(row.points.d, swapped.points.d);
    EXPECT_EQ(row.points.n.x, -swapped.points.n.x);
    EXPECT_EQ(row.points.n.y, -swapped.points.n.y);
    EXPECT_EQ(row.row.d_dot, swapped.row.d_dot);
    EXPECT_EQ(row.row.gamma, swapped.row.gamma);
    for (size_t k = 0; k < 3; ++k) {
      EXPECT_EQ(row.row.J[k], swapped.row.J[k + 3]);
      EXPECT_EQ(row.row.J[k + 3], swapped.row.J[k]);
    }
  }
}

TEST(ConnectorRow, RopeIsTheUnilateralNegatedRod) {
  Random random(3);
  for (int i = 0; i < kCases; ++i) {
    const Connector c = RandomConnector(&random);
    const AssembledLcp rod = AssembleContactLcp(c.System(ConstraintType::kRod));
    const AssembledLcp rope = AssembleContactLcp(c.System(ConstraintType::kRope));
    ASSERT_EQ(rod.problem.size(), 1);
    ASSERT_EQ(rope.problem.size(), 1);
    EXPECT_TRUE(rod.problem.is_bilateral(0));
    EXPECT_FALSE(rope.problem.is_bilateral(0));
    EXPECT_EQ(rod.problem.DenseA()(0, 0), rope.problem.DenseA()(0, 0));
    EXPECT_EQ(rod.problem.b()[0], -rope.problem.b()[0]);
    EXPECT_EQ(rod.rows[0].d, -rope.rows[0].d);
    EXPECT_EQ(rod.rows[0].d_dot, -rope.rows[0].d_dot);
    EXPECT_EQ(rod.rows[0].gamma, -rope.rows[0].gamma);
    EXPECT_EQ(rod.rows[0].n.x, -rope.rows[0].n.x);
    EXPECT_EQ(rod.rows[0].bilateral, true);
    EXPECT_EQ(rope.rows[0].bilateral, false);
    EXPECT_EQ((Eigen::MatrixXd(rod.problem.J()) + Eigen::MatrixXd(rope.problem.J())).norm(), 0);
    EXPECT_EQ(rod.rows[0].d, c.Row().points.d - c.length);
  }
}

// A mass m circling at speed v on a rope of length L is held by m v^2/L, and by m g more at the lowest point.
TEST(ConnectorRow, RopeOfACirclingMassPullsWithTheCentripetalForce) {
  const double mass = 3;
  const double speed = 4;
  const double length = 2;
  const double weight = 30;
  Body bob;
  bob.mass = mass;
  bob.x = {0, -length};
  bob.v = {speed, 0};
  bob.force = {0, -weight};
  Body ceiling;
  ceiling.fixed = true;
  const Connector c{bob, ceiling, {0, 0}, {0, 0}, length};
  for (const ConstraintType type : {ConstraintType::kRod, ConstraintType::kRope}) {
    const AssembledLcp lcp = AssembleContactLcp(c.System(type));
    const double f = -lcp.problem.b()[0] / lcp.problem.DenseA()(0, 0);
    const double tension = mass * speed * speed / length + weight;
    EXPECT_DOUBLE_EQ(type == ConstraintType::kRope ? f : -f, tension);
    EXPECT_EQ(lcp.rows[0].d, 0);
  }
}

TEST(ConnectorRow, RefusesWhatHasNoDirectionOrLengthNamingIt) {
  Random random(4);
  const Connector good = RandomConnector(&random);
  for (const auto& [type, name] :
       {std::pair{ConstraintType::kRod, "rod 0"}, std::pair{ConstraintType::kRope, "rope 0"}}) {
    const auto expect_refused = [&, kind = std::string(name)](const ContactSystem& system, const char* mentions) {
      const std::string error = ErrorOf(system);
      EXPECT_NE(error.find(kind), std::string::npos) << error;
      EXPECT_NE(error.find(mentions), std::string::npos) << error;
      EXPECT_EQ(error.find('\n'), std::string::npos);
    };
    EXPECT_EQ(ErrorOf(good.System(type)), "");
    Connector coincident = good;
    coincident.body2.x = coincident.body1.x;
    coincident.body2.theta = coincident.body1.theta;
    coincident.vertex2 = coincident.vertex1;
    expect_refused(coincident.System(type), "zero distance");
    coincident.body2.x.x += 1e-13;
    expect_refused(coincident.System(type), "zero distance");
    for (const double length : {0.0, -1.0, kNan, std::numeric_limits<double>::infinity()}) {
      Connector wrong = good;
      wrong.length = length;
      expect_refused(wrong.System(type), "length");
    }
    Connector nan = good;
    nan.vertex1.x = kNan;
    expect_refused(nan.System(type), "not finite");
    ContactSystem edge = good.System(type);
    edge.constraints[0].feature2 = StraightEdge{{0, 0}, {1, 0}};
    expect_refused(edge, "needs two vertices");
  }
  // A contact between two vertices stays refused, at any distance.
  EXPECT_NE(ErrorOf(good.System(ConstraintType::kContact)).find("vertex against vertex"), std::string::npos);
}

}  // namespace
}  // namespace lcpbench::testing
