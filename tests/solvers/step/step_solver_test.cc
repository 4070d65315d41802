// From an engine's arrays to forces: every answer is judged by the verifier on the problem that the arrays stand for.

#include "solvers/step/step_solver.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <tuple>
#include <vector>

#include "benchmarks/measure/allocation_count.h"
#include "model/contact/assembly.h"
#include "model/scenes/scene.h"
#include "solvers/lcp/verify.h"
#include "support/input_error.h"
#include "tests/solvers/exact_problems.h"
#include "tests/solvers/lcp/same_problem.h"
#include "tests/solvers/solve_with.h"
#include "tests/solvers/step/random_step.h"
#include "tests/solvers/test_problems.h"
#include "tests/support/refusal.h"

namespace lcpbench {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// All that a solve hands out.
struct Solved {
  StepAnswer answer;
  VectorXd f, w;
};

Solved Solve(StepSolver* solver, const StepRows& rows, const double* initial_f = nullptr) {
  Solved solved;
  solved.f = VectorXd::Constant(rows.rows, kNotANumber);
  solved.w = VectorXd::Constant(rows.rows, kNotANumber);
  solved.answer = solver->Solve(rows, initial_f, solved.f.data(), solved.w.data());
  return solved;
}

Verdict Judge(const LcpProblem& problem, const Solved& solved, double tolerance = 1e-9) {
  return Verify(problem, Claim(solved.f, solved.answer.status), tolerance);
}

// Claimed, verified, rho no larger than the solver says, and w as the verifier finds it.
void ExpectVerified(const LcpProblem& problem, const Solved& solved, const std::string& what, double tolerance = 1e-9) {
  const Verdict verdict = Judge(problem, solved, tolerance);
  EXPECT_EQ(solved.answer.status, LcpStatus::kSolved) << what;
  EXPECT_TRUE(verdict.passes) << what << ": " << verdict.reason;
  EXPECT_GE(solved.answer.iterations, 0) << what;
  EXPECT_LE(solved.answer.rho, tolerance) << what;
  // The largest of its islands is no less than that of the whole; the verifier sums in extended precision.
  EXPECT_LE(verdict.metrics.rho, solved.answer.rho + 2e-2 * tolerance + 4 * verdict.metrics.answer_floor) << what;
  // What rounding leaves of a sum, by rows: u (|A||f| + |b|) times the number of terms, at most.
  const VectorXd size = problem.SparseA().cwiseAbs() * solved.f.cwiseAbs() + problem.b().cwiseAbs();
  const VectorXd difference = (solved.w - verdict.metrics.w).cwiseAbs();
  EXPECT_TRUE((difference.array() <= 1e-12 * size.array()).all()) << what << ": w differs by " << difference.maxCoeff();
}

// As ExpectVerified; where `auto` has no answer either, nothing may be claimed.
void ExpectRight(const LcpProblem& problem, const Solved& solved, const std::string& what) {
  if (SolveBy("auto", problem).status == LcpStatus::kSolved) {
    ExpectVerified(problem, solved, what);
  } else {
    EXPECT_NE(solved.answer.status, LcpStatus::kSolved) << what;
  }
}

LcpProblem SceneProblem(std::string_view family, Index rows, std::uint64_t seed) {
  return AssembleContactLcp(GenerateScene(family, static_cast<int>(rows), seed)).problem;
}

std::vector<std::string> Families() {
  std::vector<std::string> keys;
  for (const SceneFamily& family : AllScenes()) keys.emplace_back(family.key);
  return keys;
}

std::string Named(std::string key) {
  std::replace(key.begin(), key.end(), '-', '_');
  return key;
}

// ----- scenes

class StepsOfScenes : public testing::TestWithParam<std::string> {};

TEST_P(StepsOfScenes, AreSolvedAndVerifiedAtEverySize) {
  StepSolver solver;
  for (const Index n : {1, 2, 3, 4, 6, 9, 13, 16, 17, 24, 33, 50, 64, 65, 90, 128, 129, 180, 300}) {
    for (std::uint64_t seed = 1; seed <= (n <= 16 ? 6U : 2U); ++seed) {
      const LcpProblem scene = SceneProblem(GetParam(), n, seed);
      ASSERT_TRUE(scene.has_two_body_rows());
      StepArrays arrays = StepArrays::Of(scene);
      const LcpProblem problem = arrays.Problem();
      const std::string what = GetParam() + ", " + std::to_string(n) + " rows, seed " + std::to_string(seed);
      ExpectRight(problem, Solve(&solver, arrays.View()), what);
      if (seed > 1) continue;
      arrays.Round();
      ExpectRight(arrays.Problem(true), Solve(&solver, arrays.View(true)), what + ", J in single precision");
    }
  }
}

TEST_P(StepsOfScenes, StartFromTheForcesBefore) {
  StepSolver solver;
  for (const Index n : {2, 10, 40, 120, 250}) {
    const StepArrays arrays = StepArrays::Of(SceneProblem(GetParam(), n, 3));
    const LcpProblem problem = arrays.Problem();
    const std::string what = GetParam() + ", " + std::to_string(n) + " rows";
    const Solved cold = Solve(&solver, arrays.View());
    if (cold.answer.status != LcpStatus::kSolved) continue;
    const Solved warm = Solve(&solver, arrays.View(), cold.f.data());
    ExpectVerified(problem, warm, what + ", from the answer");
    if (solver.fallbacks() == 0) {
      EXPECT_LE(warm.answer.iterations, std::max<std::int64_t>(cold.answer.iterations, 1)) << what;
    }
    TestRandom random(static_cast<unsigned>(n));
    VectorXd wrong(n);
    for (Index i = 0; i < n; ++i) wrong[i] = random.Integer(-5, 5);
    ExpectVerified(problem, Solve(&solver, arrays.View(), wrong.data()), what + ", from anything");
  }
}

INSTANTIATE_TEST_SUITE_P(Families, StepsOfScenes, testing::ValuesIn(Families()),
                         [](const auto& test) { return Named(test.param); });

// ----- random rows

struct RandomCase {
  int columns_per_body;
  const char* name;
  double bodies_per_row;
};

std::ostream& operator<<(std::ostream& out, const RandomCase& rows) { return out << rows.name; }

class StepsOfRandomRows : public testing::TestWithParam<std::tuple<RandomCase, InstructionSet>> {};

TEST_P(StepsOfRandomRows, AreSolvedAndVerifiedAtEverySize) {
  StepSolver solver({.instructions = std::get<1>(GetParam())});
  const auto [p, name, bodies_per_row] = std::get<0>(GetParam());
  for (const Index n : {1, 2, 3, 4, 5, 6, 7, 8, 11, 15, 16, 17, 20, 27, 40, 63, 64, 65, 100, 128, 150, 300}) {
    for (unsigned seed = 0; seed < (n <= 20 ? 10U : 3U); ++seed) {
      const auto bodies = static_cast<Index>(std::ceil(bodies_per_row * static_cast<double>(n))) + 1;
      StepArrays arrays = RandomStep(n, bodies, p, 100 * seed + static_cast<unsigned>(n));
      const std::string what = std::to_string(n) + " rows, seed " + std::to_string(seed);
      ExpectVerified(arrays.Problem(), Solve(&solver, arrays.View()), what);
      // Rounding leaves planted rows solvable where no row depends on others; `auto` tells.
      arrays.Round();
      ExpectRight(arrays.Problem(true), Solve(&solver, arrays.View(true)), what + ", J in single precision");
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    Kinds, StepsOfRandomRows,
    testing::Combine(testing::Values(RandomCase{3, "PlanarIndependent", 1.5}, RandomCase{3, "PlanarRedundant", 0.2},
                                     RandomCase{6, "SpatialIndependent", 1.5}, RandomCase{6, "SpatialRedundant", 0.1}),
                     testing::ValuesIn(AvailableInstructionSets())),
    [](const auto& test) { return std::get<0>(test.param).name + std::string(ToString(std::get<1>(test.param))); });

// ----- by hand

TEST(StepRows, DenseAIsThatOfTheProblem) {
  constexpr Index kStride = 28;
  for (const int p : {3, 6}) {
    for (unsigned seed = 0; seed < 40; ++seed) {
      const Index n = 1 + seed % 25;
      StepArrays step = RandomStep(n, 1 + n / 3, p, seed);
      step.Round();
      for (const bool single : {false, true}) {
        std::vector<double> A(static_cast<std::size_t>(n * kStride), kNotANumber);
        AssembleDenseA(step.View(single), A.data(), kStride);
        const Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> found(
            A.data(), n, kStride);
        const MatrixXd expected = step.Problem(single).DenseA();
        // Sums of at most 2 p products, each of which is at most the geometric mean of two diagonal entries.
        EXPECT_LE((found.leftCols(n) - expected).cwiseAbs().maxCoeff(), 1e-14 * expected.diagonal().maxCoeff());
        EXPECT_EQ(found.leftCols(n), found.leftCols(n).transpose());
        EXPECT_TRUE((found.rightCols(kStride - n).array() == 0).all());
      }
    }
  }
}

TEST(StepSolver, TakesRowsThatMoveNothing) {
  StepSolver solver;
  StepArrays arrays;
  arrays.inverse_mass = {0, 0, 0, 1, 1, 1};
  const std::vector<double> numbers = {1, 2, 3, 4, 5, 6};
  arrays.Add(0, -1, numbers, 2);
  arrays.Add(-1, -1, numbers, 0);
  arrays.Add(-1, 0, numbers, 0, true);
  arrays.Add(1, 0, numbers, -28);  // 1 + 4 + 9 = 14
  const Solved solved = Solve(&solver, arrays.View());
  ExpectVerified(arrays.Problem(), solved, "rows that move nothing");
  EXPECT_NEAR(solved.f[3], 2, 1e-14);
  EXPECT_EQ(solved.w[0], 2);
  EXPECT_EQ(solver.fallbacks(), 0);
  arrays.Add(-1, 0, numbers, -1);  // which nothing can hold
  EXPECT_NE(Solve(&solver, arrays.View()).answer.status, LcpStatus::kSolved);
}

// A row of zeros between moving bodies keeps their island out of the tableau, which then writes no forces: those that
// the caller left there must not become a start.
TEST(StepSolver, DoesNotReadTheForcesThatItWrites) {
  constexpr int kBodies = 20;
  StepArrays arrays;
  arrays.inverse_mass.assign(3 * kBodies, 1);
  for (int k = 0; k + 1 < kBodies; ++k) arrays.Add(k, k + 1, {1, 0, 0, -1, 0, 0.5}, k % 3 == 0 ? -1 : 0.25);
  arrays.Add(3, 4, {0, 0, 0, 0, 0, 0}, 1);
  const Eigen::Index rows = arrays.View().rows;
  VectorXd first;
  for (const double before : {0.0, 1e300, -7.0, std::numeric_limits<double>::quiet_NaN()}) {
    StepSolver solver;
    Solved solved;
    solved.f = VectorXd::Constant(rows, before);
    solved.w = solved.f;
    solved.answer = solver.Solve(arrays.View(), nullptr, solved.f.data(), solved.w.data());
    ExpectVerified(arrays.Problem(), solved, "a row of zeros");
    if (first.size() == 0) first = solved.f;
    EXPECT_EQ(solved.f, first) << before;
  }
}

TEST(StepSolver, ClaimsNothingOfJointsThatContradictEachOther) {
  for (const int p : {3, 6}) {
    for (const Index n : {0, 10, 70, 200}) {
      StepSolver solver;
      StepArrays arrays = RandomStep(n, n + 3, p, static_cast<unsigned>(n));
      std::vector<double> numbers(static_cast<std::size_t>(2 * p), 0.0);
      numbers[0] = 1;
      arrays.Add(1, -1, numbers, 1, true);
      arrays.Add(1, -1, numbers, -1, true);
      const Solved solved = Solve(&solver, arrays.View());
      const Verdict verdict = Judge(arrays.Problem(), solved);
      EXPECT_FALSE(verdict.passes);
      EXPECT_NE(solved.answer.status, LcpStatus::kSolved) << n;
      EXPECT_NE(solved.answer.status, LcpStatus::kNotRun) << n;
      EXPECT_TRUE(solved.f.allFinite()) << n;
      // The object goes on as before.
      arrays = RandomStep(20, 30, p, 5);
      ExpectVerified(arrays.Problem(), Solve(&solver, arrays.View()), "after joints without an answer");
    }
  }
}

// Two joints of one body in the plane, along (x, y) and along (u, v), that want it to go both ways.
StepAnswer SolveTwoJoints(double x, double y, double u, double v) {
  StepArrays arrays;
  arrays.inverse_mass.assign(3, 1);
  arrays.Add(0, -1, {x, y, 0, 0, 0, 0}, 1, true);
  arrays.Add(0, -1, {u, v, 0, 0, 0, 0}, -1, true);
  StepSolver solver;
  const Solved solved = Solve(&solver, arrays.View());
  EXPECT_TRUE(solved.f.allFinite());
  return solved.answer;
}

TEST(StepSolver, TellsHowSurelyThereIsNoAnswer) {
  StepAnswer answer = SolveTwoJoints(1, 0, 1, 0);
  EXPECT_EQ(answer.status, LcpStatus::kInfeasible);
  EXPECT_TRUE(answer.infeasible_proved && std::isinf(answer.force_min));
  // The second joint is three times the first, but for the last digits.
  answer = SolveTwoJoints(0.3, 0.1, 0.9, 0.3);
  EXPECT_EQ(answer.status, LcpStatus::kInfeasible);
  EXPECT_TRUE(!answer.infeasible_proved && answer.force_min > 1e12 && std::isfinite(answer.force_min));
  // From an angle of 1e-13 on there is a solution.
  for (double angle = 1e-12; angle < 0.1; angle *= 7) {
    answer = SolveTwoJoints(0.6, 0.8, 0.6 - 0.8 * angle, 0.8 + 0.6 * angle);
    EXPECT_NE(answer.status, LcpStatus::kInfeasible) << angle;
    EXPECT_TRUE(!answer.infeasible_proved && answer.force_min == 0) << angle;
  }
}

// Numbers up to the ends of double's range, solvable or not, and also without time: rho is a number or infinite, and
// that of the verifier where the solver failed.
TEST(StepSolver, RhoIsNeverNan) {
  for (const double size : {0.0, 1.0, 1e-320, 1e-170, 1e100, 1e150}) {
    // A: 0 in double, not so for the verifier
    const bool is_below_double = size > 0 && size * size == 0;
    for (const double load : {0.0, -1.0, 1.0, -1e-320, -1e-170, 1e170, -1e308}) {
      for (const Index n : {1, 4, 30}) {
        StepArrays arrays = RandomStep(n, n + 2, 3, static_cast<unsigned>(n));
        for (double& number : arrays.J) number *= size;
        for (Index i = 0; i < n; ++i) arrays.b[static_cast<std::size_t>(i)] = load * (i % 3 == 2 ? -0.5 : 1);
        for (const double limit : {kInfinity, 1e-12}) {
          StepSolver solver({.time_limit_s = limit});
          Solved solved = Solve(&solver, arrays.View());
          const double rho = Judge(arrays.Problem(), solved).metrics.rho;
          const std::string what = std::to_string(n) + " rows, " + std::to_string(size) + ", " + std::to_string(load);
          EXPECT_FALSE(std::isnan(solved.answer.rho) || std::isnan(rho)) << what;
          const bool agrees = solved.answer.rho == rho || std::abs(solved.answer.rho - rho) <= 1e-9 * (1 + rho);
          EXPECT_TRUE(solved.answer.status == LcpStatus::kSolved || is_below_double || agrees) << what;
          solver.SolveBatch(arrays.View(), std::vector{0, static_cast<std::int32_t>(n)}, solved.f.data(),
                            {&solved.answer, 1});
          EXPECT_FALSE(std::isnan(solved.answer.rho)) << what;
        }
      }
    }
  }
}

// Units far from 1, up to the ends of the doubles' range.
TEST(StepSolver, SolvesAtEveryScale) {
  for (const int exponent : {-120, -70, -40, 0, 40, 70, 120}) {
    for (const int of_b : {-400, -140, 0, 100, 300}) {
      for (const int of_mass : {-90, 0, 90}) {
        StepSolver solver;
        StepArrays arrays = RandomStep(12, 20, 6, 7);
        for (double& number : arrays.J) number = std::ldexp(number, exponent);
        for (double& number : arrays.b) number = std::ldexp(number, of_b);
        for (double& number : arrays.inverse_mass) number = std::ldexp(number, of_mass);
        const LcpProblem problem = arrays.Problem();
        const std::string what = "J 2^" + std::to_string(exponent) + ", b 2^" + std::to_string(of_b) +
                                 ", inverse masses 2^" + std::to_string(of_mass);
        const Solved solved = Solve(&solver, arrays.View());
        const Verdict verdict = Judge(problem, solved);
        EXPECT_FALSE(verdict.false_success) << what << ": " << verdict.reason;
        ExpectRight(problem, solved, what);
      }
    }
  }
}

TEST(StepSolver, MeetsTheToleranceThatIsAskedFor) {
  for (const double tolerance : {1e-3, 1e-6, 1e-12}) {
    StepOptions options;
    options.tolerance = tolerance;
    StepSolver solver(options);
    for (const Index n : {5, 50, 200}) {
      const StepArrays arrays = RandomStep(n, 2 * n, 3, static_cast<unsigned>(n));
      ExpectVerified(arrays.Problem(), Solve(&solver, arrays.View()), std::to_string(tolerance), tolerance);
    }
  }
}

// ----- nothing carries over

bool AreSameBits(const Solved& a, const Solved& b) {
  return SameBits(a.f, b.f) && SameBits(a.w, b.w) && a.answer.status == b.answer.status &&
         a.answer.iterations == b.answer.iterations && a.answer.rho == b.answer.rho;
}

TEST(StepSolver, GivesTheSameBitsWhateverCameBefore) {
  std::vector<StepArrays> steps;
  for (unsigned k = 0; k < 12; ++k) {
    const Index n = Index{1} << (k % 9);
    steps.push_back(RandomStep(n, k % 2 == 0 ? 2 * n : n / 4 + 2, k % 3 == 0 ? 6 : 3, k));
  }
  for (const std::string& family : Families()) steps.push_back(StepArrays::Of(SceneProblem(family, 70, 1)));
  StepSolver used;
  std::vector<VectorXd> starts;
  std::vector<Solved> fresh;
  std::vector<Solved> fresh_warm;
  for (const StepArrays& step : steps) {
    StepSolver solver;
    starts.emplace_back(VectorXd::Constant(step.rows(), 0.5));
    fresh.push_back(Solve(&solver, step.View()));
    StepSolver another;
    another.Reserve(1000, 1000);
    fresh_warm.push_back(Solve(&another, step.View(), starts.back().data()));
  }
  for (int times = 0; times < 3; ++times) {
    for (std::size_t k = 0; k < steps.size(); ++k) {
      const std::size_t which = (k * 7 + static_cast<std::size_t>(times)) % steps.size();
      const StepRows rows = steps[which].View();
      EXPECT_TRUE(AreSameBits(Solve(&used, rows), fresh[which])) << which;
      EXPECT_TRUE(AreSameBits(Solve(&used, rows, starts[which].data()), fresh_warm[which])) << which << ", warm";
    }
  }
}

// ----- mistakes

TEST(StepSolver, RefusesWrongArraysByNameWithNothingWritten) {
  struct Mistake {
    const char* words;
    std::function<void(StepArrays*, StepRows*)> make;
  };
  const Mistake mistakes[] = {
      {"columns per body must be 3 or 6, found 4", [](auto*, auto* of) { of->columns_per_body = 4; }},
      {"rows and bodies must be >= 0", [](auto*, auto* of) { of->rows = -1; }},
      {"rows and bodies must be >= 0", [](auto*, auto* of) { of->bodies = -1; }},
      {"body is missing", [](auto*, auto* of) { of->body = nullptr; }},
      {"b is missing", [](auto*, auto* of) { of->b = nullptr; }},
      {"J is missing", [](auto*, auto* of) { of->J = nullptr; }},
      {"inverse mass is missing", [](auto*, auto* of) { of->inverse_mass = nullptr; }},
      {"body of row 2 is 3.000000, expected one in [-1, 3)", [](auto*, auto* of) { of->bodies = 3; }},
      {"body of row 1 is -2.000000, expected one in [-1, 4)", [](auto* of, auto*) { of->body[3] = -2; }},
      {"body of row 0 is 4.000000, expected one in [-1, 4)", [](auto* of, auto*) { of->body[0] = 4; }},
      {"J of row 1 is nan, expected a finite number", [](auto* of, auto*) { of->J[6] = kNotANumber; }},
      {"J of row 2 is -inf, expected a finite number", [](auto* of, auto*) { of->J[17] = -kInfinity; }},
      {"b of row 2 is nan, expected a finite number", [](auto* of, auto*) { of->b[2] = kNotANumber; }},
      {"b of row 0 is inf, expected a finite number", [](auto* of, auto*) { of->b[0] = kInfinity; }},
      {"inverse mass of body 3 is -1.000000, expected a finite number >= 0",
       [](auto* of, auto*) { of->inverse_mass[11] = -1; }},
      {"inverse mass of body 1 is nan, expected a finite number >= 0",
       [](auto* of, auto*) { of->inverse_mass[3] = kNotANumber; }},
      {"inverse mass of body 2 is inf, expected a finite number >= 0",
       [](auto* of, auto*) { of->inverse_mass[7] = kInfinity; }}};
  StepSolver solver;
  StepArrays right;
  right.inverse_mass.assign(12, 1);
  right.Add(0, 1, {1, 0, 0, -1, 0, 0}, -1);
  right.Add(1, 2, {1, 0, 0, -1, 0, 0}, -1);
  right.Add(3, -1, {0, 1, 0, 0, 0, 0}, -1);
  for (const Mistake& mistake : mistakes) {
    StepArrays arrays = right;
    StepRows rows = arrays.View();
    mistake.make(&arrays, &rows);
    VectorXd f = VectorXd::Constant(3, 77);
    VectorXd w = f;
    EXPECT_EQ(RefusalOf([&] { solver.Solve(rows, nullptr, f.data(), w.data()); }),
              std::string("step rows: ") + mistake.words);
    EXPECT_TRUE((f.array() == 77).all() && (w.array() == 77).all()) << mistake.words;
  }
  VectorXd start = VectorXd::Zero(3);
  start[1] = kNotANumber;
  VectorXd f = VectorXd::Constant(3, 77);
  EXPECT_EQ(RefusalOf([&] { solver.Solve(right.View(), start.data(), f.data()); }),
            "step rows: initial f of row 1 is nan, expected a finite number");
  EXPECT_TRUE((f.array() == 77).all());
  right.Round();
  right.J_single[12] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(RefusalOf([&] { solver.Solve(right.View(true), nullptr, f.data()); }),
            "step rows: J of row 2 is nan, expected a finite number");
  ExpectVerified(right.Problem(), Solve(&solver, right.View()), "after mistakes");
}

// A block on the ground, pushed along.
TEST(StepSolver, FrictionAndBoundedRowsAreSolvedAloneAndInBatches) {
  StepArrays arrays;
  arrays.inverse_mass.assign(6, 1);
  arrays.Add(0, -1, {0, 1, 0, 0, 0, 0}, -1);
  arrays.Add(0, -1, {1, 0, 0, 0, 0, 0}, 1);
  StepSolver solver;
  VectorXd f = VectorXd::Constant(2, 77);
  VectorXd w = f;
  const auto solve = [&](const StepRows& rows) { return solver.Solve(rows, nullptr, f.data(), w.data()); };
  const std::vector<FrictionRow> friction = {{1, 0, 0.5}};
  const std::vector<BoundedRow> bounded = {{1, -1, 1}};
  std::vector<StepRows> steps(2, arrays.View());
  steps[0].friction = friction;
  steps[1].bounded = bounded;
  for (const StepRows& rows : steps) {
    const StepAnswer answer = solve(rows);
    EXPECT_EQ(answer.status, LcpStatus::kSolved);
    const double least = rows.friction.empty() ? -1 : -0.5;  // A is the unit matrix, b = (-1, 1)
    EXPECT_NEAR((f - Eigen::Vector2d(1, least)).norm(), 0, 1e-12);
    EXPECT_NEAR((w - Eigen::Vector2d(0, 1 + least)).norm(), 0, 1e-12);
    std::vector<StepAnswer> answers(1);
    VectorXd in_batch(2);
    solver.SolveBatch(rows, std::vector<std::int32_t>{0, 2}, in_batch.data(), answers);
    EXPECT_EQ(in_batch, f);
    EXPECT_EQ(answers.front().status, LcpStatus::kSolved);
  }
  const auto refusal = [&](const FrictionRow& row) {
    StepRows rows = arrays.View();
    rows.friction = {&row, 1};
    return RefusalOf([&] { solve(rows); });
  };
  EXPECT_EQ(refusal({1, 0, -1}), "problem 'step': friction: row 1: mu is -1, expected a finite number >= 0");
  EXPECT_EQ(refusal({1, 1, 1}), "problem 'step': friction: row 1: normal is 1, expected a unilateral row");
  StepRows none;
  none.bounded = bounded;
  EXPECT_EQ(RefusalOf([&] { solve(none); }), "problem 'step': bounded: row 1 is outside [0, 0)");
}

// In a world of few bodies, too, whatever another body has: by Solve, by SolveBatch in lanes and by what it leaves to
// Solve, and by the solvers that both ask where no joint force can hold.
TEST(StepSolver, ReadsInverseMassesOfNamedBodiesOnlyInBatchesAsWell) {
  for (const bool is_solvable : {true, false}) {
    for (const Index n : {1, 6, 40}) {
      StepArrays arrays;
      arrays.inverse_mass.assign(9, 1);
      for (Index i = 0; i < n; ++i) arrays.Add(0, 2, {1, 0, 0, -1, 0, 0}, -1);
      if (!is_solvable) {
        arrays.Add(0, -1, {0, 1, 0, 0, 0, 0}, 1, true);
        arrays.Add(0, -1, {0, 1, 0, 0, 0, 0}, -1, true);
      }
      const auto rows = static_cast<std::int32_t>(arrays.rows());
      const LcpProblem problem = arrays.Problem();
      StepSolver reference;
      const Solved expected = Solve(&reference, arrays.View());
      for (const double bad : {kNotANumber, kInfinity, -kInfinity, -3.0, 1e300, 1e-300}) {
        const std::string what = std::to_string(rows) + " rows, body 1 has " + std::to_string(bad);
        arrays.inverse_mass[4] = bad;
        StepSolver solver;
        const Solved alone = Solve(&solver, arrays.View());
        EXPECT_EQ(alone.answer.status, expected.answer.status) << what;
        EXPECT_EQ(alone.f, expected.f) << what;
        Solved batch = alone;
        solver.SolveBatch(arrays.View(), std::vector<std::int32_t>{0, rows}, batch.f.data(), {&batch.answer, 1});
        EXPECT_EQ(batch.answer.status, expected.answer.status) << what;
        EXPECT_EQ(Judge(problem, batch).passes, is_solvable) << what;
        EXPECT_EQ(Judge(problem, alone).passes, is_solvable) << what;
      }
    }
  }
}

TEST(StepSolver, RefusesOptionsAndStartsOutOfRange) {
  for (const double tolerance : {0.0, 1.0, -1e-6, kNotANumber}) {
    EXPECT_THROW(StepSolver({tolerance, 1}), InputError) << tolerance;
  }
  for (const double limit : {0.0, -1.0, kNotANumber}) EXPECT_THROW(StepSolver({1e-6, limit}), InputError) << limit;
  StepSolver solver;
  const StepArrays arrays = RandomStep(4, 6, 3, 1);
  VectorXd f(4);
  std::vector<StepAnswer> answers(2);
  for (const std::vector<std::int32_t>& start :
       {std::vector<std::int32_t>{0, 4}, {0, 2, 3}, {1, 2, 4}, {0, 5, 4}, {0, -1, 4}, {}}) {
    EXPECT_THROW(solver.SolveBatch(arrays.View(), start, f.data(), answers), InputError);
  }
}

// ----- no allocation after Reserve

// Steps of scenes, and random rows.
std::vector<std::string> FamiliesAndSpatial() {
  std::vector<std::string> families = Families();
  families.emplace_back("spatial");
  return families;
}

class StepsWithoutAllocation : public testing::TestWithParam<std::tuple<std::string, Index>> {};

// Up to 1000 rows no method that allocates may be needed: for scenes of every family, and for rows in space. Rounding J
// to single precision makes redundant rows contradict each other by 1e-8, so that there other solvers may be asked.
TEST_P(StepsWithoutAllocation, AllocateInReserveOnlyAndNeedNoOtherSolversInDoublePrecision) {
  const auto& [family, rows] = GetParam();
  StepArrays arrays =
      family == "spatial" ? RandomStep(rows, rows + 1, 6, 1) : StepArrays::Of(SceneProblem(family, rows, 1));
  arrays.Round();
  // Only what has an answer must be found by what allocates nothing.
  ASSERT_EQ(SolveBy("auto", arrays.Problem()).status, LcpStatus::kSolved);
  StepSolver solver;
  solver.Reserve(rows, arrays.bodies());
  VectorXd f(rows);
  VectorXd w(rows);
  const auto solve = [&](const char* what, bool single, const double* initial_f) {
    const StepRows view = arrays.View(single);
    const std::int64_t fallbacks = solver.fallbacks();
    CountAllocations(true);
    const long before = AllocationCount();
    const StepAnswer answer = solver.Solve(view, initial_f, f.data(), w.data());
    const long allocations = AllocationCount() - before;
    CountAllocations(false);
    EXPECT_EQ(answer.status, LcpStatus::kSolved) << what;
    EXPECT_TRUE(single || solver.fallbacks() == fallbacks) << what;
    EXPECT_TRUE(allocations == 0 || solver.fallbacks() > fallbacks) << what;
  };
  solve("cold", false, nullptr);
  VectorXd start = f;
  solve("warm", false, start.data());
  // The answer of a step before: most of it holds.
  for (Index i = 0; i < rows; i += 7) start[i] = i % 2 == 0 ? 0 : 1;
  solve("from nearly the answer", false, start.data());
  if (SolveBy("auto", arrays.Problem(true)).status == LcpStatus::kSolved) solve("single", true, nullptr);
}

INSTANTIATE_TEST_SUITE_P(Families, StepsWithoutAllocation,
                         testing::Combine(testing::ValuesIn(FamiliesAndSpatial()),
                                          testing::Values(1, 6, 30, 100, 200, 300, 500, 1000)),
                         [](const auto& test) {
                           return Named(std::get<0>(test.param)) + "_" + std::to_string(std::get<1>(test.param));
                         });

}  // namespace
}  // namespace lcpbench
