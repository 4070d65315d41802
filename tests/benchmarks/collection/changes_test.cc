// What every change leaves as it was, and what it changes, on problems of all families.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "benchmarks/collection/properties.h"
#include "benchmarks/collection/recipes/changes.h"
#include "benchmarks/collection/recipes/recipe.h"
#include "model/scenes/scene.h"
#include "solvers/exact/sparse_rank.h"
#include "solvers/lcp/verify.h"
#include "solvers/registry.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

constexpr int kRows = 40;

Instance Given(std::string_view scene, std::uint64_t seed = 1) {
  return MakeInstance({std::string(scene), kRows, seed, {}});
}

Eigen::VectorXd AnswerW(const LcpProblem& problem) {
  LcpOptions options;
  options.tolerance = 1e-12;
  LcpResult result;
  MakeSolver("dantzig")->Solve(problem, options, &result);
  EXPECT_TRUE(Verify(problem, result, 1e-9).passes) << problem.id() << ": " << result.detail;
  return ComputeMetrics(problem, result.f).w;
}

class ChangesOf : public testing::TestWithParam<std::string_view> {};

std::vector<std::string_view> Families() {
  std::vector<std::string_view> keys;
  for (const SceneFamily& scene : AllScenes()) keys.push_back(scene.key);
  return keys;
}

INSTANTIATE_TEST_SUITE_P(Scenes, ChangesOf, testing::ValuesIn(Families()), [](const auto& test) {
  std::string name(test.param);
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
});

TEST(PortablePower, IsThePower) {
  EXPECT_EQ(PortablePower(10, 0), 1);
  EXPECT_EQ(PortablePower(10, 1), 10);
  EXPECT_EQ(PortablePower(16, 0.25), 2);
  for (const double ratio : {0.1, 2.0, 1e6, 1e8}) {
    for (int k = 0; k <= 1000; ++k) {
      const double u = k / 1000.0;
      EXPECT_NEAR(PortablePower(ratio, u) / std::pow(ratio, u), 1, 1e-14) << ratio << " ^ " << u;
    }
  }
}

/// Every row that was added is a unilateral one of the given rows times `sign`, and the rank stays.
void ExpectCopies(const Instance& given, const Instance& changed, double sign) {
  const Index n = given.problem.size();
  EXPECT_GT(changed.problem.size(), n);
  ASSERT_EQ(changed.rows.size(), static_cast<size_t>(changed.problem.size()));
  EXPECT_EQ(RankOf(changed.problem, 1000), RankOf(given.problem, 1000));
  EXPECT_EQ(changed.problem.bilateral_rows(), given.problem.bilateral_rows());
  const Eigen::MatrixXd before(given.problem.J());
  const Eigen::MatrixXd after(changed.problem.J());
  EXPECT_EQ(after.topRows(n), before);
  for (Index i = n; i < changed.problem.size(); ++i) {
    bool found = false;
    for (Index k = 0; k < n && !found; ++k) {
      found = after.row(i) == sign * before.row(k) && changed.problem.b()[i] == sign * given.problem.b()[k] &&
              !given.problem.is_bilateral(k);
    }
    EXPECT_TRUE(found) << i;
  }
}

TEST_P(ChangesOf, DuplicatesKeepRankAndAccelerations) {
  const Instance given = Given(GetParam());
  Instance changed = given;
  DuplicateRows(&changed, 0.5, 3);
  ExpectCopies(given, changed, 1);
  const Index n = given.problem.size();
  const auto unilateral = static_cast<double>(n - static_cast<Index>(given.problem.bilateral_rows().size()));
  EXPECT_EQ(changed.problem.size(), n + static_cast<Index>(std::floor(0.5 * unilateral + 0.5)));
  const Eigen::VectorXd w = AnswerW(given.problem);
  const double scale = given.problem.b().cwiseAbs().maxCoeff();
  EXPECT_LE((AnswerW(changed.problem).head(n) - w).cwiseAbs().maxCoeff(), 1e-8 * scale);
}

TEST_P(ChangesOf, OpposedRowsKeepTheRankAndNegate) {
  const Instance given = Given(GetParam());
  Instance changed = given;
  OpposeRows(&changed, 0.25, 5);
  ExpectCopies(given, changed, -1);
}

