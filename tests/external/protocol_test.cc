#include "solvers/external/protocol.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <stdexcept>

#include "tests/solvers/test_problems.h"

namespace lcpbench {
namespace {

void ExpectSameProblem(const LcpProblem& p, const LcpProblem& q) {
  ASSERT_EQ(p.size(), q.size());
  EXPECT_EQ(p.b(), q.b());
  EXPECT_EQ(p.bilateral_rows(), q.bilateral_rows());
  EXPECT_EQ(p.facts().symmetric, q.facts().symmetric);
  EXPECT_EQ(p.facts().positive_semidefinite, q.facts().positive_semidefinite);
}

TEST(Protocol, ProblemsOfEveryFormComeBackBitForBit) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const LcpProblem problem = PlantedProblem(9, 4, seed, 2, 0).problem;
    const LcpProblem given = DecodeProblem(Encode(problem, WantedForm::kAsGiven));
    ExpectSameProblem(problem, given);
    EXPECT_EQ(given.given_form(), problem.given_form());
    const LcpProblem dense = DecodeProblem(Encode(problem, WantedForm::kDense));
    ExpectSameProblem(problem, dense);
    EXPECT_EQ(dense.DenseA(), problem.DenseA());
    const LcpProblem sparse = DecodeProblem(Encode(problem, WantedForm::kSparse));
    ExpectSameProblem(problem, sparse);
    EXPECT_EQ(Eigen::MatrixXd(sparse.SparseA()), Eigen::MatrixXd(problem.SparseA()));
    if (problem.has_factors()) {
      EXPECT_EQ(Eigen::MatrixXd(given.J()), Eigen::MatrixXd(problem.J()));
      EXPECT_EQ(given.inverse_mass(), problem.inverse_mass());
    }
  }
}

TEST(Protocol, AnswersComeBackBitForBit) {
  LcpResult result;
  result.status = LcpStatus::kInfeasible;
  result.f = Eigen::Vector3d(1, -0.0, std::numeric_limits<double>::denorm_min());
  result.iterations = 12345678901LL;
  result.detail = "a ray";
  result.own_solve_s = 1e-6;
  result.own_convert_s = 2e-6;
  result.farkas_ray = Eigen::Vector3d(0, 1, 0);
  const LcpResult back = DecodeResult(Encode(result), 3);
  EXPECT_EQ(back.status, result.status);
  EXPECT_EQ(back.f, result.f);
  EXPECT_EQ(back.iterations, result.iterations);
  EXPECT_EQ(back.detail, result.detail);
  EXPECT_EQ(back.own_solve_s, result.own_solve_s);
  EXPECT_EQ(back.own_convert_s, result.own_convert_s);
  EXPECT_EQ(back.farkas_ray, result.farkas_ray);

  SolveRequest request{1e-6, 2.5, 7, 100, Eigen::VectorXd::Ones(3)};
  const SolveRequest asked = DecodeSolve(Encode(request), 3);
  EXPECT_EQ(asked.tolerance, request.tolerance);
  EXPECT_EQ(asked.time_limit_s, request.time_limit_s);
  EXPECT_EQ(asked.max_iterations, request.max_iterations);
  EXPECT_EQ(asked.repetitions, request.repetitions);
  EXPECT_EQ(asked.start, request.start);
}

// Whatever arrives, it is a message or a clear error: no crash, no allocation beyond what arrived.
TEST(Protocol, BrokenPayloadsAreErrors) {
  std::mt19937_64 random(1);
  for (const WantedForm form : {WantedForm::kAsGiven, WantedForm::kDense, WantedForm::kSparse}) {
    const Bytes good = Encode(PlantedProblem(6, 3, 1, 1, 0).problem, form);
    for (std::size_t size = 0; size < good.size(); ++size) {
      EXPECT_THROW(DecodeProblem(Bytes(good.begin(), good.begin() + static_cast<std::ptrdiff_t>(size))),
                   std::runtime_error);
    }
    int refused = 0;
    for (int i = 0; i < 3000; ++i) {
      Bytes bad = good;
      for (int k = 0; k < 3; ++k) bad[random() % bad.size()] = static_cast<char>(random());
      try {
        DecodeProblem(bad);
      } catch (const std::exception&) {
        ++refused;
      }
    }
    EXPECT_GT(refused, 0);
  }
  Bytes hello = Encode(Hello{2, WantedForm::kDense, "n", "v", "l"});
  EXPECT_THROW(DecodeHello(hello), std::runtime_error);
}

}  // namespace
}  // namespace lcpbench
