// What is particular to incremental pivoting; the contract that it shares with all solvers is in contract_test.cc.

#include "solvers/dantzig.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>
#include <vector>

#include "solvers/dense_ldlt.h"
#include "solvers/lcp/json_lines.h"
#include "solvers/lcp/verify.h"
#include "tests/solvers/allocation_count.h"
#include "tests/solvers/exact_problems.h"
#include "tests/solvers/test_problems.h"

namespace lcpbench {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr DantzigOrder kOrders[] = {DantzigOrder::kIndex, DantzigOrder::kMostNegative};

DantzigOptions WithOrder(DantzigOrder order) {
  DantzigOptions options;
  options.order = order;
  return options;
}

LcpResult Solve(const LcpProblem& problem, const LcpOptions& options = {}, DantzigOrder order = DantzigOrder::kIndex) {
  DantzigSolver solver(WithOrder(order));
  LcpResult result;
  solver.Solve(problem, options, &result);
  return result;
}

using Planted = TestProblem;

// ---------------------------------------------------------------------------------------------------------- the factor

MatrixXd Lower(const DenseLdlt& factor) {
  MatrixXd L = MatrixXd::Identity(factor.size(), factor.size());
  for (Index k = 0; k < factor.size(); ++k) {
    for (Index i = k + 1; i < factor.size(); ++i) L(i, k) = factor.lower(i, k);
  }
  return L;
}

void Enter(const MatrixXd& A, const std::vector<Index>& rows, Index row, DenseLdlt* factor) {
  VectorXd z(static_cast<Index>(rows.size()));
  for (Index k = 0; k < z.size(); ++k) z[k] = A(rows[static_cast<size_t>(k)], row);
  factor->ForwardSolve(z.data());
  factor->Append(z.data(), factor->PivotOf(z.data(), A(row, row)));
}

TEST(DenseLdlt, AFactorUpdatedManyTimesEqualsAFreshOne) {
  for (const Index n : {1, 2, 7, 8, 40}) {
    TestRandom random(static_cast<unsigned>(n));
    MatrixXd G(n, n + 2);
    for (Index i = 0; i < G.size(); ++i) G(i) = random.Integer(-9, 9);
    const MatrixXd A = G * G.transpose() + MatrixXd::Identity(n, n);
    DenseLdlt updated;
    updated.Reserve(n);
    updated.Reset(n);
    std::vector<Index> inside;
    std::vector<Index> outside(static_cast<size_t>(n));
    for (Index i = 0; i < n; ++i) outside[static_cast<size_t>(i)] = i;
    for (int change = 0; change < 400; ++change) {
      if (inside.empty() || (!outside.empty() && random.Chance(0.6))) {
        const auto pick = static_cast<size_t>(random.Integer(0, static_cast<int>(outside.size()) - 1));
        Enter(A, inside, outside[pick], &updated);
        inside.push_back(outside[pick]);
        outside.erase(outside.begin() + static_cast<std::ptrdiff_t>(pick));
      } else {
        const int pick = random.Integer(0, static_cast<int>(inside.size()) - 1);
        updated.Remove(pick);
        outside.push_back(inside[static_cast<size_t>(pick)]);
        inside.erase(inside.begin() + pick);
      }
    }
    DenseLdlt fresh;
    fresh.Reserve(n);
    fresh.Reset(n);
    std::vector<Index> entered;
    for (const Index row : inside) {
      Enter(A, entered, row, &fresh);
      entered.push_back(row);
    }
    ASSERT_EQ(updated.size(), fresh.size());
    if (fresh.size() == 0) continue;
    const double scale = A.diagonal().maxCoeff();
    for (Index k = 0; k < fresh.size(); ++k) EXPECT_NEAR(updated.pivot(k), fresh.pivot(k), 1e-11 * scale);
    EXPECT_LE((Lower(updated) - Lower(fresh)).cwiseAbs().maxCoeff(), 1e-11) << "n = " << n;
    VectorXd x = VectorXd::LinSpaced(fresh.size(), 1, 2);
    VectorXd back = VectorXd::Zero(fresh.size());
    const VectorXd right = x;
    updated.Solve(x.data());
    for (Index i = 0; i < x.size(); ++i) {
      for (Index j = 0; j < x.size(); ++j)
        back[i] += A(inside[static_cast<size_t>(i)], inside[static_cast<size_t>(j)]) * x[j];
    }
    EXPECT_LE((back - right).cwiseAbs().maxCoeff(), 1e-9);
  }
}

// --------------------------------------------------------------------------------------------------- exact outside
// data

TEST(Dantzig, FindsTheExactWOrAProvenRayForEveryOracleProblem) {
  const std::string path = std::string(LCPBENCH_SHARED_DIR) + "/data/oracle/lcp.jsonl";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is absent";
  const std::vector<LcpRecord> records = ReadLcpFile(path);
  for (const DantzigOrder order : kOrders) {
    DantzigSolver solver(WithOrder(order));
    for (const LcpRecord& record : records) {
      SCOPED_TRACE(record.problem.id());
      LcpResult result;
      solver.Solve(record.problem, {}, &result);
      const Verdict verdict = Verify(record.problem, result, 1e-9, &record.reference);
      if (record.reference.status == LcpReference::Status::kInfeasible) {
        EXPECT_EQ(result.status, LcpStatus::kInfeasible) << result.detail;
        ASSERT_TRUE(verdict.farkas.has_value());
        EXPECT_TRUE(verdict.farkas->accepted) << verdict.farkas->reason;
      } else {
        EXPECT_EQ(result.status, LcpStatus::kSolved) << result.detail;
        EXPECT_TRUE(verdict.passes) << verdict.reason;
        EXPECT_LE(verdict.metrics.rho, 1e-12) << "a direct method aims at rounding, whatever the tolerance";
        EXPECT_LE(verdict.metrics.w_error, 1e-8);
      }
    }
  }
}

TEST(Dantzig, SolvesTheUnitProblemsOfAnotherEngine) {
  const std::string path = std::string(LCPBENCH_SHARED_DIR) + "/data/myphysicslab/unit_problems.jsonl";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is absent";
  std::ifstream file(path);
  std::string line;
  int solved = 0;
  while (std::getline(file, line)) {
    if (line.find("\"compute_forces\"") == std::string::npos) continue;
    const LcpRecord record = ParseLcpRecord(line, path);
    const LcpResult result = Solve(record.problem);
    const Verdict verdict = Verify(record.problem, result, 1e-9);
    EXPECT_FALSE(verdict.false_success) << verdict.reason;
    if (result.status == LcpStatus::kSolved) ++solved;
  }
  EXPECT_GE(solved, 6);  // of 7: one of them misses its own null space by 1e-9
}

// ---------------------------------------------------------------------------------------------------- generated
// families

TEST(Dantzig, FindsPlantedSolutionsOfEveryRank) {
  for (const bool wide_masses : {false, true}) {
    for (const DantzigOrder order : kOrders) {
      DantzigSolver solver(WithOrder(order));
      for (unsigned seed = 0; seed < 1000; ++seed) {
        const Planted planted = PlantedExactly(seed, 30, wide_masses);
        SCOPED_TRACE(planted.problem.id() + (wide_masses ? " with wide masses" : ""));
        LcpResult result;
        solver.Solve(planted.problem, {}, &result);
        const Verdict verdict = Verify(planted.problem, result, 1e-9, &planted.reference);
        EXPECT_EQ(result.status, LcpStatus::kSolved) << result.detail;
        EXPECT_TRUE(verdict.passes) << verdict.reason;
        EXPECT_LE(verdict.metrics.w_error, 1e-8);
        EXPECT_LE(result.iterations, 12 * planted.problem.size() + 12);
      }
    }
  }
}

TEST(Dantzig, EndsOnFullyDegenerateProblems) {
  for (const DantzigOrder order : kOrders) {
    for (unsigned seed = 0; seed < 300; ++seed) {
      const LcpProblem problem = FullyDegenerate(seed, 30);
      const LcpResult result = Solve(problem, {}, order);
      EXPECT_EQ(result.status, LcpStatus::kSolved) << "seed " << seed << ": " << result.detail;
      EXPECT_TRUE(Verify(problem, result, 1e-9).passes) << "seed " << seed;
    }
  }
}

TEST(Dantzig, ProvesPlantedInfeasibility) {
  for (const DantzigOrder order : kOrders) {
    for (unsigned seed = 0; seed < 500; ++seed) {
      const LcpProblem problem = InfeasibleExactly(seed, 30);
      const LcpResult result = Solve(problem, {}, order);
      EXPECT_EQ(result.status, LcpStatus::kInfeasible) << "seed " << seed << ": " << result.detail;
      ASSERT_TRUE(result.farkas_ray.has_value()) << "seed " << seed;
      const FarkasVerdict verdict = VerifyFarkasRay(problem, *result.farkas_ray);
      EXPECT_TRUE(verdict.accepted) << "seed " << seed << ": " << verdict.reason;
    }
  }
}

TEST(Dantzig, ARowOfZerosIsRightOrProvedImpossible) {
  MatrixXd A = MatrixXd::Zero(3, 3);
  A(1, 1) = 2;
  const auto status = [&](double b0, double b2, const std::vector<Index>& bilateral) {
    const LcpProblem problem = LcpProblem::FromDense("zero-rows", A, Eigen::Vector3d(b0, -4, b2),
                                                     RowBounds::WithBilateralRows(3, bilateral), SymmetricPsd());
    const LcpResult result = Solve(problem);
    if (result.status == LcpStatus::kInfeasible) {
      EXPECT_TRUE(result.farkas_ray.has_value() && VerifyFarkasRay(problem, *result.farkas_ray).accepted);
    } else {
      EXPECT_DOUBLE_EQ(result.f[1], 2);
    }
    return result.status;
  };
  EXPECT_EQ(status(0, 5, {}), LcpStatus::kSolved);
  EXPECT_EQ(status(1, 0, {2}), LcpStatus::kSolved);
  EXPECT_EQ(status(-1, 5, {}), LcpStatus::kInfeasible);
  EXPECT_EQ(status(0, 5, {2}), LcpStatus::kInfeasible);
  EXPECT_EQ(status(0, -5, {2}), LcpStatus::kInfeasible);
}

TEST(Dantzig, ARedundantJointIsLeftOutOrProvedImpossible) {
  // Rows 0 and 1 are one joint written twice, row 2 a contact.
  MatrixXd A(3, 3);
  A << 1, -2, 0.5,  //
      -2, 4, -1,    //
      0.5, -1, 1;
  for (const double mismatch : {0.0, 1.0, -1.0}) {
    const LcpProblem problem = LcpProblem::FromDense("joint-twice", A, Eigen::Vector3d(3, -6 + mismatch, -2),
                                                     RowBounds::WithBilateralRows(3, {0, 1}), SymmetricPsd());
    const LcpResult result = Solve(problem);
    EXPECT_EQ(result.status, mismatch == 0 ? LcpStatus::kSolved : LcpStatus::kInfeasible);
    EXPECT_EQ(Verify(problem, result, 1e-9).passes, mismatch == 0);
    if (mismatch != 0) {
      ASSERT_TRUE(result.farkas_ray.has_value());
      EXPECT_TRUE(VerifyFarkasRay(problem, *result.farkas_ray).accepted);
    }
  }
}

// ------------------------------------------------------------------------------------------------------------
// invariance

TEST(Dantzig, PowersOfTwoChangeNoPivotAndNoBitOfTheAnswer) {
  for (const DantzigOrder order : kOrders) {
    for (unsigned seed = 0; seed < 200; ++seed) {
      const Planted planted = PlantedExactly(seed, 25, true);
      const Index n = planted.problem.size();
      const MatrixXd& A = planted.problem.DenseA();
      const VectorXd& b = planted.problem.b();
      const RowBounds bounds = RowBounds::WithBilateralRows(n, planted.problem.bilateral_rows());
      const LcpResult plain = Solve(planted.problem, {}, order);
      const auto expect_same = [&](const MatrixXd& other_A, const VectorXd& other_b, const VectorXd& force_unit) {
        const LcpResult other =
            Solve(LcpProblem::FromDense("rescaled", other_A, other_b, bounds, SymmetricPsd()), {}, order);
        EXPECT_EQ(other.status, plain.status) << "seed " << seed;
        EXPECT_EQ(other.iterations, plain.iterations) << "seed " << seed;
        EXPECT_TRUE(other.f == force_unit.cwiseProduct(plain.f)) << "seed " << seed;
      };
      const VectorXd ones = VectorXd::Ones(n);
      expect_same(std::ldexp(1.0, 41) * A, b, std::ldexp(1.0, -41) * ones);
      expect_same(A, std::ldexp(1.0, -39) * b, std::ldexp(1.0, -39) * ones);
      TestRandom random(seed);
      VectorXd S(n);
      for (Index i = 0; i < n; ++i) S[i] = std::ldexp(1.0, random.Integer(-20, 20));
      expect_same(S.asDiagonal() * A * S.asDiagonal(), S.cwiseProduct(b), S.cwiseInverse());
    }
  }
}

// ------------------------------------------------------------------------------------------------- limits and warm
// starts

TEST(Dantzig, WarmStartFromTheSolutionTakesFewPivots) {
  std::int64_t cold_pivots = 0;
  std::int64_t warm_pivots = 0;
  for (unsigned seed = 0; seed < 300; ++seed) {
    const Planted planted = PlantedExactly(seed, 30, false);
    const LcpResult cold = Solve(planted.problem);
    LcpOptions options;
    options.initial_f = &cold.f;
    const LcpResult warm = Solve(planted.problem, options);
    EXPECT_EQ(warm.status, LcpStatus::kSolved) << "seed " << seed << ": " << warm.detail;
    EXPECT_TRUE(Verify(planted.problem, warm, 1e-9).passes) << "seed " << seed;
    cold_pivots += cold.iterations;
    warm_pivots += warm.iterations;
  }
  EXPECT_LE(20 * warm_pivots, cold_pivots);
}

TEST(Dantzig, AWrongWarmStartDoesNoHarm) {
  for (unsigned seed = 0; seed < 300; ++seed) {
    const Planted planted = PlantedExactly(seed, 30, false);
    TestRandom random(seed + 1000);
    VectorXd start(planted.problem.size());
    for (Index i = 0; i < start.size(); ++i) start[i] = random.Integer(-3, 3);
    LcpOptions options;
    options.initial_f = &start;
    const LcpResult result = Solve(planted.problem, options);
    EXPECT_EQ(result.status, LcpStatus::kSolved) << "seed " << seed << ": " << result.detail;
    EXPECT_TRUE(Verify(planted.problem, result, 1e-9, &planted.reference).passes) << "seed " << seed;
  }
}

TEST(Dantzig, StopsAtItsLimitsWithNonnegativeForces) {
  const Index n = 12;
  const MatrixXd A = MatrixXd::Identity(n, n) + 0.1 * MatrixXd::Ones(n, n);
  const LcpProblem problem = LcpProblem::FromDense("limits", A, -VectorXd::Ones(n), {}, SymmetricPsd());
  LcpOptions options;
  options.max_iterations = 3;
  LcpResult result = Solve(problem, options);
  EXPECT_EQ(result.status, LcpStatus::kIterationLimit);
  EXPECT_EQ(result.iterations, 3);
  EXPECT_EQ((result.f.array() > 0).count(), 3);
  EXPECT_GE(result.f.minCoeff(), 0);

  options.max_iterations = 0;
  options.time_limit_s = 1;
  options.now = [] {
    static double time = 0;
    return time += 2;
  };
  result = Solve(problem, options);
  EXPECT_EQ(result.status, LcpStatus::kTimeLimit);
  EXPECT_GE(result.f.minCoeff(), 0);
}

TEST(Dantzig, RefusesWhatItIsNotFor) {
  MatrixXd A = MatrixXd::Identity(2, 2);
  A(0, 1) = 0.5;
  EXPECT_EQ(Solve(LcpProblem::FromDense("asymmetric", A, VectorXd::Ones(2))).status, LcpStatus::kUnsupported);
  EXPECT_EQ(Solve(LcpProblem::FromDense("negative", -MatrixXd::Identity(2, 2), VectorXd::Ones(2))).status,
            LcpStatus::kUnsupported);
  // Symmetric and indefinite, without a solution: no claim may come of it.
  A << 1, -2, -2, 1;
  const LcpProblem indefinite = LcpProblem::FromDense("indefinite", A, Eigen::Vector2d(-1, -1));
  const LcpResult result = Solve(indefinite);
  EXPECT_NE(result.status, LcpStatus::kSolved);
  EXPECT_NE(result.status, LcpStatus::kInfeasible);
  EXPECT_FALSE(result.detail.empty());
}

TEST(Dantzig, ReadsItsSettings) {
  const DantzigOptions options =
      DantzigOptions::FromSettings({{"rank_tolerance", "1e-10"}, {"order", "most-negative"}});
  EXPECT_EQ(options.rank_tolerance, 1e-10);
  EXPECT_EQ(options.order, DantzigOrder::kMostNegative);
  EXPECT_EQ(DantzigOptions::FromSettings({}).order, DantzigOrder::kIndex);
}

// ------------------------------------------------------------------------------------------------------------
// allocations

TEST(Dantzig, SolvingAgainDoesNotAllocate) {
  if (!AllocationsAreCounted()) GTEST_SKIP() << "allocations cannot be counted in this build";
  for (unsigned seed = 0; seed < 50; ++seed) {
    const Planted dense = PlantedExactly(seed, 60, false);
    const Index n = dense.problem.size();
    // The same kind of problem by factors, where w goes through body space.
    SparseMatrix J = MatrixXd(MatrixXd::Identity(n, n)).sparseView();
    for (Index i = 0; i + 1 < n; ++i) J.coeffRef(i, i + 1) = -0.5;
    const LcpProblem by_factors =
        LcpProblem::FromFactors("chain", J, VectorXd::Ones(n), VectorXd::LinSpaced(n, -1, 0.5));
    DantzigSolver solver;
    solver.Reserve(n);
    for (const LcpProblem& problem : {dense.problem, by_factors}) {
      solver.Prepare(problem);
      LcpResult result;
      solver.Solve(problem, {}, &result);
      ASSERT_EQ(result.status, LcpStatus::kSolved);
      const VectorXd f = result.f;
      LcpOptions warm;
      warm.initial_f = &f;
      const long before = AllocationCount();
      solver.Solve(problem, {}, &result);
      solver.Solve(problem, warm, &result);
      EXPECT_EQ(AllocationCount() - before, 0) << "seed " << seed << ", " << problem.id();
      EXPECT_EQ(result.status, LcpStatus::kSolved);
    }
  }
}

TEST(Dantzig, RefusesMoreRowsThanItsDenseArraysAreMeantFor) {
  const LcpProblem problem = PlantedProblem(8, 4, 1, 0, 0).problem;
  LcpResult result;
  DantzigSolver(DantzigOptions::FromSettings({{"max_rows", "7"}})).Solve(problem, {}, &result);
  EXPECT_EQ(result.status, LcpStatus::kUnsupported);
  EXPECT_NE(result.detail.find("max_rows"), std::string::npos);
  DantzigSolver(DantzigOptions::FromSettings({{"max_rows", "8"}})).Solve(problem, {}, &result);
  EXPECT_EQ(result.status, LcpStatus::kSolved);
}

}  // namespace
}  // namespace lcpbench
