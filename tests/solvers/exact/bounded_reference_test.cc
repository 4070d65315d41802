// Bounds are compared with exact answers: none may be below the error that it bounds, whatever it was made from.

#include "solvers/exact/bounded_reference.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "benchmarks/measure/reference_solves.h"
#include "model/contact/assembly.h"
#include "model/scenes/scene.h"
#include "solvers/exact/exact_solver.h"
#include "solvers/exact/mode_system.h"
#include "support/input_error.h"
#include "tests/solvers/solve_with.h"
#include "tests/solvers/test_problems.h"

namespace lcpbench {
namespace {

using Proof = BoundedReference::Proof;

Rational Square(const Rational& x) { return x * x; }

Rational Diagonal(const ExactLcp& lcp, Index i) {
  const Rational& diagonal = lcp.A[At(i * lcp.size + i)];
  return diagonal > 0 ? diagonal : Rational(1);
}

// |f - g|_A^2
Rational EnergyOfDifference(const ExactLcp& lcp, const std::vector<Rational>& f, const std::vector<Rational>& g) {
  const std::vector<Rational> w_f = GapsOf(lcp, f);
  const std::vector<Rational> w_g = GapsOf(lcp, g);
  Rational energy = 0;
  for (size_t i = 0; i < f.size(); ++i) energy += (f[i] - g[i]) * (w_f[i] - w_g[i]);
  return energy;
}

Rational SquaredShift(const ExactLcp& lcp, const std::vector<Rational>& w, const std::vector<Rational>& feasible) {
  Rational sum = 0;
  for (Index i = 0; i < lcp.size; ++i) sum += Square(feasible[At(i)] - w[At(i)]) / Diagonal(lcp, i);
  return sum;
}

ExactLcp WithGaps(ExactLcp lcp, const std::vector<Rational>& w, const std::vector<Rational>& feasible) {
  for (size_t i = 0; i < w.size(); ++i) lcp.b[i] += feasible[i] - w[i];
  return lcp;
}

ExactAnswer Exactly(const ExactLcp& lcp) { return SolveExactly(lcp, {.answer_only = true, .guess = GuessBySolvers}); }

double SizeOfLoads(const LcpProblem& problem) {
  const auto root = [](double diagonal) { return diagonal > 0 ? std::sqrt(diagonal) : 1; };
  return problem.b().cwiseQuotient(problem.DiagonalA().unaryExpr(root)).norm();
}

// Every statement of the reference, against the exact answer of the problem that it names.
void ExpectProved(const LcpProblem& problem, const BoundedReference& reference) {
  const ExactLcp lcp = ExactFrom(problem);
  const std::vector<Rational> w = GapsOf(lcp, reference.f);
  if (reference.proof == Proof::kNearbyProblem) {
    std::vector<Rational> feasible(w.size());
    for (Index i = 0; i < lcp.size; ++i) {
      const bool keeps = lcp.bilateral[At(i)] == 0 && reference.f[At(i)] == 0 && w[At(i)] > 0;
      if (keeps) feasible[At(i)] = w[At(i)];
      EXPECT_EQ(reference.w[i], RoundToNearest(feasible[At(i)]));
    }
    ExactAnswer claimed;
    claimed.status = ExactAnswer::Status::kSolved;
    claimed.f = reference.f;
    claimed.w = feasible;
    EXPECT_EQ(FindFault(WithGaps(lcp, w, feasible), claimed), "");
    EXPECT_LE(SquaredShift(lcp, w, feasible), Square(Rational(reference.energy_shift)));
    EXPECT_EQ(reference.energy_bound, 0);
    EXPECT_EQ(reference.w_bound, 0);
    return;
  }
  EXPECT_EQ(reference.energy_shift, 0);
  const ExactAnswer answer = Exactly(lcp);
  ASSERT_EQ(answer.status, ExactAnswer::Status::kSolved);
  EXPECT_LE(EnergyOfDifference(lcp, reference.f, answer.f), Rational(reference.energy_bound));
  const Rational unit_roundoff(std::numeric_limits<double>::epsilon() / 2);
  for (Index i = 0; i < lcp.size; ++i) {
    const bool active = reference.proof == Proof::kActiveRows && (reference.f[At(i)] != 0 || lcp.bilateral[At(i)] != 0);
    const Rational gap = active ? Rational(0) : w[At(i)];
    EXPECT_LE(Square(gap - answer.w[At(i)]), Diagonal(lcp, i) * Square(Rational(reference.w_bound)));
    EXPECT_EQ(reference.w[i], RoundToNearest(gap));
    if (reference.proof != Proof::kActiveRows) continue;
    EXPECT_EQ(answer.w[At(i)] == 0, active);
    EXPECT_LE(Diagonal(lcp, i) * Square(reference.f[At(i)] - answer.f[At(i)]),
              Square(Rational(reference.f_bound.value())));
  }
}

TEST(BoundedReference, BoundsOfScenesHold) {
  int problems = 0;
  int as_given = 0;
  for (const SceneFamily& scene : AllScenes()) {
    for (const int size : {10, 30, 60}) {
      for (const std::uint64_t seed : {1U, 2U}) {
        const LcpProblem problem = AssembleContactLcp(GenerateScene(scene.key, size, seed)).problem;
        SCOPED_TRACE(problem.id());
        const BoundedReference reference = RefineReference(problem, SolveBy("auto", problem, 1e-12).f, {});
        ExpectProved(problem, reference);
        ++problems;
        if (reference.proof == Proof::kNearbyProblem) {
          EXPECT_LE(reference.energy_shift, 1e-15 * SizeOfLoads(problem));
          continue;
        }
        EXPECT_LE(reference.w_bound, 1e-40 * SizeOfLoads(problem));
        ++as_given;
      }
    }
  }
  EXPECT_GE(as_given, problems * 9 / 10);
}

TEST(BoundedReference, BoundsOfGeneratedProblemsHold) {
  for (const TestProblem& test : GeneratedProblems()) {
    if (test.problem.size() > 40) continue;
    SCOPED_TRACE(test.problem.id());
    ExpectProved(test.problem, RefineReference(test.problem, SolveBy("dantzig", test.problem, 1e-9).f, {}));
    // Degenerate forces that are 0 to the last digit.
    ExactSolver exact;
    ExpectProved(test.problem, RefineReference(test.problem, SolveWith(&exact, test.problem).f, {}));
  }
}

// Forces of no solver: proofs may be poorer, and must hold.
TEST(BoundedReference, BoundsHoldFromAnyStart) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> part(0, 1);
  for (const SceneFamily& scene : AllScenes()) {
    const LcpProblem problem = AssembleContactLcp(GenerateScene(scene.key, 24, 1)).problem;
    const Eigen::VectorXd solved = SolveBy("auto", problem, 1e-9).f;
    for (const double spoilt : {1e-6, 1e-2, 1.0}) {
      SCOPED_TRACE(problem.id() + " " + std::to_string(spoilt));
      Eigen::VectorXd start = solved;
      for (double& force : start) force += spoilt * (part(random) - 0.5) * solved.cwiseAbs().maxCoeff();
      ExpectProved(problem, RefineReference(problem, start, {}));
    }
    ExpectProved(problem, RefineReference(problem, Eigen::VectorXd::Zero(24), {}));
    ExpectProved(problem, RefineReference(problem, solved, {.time_limit_s = 0}));
  }
}

// The bearing is one rounding away from a solution; nothing may be said of what it has not.
TEST(BoundedReference, ProblemsWithoutASolutionAreNeverBoundedAsGiven) {
  int infeasible = 0;
  for (const int size : {30, 40, 60, 80}) {
    for (const std::uint64_t seed : {1U, 2U, 3U}) {
      const LcpProblem problem = AssembleContactLcp(GenerateScene("roller-bearing", size, seed)).problem;
      if (Exactly(ExactFrom(problem)).status != ExactAnswer::Status::kInfeasible) continue;
      ++infeasible;
      const BoundedReference reference = RefineReference(problem, SolveBy("auto", problem, 1e-12).f, {});
      EXPECT_EQ(reference.proof, Proof::kNearbyProblem);
      EXPECT_GT(reference.energy_shift, 0);
      ExpectProved(problem, reference);
    }
  }
  EXPECT_GT(infeasible, 0);
}

// Redundant rows, of which the last digits decide: with pivots as given, without them nearby.
TEST(BoundedReference, PivotsTellWhichOfTheDependentRowsAreActive) {
  int told = 0;
  for (const char* key : {"discs-in-v", "boxes-and-discs", "rounded-wall", "billiards-break", "tall-stacks"}) {
    for (const std::uint64_t seed : {1U, 2U, 3U}) {
      const LcpProblem problem = AssembleContactLcp(GenerateScene(key, 120, seed)).problem;
      SCOPED_TRACE(problem.id());
      const Eigen::VectorXd start = SolveBy("auto", problem, 1e-12).f;
      const BoundedReference with = RefineReference(problem, start, {});
      ExpectProved(problem, with);
      const BoundedReference without = RefineReference(problem, start, {.most_dependent_rows = 0});
      ExpectProved(problem, without);
      EXPECT_EQ(without.pivots, 0);
      told += with.pivots > 0 && with.proof == Proof::kActiveRows && without.dependent > 0 ? 1 : 0;
    }
  }
  EXPECT_GE(told, 3);
}

TEST(BoundedReference, ADegenerateRowIsStillBoundedAsGiven) {
  // Row 1 has f = w = 0, which no rounding can tell from rows that are open or closed.
  const LcpProblem problem =
      LcpProblem::FromFactors("degenerate", Eigen::MatrixXd(Eigen::MatrixXd::Identity(3, 3)).sparseView(),
                              Eigen::Vector3d(1, 1, 0.1), Eigen::Vector3d(-1, 0, -0.3));
  const BoundedReference reference = RefineReference(problem, Eigen::Vector3d(1, 0, 3), {});
  EXPECT_EQ(reference.proof, Proof::kFeasiblePoint) << reference.detail;
  ExpectProved(problem, reference);
  EXPECT_LE(reference.w_bound, 1e-20);
}

TEST(BoundedReference, TakesAllFormsOfAProblem) {
  for (const int size : {15, 40}) {
    const LcpProblem given = AssembleContactLcp(GenerateScene("ovals-in-bowl", size, 1)).problem;
    for (const LcpProblem& problem : {InForm(given, MatrixForm::kDense), InForm(given, MatrixForm::kSparse)}) {
      SCOPED_TRACE(problem.id());
      const BoundedReference reference = RefineReference(problem, SolveBy("dantzig", problem, 1e-12).f, {});
      EXPECT_EQ(reference.proof, Proof::kActiveRows);
      ExpectProved(problem, reference);
    }
  }
}

TEST(BoundedReference, RefusesWhatItCannotBound) {
  const Eigen::VectorXd one = Eigen::VectorXd::Ones(2);
  const auto refine = [&one](const Eigen::MatrixXd& A, MatrixFacts facts) {
    RefineReference(LcpProblem::FromDense("small", A, -one, {}, facts), one, {});
  };
  MatrixFacts semidefinite;
  semidefinite.positive_semidefinite = true;
  EXPECT_NO_THROW(refine(Eigen::MatrixXd::Identity(2, 2), semidefinite));
  EXPECT_THROW(refine(Eigen::MatrixXd::Identity(2, 2), {}), InputError);
  EXPECT_THROW(refine((Eigen::MatrixXd(2, 2) << 2, 1, 1 + 1e-15, 2).finished(), semidefinite), InputError);
  const LcpProblem problem = LcpProblem::FromDense("small", Eigen::MatrixXd::Identity(2, 2), -one, {}, semidefinite);
  EXPECT_THROW(RefineReference(problem, Eigen::VectorXd::Ones(3), {}), InputError);
  EXPECT_THROW(RefineReference(problem, Eigen::VectorXd::Constant(2, std::nan("")), {}), InputError);
}

}  // namespace
}  // namespace lcpbench
