#include "model/contact/contact_row.h"

#include <boost/multiprecision/cpp_bin_float.hpp>

#include "tests/model/contact/random_contacts.h"

namespace lcpbench::testing {
namespace {

constexpr int kRowCases = 300;
constexpr int kGeneralRowCases = 40;  // of each of the many kinds with a general curve
constexpr double kRoundingOfRows = 1e-12;

// The row of the bodies exchanged, bit by bit.
void ExpectSwapped(const ClosestPoints& p, const ContactRow& row, const ClosestPoints& q, const ContactRow& other) {
  EXPECT_EQ(p.d, q.d);
  EXPECT_EQ(p.n, -q.n);
  EXPECT_EQ(row.d_dot, other.d_dot);
  EXPECT_EQ(row.gamma, other.gamma);
  ExpectExchanged(row.J, other.J);
}

ContactRow RowOf(const ContactCase& c) { return ComputeContactRow(c.Closest(), c.body1, c.body2); }

// First and second derivative at 0 of a function of k steps of h, to the fourth order.
template <class Function>
std::array<double, 3> Derivatives(const Function& f, long double h) {
  const long double f0 = f(0), p1 = f(1), m1 = f(-1), p2 = f(2), m2 = f(-2);
  return {static_cast<double>(f0), static_cast<double>((8 * (p1 - m1) - (p2 - m2)) / (12 * h)),
          static_cast<double>((16 * (p1 + m1) - (p2 + m2) - 30 * f0) / (12 * h * h))};
}

// The gap of section 2 in long double along a smooth random motion: independent of the code under test, which also has
// other arms, another order of evaluation and no time.
struct Acceleration {
  Vec2 a;
  double alpha = 0;
  Vec2 jerk;
  double angular_jerk = 0;
};

struct LongPose {
  LongVec x;
  long double theta = 0;

  LongVec Turn(LongVec c) const { return Turned(c, theta); }
  LongVec World(Vec2 c) const { return x + Turn(Long(c)); }
  LongVec Point(const Feature& feature, long double s) const { return x + Turn(LongPoint(feature, s)); }
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

// The gap where the features' tangents are parallel and the connecting line is normal to them, by Newton's method with
// difference quotients: an error e of the parameters changes the gap by the order of e^2 only.
class LongSearch {
 public:
  LongSearch(const Feature& feature1, const LongPose& pose1, const Feature& feature2, const LongPose& pose2)
      : feature1_(feature1), feature2_(feature2), pose1_(pose1), pose2_(pose2) {}

  long double Gap(std::optional<double> start1, std::optional<double> start2) const {
    std::array<long double, 2> s = {static_cast<long double>(start1.value_or(0)),
                                    static_cast<long double>(start2.value_or(0))};
    for (int i = 0; i < 12; ++i) {
      const long double h = 1e-6L;
      const std::array<long double, 2> f = Residuals(s);
      const std::array<long double, 2> f1 = Residuals({s[0] + h, s[1]});
      const std::array<long double, 2> f2 = Residuals({s[0], s[1] + h});
      const long double a = (f1[0] - f[0]) / h, b = (f2[0] - f[0]) / h;
      const long double c = (f1[1] - f[1]) / h, d = (f2[1] - f[1]) / h;
      const long double determinant = a * d - b * c;
      s[0] -= (d * f[0] - b * f[1]) / determinant;
      s[1] -= (a * f[1] - c * f[0]) / determinant;
    }
    const bool vertex2 = std::holds_alternative<Vertex>(feature2_);
    const LongVec along = vertex2 ? Tangent(feature1_, pose1_, s[0]) : Tangent(feature2_, pose2_, s[1]);
    const LongVec outward = LongVec{along.y, -along.x};
    const auto sign = static_cast<long double>(vertex2 ? -MaterialSide(feature1_) : MaterialSide(feature2_));
    return sign * Dot(outward, pose1_.Point(feature1_, s[0]) - pose2_.Point(feature2_, s[1]));
  }

 private:
  static LongVec Tangent(const Feature& feature, const LongPose& pose, long double s) {
    const long double h = 1e-5L;
    const LongVec chord = pose.Point(feature, s + h) - pose.Point(feature, s - h);
    return (1 / Norm(chord)) * chord;
  }