// The neighbour's row from its definition: R x n with R moved along the tangent, and b from the free accelerations.
TEST_P(ChangesOf, CrowdedContactsAreNeighbours) {
  const Instance given = Given(GetParam());
  const double kDistance = 0.01;
  Instance changed = given;
  CrowdContacts(&changed, 1, kDistance, 7);
  const LcpProblem& problem = changed.problem;
  Eigen::VectorXd acceleration = Eigen::VectorXd::Zero(problem.J().cols());
  for (size_t k = 0; k < given.system.bodies.size(); ++k) {
    const Body& body = given.system.bodies[k];
    acceleration.segment<3>(3 * static_cast<Index>(k)) =
        body.fixed ? Eigen::Vector3d(body.acceleration.x, body.acceleration.y, body.alpha)
                   : Eigen::Vector3d(body.force.x / body.mass, body.force.y / body.mass, body.torque / body.inertia);
  }
  const Index n = given.problem.size();
  for (Index i = n; i < problem.size(); ++i) {
    const RowInfo& row = changed.rows[static_cast<size_t>(i)];
    const Constraint& constraint = given.system.constraints[static_cast<size_t>(row.constraint)];
    ASSERT_EQ(constraint.type, ConstraintType::kContact);
    const Body& body1 = given.system.bodies[static_cast<size_t>(constraint.body1)];
    const Body& body2 = given.system.bodies[static_cast<size_t>(constraint.body2)];
    double shift = std::numeric_limits<double>::infinity();
    for (const Body* body : {&body1, &body2}) {
      const double other = body == &body1 ? body2.inertia : body1.inertia;
      if (body->fixed || (!(body == &body1 ? body2 : body1).fixed && other < body->inertia)) continue;
      shift = kDistance * std::sqrt(body->inertia / body->mass);
    }
    const Vec2 moved = shift * Vec2{-row.n.y, row.n.x};
    Eigen::VectorXd expected = Eigen::VectorXd::Zero(problem.J().cols());
    const Vec2 r1 = row.p1 + moved - body1.x;
    const Vec2 r2 = row.p2 + moved - body2.x;
    expected.segment<3>(3 * constraint.body1) = Eigen::Vector3d(row.n.x, row.n.y, Cross(r1, row.n));
    expected.segment<3>(3 * constraint.body2) = Eigen::Vector3d(-row.n.x, -row.n.y, -Cross(r2, row.n));
    const Eigen::VectorXd found = Eigen::MatrixXd(problem.J().row(i)).transpose();
    EXPECT_LE((found - expected).cwiseAbs().maxCoeff(), 1e-12 * (1 + expected.cwiseAbs().maxCoeff())) << i;
    const double b = expected.dot(acceleration) + row.gamma;
    EXPECT_NEAR(problem.b()[i], b, 1e-10 * (1 + std::abs(b) + expected.cwiseProduct(acceleration).cwiseAbs().sum()));
  }
}

TEST_P(ChangesOf, ScaledRowsAreTheSameProblemInOtherUnits) {
  const Instance given = Given(GetParam());
  Instance changed = given;
  ScaleRows(&changed, 20, 9);
  const Eigen::MatrixXd before(given.problem.J());
  const Eigen::MatrixXd after(changed.problem.J());
  LcpResult result;
  MakeSolver("dantzig")->Solve(given.problem, {}, &result);
  Eigen::VectorXd f = result.f;
  double largest = 1;
  for (Index i = 0; i < before.rows(); ++i) {
    Index at = 0;
    before.row(i).cwiseAbs().maxCoeff(&at);
    const double factor = before(i, at) == 0 ? 1 : after(i, at) / before(i, at);
    int exponent = 0;
    EXPECT_EQ(std::frexp(factor, &exponent), 0.5) << factor;
    EXPECT_EQ(after.row(i), factor * before.row(i));
    f[i] /= factor;
    largest = std::max(largest, std::max(factor, 1 / factor));
  }
  EXPECT_GT(largest, 1000);
  EXPECT_LE(largest, std::ldexp(1, 20));
  // rho and backward error do not see units.
  const Metrics in_old = ComputeMetrics(given.problem, result.f);
  const Metrics in_new = ComputeMetrics(changed.problem, f);
  EXPECT_NEAR(in_new.rho, in_old.rho, 1e-17);
  EXPECT_NEAR(in_new.backward_error, in_old.backward_error, 1e-17);
}

TEST_P(ChangesOf, SlackLeavesFewerRowsActive) {
  double before = 2;
  for (const double slack : {0.0, 0.5, 2.0, 50.0}) {
    Instance changed = Given(GetParam());
    AddSlack(&changed, slack);
    const Eigen::VectorXd w = AnswerW(changed.problem);
    const double active =
        MeasureAnswer(changed.problem, Eigen::VectorXd::Zero(w.size()), w, 1e-7 * w.cwiseAbs().maxCoeff())
            .fraction_active;
    EXPECT_LE(active, before) << slack;
    before = active;
  }
}

