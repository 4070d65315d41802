// How problems are made: what changes leave as it was and what they change, on all families; what is said of hard
// cases, exactly; steps of motions.

#include "benchmarks/collection/content_hash.h"
#include "benchmarks/collection/properties.h"
#include "benchmarks/collection/recipes/hard_cases.h"
#include "benchmarks/collection/recipes/motion_steps.h"
#include "benchmarks/collection/recipes/recipe.h"
#include "model/scenes/scene.h"
#include "solvers/exact/exact_lcp.h"
#include "solvers/exact/sparse_rank.h"
#include "solvers/lcp/verify.h"
#include "solvers/registry.h"
#include "tests/support/refusal.h"

namespace lcpbench {
namespace {

constexpr int kRows = 40;

Instance Given(std::string_view scene, const std::vector<Change>& changes = {}, std::uint64_t seed = 1) {
  return Changed(GenerateScene(scene, kRows, 1), changes, seed);
}

Eigen::VectorXd Solved(const LcpProblem& problem, double tier = 1e-9) {
  LcpOptions options;
  options.tolerance = 1e-12;
  LcpResult result;
  MakeSolver("dantzig")->Solve(problem, options, &result);
  EXPECT_TRUE(Verify(problem, result, tier).passes) << problem.id() << ": " << result.detail;
  return result.f;
}

Eigen::VectorXd AnswerW(const LcpProblem& problem) { return ComputeMetrics(problem, Solved(problem)).w; }

double Largest(const Eigen::MatrixXd& matrix) { return matrix.size() == 0 ? 0 : matrix.cwiseAbs().maxCoeff(); }

// The changes of a scene family; `given_` is its problem without changes.
class ChangesOf : public testing::TestWithParam<std::string_view> {
 protected:
  Instance With(const char* change, double amount, std::uint64_t seed = 3) const {
    return Given(GetParam(), {{change, amount}}, seed);
  }
  const Instance given_ = Given(GetParam());
  const LcpProblem& problem_ = given_.problem;
  const Index n_ = problem_.size();
};

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

// Every row that was added is a unilateral one of the given rows times the sign, and the rank stays.
TEST_P(ChangesOf, RepeatedRowsAreCopiesKeepTheRankAndDuplicatesTheAccelerations) {
  const auto unilateral = static_cast<double>(n_ - static_cast<Index>(problem_.bilateral_rows().size()));
  for (const auto& [name, share, sign] : {std::tuple{"duplicate-rows", 0.5, 1.0}, {"oppose-rows", 0.25, -1.0}}) {
    const Instance changed = With(name, share);
    const LcpProblem& problem = changed.problem;
    EXPECT_EQ(problem.size(), n_ + static_cast<Index>(std::floor(share * unilateral + 0.5)));
    ASSERT_EQ(changed.rows.size(), static_cast<size_t>(problem.size()));
    EXPECT_EQ(RankOf(problem, 1000), RankOf(problem_, 1000));
    EXPECT_EQ(problem.bilateral_rows(), problem_.bilateral_rows());
    const Eigen::MatrixXd before(problem_.J());
    const Eigen::MatrixXd after(problem.J());
    EXPECT_EQ(after.topRows(n_), before);
    for (Index i = n_; i < problem.size(); ++i) {
      bool found = false;
      for (Index k = 0; k < n_ && !found; ++k) {
        found = after.row(i) == sign * before.row(k) && problem.b()[i] == sign * problem_.b()[k] &&
                !problem_.is_bilateral(k);
      }
      EXPECT_TRUE(found) << name << " " << i;
    }
  }
  const Eigen::VectorXd w = AnswerW(With("duplicate-rows", 0.5).problem).head(n_);
  EXPECT_LE(Largest(w - AnswerW(problem_)), 1e-8 * Largest(problem_.b()));
}

// The neighbour's row from its definition: R x n with R moved along the tangent, and b from the free accelerations.
TEST_P(ChangesOf, CrowdedContactsAreNeighbours) {
  constexpr double kDistance = 0.01;
  const Instance changed = With("crowd-contacts", kDistance);
  const LcpProblem& problem = changed.problem;
  const std::vector<Body>& bodies = given_.system.bodies;
  Eigen::VectorXd acceleration(problem.J().cols());
  for (size_t k = 0; k < bodies.size(); ++k) {
    const Body& body = bodies[k];
    acceleration.segment<3>(3 * static_cast<Index>(k)) =
        body.fixed ? Eigen::Vector3d(body.acceleration.x, body.acceleration.y, body.alpha)
                   : Eigen::Vector3d(body.force.x / body.mass, body.force.y / body.mass, body.torque / body.inertia);
  }
  for (Index i = n_; i < problem.size(); ++i) {
    const RowInfo& row = changed.rows[static_cast<size_t>(i)];
    const Constraint& constraint = given_.system.constraints[static_cast<size_t>(row.constraint)];
    ASSERT_EQ(constraint.type, ConstraintType::kContact);
    const Body& body1 = bodies[static_cast<size_t>(constraint.body1)];
    const Body& body2 = bodies[static_cast<size_t>(constraint.body2)];
    // The inertia of the body that turns more easily decides.
    const auto inertia = [](const Body& body) { return body.fixed ? HUGE_VAL : body.inertia; };
    const Body& turned = inertia(body1) <= inertia(body2) ? body1 : body2;
    const Vec2 moved = kDistance * std::sqrt(turned.inertia / turned.mass) * Vec2{-row.n.y, row.n.x};
    Eigen::VectorXd expected = Eigen::VectorXd::Zero(problem.J().cols());
    for (const auto& [index, place, sign] :
         {std::tuple{constraint.body1, row.p1, 1.0}, {constraint.body2, row.p2, -1.0}}) {
      const Vec2 r = place + moved - bodies[static_cast<size_t>(index)].x;
      expected.segment<3>(3 * index) = sign * Eigen::Vector3d(row.n.x, row.n.y, Cross(r, row.n));
    }
    const Eigen::VectorXd found = Eigen::MatrixXd(problem.J().row(i)).transpose();
    EXPECT_LE(Largest(found - expected), 1e-12 * (1 + Largest(expected))) << i;
    const double b = expected.dot(acceleration) + row.gamma;
    EXPECT_NEAR(problem.b()[i], b, 1e-10 * (1 + std::abs(b) + expected.cwiseProduct(acceleration).cwiseAbs().sum()));
  }
}

TEST_P(ChangesOf, ScaledRowsAreTheSameProblemInOtherUnits) {
  const LcpProblem changed = With("scale-rows", 20).problem;
  const Eigen::MatrixXd before(problem_.J());
  const Eigen::MatrixXd after(changed.J());
  const Eigen::VectorXd f = Solved(problem_);
  Eigen::VectorXd scaled = f;
  double largest = 1;
  for (Index i = 0; i < n_; ++i) {
    Index at = 0;
    before.row(i).cwiseAbs().maxCoeff(&at);
    const double factor = before(i, at) == 0 ? 1 : after(i, at) / before(i, at);
    int exponent = 0;
    EXPECT_EQ(std::frexp(factor, &exponent), 0.5) << factor;
    EXPECT_EQ(after.row(i), factor * before.row(i));
    scaled[i] /= factor;
    largest = std::max({largest, factor, 1 / factor});
  }
  EXPECT_GT(largest, 1000);
  EXPECT_LE(largest, std::ldexp(1, 20));
  // rho and backward error do not see units.
  const Metrics in_old = ComputeMetrics(problem_, f);
  const Metrics in_new = ComputeMetrics(changed, scaled);
  EXPECT_NEAR(in_new.rho, in_old.rho, 1e-17);
  EXPECT_NEAR(in_new.backward_error, in_old.backward_error, 1e-17);
}

// Every contact gets a tangent row; A of the other rows stays, bit by bit, and b is that of a time step.
TEST_P(ChangesOf, FrictionGivesEveryContactATangentRow) {
  EXPECT_EQ(ContentHash(With("friction", 0).problem), ContentHash(problem_));
  const Instance rough = With("friction", 0.6);
  Index contacts = 0;
  for (const Constraint& constraint : rough.system.constraints) {
    contacts += constraint.type == ConstraintType::kContact ? 1 : 0;
  }
  ASSERT_EQ(rough.problem.size(), n_ + contacts);
  ASSERT_EQ(static_cast<Index>(rough.problem.friction_rows().size()), contacts);
  std::vector<Index> others;
  for (Index i = 0; i < rough.problem.size(); ++i) {
    if (rough.problem.kind(i) != RowKind::kFriction) others.push_back(i);
  }
  EXPECT_EQ(Eigen::MatrixXd(rough.problem.DenseA()(others, others)), problem_.DenseA());
  for (const FrictionRow& row : rough.problem.friction_rows()) EXPECT_EQ(row, (FrictionRow{row.row, row.row - 1, 0.6}));
  const Eigen::VectorXd u = rough.problem.J() * FreeVelocity(rough.system.bodies, kInstantStep);
  for (Index i = 0; i < u.size(); ++i) {
    const RowInfo& info = rough.rows[static_cast<std::size_t>(i)];
    const double open = info.bilateral ? 0 : std::max(info.d, 0.0) / kInstantStep;
    EXPECT_NEAR(rough.problem.b()[i], u[i] + open, 1e-12 * (1 + std::abs(u[i])));
  }
}

// In other units the same forces obey the same laws.
TEST_P(ChangesOf, ScaledRowsKeepTheFriction) {
  const Instance rough = With("friction", 0.6);
  const Instance scaled = Given(GetParam(), {{"friction", 0.6}, {"scale-rows", 20}});
  const Eigen::VectorXd scale = scaled.problem.DiagonalA().cwiseQuotient(rough.problem.DiagonalA()).cwiseSqrt();
  LcpResult any;
  any.f = Eigen::VectorXd::LinSpaced(rough.problem.size(), -1, 1);
  LcpResult same = any;
  same.f = any.f.cwiseQuotient(scale);
  const double rho = Verify(rough.problem, any, 1e-3).metrics.rho;
  EXPECT_NEAR(Verify(scaled.problem, same, 1e-3).metrics.rho, rho, 1e-9 * rho);
}

TEST_P(ChangesOf, SlackLeavesFewerRowsActive) {
  double before = 2;
  for (const double slack : {0.0, 0.5, 2.0, 50.0}) {
    const LcpProblem problem = With("slack", slack).problem;
    const Eigen::VectorXd w = AnswerW(problem);
    const double active = MeasureAnswer(problem, Eigen::VectorXd::Zero(w.size()), w, 1e-7 * Largest(w)).fraction_active;
    EXPECT_LE(active, before) << slack;
    before = active;
  }
}

TEST_P(ChangesOf, CurvatureChangesGammaAlone) {
  const Instance changed = With("curvature-contrast", 100);
  ASSERT_EQ(changed.rows.size(), given_.rows.size());
  EXPECT_LE(Largest(Eigen::MatrixXd(changed.problem.J()) - Eigen::MatrixXd(problem_.J())), 1e-7);
  for (size_t i = 0; i < changed.rows.size(); ++i) {
    const auto row = static_cast<Index>(i);
    const double change = changed.problem.b()[row] - problem_.b()[row];
    EXPECT_NEAR(change, changed.rows[i].gamma - given_.rows[i].gamma, 1e-6 * (1 + std::abs(problem_.b()[row]))) << i;
  }
  // At rest curvature has nothing to act on.
  ContactSystem still = given_.system;
  for (Body& body : still.bodies) {
    body.v = {};
    body.omega = 0;
  }
  const Eigen::VectorXd b = Changed(still, {}, 1).problem.b();
  EXPECT_LE(Largest(Changed(still, {{"curvature-contrast", 100}}, 3).problem.b() - b), 1e-6 * (1 + Largest(b)));
}

TEST_P(ChangesOf, AnotherBLeavesProblemsSolvableAndMovesTheirForces) {
  const LcpProblem given = MakeInstance({std::string(GetParam()), 25, 1, {}}).problem;
  const Eigen::VectorXd b = AnotherB(given, 5);
  EXPECT_EQ(AnotherB(given, 5), b);
  EXPECT_NE(AnotherB(given, 6), b);
  const Eigen::VectorXd f = Solved(given);
  const double change = (Solved(given.WithB(b)) - f).norm() / f.norm();
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

TEST_P(ChangesOf, SpreadMassesAreMultipliedByOneToTheRatioAndLeaveProblemsSolvable) {
  for (const std::uint64_t seed : {1, 2, 3}) Solved(With("mass-ratio", 1e6, seed).problem, 1e-6);
  EXPECT_EQ(With("mass-ratio", 1).problem.inverse_mass(), problem_.inverse_mass());
  for (const double ratio : {10.0, 1e6}) {
    const LcpProblem spread = With("mass-ratio", ratio).problem;
    std::vector<double> factors;
    for (Index body = 0; body < problem_.inverse_mass().size() / 3; ++body) {
      const Eigen::Vector3d before = problem_.inverse_mass().segment<3>(3 * body);
      const Eigen::Vector3d after = spread.inverse_mass().segment<3>(3 * body);
      if (before.isZero(0)) {
        EXPECT_TRUE(after.isZero(0)) << body;
        continue;
      }
      factors.push_back(before.maxCoeff() / after.maxCoeff());
      // Mass and inertia of a body by the same factor: its shape stays.
      EXPECT_LE((factors.back() * after - before).norm(), 1e-14 * before.norm()) << body;
    }
    EXPECT_EQ(spread.b(), problem_.b());
    EXPECT_EQ(Eigen::MatrixXd(spread.J()), Eigen::MatrixXd(problem_.J()));
    EXPECT_EQ(spread.bilateral_rows(), problem_.bilateral_rows());
    if (factors.size() < 2) continue;
    const auto [least, most] = std::minmax_element(factors.begin(), factors.end());
    EXPECT_NEAR(*least, 1, 1e-14);
    EXPECT_NEAR(*most, ratio, 1e-13 * ratio);
    EXPECT_NE(With("mass-ratio", ratio, 4).problem.inverse_mass(), spread.inverse_mass());
  }
}

TEST(Changes, CurvatureMatters) {
  for (const char* scene : {"disc-track", "rockers", "ovals-in-bowl", "gear-train", "cam-follower"}) {
    const Eigen::VectorXd b = Given(scene).problem.b();
    EXPECT_GT((Given(scene, {{"curvature-contrast", 100}}).problem.b() - b).norm(), 0.01 * b.norm()) << scene;
  }
}

TEST(Changes, NearlyConformalArcsHaveGammaInverseToTheirClearance) {
  const Instance wide = Given("disc-track", {{"conformal", 1e-3}});
  const Instance narrow = Given("disc-track", {{"conformal", 1e-5}});
  int compared = 0;
  for (size_t i = 0; i < wide.rows.size(); ++i) {
    const Constraint& constraint = wide.system.constraints[static_cast<size_t>(wide.rows[i].constraint)];
    const Side side1 = std::get<ArcEdge>(constraint.feature1).side;
    if (side1 == std::get<ArcEdge>(constraint.feature2).side || std::abs(wide.rows[i].gamma) < 1) continue;
    ++compared;
    EXPECT_NEAR(narrow.rows[i].gamma / wide.rows[i].gamma, 100, 1) << i;
  }
  EXPECT_GT(compared, 5);
  EXPECT_THROW(Given("disc-pile", {{"conformal", 0.1}}), InputError);
}

TEST(Changes, CrowdingMakesTheConditionWorseWithTheSquareOfTheDistance) {
  const auto condition = [](double distance) {
    return *MeasureProperties(Given("rockers", {{"crowd-contacts", distance}}, 3).problem).condition.value;
  };
  EXPECT_NEAR(condition(1e-6) / condition(1e-4), 1e4, 1e3);
  EXPECT_GT(condition(1e-4), 100 * condition(1e-2));
}

TEST(Changes, AreTheSameForTheSameSeedOnly) {
  const std::map<std::string, double> amounts = {{"mass-ratio", 100}, {"curvature-contrast", 100}, {"scale-rows", 30}};
  for (const std::string& name : AllChanges()) {
    if (name == "conformal" || name == "slack" || name == "friction") continue;
    const double amount = amounts.count(name) > 0 ? amounts.at(name) : 0.5;
    const std::string id = "rockers-n40-s2-" + name;
    EXPECT_EQ(RecipeId({"rockers", kRows, 2, {{name, amount}}}).rfind(id, 0), 0U);
    const LcpProblem a = MakeInstance({"rockers", kRows, 2, {{name, amount}}}).problem;
    EXPECT_EQ(a.id().rfind(id, 0), 0U);
    EXPECT_EQ(ContentHash(a), ContentHash(MakeInstance({"rockers", kRows, 2, {{name, amount}}}).problem)) << name;
    EXPECT_NE(ContentHash(Given("rockers", {{name, amount}}, 2).problem),
              ContentHash(Given("rockers", {{name, amount}}, 3).problem))
        << name;
  }
}

TEST(Changes, RefuseImpossibleNumbers) {
  const double nan = std::nan("");
  const std::pair<const char*, std::vector<double>> kImpossible[] = {{"duplicate-rows", {1.5, -0.1}},
                                                                     {"oppose-rows", {nan}},
                                                                     {"crowd-contacts", {0}},
                                                                     {"scale-rows", {0.5, 1000}},
                                                                     {"curvature-contrast", {0.5}},
                                                                     {"conformal", {0, 1}},
                                                                     {"slack", {nan}},
                                                                     {"no-such-change", {1}},
                                                                     {"mass-ratio", {0.5, -1, HUGE_VAL, nan}}};
  for (const auto& [name, amounts] : kImpossible) {
    for (const double amount : amounts) {
      ExpectRefused(
          [&, &change = name] {
            MakeInstance({"disc-track", 20, 1, {{change, amount}}});
          },
          "", "disc-track-n20-s1-");
    }
  }
  EXPECT_THROW(MakeInstance({"no-such-scene", 20, 1, {}}), InputError);
  EXPECT_THROW(MakeInstance({"disc-pile", 0, 1, {}}), InputError);
}

// ----- hard cases, by rational arithmetic

ExactAnswer Exactly(const char* key, int rows, std::uint64_t seed) {
  const ExactLcp problem = ExactFrom(MakeInstance({key, rows, seed, {}}).problem);
  ExactAnswer answer = SolveExactly(problem, {});
  EXPECT_EQ(FindFault(problem, answer), "") << key << " " << rows;
  return answer;
}

TEST(HardCases, SqueezedRowsHaveTheRayOfOnes) {
  for (const char* key : {"squeezed-row", "barely-squeezed-row"}) {
    for (const int rows : {2, 3, 8, 31}) {
      for (const std::uint64_t seed : {1, 2, 3}) {
        const ExactAnswer answer = Exactly(key, rows, seed);
        ASSERT_EQ(answer.status, ExactAnswer::Status::kInfeasible) << key << " " << rows;
        EXPECT_EQ(answer.ray, std::vector<Rational>(static_cast<size_t>(rows), answer.ray.front()));
      }
    }
  }
}

TEST(HardCases, OthersAreSolvedInTheWayThatIsSaid) {
  for (const int rows : {1, 2, 9, 40}) {
    const ExactAnswer idle = Exactly("idle-line", rows, 1);
    ASSERT_EQ(idle.status, ExactAnswer::Status::kSolved);
    EXPECT_EQ(idle.w, std::vector<Rational>(static_cast<size_t>(rows), 0));
    EXPECT_EQ(idle.degenerate.size(), static_cast<size_t>(rows / 2)) << "sideways";
    EXPECT_EQ(idle.f_unique, true);
  }
  EXPECT_EQ((MakeInstance({"fixed-pairs", 21, 1, {}}).problem.DiagonalA().array() == 0).count(), 10);
  const ExactAnswer pairs = Exactly("fixed-pairs", 21, 1);
  EXPECT_EQ(pairs.status, ExactAnswer::Status::kSolved);
  EXPECT_EQ(pairs.f_unique, false);
  for (const int rows : {4, 6, 20}) {
    EXPECT_EQ(Exactly("overpinned-beam", rows, 2).status, ExactAnswer::Status::kSolved) << rows;
    EXPECT_EQ(RankOf(MakeInstance({"overpinned-beam", rows, 2, {}}).problem, 100), rows == 4 ? 4 : 5);
  }
}

TEST(HardCases, HaveTheRowsAskedFor) {
  for (const HardCase& hard : AllHardCases()) {
    for (const int rows : {1, 2, 5, 12, 33}) {
      const Instance instance = MakeInstance({std::string(hard.key), rows, 4, {}});
      EXPECT_LE(instance.problem.size(), std::max(rows, 2)) << hard.key;
      EXPECT_GE(instance.problem.size(), rows - 1) << hard.key;
    }
  }
}

// ----- steps of motions

TEST(SweepSolver, SolvesWhatSweepsSolve) {
  SweepSolver solver;
  int solved = 0;
  for (const Recipe& recipe : {Recipe{"disc-pile", 12, 1, {}}, Recipe{"chain-of-links", 12, 1, {}},
                               Recipe{"rounded-wall", 12, 1, {}}, Recipe{"disc-pile", 12, 1, {{"friction", 0.3}}},
                               Recipe{"chain-of-links", 12, 1, {{"friction", 0.6}}}, Recipe{"drum", 12, 1, {}}}) {
    const std::string scene = RecipeId(recipe);
    const LcpProblem problem = MakeInstance(recipe).problem;
    LcpResult result;
    solver.Solve(problem, {}, &result);
    if (result.status == LcpStatus::kSolved) {
      EXPECT_LE(ComputeMetrics(problem, result.f).rho, 1e-5) << scene;
      solved += problem.is_plain() ? 0 : 1;
    }
    EXPECT_LE(result.iterations, SweepSolver::kMostSweeps);
    // From its own answer it goes no further than from anywhere else.
    LcpOptions warm;
    const Eigen::VectorXd f = result.f;
    warm.initial_f = &f;
    solver.Solve(problem, warm, &result);
    EXPECT_LE(Largest(result.f - f), 1e-3 * (1e-300 + Largest(f))) << scene;
  }
  EXPECT_GT(solved, 0);
}

TEST(MotionSteps, AreTakenByTheRule) {
  for (const char* scene : {"disc-pile", "oval-train"}) {
    const Recipe start{scene, 45, 1, {}};
    std::vector<int> numbers;
    std::vector<std::int64_t> closings;
    TakeSteps(start, 2, [&](const MotionStep& step) {
      numbers.push_back(step.number);
      closings.push_back(step.closings);
      return numbers.size() != 2;  // the second one offered is refused
    });
    ASSERT_EQ(numbers.size(), 3U) << scene;
    EXPECT_TRUE(numbers[0] == kLatestStep || (numbers[0] >= kSettled && closings[0] >= 45 / 4)) << scene;
    EXPECT_EQ(numbers[1], numbers[0] + kStepsBetween) << scene;
    EXPECT_EQ(numbers[2], numbers[1] + 1) << scene;
    int offered = 0;
    TakeSteps(start, 2, [&](const MotionStep&) { return ++offered < 0; });
    EXPECT_EQ(offered, kStepsTried);
  }
}

TEST(MotionSteps, AreThoseOfTheirRecipes) {
  const Recipe recipe{"rounded-wall", 45, 3, {}, 7};
  const LcpProblem made = MakeInstance(recipe).problem;
  EXPECT_EQ(made.id(), "rounded-wall-n45-s3-motion-step7");
  std::string hash;
  Recipe start = recipe;
  start.motion_step = 0;
  FollowMotion(start, 10, [&](const MotionStep& step) {
    if (step.number == 7) hash = ContentHash(step.instance.problem);
    return true;
  });
  EXPECT_EQ(ContentHash(made), hash);
  Recipe changed = recipe;
  changed.changes = {{"slack", 1}};
  EXPECT_THROW(MakeInstance(changed), InputError);
}

// What is met on the way are contacts that have met, not overlaps that a bad solver left.
TEST(MotionSteps, KeepTheirContactsApart) {
  for (const SceneFamily& family : AllScenes()) {
    double deepest = 0;
    const std::string end = FollowMotion({std::string(family.key), 12, 1, {}}, 60, [&](const MotionStep& step) {
      for (const RowInfo& row : step.instance.rows) {
        if (!row.bilateral) deepest = std::max(deepest, -row.d);
      }
      return true;
    });
    EXPECT_EQ(end, "") << family.key;
    EXPECT_LE(deepest, 5e-3) << family.key;
  }
}

}  // namespace
}  // namespace lcpbench
