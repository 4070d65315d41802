#include "benchmarks/collection/recipes/formulas.h"

#include <Eigen/Eigenvalues>

#include "benchmarks/collection/content_hash.h"
#include "benchmarks/collection/plan.h"
#include "benchmarks/collection/recipes/recipe.h"
#include "solvers/exact/modes/mode_search.h"
#include "solvers/exact/sparse_rank.h"
#include "solvers/registry.h"
#include "support/input_error.h"
#include "tests/support/test.h"

namespace lcpbench {
namespace {

Eigen::VectorXd SolutionOf(const LcpProblem& problem) {
  LcpOptions options;
  options.tolerance = 1e-12;
  LcpResult result;
  MakeSolver("auto")->Solve(problem, options, &result);
  EXPECT_EQ(result.status, LcpStatus::kSolved) << problem.id() << ": " << result.detail;
  return result.f;
}

double Energy(const LcpProblem& problem, const Eigen::VectorXd& f) {
  Eigen::VectorXd w;
  problem.ComputeW(f, &w);
  return f.dot(w + problem.b()) / 2;
}

// Every problem of the two tiers up to some size.
class FormulaTier : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Tiers, FormulaTier, testing::Values("literature", "nonsymmetric"),
                         [](const auto& test) { return test.param; });

TEST_P(FormulaTier, HasProblemsThatAreWhatIsSaidOfThem) {
  constexpr int kMostRows = 1100;
  constexpr int kMostRowsRanked = 130;
  for (const Candidate& candidate : PlanTier(GetParam()).problems) {
    const Recipe& recipe = candidate.recipe;
    if (recipe.rows > kMostRows) continue;
    const Instance instance = MakeInstance(recipe);
    const LcpProblem& problem = instance.problem;
    EXPECT_EQ(problem.id(), RecipeId(recipe));
    EXPECT_EQ(problem.size(), recipe.rows);
    EXPECT_EQ(ContentHash(MakeInstance(recipe).problem), ContentHash(problem)) << problem.id();
    EXPECT_EQ(problem.facts().positive_semidefinite, GetParam() == "literature") << problem.id();
    if (problem.facts().symmetric) {
      EXPECT_EQ(problem.Asymmetry(), 0) << problem.id();
    }
    if (problem.size() <= kMostRowsRanked) {
      EXPECT_EQ(SparseRank(problem.SparseA()), problem.facts().rank) << problem.id();
    }
    if (instance.known_f) {
      EXPECT_TRUE(GapsOfAnswer(problem, {instance.known_f->begin(), instance.known_f->end()})) << problem.id();
    }
  }
}

// Nothing above 0 beside the diagonal, and rows that are diagonally dominant, some of them strictly.
TEST(Formulas, OfVariationalInequalitiesAreMMatrices) {
  for (const char* key : {"obstacle", "torsion", "journal-bearing", "block-tridiagonal", "block-tridiagonal-skew"}) {
    for (const int rows : {4, 9, 100, 1024}) {
      const LcpProblem problem = MakeInstance({key, rows, 1, {}}).problem;
      const SparseMatrix& A = problem.SparseA();
      int strict = 0;
      for (Index i = 0; i < rows; ++i) {
        double off = 0;
        for (SparseMatrix::InnerIterator it(A, i); it; ++it) {
          if (it.col() == i) continue;
          EXPECT_LT(it.value(), 0) << key;
          off -= it.value();
        }
        EXPECT_GE(A.coeff(i, i), off * (1 - 1e-14)) << key << " row " << i;
        if (A.coeff(i, i) > off * 1.01) ++strict;
      }
      EXPECT_GT(strict, 0) << key;
    }
  }
}

// CUTE's OBSTCLAE, JNLBRNG2 and BIGGSB1 say their solutions' objective values; those of JNLBRNG2 are printed without
// their power of ten (papers have -4.1 for 10^4 points).
TEST(Formulas, HaveThePublishedObjectiveValues) {
  const auto obstacle = [](int points) {
    const int side = points - 2;
    const double h = 1.0 / (points - 1);
    const LcpProblem problem = MakeInstance({"obstacle", side * side, 1, {}}).problem;
    Eigen::VectorXd psi(problem.size());
    for (int i = 0; i < side; ++i) {
      for (int j = 0; j < side; ++j) psi[i * side + j] = std::sin(3.2 * h * (i + 1)) * std::sin(3.3 * h * (j + 1));
    }
    const Eigen::VectorXd u = psi + SolutionOf(problem);
    return u.dot(problem.SparseA() * u) / 2 - h * h * u.sum();
  };
  EXPECT_NEAR(obstacle(10), 1.397897560, 1e-8);
  EXPECT_NEAR(obstacle(23), 1.678027027, 1e-8);
  EXPECT_NEAR(obstacle(32), 1.748270031, 1e-8);
  const auto bearing = [](int points) {
    const LcpProblem problem =
        MakeInstance({"journal-bearing", (points - 2) * (points - 2), 1, {{"eccentricity", 0.5}}}).problem;
    return Energy(problem, SolutionOf(problem));
  };
  EXPECT_NEAR(bearing(10), -3.9528, 5e-5);
  EXPECT_NEAR(bearing(23), -4.1024, 5e-5);
  EXPECT_NEAR(bearing(32), -4.1249, 5e-5);
  const Instance biggs = MakeInstance({"biggsb1", 1000, 1, {}});
  const double at_bounds = 2 * (1 - 0.9) * (1 - 0.9);  // x = 0.9 everywhere
  EXPECT_NEAR(at_bounds + Energy(biggs.problem, *biggs.known_f), 0.015, 1e-15);
}

// The yielding bar: the angle of twist at which it begins, and |v| <= d.
TEST(Formulas, TorsionIsElasticAtSmallAnglesAndPlasticAtLarge) {
  const auto plastic = [](double angle) {
    const LcpProblem problem = MakeInstance({"torsion", 1024, 1, {{"angle", angle}}}).problem;
    const Eigen::VectorXd f = SolutionOf(problem);
    Eigen::VectorXd w;
    problem.ComputeW(f, &w);
    EXPECT_LE(f.maxCoeff(), 33 / 2.0);  // v >= 0: the bound that is left out is not met
    return (w.array() > 1e-9).count();
  };
  EXPECT_EQ(plastic(1), 0);
  const auto some = plastic(5);
  EXPECT_GT(some, 0);
  EXPECT_GT(plastic(10), some);
}

TEST(Formulas, DenseOnesHaveTheirDefiningProperties) {
  constexpr int kRows = 12;
  const Eigen::MatrixXd murty = MakeInstance({"murty", kRows, 1, {}}).problem.DenseA();
  EXPECT_EQ(MakeInstance({"fathi", kRows, 1, {}}).problem.DenseA(), murty * murty.transpose());
  const Eigen::MatrixXd hilbert = MakeInstance({"hilbert", kRows, 1, {}}).problem.DenseA();
  for (int i = 0; i < kRows; ++i) {
    for (int j = 0; j < kRows; ++j) EXPECT_EQ(hilbert(i, j) * (i + j + 1), hilbert(0, 0));
  }
  const Eigen::MatrixXd random = MakeInstance({"harker-pang-skew", kRows, 1, {}}).problem.DenseA();
  const Eigen::MatrixXd part = random + random.transpose();
  EXPECT_GT(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(part).eigenvalues()[0], 0);
  EXPECT_NE(random, random.transpose());
}

TEST(Formulas, MistakesAreTold) {
  const std::vector<Recipe> kBad{{"obstacle", 10, 1, {}},
                                 {"hilbert", 21, 1, {}},
                                 {"fathi", 1, 1, {}},
                                 {"fathi", 5, 1, {{"slack", 1}}},
                                 {"torsion", 4, 1, {{"angle", -1}}},
                                 {"torsion", 4, 1, {{"load", 1}}}};
  for (const Recipe& recipe : kBad) EXPECT_THROW(MakeInstance(recipe), InputError) << RecipeId(recipe);
}

}  // namespace
}  // namespace lcpbench