TEST_P(ChangesOf, CurvatureChangesGammaAlone) {
  const ContactSystem given = GenerateScene(GetParam(), kRows, 1);
  const AssembledLcp before = AssembleContactLcp(given);
  ContactSystem changed = given;
  ContrastCurvature(&changed, 100, 11);
  const AssembledLcp after = AssembleContactLcp(changed);
  ASSERT_EQ(after.rows.size(), before.rows.size());
  const Eigen::MatrixXd difference = Eigen::MatrixXd(after.problem.J()) - Eigen::MatrixXd(before.problem.J());
  EXPECT_LE(difference.cwiseAbs().maxCoeff(), 1e-7);
  for (size_t i = 0; i < after.rows.size(); ++i) {
    const auto row = static_cast<Index>(i);
    const double gamma = after.rows[i].gamma - before.rows[i].gamma;
    const double change = after.problem.b()[row] - before.problem.b()[row];
    EXPECT_NEAR(change, gamma, 1e-6 * (1 + std::abs(before.problem.b()[row]))) << i;
  }
  // At rest curvature has nothing to act on.
  ContactSystem still = given;
  for (Body& body : still.bodies) {
    body.v = {};
    body.omega = 0;
  }
  ContactSystem still_changed = still;
  ContrastCurvature(&still_changed, 100, 11);
  const Eigen::VectorXd b = AssembleContactLcp(still).problem.b();
  EXPECT_LE((AssembleContactLcp(still_changed).problem.b() - b).cwiseAbs().maxCoeff(),
            1e-6 * (1 + b.cwiseAbs().maxCoeff()));
}

TEST_P(ChangesOf, AnotherBLeavesProblemsSolvableAndMovesTheirForces) {
  const LcpProblem given = MakeInstance({std::string(GetParam()), 25, 1, {}}).problem;
  const Eigen::VectorXd b = AnotherB(given, 5);
  EXPECT_EQ(AnotherB(given, 5), b);
  EXPECT_NE(AnotherB(given, 6), b);
  const LcpProblem problem = given.WithB(b);
  LcpResult before;
  LcpResult after;
  MakeSolver("dantzig")->Solve(given, {}, &before);
  MakeSolver("dantzig")->Solve(problem, {}, &after);
  EXPECT_TRUE(Verify(problem, after, 1e-9).passes) << after.detail;
  const double change = (after.f - before.f).norm() / before.f.norm();
  EXPECT_GT(change, 1e-3);
  EXPECT_LT(change, 10);
}

// b' + A d = b, with forces d that only press.
TEST(AnotherB, IsWhatMoreForceWouldUndo) {
  const LcpProblem given = LcpProblem::FromDense("d", Eigen::Vector3d(2, 8, 0).asDiagonal(), Eigen::Vector3d(-4, 1, 1),
                                                 RowBounds::WithBilateralRows(3, {1}));
  const Eigen::VectorXd change = given.b() - AnotherB(given, 1);
  const double load = 4 / std::sqrt(2.0);
  EXPECT_GE(change[0], 0);
  EXPECT_LE(change[0], 0.1 * load * std::sqrt(2.0));
  EXPECT_LE(std::abs(change[1]), 0.1 * load * std::sqrt(8.0));
  EXPECT_EQ(change[2], 0);
}

TEST_P(ChangesOf, SpreadMassesAreMultipliedByOneToTheRatio) {
  const LcpProblem given = Given(GetParam()).problem;
  EXPECT_EQ(SpreadMasses(given, 1, 1).inverse_mass(), given.inverse_mass());
  for (const double ratio : {10.0, 1e6}) {
    const LcpProblem spread = SpreadMasses(given, ratio, 3);
    std::vector<double> factors;
    for (Index body = 0; body < given.inverse_mass().size() / 3; ++body) {
      const Eigen::Vector3d before = given.inverse_mass().segment<3>(3 * body);
      const Eigen::Vector3d after = spread.inverse_mass().segment<3>(3 * body);
      if (before.isZero(0)) {
        EXPECT_TRUE(after.isZero(0)) << body;
        continue;
      }
      factors.push_back(before.maxCoeff() / after.maxCoeff());
      // Mass and inertia of a body by the same factor: its shape stays.
      EXPECT_LE((factors.back() * after - before).norm(), 1e-14 * before.norm()) << body;
    }
    EXPECT_EQ(spread.b(), given.b());
    EXPECT_EQ(Eigen::MatrixXd(spread.J()), Eigen::MatrixXd(given.J()));
    EXPECT_EQ(spread.bilateral_rows(), given.bilateral_rows());
    if (factors.size() < 2) continue;
    const auto [least, most] = std::minmax_element(factors.begin(), factors.end());
    EXPECT_NEAR(*least, 1, 1e-14);
    EXPECT_NEAR(*most, ratio, 1e-13 * ratio);
    EXPECT_NE(SpreadMasses(given, ratio, 4).inverse_mass(), spread.inverse_mass());
  }
}

TEST_P(ChangesOf, SpreadMassesLeaveProblemsSolvable) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const LcpProblem spread = SpreadMasses(Given(GetParam()).problem, 1e6, seed);
    LcpResult result;
    MakeSolver("dantzig")->Solve(spread, {}, &result);
    EXPECT_TRUE(Verify(spread, result, 1e-6).passes) << result.detail;
  }
}

