#include "solvers/rows/fixed_size_bpp.h"

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include "tests/solvers/step/random_step.h"

namespace lcpbench {
namespace {

// The gaps of the solution, which are unique, by trying every active set with Eigen.
Eigen::VectorXd GapsByEnumeration(const LcpProblem& problem) {
  const Index n = problem.size();
  const Eigen::MatrixXd& A = problem.DenseA();
  const Eigen::VectorXd& b = problem.b();
  Eigen::VectorXd best = Eigen::VectorXd::Zero(n);
  double least = std::numeric_limits<double>::infinity();
  for (unsigned set = 0; set < 1U << n; ++set) {
    std::vector<Index> active;
    for (Index i = 0; i < n; ++i) {
      if ((set >> i & 1U) != 0) active.push_back(i);
    }
    Eigen::VectorXd f = Eigen::VectorXd::Zero(n);
    if (!active.empty()) {
      const Eigen::MatrixXd block = A(active, active);
      const Eigen::VectorXd right = -b(active);
      const Eigen::VectorXd forces = block.completeOrthogonalDecomposition().solve(right);
      f(active) = forces;
    }
    const Eigen::VectorXd w = A * f + b;
    double worst = 0;
    for (Index i = 0; i < n; ++i) {
      worst = std::max(worst, std::abs(problem.is_bilateral(i) ? w[i] : std::min(w[i], A(i, i) * f[i])));
    }
    if (worst >= least) continue;
    least = worst;
    best = w;
  }
  EXPECT_LT(least, 1e-9 * (1 + b.norm()));
  return best;
}

class FixedSizeBppTest : public ::testing::TestWithParam<InstructionSet> {};

TEST_P(FixedSizeBppTest, FindsTheGapsThatEnumerationFinds) {
  const FixedSizeBpp solver(GetParam());
  constexpr double kTolerance = 1e-6;
  const double row_limit = 0.1 * std::sqrt(kTolerance);
  int solved = 0;
  int asked = 0;
  for (unsigned seed = 0; seed < 600; ++seed) {
    const Index n = 1 + seed % FixedSizeBpp::kMostRows;
    const StepArrays arrays = RandomStep(n, 1 + seed / 6 % 5, seed % 4 == 3 ? 6 : 3, seed);
    const StepRows rows = arrays.View();
    const LcpProblem problem = ProblemOf(rows);
    if (problem.DiagonalA().minCoeff() <= 0) continue;
    std::vector<std::int32_t> part(static_cast<std::size_t>(n));
    std::iota(part.begin(), part.end(), 0);
    Eigen::VectorXd f = Eigen::VectorXd::Zero(n);
    Eigen::VectorXd w = Eigen::VectorXd::Zero(n);
    double rho = 0;
    ++asked;
    if (!solver.Solve(rows, part, kTolerance, row_limit, f.data(), w.data(), &rho)) continue;
    ++solved;
    const double size = 1 + problem.b().norm();
    EXPECT_LT((problem.DenseA() * f + problem.b() - w).norm(), 1e-12 * size) << seed;
    EXPECT_LT((w - GapsByEnumeration(problem)).norm(), 1e-9 * size) << seed;
    EXPECT_LE(rho, kTolerance);
  }
  EXPECT_GT(asked, 200);
  EXPECT_GT(solved, asked * 9 / 10);
}

INSTANTIATE_TEST_SUITE_P(EveryInstructionSet, FixedSizeBppTest, ::testing::ValuesIn(AvailableInstructionSets()),
                         ::testing::PrintToStringParamName());

}  // namespace
}  // namespace lcpbench
