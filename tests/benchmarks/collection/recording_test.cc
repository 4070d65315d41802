#include "benchmarks/collection/recording.h"

#include <Eigen/Geometry>

#include "tests/model/shape/random_outlines.h"
#include "tests/support/refusal.h"

namespace lcpbench {
namespace {

using testing::Random;

RecordedStep::Vector Vector(Random* random, int dimension) {
  return {random->Uniform(-1, 1), random->Uniform(-1, 1), dimension == 3 ? random->Uniform(-1, 1) : 0.0};
}
// In the plane only the third number.
RecordedStep::Vector Spin(Random* random, int dimension) {
  return dimension == 3 ? Vector(random, 3) : RecordedStep::Vector{0, 0, random->Uniform(-1, 1)};
}

struct Recording {
  RecordingHeader header;
  RecordedStep step;
};

// Bodies with random contacts and joints; the first body cannot move, but has a velocity.
Recording RandomRecording(int dimension, unsigned seed) {
  Random random(seed);
  Recording made;
  made.header.engine = "engine";
  made.header.scene = "scene";
  made.header.dimension = dimension;
  made.header.time_step = 0.02;
  const int bodies = 6;
  for (int k = 0; k < bodies; ++k) {
    RecordingHeader::Body& body = made.header.bodies.emplace_back();
    RecordedStep::Body& state = made.step.bodies.emplace_back();
    if (k > 0) {
      body.inverse_mass = random.Uniform(0.5, 2);
      for (double& inverse : body.inverse_inertia) inverse = random.Uniform(0.5, 5);
    }
    state.x = Vector(&random, dimension);
    state.v = Vector(&random, dimension);
    state.omega = Spin(&random, dimension);
    state.force = Vector(&random, dimension);
    state.torque = Spin(&random, dimension);
    Eigen::Vector4d q = Eigen::Vector4d::NullaryExpr([&] { return random.Uniform(-1, 1); });
    q.normalize();
    std::copy(q.begin(), q.end(), state.turn.begin());
  }
  made.step.number = 7;
  const auto end = [&](int but) {
    int body = but;
    while (body == but) body = testing::RandomInteger(bodies + 1, &random) - 1;
    return body;
  };
  for (int k = 0; k < 8; ++k) {
    RecordedStep::Contact& contact = made.step.contacts.emplace_back();
    contact.first = end(-2);
    contact.second = end(contact.first);
    contact.point = Vector(&random, dimension);
    contact.normal = Vector(&random, dimension);
    const double size = std::hypot(contact.normal[0], contact.normal[1], contact.normal[2]);
    for (double& component : contact.normal) component /= size;
    contact.gap = random.Uniform(-0.01, 0.01);
    contact.identity = "c" + std::to_string(k);
  }
  for (int k = 0; k < 3; ++k) {
    RecordedStep::JointRow& row = made.step.joint_rows.emplace_back();
    row.first = end(-2);
    row.second = end(row.first);
    row.J.resize(dimension == 3 ? 12 : 6);
    for (double& number : row.J) number = random.Uniform(-1, 1);
    row.is_limit = k == 2;
    row.identity = "j" + std::to_string(k);
  }
  return made;
}

// What a body's velocity becomes by loads and by impulses on rows, in world axes: without any J of the code under test.
struct Motion {
  Eigen::Vector3d v = Eigen::Vector3d::Zero();
  Eigen::Vector3d omega = Eigen::Vector3d::Zero();
};

Eigen::Vector3d Of(const RecordedStep::Vector& vector) { return {vector[0], vector[1], vector[2]}; }

Eigen::Matrix3d InverseInertia(const Recording& made, std::size_t k) {
  const auto& inverse = made.header.bodies[k].inverse_inertia;
  if (made.header.dimension == 2) return Eigen::Vector3d(0, 0, inverse[2]).asDiagonal();
  const auto& q = made.step.bodies[k].turn;
  const Eigen::Matrix3d R = Eigen::Quaterniond(q[0], q[1], q[2], q[3]).toRotationMatrix();
  return R * Eigen::Vector3d(inverse[0], inverse[1], inverse[2]).asDiagonal() * R.transpose();
}

// A row's directions of a body: what its speed counts, and what its impulse does.
struct Side {
  int body = -1;
  Eigen::Vector3d linear;
  Eigen::Vector3d angular;
};

struct ExpectedRow {
  std::string identity;
  bool is_bilateral = false;
  double opening = 0;  // [m/s], of a gap
  std::array<Side, 2> sides;
};

ExpectedRow RowOf(const Recording& made, const RecordedStep::Contact& contact) {
  const auto side = [&](int body, double sign) -> Side {
    if (body < 0) return {};
    const Eigen::Vector3d normal = sign * Of(contact.normal);
    const Eigen::Vector3d arm = Of(contact.point) - Of(made.step.bodies[static_cast<std::size_t>(body)].x);
    return {body, normal, arm.cross(normal)};
  };
  return {contact.identity,
          false,
          std::max(contact.gap, 0.0) / made.header.time_step,
          {side(contact.first, -1), side(contact.second, 1)}};
}

ExpectedRow RowOf(const Recording& made, const RecordedStep::JointRow& joint) {
  const auto side = [&](int body, std::size_t begin) -> Side {
    const double* j = joint.J.data() + begin;
    if (made.header.dimension == 2) return {body, {j[0], j[1], 0}, {0, 0, j[2]}};
    return {body, {j[0], j[1], j[2]}, {j[3], j[4], j[5]}};
  };
  return {joint.identity, !joint.is_limit, 0, {side(joint.first, 0), side(joint.second, joint.J.size() / 2)}};
}

TEST(Recording, RowsAreTheSpeedsAtWhichBodiesPart) {
  for (const int dimension : {2, 3}) {
    for (unsigned seed = 1; seed <= 50; ++seed) {
      const Recording made = RandomRecording(dimension, seed);
      const RecordedProblem found = VelocityProblem(made.header, made.step);
      const LcpProblem& problem = found.problem;
      ASSERT_EQ(problem.columns_per_body(), dimension == 3 ? 6 : 3);
      Random random(seed + 1000);
      const Eigen::VectorXd f = Eigen::VectorXd::NullaryExpr(problem.size(), [&] { return random.Uniform(-1, 1); });
      std::vector<std::pair<Index, ExpectedRow>> rows;
      const auto expect = [&](const ExpectedRow& row) {
        const Index place =
            std::find(found.identity.begin(), found.identity.end(), row.identity) - found.identity.begin();
        if (place < problem.size()) rows.emplace_back(place, row);
      };
      for (const RecordedStep::Contact& contact : made.step.contacts) expect(RowOf(made, contact));
      for (const RecordedStep::JointRow& joint : made.step.joint_rows) expect(RowOf(made, joint));
      EXPECT_EQ(static_cast<Index>(rows.size()), problem.size());

      std::vector<Motion> motion(made.header.bodies.size());
      const auto push = [&](const Side& side, double size) {
        if (side.body < 0) return;
        const auto k = static_cast<std::size_t>(side.body);
        motion[k].v += made.header.bodies[k].inverse_mass * size * side.linear;
        motion[k].omega += InverseInertia(made, k) * (size * side.angular);
      };
      for (std::size_t k = 0; k < motion.size(); ++k) {
        const RecordedStep::Body& state = made.step.bodies[k];
        motion[k] = {Of(state.v), Of(state.omega)};
        push({static_cast<int>(k), Of(state.force), Of(state.torque)}, made.header.time_step);
      }
      for (const auto& [place, row] : rows) {
        for (const Side& side : row.sides) push(side, f[place]);
      }
      Eigen::VectorXd w;
      problem.ComputeW(f, &w);
      for (const auto& [place, row] : rows) {
        double speed = row.opening;
        for (const Side& side : row.sides) {
          if (side.body < 0) continue;
          const Motion& moved = motion[static_cast<std::size_t>(side.body)];
          speed += side.linear.dot(moved.v) + side.angular.dot(moved.omega);
        }
        EXPECT_NEAR(w[place], speed, 1e-12) << dimension << ' ' << seed;
        EXPECT_EQ(problem.is_bilateral(place), row.is_bilateral);
      }
    }
  }
}

// A body on the world: what it does along the axes and turning is told by rows of one orthogonal matrix, the normal
// first.
TEST(Recording, FrictionRowsAreTheSlipAlongTangents) {
  for (const int dimension : {2, 3}) {
    for (unsigned seed = 1; seed <= 50; ++seed) {
      Recording made = RandomRecording(dimension, seed);
      RecordedStep::Contact contact = made.step.contacts[0];
      std::tie(contact.first, contact.second, contact.gap) = std::tuple(-1, 1, 0);
      made.step.contacts = {contact};
      made.step.joint_rows.clear();
      EXPECT_EQ(VelocityProblem(made.header, made.step, true).problem.size(), 1) << "without a coefficient";
      made.step.contacts[0].friction = 0.5;
      EXPECT_EQ(VelocityProblem(made.header, made.step).problem.size(), 1);
      RecordedStep::Body& body = made.step.bodies[1];
      const RecordedStep::Vector spin = body.omega;
      const auto b_of = [&](const RecordedStep::Vector& v, const RecordedStep::Vector& omega) -> Eigen::VectorXd {
        body.v = v;
        body.omega = omega;
        body.force = body.torque = {0, 0, 0};
        return VelocityProblem(made.header, made.step, true).problem.b();
      };
      Eigen::MatrixXd T(dimension, dimension);
      for (int axis = 0; axis < dimension; ++axis) {
        RecordedStep::Vector v = {0, 0, 0};
        v[static_cast<std::size_t>(axis)] = 1;
        T.col(axis) = b_of(v, {0, 0, 0});
      }
      EXPECT_LT((T * T.transpose() - Eigen::MatrixXd::Identity(dimension, dimension)).norm(), 1e-14);
      EXPECT_LT((T.row(0).transpose() - Of(contact.normal).head(dimension)).norm(), 1e-15);
      EXPECT_NEAR(T.determinant(), 1, 1e-14);
      const Eigen::Vector3d slip = Of(spin).cross(Of(contact.point) - Of(body.x));
      EXPECT_LT((b_of({0, 0, 0}, spin) - T * slip.head(dimension)).norm(), 1e-14);
      const LcpProblem problem = VelocityProblem(made.header, made.step, true).problem;
      ASSERT_EQ(static_cast<int>(problem.friction_rows().size()), dimension - 1);
      for (int t = 1; t < dimension; ++t) {
        EXPECT_EQ(problem.friction_rows()[static_cast<std::size_t>(t - 1)], (FrictionRow{t, 0, 0.5}));
      }
    }
  }
}

TEST(Recording, IslandsShareNoRowAndHaveTheRowsOfTheWhole) {
  for (unsigned seed = 1; seed <= 50; ++seed) {
    const Recording made = RandomRecording(3, seed);
    const RecordedProblem whole = VelocityProblem(made.header, made.step);
    std::vector<std::string> identity;
    for (const RecordedProblem& island : IslandsOf(whole, 1)) {
      identity.insert(identity.end(), island.identity.begin(), island.identity.end());
      for (Index i = 0; i < island.problem.size(); ++i) {
        const auto name =
            std::find(whole.identity.begin(), whole.identity.end(), island.identity[static_cast<std::size_t>(i)]);
        const Index row = name - whole.identity.begin();
        EXPECT_EQ(island.problem.b()[i], whole.problem.b()[row]);
        EXPECT_EQ(island.problem.DiagonalA()[i], whole.problem.DiagonalA()[row]);
      }
    }
    std::vector<std::string> all = whole.identity;
    std::sort(all.begin(), all.end());
    std::sort(identity.begin(), identity.end());
    EXPECT_EQ(identity, all);
  }
}

// A disc that rolls or slides over a fixed one: the distance of their centres grows by v^2 / (R + r) - g.
TEST(Recording, CurvatureEntersTheAcceleration) {
  for (const double inner : {-3.0, 2.0}) {
    for (const double v : {0.0, 1.5}) {
      Recording made;
      made.header.time_step = 0.1;
      made.header.bodies = {{0.5, {0, 0, 1}}};
      const double r = 0.5;
      const double side = inner < 0 ? -1 : 1;  // in a bowl, or on top of a disc
      made.step.bodies.resize(1);
      made.step.bodies[0].x = {0, inner + r, 0};
      made.step.bodies[0].v = {v, 0, 0};
      made.step.bodies[0].force = {0, -9.0 * 2, 0};
      RecordedStep::Contact& contact = made.step.contacts.emplace_back();
      contact.second = 0;
      contact.point = {0, inner, 0};
      contact.normal = {0, 1, 0};
      contact.radius = {inner, r};
      const auto found = AccelerationProblem(made.header, made.step);
      ASSERT_TRUE(found.has_value());
      ASSERT_EQ(found->problem.size(), 1);
      const double path = side * std::abs(std::abs(inner) + side * r);  // the circle that its centre follows
      EXPECT_NEAR(found->problem.b()[0], v * v / path - 9, 1e-12) << inner << ' ' << v;
      EXPECT_NEAR(found->problem.DiagonalA()[0], 0.5, 1e-15);
    }
  }
}

TEST(Recording, StepsThatAreNoneAreRefusedByName) {
  RecordingHeader header;
  header.bodies.resize(1);
  const auto refused = [&](const std::string& contact, const char* why) {
    ExpectRefused(
        [&] {
          ParseRecordedStep(
              R"({"step":1,"bodies":{"x":[[0,0]],"q":[0],"v":[[0,0]],"omega":[0],"force":[[0,0]],"torque":[0]},)"
              R"("joints":[],"contacts":[)" +
                  contact + "]}",
              header, "file:2");
        },
        why);
  };
  refused(R"({"b":[0,0]})", "two different bodies");
  refused(R"({"b":[0,1]})", "/contacts/0/b/1");
  refused(R"({"b":[-1,0],"p":[0,0],"n":[1,1]})", "a unit vector");
  const std::string contact =
      R"({"b":[-1,0],"p":[0,0],"n":[0,1],"gap":0,"mu":0,"id":"c","shape":["a","b"],"radius":[null,null]})";
  refused(contact + "," + contact, "an id that stands once in the step");
}

}  // namespace
}  // namespace lcpbench
