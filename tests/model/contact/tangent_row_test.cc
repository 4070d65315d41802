// Tangent rows of contacts: docs/model.md section 7.

#include "model/contact/assembly.h"
#include "model/contact/contact_row.h"
#include "model/contact/world.h"
#include "model/records/records.h"
#include "model/scenes/scene.h"
#include "tests/model/contact/random_contacts.h"

namespace lcpbench::testing {
namespace {

using Json = nlohmann::json;

constexpr int kCases = 200;

TangentRow TangentOf(const ContactCase& c) {
  const ClosestPoints closest = c.Closest();
  return ComputeTangentRow(closest, c.body1, c.body2, ComputeContactRow(closest, c.body1, c.body2));
}

class TangentRows : public ::testing::TestWithParam<PairKind> {};

TEST_P(TangentRows, GiveTheDerivativeOfTheSlipAlongAnyMotion) {
  OverRandomContacts(GetParam(), kCases, 1, [](const ContactCase& c, Random* random) {
    const Vec2 a1 = random->Vector(3);
    const Vec2 a2 = random->Vector(3);
    const double alpha1 = random->Uniform(-3, 3);
    const double alpha2 = random->Uniform(-3, 3);
    const auto slip_after = [&](double t) {
      ContactCase moved = c;
      const auto move = [t](Vec2 a, double alpha, Body* body) {
        body->x = body->x + t * body->v + (t * t / 2) * a;
        body->theta += t * body->omega + t * t / 2 * alpha;
        body->v = body->v + t * a;
        body->omega += t * alpha;
      };
      move(a1, alpha1, &moved.body1);
      move(a2, alpha2, &moved.body2);
      return TangentOf(moved).slip;
    };
    const double h = 1e-5;
    const double expected =
        (8 * (slip_after(h) - slip_after(-h)) - (slip_after(2 * h) - slip_after(-2 * h))) / (12 * h);
    const TangentRow row = TangentOf(c);
    ExpectClose(RowTimes(row.J, a1, alpha1, a2, alpha2) + row.gamma, expected, 1e-6, "u'");
    ExpectClose(row.slip, RowTimes(row.J, c.body1.v, c.body1.omega, c.body2.v, c.body2.omega), 1e-12, "u");
  });
}

TEST_P(TangentRows, AreTheSameBitsForSwappedBodies) {
  OverRandomContacts(GetParam(), kCases, 2, [](const ContactCase& c, Random*) {
    const TangentRow row = TangentOf(c);
    const TangentRow other = TangentOf(c.Swapped());
    EXPECT_EQ(row.slip, other.slip);
    EXPECT_EQ(row.gamma, other.gamma);
    ExpectExchanged(row.J, other.J);
  });
}

INSTANTIATE_TEST_SUITE_P(Law, TangentRows, ::testing::ValuesIn(AllPairKinds()), ::testing::PrintToStringParamName());

// Calls check(system, expected tangent rows, A of all rows, indices of normal rows and tangent rows) for every record.
template <class Check>
int ForEachTangentRecord(const std::string& file, const Check& check) {
  std::ifstream in(LCPBENCH_SOURCE_DIR "/tests/data/oracle/" + file);
  int count = 0;
  for (std::string line; std::getline(in, line);) {
    const Json record = Json::parse(line);
    SCOPED_TRACE(record["id"]);
    ContactSystem system = ParseSystemRecord(line, file);
    for (Constraint& constraint : system.constraints) {
      constraint.friction = constraint.type == ConstraintType::kContact ? 0.5 : 0;
    }
    check(record["expect"], system, AssembleContactLcp(system, Friction::kRows));
    ++count;
  }
  return count;
}

constexpr double kOracleTolerance = 1e-13;

TEST(TangentRow, IsThatOfTheOracleForEveryKindOfContact) {
  const int count =
      ForEachTangentRecord("contacts.jsonl", [](const Json& expect, const ContactSystem&, const AssembledLcp& lcp) {
        ASSERT_EQ(lcp.rows.size(), 2u);
        const RowInfo& row = lcp.rows[1];
        EXPECT_EQ(row.axis, 't');
        EXPECT_EQ(lcp.problem.friction_rows(), std::vector<FrictionRow>({{1, 0, 0.5}}));
        for (std::size_t k = 0; k < 6; ++k) {
          ExpectClose(lcp.problem.J().coeff(1, static_cast<Index>(k)), expect["Jt"][k], kOracleTolerance, "Jt");
        }
        ExpectClose(row.d_dot, expect["slip"], kOracleTolerance, "slip");
        ExpectClose(row.gamma, expect["gamma_t"], kOracleTolerance, "gamma_t");
        ExpectClose(row.n.x, expect["t"][0], kOracleTolerance, "t");
        ExpectClose(lcp.problem.b()[1], expect["b_t"], kOracleTolerance, "b_t");
        ExpectClose(lcp.problem.DenseA()(0, 1), expect["A_nt"], kOracleTolerance, "A_nt");
        ExpectClose(lcp.problem.DenseA()(1, 1), expect["A_tt"], kOracleTolerance, "A_tt");
      });
  EXPECT_EQ(count, 248);
}

TEST(TangentRow, CouplesToOthersAsTheOracleSays) {
  const int count = ForEachTangentRecord(
      "systems.jsonl", [](const Json& expect, const ContactSystem& system, const AssembledLcp& lcp) {
        const Json& tangent = expect["tangent"];
        // Path joints have tangents in the records too, which nothing uses.
        std::vector<std::pair<Index, std::size_t>> tangents;  // row, place in the record
        std::vector<Index> others;
        for (std::size_t i = 0; i < lcp.rows.size(); ++i) {
          const RowInfo& row = lcp.rows[i];
          if (row.axis != 't') {
            others.push_back(static_cast<Index>(i));
            continue;
          }
          EXPECT_EQ(lcp.rows[i - 1].constraint, row.constraint);
          for (std::size_t k = 0; k < tangent["contact"].size(); ++k) {
            if (tangent["contact"][k] == row.constraint) tangents.emplace_back(static_cast<Index>(i), k);
          }
        }
        std::size_t contacts = 0;
        for (const Constraint& constraint : system.constraints) {
          contacts += constraint.type == ConstraintType::kContact ? 1 : 0;
        }
        ASSERT_EQ(tangents.size(), contacts);
        const Eigen::MatrixXd& A = lcp.problem.DenseA();
        for (const auto& [i, k] : tangents) {
          ExpectClose(lcp.problem.b()[i], tangent["b_t"][k], kOracleTolerance, "b_t");
          ExpectClose(lcp.rows[static_cast<std::size_t>(i)].gamma, tangent["gamma_t"][k], kOracleTolerance, "gamma_t");
          for (const auto& [j, l] : tangents) ExpectClose(A(i, j), tangent["A_tt"][k][l], kOracleTolerance, "A_tt");
          for (std::size_t r = 0; r < others.size(); ++r) {
            ExpectClose(A(others[r], i), tangent["A_nt"][r][k], kOracleTolerance, "A_nt");
          }
        }
      });
  EXPECT_EQ(count, 26);
}

ContactSystem WithFriction(ContactSystem system, double mu) {
  for (Body& body : system.bodies) body.friction = mu;
  for (Constraint& constraint : system.constraints) {
    if (constraint.type == ConstraintType::kContact) constraint.friction = mu;
  }
  return system;
}

// Normal rows stay where they were among normal rows, bit by bit; every contact has its tangent row after them, and
// none without friction.
TEST(TangentRow, StandsAfterTheNormalRowOfItsContactWhereThereIsFriction) {
  for (const SceneFamily& family : AllScenes()) {
    const ContactSystem system = family.generate(20, 3);
    const AssembledLcp without = AssembleContactLcp(system);
    for (const AssembledLcp& same : {AssembleContactLcp(system, Friction::kRows), AssembleInstant(system, 0.01)}) {
      EXPECT_EQ(same.problem.b(), without.problem.b()) << family.key;
      EXPECT_EQ(same.problem.DenseA(), without.problem.DenseA()) << family.key;
      EXPECT_TRUE(same.problem.is_plain());
    }
    const AssembledLcp with = AssembleContactLcp(WithFriction(system, 0.3), Friction::kRows);
    std::size_t other = 0;
    std::size_t tangent = 0;
    for (std::size_t i = 0; i < with.rows.size(); ++i) {
      const RowInfo& row = with.rows[i];
      const auto index = static_cast<Index>(i);
      if (row.axis == 't') {
        EXPECT_EQ(with.problem.friction_rows()[tangent++], (FrictionRow{index, index - 1, 0.3}));
        EXPECT_EQ(row.constraint, with.rows[i - 1].constraint);
        EXPECT_EQ(Dot(row.n, with.rows[i - 1].n), 0);
        continue;
      }
      EXPECT_EQ(with.problem.b()[index], without.problem.b()[static_cast<Index>(other++)]);
      const bool contact =
          system.constraints[static_cast<std::size_t>(row.constraint)].type == ConstraintType::kContact;
      EXPECT_EQ(contact, i + 1 < with.rows.size() && with.rows[i + 1].axis == 't');
    }
    EXPECT_EQ(tangent, with.problem.friction_rows().size());
  }
}

TEST(TangentRow, RefusesFrictionThatIsNone) {
  for (const double mu : {-0.1, 2e6, kNaN}) {
    const ContactSystem system = WithFriction(GenerateScene("disc-pile", 4, 1), mu);
    EXPECT_THROW(AssembleContactLcp(system, Friction::kRows), InputError) << mu;
    World world = WorldOf(GenerateScene("disc-pile", 4, 1));
    world.friction = {{0, 1, mu}};
    EXPECT_THROW(RequireValid(world), InputError) << mu;
  }
  World world = WorldOf(GenerateScene("disc-pile", 4, 1));
  world.friction = {{0, 1, 0.5}, {1, 0, 0.5}};
  EXPECT_THROW(RequireValid(world), InputError);
}

TEST(WorldFriction, IsTheRootOfTheProductUnlessThePairHasItsOwn) {
  World world = WorldOf(GenerateScene("disc-pile", 8, 1));
  world.bodies[0].friction = 0.25;
  world.bodies[1].friction = 0.64;
  world.friction = {{2, 0, 0.7}};
  const ContactSystem listed = GenerateScene("disc-pile", 8, 1);
  const ContactSystem instant = InstantOf(world, listed.constraints);
  for (const Constraint& contact : instant.constraints) {
    const std::pair<int, int> pair = std::minmax(contact.body1, contact.body2);
    const double expected = pair == std::pair(0, 1) ? 0.4 : pair == std::pair(0, 2) ? 0.7 : 0;
    EXPECT_DOUBLE_EQ(contact.friction, expected);
  }
  // And back.
  const World again = WorldOf(instant);
  EXPECT_EQ(InstantOf(again, listed.constraints).constraints, instant.constraints);
}

// b = J v^ + c, c of open gaps only.
TEST(StepLcp, IsTheTimeStepOfAnInstant) {
  Random random(5);
  for (const PairKind& kind : ClosedPairKinds()) {
    OverRandomContacts(kind, 20, 4, [](const ContactCase& c, Random*) {
      ContactSystem system = SystemOf(c);
      system.constraints[0].friction = 0.5;
      const double h = 0.01;
      const AssembledLcp step = AssembleStepLcp(system, h);
      const Eigen::VectorXd v = FreeVelocity(system.bodies, h);
      const Eigen::VectorXd u = step.problem.J() * v;
      ExpectClose(step.problem.b()[0], u[0] + std::max(step.rows[0].d, 0.0) / h, 1e-12, "b_n");
      ExpectClose(step.problem.b()[1], u[1], 1e-12, "b_t");
    });
  }
}

}  // namespace
}  // namespace lcpbench::testing
