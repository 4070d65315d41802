#include "model/contact/assembly.h"

#include "tests/model/contact/random_contacts.h"

namespace lcpbench::testing {
namespace {

constexpr double kRounding = 1e-11;

// A few bodies with contacts of every kind, path joints and pins between random pairs of them.
ContactSystem RandomSystem(unsigned seed) {
  Random random(seed);
  ContactSystem system;
  system.name = "random";
  for (const PairKind& kind : AllPairKinds()) {
    ContactCase c = RandomContact(kind, &random);
    const auto first = static_cast<int>(system.bodies.size());
    const bool has_vertex = kind.shape1 == Shape::kVertex || kind.shape2 == Shape::kVertex;
    const bool is_path = has_vertex && random.Uniform(0, 1) < 0.5;
    Constraint constraint = ConstraintOf(c, is_path ? ConstraintType::kPathJoint : ConstraintType::kContact);
    constraint.body1 = first + 1;
    constraint.body2 = first;
    if (random.Uniform(0, 1) < 0.3) {
      c.body2.fixed = true;
      c.body2.acceleration = random.Vector(3);
      c.body2.alpha = random.Uniform(-2, 2);
    }
    system.bodies.push_back(c.body2);
    system.bodies.push_back(c.body1);
    system.constraints.push_back(constraint);
    if (first > 0) {
      const Vertex on1{random.Vector(1)};
      const Vertex on2{random.Vector(1)};
      system.constraints.push_back({ConstraintType::kPin, first - 1, first + 1, on1, on2});
    }
  }
  return system;
}

ContactSystem BoxOnFloor() {
  Body floor;
  floor.name = "floor";
  floor.fixed = true;
  Body box;
  box.name = "box";
  box.mass = 2;
  box.x = {0, 1};
  box.force = {3, -10};
  box.torque = 8;
  ContactSystem system{"box-on-floor", {floor, box}, {}};
  for (const double x : {-1.0, 1.0}) {
    system.constraints.push_back({ConstraintType::kContact, 1, 0, Vertex{{x, -1}}, StraightEdge{{16, 0}, {-16, 0}}});
  }
  return system;
}

TEST(Assembly, BoxOnFloorIsTheTextbookProblem) {
  const AssembledLcp lcp = AssembleContactLcp(BoxOnFloor());
  Eigen::MatrixXd J(2, 6);
  J << 0, -1, 1, 0, 1, -1,  //
      0, -1, -1, 0, 1, 1;
  Eigen::MatrixXd A(2, 2);
  A << 1.5, -0.5, -0.5, 1.5;
  EXPECT_EQ(Eigen::MatrixXd(lcp.problem.J()), J);
  EXPECT_EQ(lcp.problem.DenseA(), A);
  EXPECT_EQ(lcp.problem.b(), Eigen::Vector2d(-13, 3));
  EXPECT_EQ(lcp.problem.id(), "box-on-floor");
  EXPECT_TRUE(lcp.problem.bilateral_rows().empty());
  EXPECT_TRUE(lcp.problem.has_two_body_rows());
  EXPECT_EQ(lcp.rows[1].constraint, 1);
  EXPECT_EQ(lcp.rows[1].p1.x, 1);
  EXPECT_EQ(lcp.rows[1].d, 0);
}

TEST(Assembly, SystemWithoutConstraintsHasNoRows) {
  EXPECT_EQ(AssembleContactLcp({}).problem.size(), 0);
  ContactSystem bodies_only = BoxOnFloor();
  bodies_only.constraints.clear();
  const AssembledLcp lcp = AssembleContactLcp(bodies_only);
  EXPECT_EQ(lcp.problem.size(), 0);
  EXPECT_EQ(lcp.problem.J().cols(), 6);
}

TEST(Assembly, IsJInverseMassTimesForcePlusGamma) {
  for (unsigned seed = 0; seed < 30; ++seed) {
    const ContactSystem system = RandomSystem(seed);
    const AssembledLcp lcp = AssembleContactLcp(system);
    const auto columns = static_cast<Index>(3 * system.bodies.size());
    Eigen::VectorXd acceleration(columns);
    Eigen::VectorXd velocity(columns);
    Eigen::VectorXd inverse_mass(columns);
    for (size_t i = 0; i < system.bodies.size(); ++i) {
      const Body& body = system.bodies[i];
      const auto k = static_cast<Index>(3 * i);
      velocity.segment(k, 3) << body.v.x, body.v.y, body.omega;
      if (body.fixed) {
        acceleration.segment(k, 3) << body.acceleration.x, body.acceleration.y, body.alpha;
        inverse_mass.segment(k, 3).setZero();
      } else {
        acceleration.segment(k, 3) << body.force.x / body.mass, body.force.y / body.mass, body.torque / body.inertia;
        inverse_mass.segment(k, 3) << 1 / body.mass, 1 / body.mass, 1 / body.inertia;
      }
    }
    EXPECT_EQ(lcp.problem.inverse_mass(), inverse_mass);
    const Eigen::VectorXd J_a = lcp.problem.J() * acceleration;
    const Eigen::VectorXd J_v = lcp.problem.J() * velocity;
    for (Index i = 0; i < lcp.problem.size(); ++i) {
      const RowInfo& row = lcp.rows[static_cast<size_t>(i)];
      EXPECT_NEAR(lcp.problem.b()[i], J_a[i] + row.gamma, kRounding);
      EXPECT_NEAR(row.d_dot, J_v[i], kRounding);
    }
    const Eigen::MatrixXd J = lcp.problem.J();
    EXPECT_LE((lcp.problem.DenseA() - J * inverse_mass.asDiagonal() * J.transpose()).cwiseAbs().maxCoeff(), kRounding);
  }
}

TEST(Assembly, FixedBodiesIgnoreForcesAndMassAndMovableOnesPrescribedAccelerations) {
  ContactSystem system = BoxOnFloor();
  const Eigen::VectorXd b = AssembleContactLcp(system).problem.b();
  system.bodies[0].force = {100, 100};
  system.bodies[0].mass = kInfinity;
  system.bodies[1].acceleration = {100, 100};
  system.bodies[1].alpha = 100;
  EXPECT_EQ(AssembleContactLcp(system).problem.b(), b);
  // A floor that rises at 2 m/s^2 takes 2 m/s^2 from the gap acceleration.
  system.bodies[0].acceleration = {0, 2};
  EXPECT_EQ(AssembleContactLcp(system).problem.b(), b - Eigen::Vector2d(2, 2));
}

TEST(Assembly, ParallelContactsOfDiscsHaveRowsThatDependExactly) {
  // A disc between two parallel walls: its rows are n and -n, and a sum of -0.0 would not be 0 with any moment left.
  Body walls;
  walls.fixed = true;
  Body disc;
  disc.theta = 0.3;
  disc.omega = 2;
  ContactSystem system{"disc-between-walls", {walls, disc}, {}};
  for (const double y : {-1.0, 1.0}) {
    system.constraints.push_back(
        {ConstraintType::kContact, 1, 0, ArcEdge{{0, 0}, 1, Side::kConvex}, StraightEdge{{-y, y}, {y, y}}});
  }
  const Eigen::MatrixXd A = AssembleContactLcp(system).problem.DenseA();
  EXPECT_EQ(A(0, 0), -A(0, 1));
  EXPECT_EQ(A(0, 0), A(1, 1));
}

// What is refused of a box on a floor after a change, and the words of the refusal.
TEST(Assembly, RefusesWrongBodiesAndConstraintsNamingThem) {
  const auto expect = [](const std::vector<std::string>& words, const auto& change) {
    ContactSystem system = BoxOnFloor();
    change(system);
    for (const std::string& word : words) ExpectRefused([&] { AssembleContactLcp(system); }, word);
  };
  expect({"box-on-floor", "contact 1", "must differ", "body 1 'box'"}, [](auto& s) { s.constraints[1].body2 = 1; });
  for (const auto& [member, name] : {std::pair(&Body::mass, "mass"), std::pair(&Body::inertia, "inertia")}) {
    for (const double value : {0.0, -1.0, kNaN, kInfinity, 1e-310}) {
      expect({"body 1 'box'", name}, [&, m = member](auto& s) { s.bodies[1].*m = value; });
    }
  }
  for (double Body::*member : {&Body::theta, &Body::omega, &Body::torque}) {
    expect({"body 1 'box'", "not finite"}, [&](auto& s) { s.bodies[1].*member = kNaN; });
  }
  for (Vec2 Body::*member : {&Body::x, &Body::v, &Body::force}) {
    expect({"body 1 'box'", "not finite"}, [&](auto& s) { (s.bodies[1].*member).y = kInfinity; });
  }
  expect({"body 0 'floor'", "prescribed acceleration"}, [&](auto& s) { s.bodies[0].acceleration.x = kNaN; });
  expect(
      {"contact 1", "body 1 'box'", "body 0 'floor'", "straight edge with a (-1, -1)", "straight edge with a (16, 0)"},
      [](auto& s) {
        s.constraints[1].feature1 = StraightEdge{{-1, -1}, {1, -1}};
      });
  expect({"pin 0", "two vertices", "vertex with p (-1, -1)", "straight edge"},
         [](auto& s) { s.constraints[0].type = ConstraintType::kPin; });
  for (const bool edges : {true, false}) {
    expect({"path joint 0", "one vertex and one edge"}, [&](auto& s) {
      s.constraints[0].type = ConstraintType::kPathJoint;
      if (edges) s.constraints[0].feature1 = ArcEdge{{0, 0}, 1, Side::kConvex};
      if (!edges) s.constraints[0].feature2 = Vertex{{0, 0}};
    });
  }
  expect({"contact 0", "overflow"}, [](auto& s) { s.bodies[1].omega = 1e200; });
  expect({"contact 0", "body 1 'box'"}, [](auto& s) {
    s.bodies[1].x = {1e308, 1e308};
    s.bodies[0].x = {-1e308, -1e308};
  });
}

// Inputs of every magnitude a double has: a refusal or finite rows, nothing else.
TEST(Assembly, IsFiniteOrRefusedForInputsOfAnyMagnitude) {
  Random random(35);
  int assembled = 0;
  int refused = 0;
  for (int i = 0; i < 20000; ++i) {
    const std::vector<PairKind>& kinds = AllPairKinds();
    ContactCase c = RandomContact(kinds[static_cast<size_t>(i) % kinds.size()], &random);
    const double range = i % 2 == 0 ? 320 : 60;
    const auto wild = [&](double value) { return value * std::pow(10, random.Uniform(-range, range)); };
    const auto wild_vector = [&](Vec2 a) { return Vec2{wild(a.x), wild(a.y)}; };
    for (Body* body : {&c.body1, &c.body2}) {
      for (double* number : {&body->mass, &body->inertia, &body->theta, &body->omega, &body->torque}) {
        *number = wild(*number);
      }
      for (Vec2* vector : {&body->x, &body->v, &body->force}) *vector = wild_vector(*vector);
    }
    for (Feature* feature : {&c.feature1, &c.feature2}) {
      if (IsVertex(*feature)) continue;
      ForEachPoint(*feature, [&](Vec2& p) { p = wild_vector(p); });
      std::visit(
          [&](auto& e) {
            if constexpr (requires { e.radius; }) e.radius = wild(e.radius);
            if constexpr (requires { e.phi; }) {
              for (double* number : {&e.a, &e.b, &e.phi}) *number = wild(*number);
            }
          },
          *feature);
    }
    try {
      const AssembledLcp lcp = AssembleContactLcp(SystemOf(c));
      ASSERT_TRUE(lcp.problem.b().allFinite());
      ASSERT_TRUE(Eigen::MatrixXd(lcp.problem.J()).allFinite());
      ASSERT_TRUE(std::isfinite(lcp.rows[0].d) && std::isfinite(lcp.rows[0].d_dot) && std::isfinite(lcp.rows[0].gamma));
      ASSERT_NEAR(Norm(lcp.rows[0].n), 1, 1e-12);
      ++assembled;
    } catch (const InputError&) {
      ++refused;
    }
  }
  EXPECT_GT(assembled, 1000);
  EXPECT_GT(refused, 1000);
}

}  // namespace
}  // namespace lcpbench::testing
