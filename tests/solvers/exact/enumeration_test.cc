#include "solvers/exact/modes/mode_search.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace lcpbench {
namespace {

using Status = ExactAnswer::Status;

LcpProblem Problem(const std::vector<std::vector<double>>& A, const std::vector<double>& b,
                   const std::vector<Index>& bilateral = {}) {
  const auto n = static_cast<Index>(b.size());
  Eigen::MatrixXd matrix(n, n);
  for (Index i = 0; i < n; ++i) {
    for (Index j = 0; j < n; ++j) matrix(i, j) = A[At(i)][At(j)];
  }
  return LcpProblem::FromDense("", matrix, Eigen::Map<const Eigen::VectorXd>(b.data(), n),
                               RowBounds::WithBilateralRows(n, bilateral));
}

TEST(Enumeration, KnowsWhatIsKnownOfSmallProblems) {
  const ExactAnswer none = SolveByEnumeration(Problem({{-1, 0}, {0, -1}}, {1, -1}), {});
  EXPECT_EQ(none.status, Status::kInfeasible);
  const ExactAnswer two = SolveByEnumeration(Problem({{1, 2}, {2, 1}}, {-1, -1}), {});
  EXPECT_EQ(two.status, Status::kSolved);
  EXPECT_EQ(two.f_unique, false);
  const ExactAnswer skew = SolveByEnumeration(Problem({{0, 1}, {-1, 0}}, {-1, 2}), {});
  EXPECT_EQ(skew.status, Status::kSolved);
  EXPECT_EQ(skew.f, (std::vector<Rational>{2, 1}));
  const ExactAnswer joint = SolveByEnumeration(Problem({{2, 1}, {1, 3}}, {4, 3}, {0}), {});
  EXPECT_EQ(joint.f, (std::vector<Rational>{-2, 0}));
  EXPECT_EQ(joint.w, (std::vector<Rational>{0, 1}));
  // Without a solution, on a singular A_FF: y.w = y.b < 0 for every f, by a ray with A^T y = 0.
  const ExactAnswer singular = SolveByEnumeration(Problem({{1, -1}, {-2, 2}}, {-1, -1}), {});
  EXPECT_EQ(singular.status, Status::kInfeasible);
  EXPECT_EQ(singular.ray, (std::vector<Rational>{Rational(2, 3), Rational(1, 3)}));
  // Several solutions on singular A_FF: f = (1 + t, t).
  const ExactAnswer line = SolveByEnumeration(Problem({{1, -1}, {-1, 1}}, {-1, 1}), {});
  EXPECT_EQ(line.status, Status::kSolved);
  EXPECT_EQ(line.f_unique, false);
  // Rows beyond those that are tried: a guess, or nothing.
  const Index n = 16;
  const LcpProblem many = LcpProblem::FromDense("", Eigen::MatrixXd::Identity(n, n), -Eigen::VectorXd::Ones(n));
  EXPECT_EQ(SolveByEnumeration(many, {}).status, Status::kUnknown);
  const ExactAnswer guessed = SolveByEnumeration(many, {Eigen::VectorXd::Ones(n)});
  EXPECT_EQ(guessed.status, Status::kSolved);
  EXPECT_FALSE(guessed.f_unique.has_value());
}

// On symmetric positive definite matrices the exact method is another way to the same, only, answer.
TEST(Enumeration, AgreesWithTheExactMethodAndNeverTrustsAGuess) {
  std::mt19937 random(7);
  std::uniform_int_distribution<int> entry(-4, 4);
  for (int round = 0; round < 40; ++round) {
    const Index n = 1 + round % 6;
    const Eigen::MatrixXd M = Eigen::MatrixXd::NullaryExpr(n, n, [&] { return entry(random); });
    const Eigen::MatrixXd A = M.transpose() * M + Eigen::MatrixXd::Identity(n, n);
    const Eigen::VectorXd b = Eigen::VectorXd::NullaryExpr(n, [&] { return entry(random); });
    const LcpProblem problem = LcpProblem::FromDense("", A, b);
    const Eigen::VectorXd guess = Eigen::VectorXd::NullaryExpr(n, [&] { return entry(random); });
    const ExactAnswer answer = SolveByEnumeration(problem, {guess});
    const ExactAnswer exact = SolveExactly(ExactFrom(problem), {});
    ASSERT_EQ(answer.status, Status::kSolved);
    EXPECT_EQ(answer.f_unique, true);
    EXPECT_EQ(answer.f, exact.f);
    EXPECT_EQ(answer.w, exact.w);
    std::vector<Rational> other = answer.f;
    other[0] += 1;
    EXPECT_FALSE(GapsOfAnswer(problem, other).has_value());
  }
}

}  // namespace
}  // namespace lcpbench
