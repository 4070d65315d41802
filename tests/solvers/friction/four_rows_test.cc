// The LCP of four rows has the solutions of the problem, each as known from elsewhere, and no others.
#include "solvers/friction/four_rows.h"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "solvers/lcp/verify.h"
#include "tests/solvers/friction/friction_records.h"
#include "tests/solvers/friction/friction_suite.h"
#include "tests/solvers/solve_with.h"

namespace lcpbench {
namespace {

// rho in the LCP of forces of the problem.
double RhoOfForces(const FourRows& four, const LcpProblem& problem, const Eigen::VectorXd& f) {
  return ComputeMetrics(four.lcp(), four.VariablesOf(f, ComputeMetrics(problem, f).w)).rho;
}

bool IsTaken(const LcpProblem& problem) {
  const FourRowSolver solver(WithinOptions{[] { return MakeSolver("auto"); }});
  return solver.WhyRefused(problem).empty();
}

TEST(FourRows, KnownSolutionsSolveTheLcp) {
  int solutions = 0;
  for (const FrictionRecord& record : FrictionRecords()) {
    if (!IsTaken(record.problem())) continue;
    const FourRows four(record.problem());
    EXPECT_FALSE(four.lcp().facts().symmetric);
    for (const Eigen::VectorXd& f : KnownSolutions(record)) {
      ++solutions;
      EXPECT_LE(RhoOfForces(four, record.problem(), f), 1e-12) << record.problem().id();
      const Eigen::VectorXd back = four.ForcesOf(four.VariablesOf(f, Eigen::VectorXd::Zero(f.size())));
      EXPECT_LE((back - f).norm(), 1e-14 * f.norm()) << record.problem().id();
    }
  }
  EXPECT_GE(solutions, 80);
}

TEST(FourRows, AnswersOfAutoSolveTheLcpAndOthersDoNot) {
  for (unsigned seed = 0; seed < 60; ++seed) {
    const LcpProblem problem = RandomFrictionProblem(600 + seed, 12);
    const LcpResult result = SolveBy("auto", problem, 1e-9);
    ASSERT_EQ(result.status, LcpStatus::kSolved) << seed;
    const FourRows four(problem);
    EXPECT_LE(RhoOfForces(four, problem, result.f), 1e-8) << seed;
    for (const FrictionRow& row : problem.friction_rows()) {
      if (!(row.mu * result.f[row.normal] > 1e-3 * result.f.norm())) continue;
      Eigen::VectorXd wrong = result.f;
      wrong[row.row] += wrong[row.row] > 0 ? -3 * row.mu * wrong[row.normal] : 3 * row.mu * wrong[row.normal];
      EXPECT_GT(RhoOfForces(four, problem, wrong), 1e-6) << seed;
    }
  }
}

// Every complementary basis of problems of up to two contacts: what solves the LCP solves the problem.
TEST(FourRows, SolutionsOfTheLcpSolveTheProblem) {
  int solutions = 0;
  for (unsigned seed = 0; seed < 40; ++seed) {
    const LcpProblem problem = RandomFrictionProblem(700 + seed, 2);
    const LcpProblem lcp = FourRows(problem).lcp();
    std::vector<Index> free;
    for (Index row = 0; row < lcp.size(); ++row) {
      if (!lcp.is_bilateral(row)) free.push_back(row);
    }
    for (std::uint32_t set = 0; set < 1U << free.size(); ++set) {
      std::vector<Index> basis = lcp.bilateral_rows();
      for (std::size_t k = 0; k < free.size(); ++k) {
        if ((set >> k & 1U) != 0) basis.push_back(free[k]);
      }
      const Eigen::FullPivLU<Eigen::MatrixXd> lu(lcp.DenseA()(basis, basis));
      if (!lu.isInvertible()) continue;
      Eigen::VectorXd variables = Eigen::VectorXd::Zero(lcp.size());
      variables(basis) = -lu.solve(Eigen::VectorXd(lcp.b()(basis)));
      if (!(ComputeMetrics(lcp, variables).rho < 1e-13)) continue;
      ++solutions;
      EXPECT_LE(ComputeMetrics(problem, FourRows(problem).ForcesOf(variables)).rho, 1e-11) << seed << " " << set;
    }
  }
  EXPECT_GE(solutions, 40);
}

}  // namespace
}  // namespace lcpbench