  std::array<long double, 2> Residuals(const std::array<long double, 2>& s) const {
    const LongVec between = pose1_.Point(feature1_, s[0]) - pose2_.Point(feature2_, s[1]);
    // A vertex has no parameter: hold it.
    if (std::holds_alternative<Vertex>(feature1_)) return {s[0], Dot(between, Tangent(feature2_, pose2_, s[1]))};
    if (std::holds_alternative<Vertex>(feature2_)) return {Dot(between, Tangent(feature1_, pose1_, s[0])), s[1]};
    const LongVec along1 = Tangent(feature1_, pose1_, s[0]);
    const LongVec along2 = Tangent(feature2_, pose2_, s[1]);
    return {Cross(along1, along2), Dot(between, along2)};
  }

  const Feature& feature1_;
  const Feature& feature2_;
  const LongPose& pose1_;
  const LongPose& pose2_;
};

struct Material {
  Vec2 velocity;
  Vec2 acceleration;
};

// Velocity and acceleration of the point fixed in a body at arm r. [docs/model.md section 1]
Material MaterialPoint(const Body& body, const Acceleration& acceleration, Vec2 r) {
  return {body.v + body.omega * Perp(r), acceleration.a + acceleration.alpha * Perp(r) - body.omega * body.omega * r};
}

// gamma and omega_n by the centre form, in double: [docs/model.md section 4]
std::pair<double, double> ByCenters(const ContactCase& c, const ClosestPoints& p) {
  const Vec2 U1 = Rotate(SinCos(c.body1.theta), Center(c.feature1, p.s1));
  const Vec2 U2 = Rotate(SinCos(c.body2.theta), Center(c.feature2, p.s2));
  const double L = SignedRadius(c.feature1, p.s1) + SignedRadius(c.feature2, p.s2) + p.d;
  const double turn = Dot(Perp(p.n), MaterialPoint(c.body1, {}, U1).velocity - MaterialPoint(c.body2, {}, U2).velocity);
  const double w1 = c.body1.omega;
  const double w2 = c.body2.omega;
  return {-w1 * w1 * Dot(p.n, U1) + w2 * w2 * Dot(p.n, U2) + turn * turn / L, turn / L};
}

Acceleration RandomAcceleration(Random* random) {
  return {random->Vector(3), random->Uniform(-3, 3), random->Vector(3), random->Uniform(-3, 3)};
}

double JTimesA(const std::array<double, 6>& J, const Acceleration& a1, const Acceleration& a2) {
  return RowTimes(J, a1.a, a1.alpha, a2.a, a2.alpha);
}

class EveryContactKind : public ::testing::TestWithParam<PairKind> {
 protected:
  // Calls check(case, random) over seeded random configurations.
  template <class Check>
  void OverCases(unsigned seed, const Check& check) {
    OverRandomContacts(GetParam(), GetParam().is_general() ? kGeneralRowCases : kRowCases, seed, check);
  }
};

TEST_P(EveryContactKind, RowGivesTheDerivativesOfTheGapAlongAnyMotion) {
  OverCases(1, [](const ContactCase& c, Random* random) {
    const Acceleration a1 = RandomAcceleration(random);
    const Acceleration a2 = RandomAcceleration(random);
    const ClosestPoints closest = c.Closest();
    const long double h = 2e-5L;
    const auto gap = [&](int k) {
      const long double t = static_cast<long double>(k) * h;
      const LongPose pose1 = PoseAt(c.body1, a1, t);
      const LongPose pose2 = PoseAt(c.body2, a2, t);
      return LongSearch(c.feature1, pose1, c.feature2, pose2).Gap(closest.s1, closest.s2);
    };
    const auto [d, d_dot, d_ddot] = Derivatives(gap, h);
    const ContactRow row = ComputeContactRow(closest, c.body1, c.body2);
    ExpectClose(closest.d, d, 1e-14, "d");
    ExpectClose(row.d_dot, d_dot, 1e-8, "d'");
    ExpectClose(JTimesA(row.J, a1, a2) + row.gamma, d_ddot, 1e-7, "d''");
    ExpectClose(row.d_dot, RowTimes(row.J, c.body1.v, c.body1.omega, c.body2.v, c.body2.omega), kRoundingOfRows, "J v");
    ExpectClose(row.J[2], Cross(closest.R1, closest.n), kRoundingOfRows, "arm of body 1");
    ExpectClose(row.J[5], -Cross(closest.R2, closest.n), kRoundingOfRows, "arm of body 2");
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
    const ContactCase swapped = c.Swapped();
    const ClosestPoints p = c.Closest();
    const ClosestPoints q = swapped.Closest();
    const ContactRow row = ComputeContactRow(p, c.body1, c.body2);
    const ContactRow other = ComputeContactRow(q, swapped.body1, swapped.body2);
    ExpectSwapped(p, row, q, other);
    EXPECT_EQ(row.omega_n, other.omega_n);
  });
}

TEST_P(EveryContactKind, CurvatureFormEqualsCenterFormWhereBothHaveCenters) {
  if (GetParam().shape1 == Shape::kStraight || GetParam().shape2 == Shape::kStraight) return;
  OverCases(5, [](const ContactCase& c, Random*) {
    const ClosestPoints p = c.Closest();
    const ContactRow row = ComputeContactRow(p, c.body1, c.body2);
    const auto [gamma, omega_n] = ByCenters(c, p);
    ExpectClose(row.gamma, gamma, 1e-11, "gamma");
    ExpectClose(row.omega_n, omega_n, 1e-11, "omega_n");
  });
}

INSTANTIATE_TEST_SUITE_P(Law, EveryContactKind, ::testing::ValuesIn(AllPairKinds()),
                         ::testing::PrintToStringParamName());
TEST(ContactRow, StraightBezierCurveActsAsTheStraightEdge) {
  Random random(20);
  for (const PairKind& kind : AllPairKinds()) {
    if (kind.shape2 != Shape::kStraight) continue;
    for (int i = 0; i < kGeneralRowCases; ++i) {
      SCOPED_TRACE(kind.name);
      const ContactCase c = RandomContact(kind, &random);
      ContactCase other = c;
      const auto& edge = std::get<StraightEdge>(c.feature2);
      const Vec2 third = (1.0 / 3) * (edge.b - edge.a);
      other.feature2 = BezierEdge{{edge.a, edge.a + third, edge.b - third, edge.b}};
      other.s2 = c.Closest().s2;
      const ContactRow row = RowOf(c);
      const ContactRow found = RowOf(other);
      EXPECT_NEAR(other.Closest().d, c.Closest().d, kRoundingOfRows);
      ExpectClose(found.gamma, row.gamma, 1e-11, "gamma");
      ExpectClose(found.omega_n, row.omega_n, 1e-11, "omega_n");
      for (size_t k = 0; k < 6; ++k) ExpectClose(found.J[k], row.J[k], 1e-11, "J");
      ASSERT_FALSE(HasFailure());
    }
  }
}

// The unified formula and the geometry of section 2 in 100 digits, for arcs (or vertices) and straight edges.
using Exact = boost::multiprecision::cpp_bin_float_100;

using ExactVec = VecOf<Exact>;

struct ExactRow {
  double d = 0;
  double J2 = 0;
  double J5 = 0;
  double gamma = 0;
};

ExactRow ExactRowOf(const ContactCase& c) {
  const auto turned = [](const Body& body, const ExactVec& a) {
    const Exact cosine = cos(Exact(body.theta));
    const Exact sine = sin(Exact(body.theta));
    return ExactVec{cosine * a.x - sine * a.y, sine * a.x + cosine * a.y};
  };
  const ExactVec dx = Lift<Exact>(c.body1.x) - Lift<Exact>(c.body2.x);
  const ExactVec U1 = turned(c.body1, Lift<Exact>(Center(c.feature1, {})));
  const Exact rho1 = SignedRadius(c.feature1, {});
  const Exact rho2 = SignedRadius(c.feature2, {});
  const bool vertex1 = rho1 == 0;
  ExactVec n;
  ExactVec R2;
  Exact d;
  if (const auto* edge = std::get_if<StraightEdge>(&c.feature2)) {
    const ExactVec along = turned(c.body2, Lift<Exact>(edge->b) - Lift<Exact>(edge->a));
    const Exact length = sqrt(Dot(along, along));
    n = {along.y / length, -along.x / length};
    d = Dot(n, dx + U1 - turned(c.body2, Lift<Exact>(edge->a))) - rho1;
    R2 = dx + U1 - (rho1 + d) * n;
  } else {
    const ExactVec U2 = turned(c.body2, Lift<Exact>(Center(c.feature2, {})));
    const ExactVec between = dx + U1 - U2;
    const Exact distance = sqrt(Dot(between, between));
    const Exact sigma = rho1 + rho2 > 0 ? 1 : -1;
    n = (sigma / distance) * between;
    d = sigma * distance - rho1 - rho2;
    R2 = U2 + rho2 * n;
  }
  const ExactVec R1 = U1 - rho1 * n;
  const Exact r1 = vertex1 ? 0 : 1;
  const Exact s1 = vertex1 ? Exact(1) : Exact(1 / rho1);
  const Exact s2 = rho2 == 0 ? Exact(0) : Exact(1 / rho2);
  const Exact w1 = c.body1.omega;
  const Exact w2 = c.body2.omega;
  const ExactVec t = {-n.y, n.x};
  const Exact u = Dot(t, Lift<Exact>(c.body1.v) - Lift<Exact>(c.body2.v)) + w1 * Dot(n, R1) - w2 * Dot(n, R2);
  const Exact D = r1 * s2 + s1 + d * s1 * s2;
  const Exact curved = s1 * s2 * u * u + 2 * u * (r1 * s2 * w1 + s1 * w2) - r1 * (w1 - w2) * (w1 - w2) -
                       d * (r1 * s2 * w1 * w1 + s1 * w2 * w2);
  const Exact gamma = w2 * w2 * Dot(n, R2) - w1 * w1 * Dot(n, R1) + curved / D;
  return {static_cast<double>(d), static_cast<double>(Cross(R1, n)), static_cast<double>(-Cross(R2, n)),
          static_cast<double>(gamma)};
}

// @param tolerance  of d; J may be off by 10 times as much, gamma by 1000 times
void ExpectExact(const ContactCase& c, const ClosestPoints& p, double tolerance) {
  const ContactRow row = ComputeContactRow(p, c.body1, c.body2);
  const ExactRow exact = ExactRowOf(c);
  ExpectClose(p.d, exact.d, tolerance, "d");
  ExpectClose(row.J[2], exact.J2, 10 * tolerance, "J2");
  ExpectClose(row.J[5], exact.J5, 10 * tolerance, "J5");
  ExpectClose(row.gamma, exact.gamma, 1000 * tolerance, "gamma");
}

TEST(ContactRow, IsThatOfTheFormulasInAHundredDigits) {
  for (const PairKind& kind : ClosedPairKinds()) {
    // The others are these with their bodies exchanged.
    if (kind.shape1 == Shape::kStraight || kind.shape2 == Shape::kVertex || IsConcave(kind.shape1)) continue;
    OverRandomContacts(kind, kRowCases, 6, [](const ContactCase& c, Random*) { ExpectExact(c, c.Closest(), 1e-14); });
  }
}

// One of body 2's arcs, or body 1's on a straight edge, of a radius up to 1e9 bodies.
TEST(ContactRow, NearlyStraightArcsKeepAllDigits) {
  Random random(21);
  for (const double radius : {1e3, 1e6, 1e9}) {
    for (const PairKind& kind : ClosedPairKinds()) {
      const bool on_straight = kind.shape2 == Shape::kStraight && kind.shape1 == Shape::kConvexArc;
      const bool on_arc = kind.shape2 == Shape::kConvexArc || kind.shape2 == Shape::kConcaveArc;
      if (kind.shape1 == Shape::kStraight || IsConcave(kind.shape1) || (!on_straight && !on_arc)) continue;
      for (int i = 0; i < kRowCases; ++i) {
        SCOPED_TRACE(kind.name);
        ContactCase c = RandomContact(kind, &random);
        if (on_straight) {
          c.feature1 = FeatureThrough(kind.shape1, c.body1, c.p1, -c.n, radius, &random);
          // gamma has the term -radius (omega1 - omega2)^2: of order 1 when the bodies turn alike.
          c.body1.omega = c.body2.omega + random.Uniform(-1, 1) / std::sqrt(radius);
        } else {
          c.feature2 = FeatureThrough(kind.shape2, c.body2, c.p2, c.n, radius, &random);
        }
        ExpectExact(c, c.Closest(), 1e-15);
        ASSERT_FALSE(HasFailure());
      }
    }
  }
}

// Both edges nearly straight: the contact point is then where two angles nearly agree.
TEST(ContactRow, NearlyFlatArcsOnEachOtherKeepAllDigitsOfTheirPlace) {
  Random random(22);
  for (const double radius : {1e3, 1e6, 1e9}) {
    for (int i = 0; i < kRowCases; ++i) {
      ContactCase c = RandomContact(ClosedPairKinds()[4], &random);
      const Shape shape2 = i % 2 == 0 ? Shape::kConvexArc : Shape::kConcaveArc;
      c.feature1 = FeatureThrough(Shape::kConvexArc, c.body1, c.p1, -c.n, radius, &random);
      c.feature2 = FeatureThrough(shape2, c.body2, c.p2, c.n, 2 * radius, &random);
      c.body1.omega = c.body2.omega + random.Uniform(-1, 1) / std::sqrt(radius);
      ExpectExact(c, c.Closest(), 1e-14);
      ASSERT_FALSE(HasFailure());
    }
  }
}

TEST(PinRows, GiveTheDerivativesOfTheGapAlongAnyMotion) {
  Random random(10);
  for (int i = 0; i < kRowCases; ++i) {
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
    const std::array<std::array<double, 3>, 2> expected = {{{g.x, g_dot.x, g_ddot.x}, {g.y, g_dot.y, g_ddot.y}}};
    for (size_t axis = 0; axis < 2; ++axis) {
      const double Jv = RowTimes(pin.J[axis], body1.v, body1.omega, body2.v, body2.omega);
      const double Ja = JTimesA(pin.J[axis], a1, a2);
      ExpectClose(pin.g[axis], expected[axis][0], kRoundingOfRows, "g");
      ExpectClose(pin.g_dot[axis], expected[axis][1], kRoundingOfRows, "g'");
      ExpectClose(Jv, expected[axis][1], kRoundingOfRows, "J v");
      ExpectClose(Ja + pin.gamma[axis], expected[axis][2], kRoundingOfRows, "g''");
    }
  }
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
    const Constraint connector{type, 0, 1, Vertex{vertex1}, Vertex{vertex2}, {}, {}, 0, length};
    return {"connector", {body1, body2}, {connector}};
  }
};

Connector RandomConnector(Random* random) {
  Connector connector;
  do {
    connector = {RandomBody(random), RandomBody(random), random->Vector(2), random->Vector(2), random->Uniform(0.5, 4)};
  } while (connector.Row().points.d < 0.3);
  return connector;
}

TEST(ConnectorRow, GivesTheDerivativesOfTheDistanceAlongAnyMotion) {
  Random random(1);
  for (int i = 0; i < kRowCases; ++i) {
    SCOPED_TRACE(i);
    const Connector c = RandomConnector(&random);
    const Acceleration motion1 = RandomAcceleration(&random);
    const Acceleration motion2 = RandomAcceleration(&random);
    const long double h = 2e-5L;
    const auto distance = [&](int k) {
      const long double t = static_cast<long double>(k) * h;
      return Norm(PoseAt(c.body1, motion1, t).World(c.vertex1) - PoseAt(c.body2, motion2, t).World(c.vertex2));
    };
    const auto [d, d_dot, d_ddot] = Derivatives(distance, h);
    const auto [points, row] = c.Row();
    ExpectClose(points.d, d, 1e-14, "d");
    ExpectClose(row.d_dot, d_dot, 1e-8, "d'");
    ExpectClose(JTimesA(row.J, motion1, motion2) + row.gamma, d_ddot, 1e-7, "d''");
  }
}

TEST(ConnectorRow, SwappingBodiesGivesTheSwappedRowBitByBit) {
  Random random(2);
  for (int i = 0; i < kRowCases; ++i) {
    const Connector c = RandomConnector(&random);
    const ConnectorRow row = c.Row();
    const ConnectorRow swapped = Connector{c.body2, c.body1, c.vertex2, c.vertex1, c.length}.Row();
    ExpectSwapped(row.points, row.row, swapped.points, swapped.row);
  }
}

// Others: tests/data/refusals/records.txt.
TEST(ConnectorRow, RefusesWhatHasNoDirectionOrFiniteNumbersNamingIt) {
  Random random(4);
  const Connector good = RandomConnector(&random);
  for (const auto& [type, name] :
       {std::pair{ConstraintType::kRod, "rod 0"}, std::pair{ConstraintType::kRope, "rope 0"}}) {
    const auto expect_refused = [&, kind = std::string(name)](const Connector& connector, const char* mentions) {
      for (const std::string& words : {kind, std::string(mentions)}) {
        ExpectRefused([&] { AssembleContactLcp(connector.System(type)); }, words);
      }
    };
    EXPECT_EQ(ErrorOf(good.System(type)), "");
    Connector coincident = good;
    coincident.body2.x = coincident.body1.x;
    coincident.body2.theta = coincident.body1.theta;
    coincident.vertex2 = coincident.vertex1;
    expect_refused(coincident, "zero distance: the two attachment points coincide");
    coincident.body2.x.x += 1e-13;
    expect_refused(coincident, "zero distance");
    for (const double length : {kNaN, kInfinity}) {
      Connector wrong = good;
      wrong.length = length;
      expect_refused(wrong, "length");
    }
    Connector nan = good;
    nan.vertex1.x = kNaN;
    expect_refused(nan, "not finite");
  }
  // A contact between two vertices stays refused, at any distance.
  EXPECT_NE(ErrorOf(good.System(ConstraintType::kContact)).find("vertex against vertex"), std::string::npos);
}

}  // namespace
}  // namespace lcpbench::testing