TEST(Changes, CurvatureMatters) {
  for (const char* scene : {"disc-track", "rockers", "ovals-in-bowl", "gear-train", "cam-follower"}) {
    const LcpProblem given = Given(scene).problem;
    const LcpProblem changed = MakeInstance({scene, kRows, 1, {{"curvature-contrast", 100}}}).problem;
    EXPECT_GT((changed.b() - given.b()).norm(), 0.01 * given.b().norm()) << scene;
  }
}

TEST(Changes, NearlyConformalArcsHaveGammaInverseToTheirClearance) {
  ContactSystem wide = GenerateScene("disc-track", kRows, 1);
  ContactSystem narrow = wide;
  MakeConformal(&wide, 1e-3);
  MakeConformal(&narrow, 1e-5);
  const AssembledLcp a = AssembleContactLcp(wide);
  const AssembledLcp b = AssembleContactLcp(narrow);
  int compared = 0;
  for (size_t i = 0; i < a.rows.size(); ++i) {
    const Constraint& constraint = wide.constraints[static_cast<size_t>(a.rows[i].constraint)];
    const auto* arc1 = std::get_if<ArcEdge>(&constraint.feature1);
    const auto* arc2 = std::get_if<ArcEdge>(&constraint.feature2);
    ASSERT_TRUE(arc1 != nullptr && arc2 != nullptr);
    if (arc1->side == arc2->side) continue;
    if (std::abs(a.rows[i].gamma) < 1) continue;
    ++compared;
    EXPECT_NEAR(b.rows[i].gamma / a.rows[i].gamma, 100, 1) << i;
  }
  EXPECT_GT(compared, 5);
  ContactSystem without = GenerateScene("disc-pile", kRows, 1);
  EXPECT_THROW(MakeConformal(&without, 0.1), InputError);
}

TEST(Changes, CrowdingMakesTheConditionWorseWithTheSquareOfTheDistance) {
  double conditions[3];
  for (int k = 0; k < 3; ++k) {
    Instance instance = Given("rockers");
    CrowdContacts(&instance, 0.5, std::pow(0.01, k + 1), 3);
    conditions[k] = *MeasureProperties(instance.problem).condition.value;
  }
  EXPECT_NEAR(conditions[2] / conditions[1], 1e4, 1e3);
  EXPECT_GT(conditions[1], 100 * conditions[0]);
}

TEST(Changes, AreTheSameForTheSameSeedOnly) {
  const std::map<std::string, double> amounts = {{"mass-ratio", 100}, {"curvature-contrast", 100}, {"scale-rows", 30}};
  for (const std::string& name : AllChanges()) {
    if (name == "conformal" || name == "slack") continue;
    const Recipe recipe{"rockers", kRows, 1, {{name, amounts.count(name) > 0 ? amounts.at(name) : 0.5}}};
    Recipe other = recipe;
    other.seed = 2;
    const LcpProblem a = MakeInstance(recipe).problem;
    const LcpProblem b = MakeInstance(recipe).problem;
    EXPECT_EQ(Eigen::MatrixXd(a.J()), Eigen::MatrixXd(b.J())) << name;
    EXPECT_EQ(a.b(), b.b()) << name;
    EXPECT_EQ(a.inverse_mass(), b.inverse_mass()) << name;
    EXPECT_EQ(a.id(), RecipeId(recipe));
    EXPECT_NE(RecipeId(recipe), RecipeId(other));
  }
}

TEST(Changes, RefuseImpossibleNumbers) {
  const std::pair<const char*, double> kImpossible[] = {
      {"duplicate-rows", 1.5}, {"duplicate-rows", -0.1}, {"oppose-rows", std::nan("")}, {"crowd-contacts", 0},
      {"scale-rows", 0.5},     {"scale-rows", 1000},     {"mass-ratio", 0.5},           {"curvature-contrast", 0.5},
      {"conformal", 1},        {"slack", std::nan("")},  {"no-such-change", 1},         {"conformal", 0},
      {"mass-ratio", -1},      {"mass-ratio", HUGE_VAL}, {"mass-ratio", std::nan("")}};
  for (const auto& [name, amount] : kImpossible) {
    try {
      MakeInstance({"disc-track", 20, 1, {{name, amount}}});
      ADD_FAILURE() << name << " " << amount;
    } catch (const InputError& error) {
      EXPECT_EQ(std::string(error.what()).rfind("disc-track-n20-s1-", 0), 0U) << error.what();
    }
  }
  EXPECT_THROW(MakeInstance({"no-such-scene", 20, 1, {}}), InputError);
  EXPECT_THROW(MakeInstance({"disc-pile", 0, 1, {}}), InputError);
}

}  // namespace
}  // namespace lcpbench
