// What doubles say of the set of solutions, against exact answers.

#include <gtest/gtest.h>

#include <string>

#include "solvers/exact/exact_lcp.h"
#include "solvers/exact/exact_solver.h"
#include "solvers/exact/unique_forces.h"
#include "solvers/pivoting/least_norm.h"
#include "support/input_error.h"
#include "tests/solvers/exact_problems.h"
#include "tests/solvers/solve_with.h"

namespace lcpbench {
namespace {

constexpr unsigned kProblemsOfFamily = 60;

// Calls visit(problem, a solution in double, the exact answer) for every solvable family.
template <typename Visit>
void ForEachSolved(Visit&& visit) {
  for (const ExactFamily& family : SolvableFamilies()) {
    for (unsigned seed = 1; seed <= kProblemsOfFamily; ++seed) {
      const LcpProblem problem = family.make(seed).problem;
      const LcpResult result = SolveBy("auto", problem, 1e-9);
      if (result.status != LcpStatus::kSolved) continue;
      const ExactAnswer exact = SolveExactly(ExactFrom(problem), {});
      if (exact.status != ExactAnswer::Status::kSolved || exact.f_least_norm.empty() || !exact.f_unique) continue;
      visit(std::string(family.name) + " " + std::to_string(seed), problem, result.f, exact);
    }
  }
}

TEST(LeastNormForces, AreTheExactOnes) {
  int compared = 0;
  int redundant = 0;
  ForEachSolved(
      [&](const std::string& name, const LcpProblem& problem, const Eigen::VectorXd& f, const ExactAnswer& exact) {
        const LeastNormForces found = FindLeastNormForces(problem, f);
        ASSERT_EQ(found.status, LcpStatus::kSolved) << name << ": " << found.detail;
        Eigen::VectorXd expected(problem.size());
        for (Index i = 0; i < problem.size(); ++i) {
          expected[i] = RoundToNearest(exact.f_least_norm[static_cast<std::size_t>(i)]);
        }
        EXPECT_LT((found.f - expected).norm(), 1e-6 * (1 + expected.norm())) << name;
        EXPECT_LE(found.f.norm(), f.norm() * (1 + 1e-8)) << name;
        ++compared;
        redundant += *exact.f_unique ? 0 : 1;
      });
  EXPECT_GT(compared, 200);
  EXPECT_GT(redundant, 50);
}

TEST(UniqueForces, NeverContradictsTheExactAnswer) {
  int yes = 0;
  int no = 0;
  int unknown = 0;
  ForEachSolved(
      [&](const std::string& name, const LcpProblem& problem, const Eigen::VectorXd& f, const ExactAnswer& exact) {
        const std::optional<bool> found = UniqueForces(problem, f);
        EXPECT_EQ(found.value_or(*exact.f_unique), *exact.f_unique) << name;
        (found ? (*found ? yes : no) : unknown)++;
      });
  EXPECT_GT(yes, 50);
  EXPECT_GT(no, 50);
  EXPECT_LT(unknown, yes + no);
}

TEST(LeastNormForces, RefuseWhatTheyAreNotFor) {
  const Eigen::Vector2d b(-1, -1);
  Eigen::Matrix2d A;
  A << 1, 2, 2, 1;
  const LcpProblem indefinite = LcpProblem::FromDense("", A, b);
  EXPECT_EQ(FindLeastNormForces(indefinite, Eigen::Vector2d(1, 0)).status, LcpStatus::kUnsupported);
  const LcpProblem good = LcpProblem::FromDense("", Eigen::Matrix2d::Identity(), b);
  EXPECT_EQ(FindLeastNormForces(good, Eigen::Vector2d(5, 5)).status, LcpStatus::kNumericalFailure);
  EXPECT_EQ(FindLeastNormForces(good, Eigen::Vector2d(1, 1)).status, LcpStatus::kSolved);
  EXPECT_THROW(FindLeastNormForces(good, Eigen::VectorXd::Ones(3)), InputError);
  EXPECT_THROW(FindLeastNormForces(good, Eigen::Vector2d(1, 1), {.rank_tolerance = 0}), InputError);
  const LcpProblem none = LcpProblem::FromDense("", Eigen::MatrixXd(0, 0), Eigen::VectorXd(0));
  EXPECT_EQ(FindLeastNormForces(none, Eigen::VectorXd(0)).status, LcpStatus::kSolved);
}

}  // namespace
}  // namespace lcpbench
