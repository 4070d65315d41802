// The exact answer as a solver's: against SolveExactly, the same bits every time, and as what drives a motion.

#include "solvers/exact/exact_solver.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "benchmarks/measure/reference_solves.h"
#include "benchmarks/motions/scene_source.h"
#include "model/contact/assembly.h"
#include "model/scenes/scene.h"
#include "tests/solvers/solve_with.h"
#include "tests/solvers/test_problems.h"

namespace lcpbench {
namespace {

LcpResult SolveAfresh(const LcpProblem& problem, const LcpOptions& options = {}) {
  ExactSolver solver;
  return SolveWith(&solver, problem, options);
}

// Equal doubles; every bit of them, as no force here is a NaN.
void ExpectSameBits(const LcpResult& one, const LcpResult& other) {
  EXPECT_EQ(one.status, other.status);
  EXPECT_EQ(one.f, other.f);
  EXPECT_EQ(one.farkas_ray, other.farkas_ray);
  EXPECT_EQ(one.iterations, other.iterations);
}

// f is that of a search of its own; w, and f where there is only one, must be those of any exact answer.
void ExpectTheExactAnswer(const LcpProblem& problem) {
  SCOPED_TRACE(problem.id());
  const ExactLcp exact = ExactFrom(problem);
  const ExactAnswer expected = SolveExactly(exact, {.guess = GuessBySolvers});
  const ExactAnswer bare = SolveExactly(exact, {.answer_only = true});
  EXPECT_EQ(FindFault(exact, bare), "");
  EXPECT_EQ(bare.status, expected.status);
  EXPECT_EQ(bare.w, expected.w);

  const LcpResult result = SolveAfresh(problem);
  if (expected.status == ExactAnswer::Status::kInfeasible) {
    // By a rounding, and it is solved nearly, or indeed.
    if (result.status == LcpStatus::kSolved) {
      EXPECT_NE(result.detail, "");
      EXPECT_TRUE(Verify(problem, result, LcpOptions{}.tolerance).passes);
      return;
    }
    EXPECT_EQ(result.status, LcpStatus::kInfeasible);
    EXPECT_FALSE(Verify(problem, result, LcpOptions{}.tolerance).false_infeasible);
    ASSERT_TRUE(result.farkas_ray.has_value());
    for (Index i = 0; i < problem.size(); ++i) {
      EXPECT_EQ((*result.farkas_ray)[i], RoundToNearest(bare.ray[static_cast<size_t>(i)]));
    }
    return;
  }
  ASSERT_EQ(result.status, LcpStatus::kSolved) << result.detail;
  const Verdict verdict = Verify(problem, result, 1e-9);
  EXPECT_TRUE(verdict.passes) << verdict.reason;
  for (Index i = 0; i < problem.size(); ++i) {
    EXPECT_EQ(result.f[i], RoundToNearest(bare.f[static_cast<size_t>(i)]));
    if (expected.f_unique == true) {
      EXPECT_EQ(result.f[i], RoundToNearest(expected.f[static_cast<size_t>(i)]));
    }
  }
}

TEST(ExactSolver, SolvesScenesAsSolveExactlyDoes) {
  for (const SceneFamily& scene : AllScenes()) {
    for (const int size : {1, 7, 16, 40}) {
      for (const std::uint64_t seed : {1U, 2U}) {
        ExpectTheExactAnswer(AssembleContactLcp(GenerateScene(scene.key, size, seed)).problem);
      }
    }
  }
}

TEST(ExactSolver, SolvesGeneratedProblemsAsSolveExactlyDoes) {
  for (const TestProblem& test : GeneratedProblems()) {
    if (test.problem.size() <= 30) ExpectTheExactAnswer(test.problem);
  }
}

TEST(ExactSolver, SolvesTextbookProblemsAndProvesThoseWithoutASolution) {
  int infeasible = 0;
  for (const TestProblem& test : TextbookProblems()) {
    if (test.problem.Asymmetry() != 0 || !test.problem.facts().positive_semidefinite) continue;
    ExpectTheExactAnswer(test.problem);
    if (test.reference.status != LcpReference::Status::kInfeasible) continue;
    ++infeasible;
    ExpectRay(test.problem, SolveAfresh(test.problem));
  }
  EXPECT_GT(infeasible, 0);
}

TEST(ExactSolver, NeitherTheProblemBeforeNorAWarmStartChangesABit) {
  ExactSolver used;
  for (const SceneFamily& scene : AllScenes()) {
    for (const int size : {12, 40}) {
      const LcpProblem problem = AssembleContactLcp(GenerateScene(scene.key, size, 3)).problem;
      SCOPED_TRACE(problem.id());
      const LcpResult fresh = SolveAfresh(problem);
      ExpectSameBits(fresh, SolveWith(&used, problem));
      ExpectSameBits(fresh, SolveWith(&used, problem, {.initial_f = &fresh.f}));
      // Some of the 40 rows of a roller bearing contradict themselves; nothing else asks for the tolerance.
      if (!fresh.detail.empty()) continue;
      ExpectSameBits(fresh, SolveWith(&used, problem, {.tolerance = 1e-15, .initial_f = &fresh.f}));
    }
  }
}

struct Met {
  Eigen::VectorXd b;
  Eigen::VectorXd f;
  std::vector<double> J;
};

std::vector<Met> ProblemsOfMotion(const SceneFamily& scene) {
  std::vector<Met> met;
  ExactSolver solver;
  const MovingScene start = LoadScene(std::string(scene.key), 12, 1);
  const std::unique_ptr<Motion> motion = StartMotion(start, {}, solver);
  motion->set_observer([&met](const MotionProblem& problem) {
    const SparseMatrix& J = problem.problem.J();
    met.push_back({problem.problem.b(), problem.result.f, {J.valuePtr(), J.valuePtr() + J.nonZeros()}});
  });
  constexpr int kSteps = 5;
  for (int step = 0; step < kSteps; ++step) motion->Advance(start.step);
  EXPECT_EQ(motion->status(), MotionStatus::kMoving) << motion->detail();
  return met;
}

TEST(ExactSolver, DrivesAMotionToTheSameProblemsTwice) {
  for (const SceneFamily& scene : AllScenes()) {
    SCOPED_TRACE(scene.key);
    const std::vector<Met> once = ProblemsOfMotion(scene);
    const std::vector<Met> twice = ProblemsOfMotion(scene);
    ASSERT_GT(once.size(), 0U);
    ASSERT_EQ(once.size(), twice.size());
    for (size_t k = 0; k < once.size(); ++k) {
      EXPECT_EQ(once[k].b, twice[k].b);
      EXPECT_EQ(once[k].f, twice[k].f);
      EXPECT_EQ(once[k].J, twice[k].J);
    }
  }
}

TEST(ExactSolver, EndsAtTheTimeLimit) {
  const LcpResult result = SolveAfresh(AssembleContactLcp(GenerateScene("disc-pile", 20, 1)).problem,
                                       {.time_limit_s = 1, .now = &TickingClock});
  EXPECT_EQ(result.status, LcpStatus::kTimeLimit);
  EXPECT_EQ(result.f, Eigen::VectorXd::Zero(20));
}

TEST(ExactSolver, SaysWhatItDoesNotTake) {
  const auto status = [](const Eigen::MatrixXd& A) {
    return SolveAfresh(LcpProblem::FromDense("small", A, Eigen::VectorXd::Constant(A.rows(), -1))).status;
  };
  EXPECT_EQ(status((Eigen::MatrixXd(2, 2) << 2, 1, 1, 2).finished()), LcpStatus::kSolved);
  EXPECT_EQ(status((Eigen::MatrixXd(2, 2) << 2, 1, 1 + 1e-15, 2).finished()), LcpStatus::kUnsupported);
  EXPECT_EQ(status((Eigen::MatrixXd(2, 2) << 1, 2, 2, 1).finished()), LcpStatus::kUnsupported);
  EXPECT_EQ(status(Eigen::MatrixXd::Identity(121, 121)), LcpStatus::kUnsupported);
  EXPECT_EQ(status((Eigen::MatrixXd(1, 1) << 1e-320).finished()), LcpStatus::kNumericalFailure);  // f = 1e320
}

TEST(ExactSolver, RoundsToTheNearestDouble) {
  constexpr double kLeast = std::numeric_limits<double>::denorm_min();
  std::mt19937_64 random(5);
  std::uniform_int_distribution<std::int64_t> integers(-1000000, 1000000);
  for (int k = 0; k < 2000; ++k) {
    Rational value(integers(random), std::abs(integers(random)) + 1);
    // Every fourth one where doubles are subnormal.
    if (k % 4 == 0) value *= Rational(kLeast) * 1000;
    const double rounded = RoundToNearest(value);
    const Rational error = abs(value - Rational(rounded));
    for (const double side : {-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()}) {
      EXPECT_LE(error, abs(value - Rational(std::nextafter(rounded, side))));
    }
  }
  const Rational ulp(std::numeric_limits<double>::epsilon());
  EXPECT_EQ(RoundToNearest(1 + ulp / 2), 1);
  EXPECT_EQ(RoundToNearest(1 + ulp * 3 / 2), 1 + 2 * std::numeric_limits<double>::epsilon());
  EXPECT_EQ(RoundToNearest(Rational(kLeast) / 2), 0);
  EXPECT_EQ(RoundToNearest(Rational(kLeast) * 3 / 2), 2 * kLeast);
  EXPECT_EQ(RoundToNearest(Rational(std::numeric_limits<double>::max()) * 2), std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace lcpbench
