// Which of several solvers' answers is taken: by the verdict of the verifier, which SolversInTurn does not know.

#include "solvers/peers/solvers_in_turn.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <random>
#include <vector>

#include "solvers/lcp/verify.h"
#include "tests/solvers/solve_with.h"
#include "tests/solvers/test_problems.h"

namespace lcpbench {
namespace {

// Answers with what it was given, and claims success.
class Fixed : public LcpSolver {
 public:
  explicit Fixed(Eigen::VectorXd f, LcpStatus status = LcpStatus::kSolved) : f_(std::move(f)), status_(status) {}
  int solves() const { return solves_; }

 protected:
  void DoPrepare(const LcpProblem& /*problem*/) override {}
  void DoSolve(const LcpProblem& /*problem*/, const LcpOptions& /*options*/, LcpResult* result) override {
    ++solves_;
    result->f = f_;
    result->status = status_;
  }

 private:
  Eigen::VectorXd f_;
  LcpStatus status_;
  int solves_ = 0;
};

constexpr LcpOptions kOptions{.tolerance = 1e-6};

TEST(SolversInTurn, AnswersWithTheFirstThatPassesElseWithTheLeastRho) {
  std::mt19937_64 random(7);
  const auto auto_solver = MakeSolver("auto");
  int passed = 0;
  for (const TestProblem& test : GeneratedProblems()) {
    const Eigen::VectorXd right = SolveWith(auto_solver.get(), test.problem).f;
    std::array<double, 4> errors{1e-12, 1e-2, 1e-1, 1};
    std::shuffle(errors.begin(), errors.end(), random);
    std::vector<std::shared_ptr<Fixed>> fixed;
    std::vector<SolversInTurn::Turn> turns;
    std::size_t expected = 0;
    std::vector<Verdict> verdicts;
    for (const double error : errors) {
      Eigen::VectorXd f = right;
      for (double& force : f) force += error * (1 + std::abs(force)) * Uniform(&random, 0.5, 1);
      fixed.push_back(std::make_shared<Fixed>(f));
      turns.push_back({fixed.back()});
      verdicts.push_back(Verify(test.problem, Claim(f), kOptions.tolerance));
      const std::size_t at = verdicts.size() - 1;
      if (verdicts[expected].passes) continue;
      if (verdicts[at].passes || verdicts[at].metrics.rho < verdicts[expected].metrics.rho) expected = at;
    }
    SolversInTurn solver(turns);
    const bool passes = verdicts[expected].passes;
    passed += passes ? 1 : 0;
    for (const LcpResult& result :
         {SolveWith(&solver, test.problem, kOptions), SolveArraysWith(&solver, test.problem, kOptions)}) {
      const auto taken = std::find_if(fixed.begin(), fixed.end(), [&](const auto& one) {
        return SolveWith(one.get(), test.problem, kOptions).f == result.f;
      });
      EXPECT_EQ(taken - fixed.begin(), static_cast<std::ptrdiff_t>(expected)) << test.problem.id();
      EXPECT_EQ(result.status, passes ? LcpStatus::kSolved : LcpStatus::kNumericalFailure) << test.problem.id();
    }
  }
  EXPECT_GT(passed, 0);
}

// Keeps the problem that it is asked.
class Asked : public LcpSolver {
 public:
  const LcpProblem& problem() const { return *problem_; }

 protected:
  void DoPrepare(const LcpProblem& /*problem*/) override {}
  void DoSolve(const LcpProblem& problem, const LcpOptions& /*options*/, LcpResult* result) override {
    problem_ = problem;
    result->f.setConstant(problem.size(), 1e3);
    result->status = LcpStatus::kInfeasible;
  }

 private:
  std::optional<LcpProblem> problem_;
};

TEST(SolversInTurn, ATurnWithAShiftIsAskedAPlusSIInTheGivenForm) {
  for (const TestProblem& test : GeneratedProblems()) {
    const Eigen::VectorXd wrong = Eigen::VectorXd::Constant(test.problem.size(), 1e6);
    for (const bool from_arrays : {false, true}) {
      const auto asked = std::make_shared<Asked>();
      SolversInTurn solver({{std::make_shared<Fixed>(wrong)}, {asked, 1e-3}});
      const LcpResult result =
          from_arrays ? SolveArraysWith(&solver, test.problem, kOptions) : SolveWith(&solver, test.problem, kOptions);
      Eigen::MatrixXd expected = test.problem.DenseA();
      const double s = 1e-3 * expected.diagonal().cwiseAbs().maxCoeff();
      expected.diagonal().array() += s;
      EXPECT_LE((asked->problem().DenseA() - expected).norm(), 1e-12 * expected.norm()) << test.problem.id();
      EXPECT_EQ(asked->problem().given_form(), test.problem.given_form()) << test.problem.id();
      // What it says of A + s I is not said of A.
      EXPECT_NE(result.status, LcpStatus::kInfeasible) << test.problem.id();
    }
  }
}

TEST(SolversInTurn, TakesNoAnswerThatIsNotANumber) {
  const LcpProblem problem = PlantedProblem(8, 4, 1, 0, 0).problem;
  const Eigen::VectorXd right = SolveBy("auto", problem).f;
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    for (Index row = 0; row < problem.size(); ++row) {
      Eigen::VectorXd f = right;
      f[row] = bad;
      SolversInTurn alone({{std::make_shared<Fixed>(f)}});
      EXPECT_EQ(SolveWith(&alone, problem, kOptions).status, LcpStatus::kNumericalFailure);
      SolversInTurn both({{std::make_shared<Fixed>(f)}, {std::make_shared<Fixed>(right)}});
      EXPECT_EQ(SolveWith(&both, problem, kOptions).f, right);
    }
  }
}

TEST(SolversInTurn, AsksNobodyAfterAnAnswerAClaimOrTheTimeLimit) {
  const LcpProblem problem = PlantedProblem(8, 4, 1, 0, 0).problem;
  const Eigen::VectorXd wrong = Eigen::VectorXd::Constant(problem.size(), 1e3);
  const Eigen::VectorXd right = SolveBy("auto", problem).f;
  const auto asked = [&](const Eigen::VectorXd& f, LcpStatus status, LcpStatus expected) {
    const auto second = std::make_shared<Fixed>(right);
    SolversInTurn solver({{std::make_shared<Fixed>(f, status)}, {second}});
    EXPECT_EQ(SolveWith(&solver, problem, kOptions).status, expected);
    return second->solves();
  };
  EXPECT_EQ(asked(right, LcpStatus::kIterationLimit, LcpStatus::kSolved), 0);
  EXPECT_EQ(asked(wrong, LcpStatus::kInfeasible, LcpStatus::kInfeasible), 0);
  EXPECT_EQ(asked(wrong, LcpStatus::kUnsupported, LcpStatus::kUnsupported), 0);
  EXPECT_EQ(asked(wrong, LcpStatus::kTimeLimit, LcpStatus::kTimeLimit), 0);
  EXPECT_EQ(asked(wrong, LcpStatus::kSolved, LcpStatus::kSolved), 1);
  EXPECT_EQ(asked(wrong, LcpStatus::kNumericalFailure, LcpStatus::kSolved), 1);
}

}  // namespace
}  // namespace lcpbench
