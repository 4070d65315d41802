// How auto takes a matrix straight from a caller's arrays: a tableau, a banded factor, or the long way.

#include "solvers/rows/matrix_arrays.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "solvers/auto/auto_solver.h"
#include "support/input_error.h"
#include "tests/solvers/exact_problems.h"
#include "tests/solvers/solve_with.h"
#include "tests/solvers/test_problems.h"

namespace lcpbench {
namespace {

using Eigen::VectorXd;

LcpResult SolveArrays(const ProblemArrays& arrays, const LcpOptions& options = {}) {
  AutoSolver solver;
  LcpResult result;
  solver.SolveArrays(arrays, options, &result);
  return result;
}

// Five-point differences on a square, and loads of both signs: an obstacle problem.
LcpProblem Obstacle(int side, unsigned seed) {
  TestRandom random(seed);
  const int n = side * side;
  Triplets entries;
  VectorXd b(n);
  for (int i = 0; i < n; ++i) {
    entries.emplace_back(i, i, 4);
    if (i % side > 0) entries.emplace_back(i, i - 1, -1);
    if (i % side < side - 1) entries.emplace_back(i, i + 1, -1);
    if (i >= side) entries.emplace_back(i, i - side, -1);
    if (i < n - side) entries.emplace_back(i, i + side, -1);
    b[i] = random.Integer(-9, 9);
  }
  return LcpProblem::FromSparse("obstacle-" + std::to_string(side), MatrixOf(n, n, entries), b, {}, SymmetricPsd());
}

TEST(MatrixArrays, ObstaclesNeedNoOtherBackend) {
  for (int side = 1; side <= 32; side += side < 9 ? 1 : 5) {
    for (unsigned seed = 0; seed < 5; ++seed) {
      const LcpProblem problem = Obstacle(side, seed);
      for (const MatrixForm form : {MatrixForm::kSparse, MatrixForm::kDense}) {
        if (form == MatrixForm::kDense && side > 20) continue;
        const LcpProblem given = InForm(problem, form);
        const LcpResult result = SolveArrays(ProblemArrays::Of(given));
        ExpectSolved(given, result);
        const AutoLimits& defaults = kDefaultLimits;
        const Index most = form == MatrixForm::kDense ? defaults.hard_tableau_rows : defaults.tableau_rows;
        EXPECT_EQ(result.detail, side * side > most ? "band" : "tableau") << problem.id();
        ExpectSolved(given, SolveArrays(ProblemArrays::Of(given), {.initial_f = &result.f}));
      }
    }
  }
}

// The problems have any rank, joints and degenerate rows: what the band leaves open goes on.
TEST(MatrixArrays, PlantedProblemsAreSolvedInEveryForm) {
  int by_band = 0;
  for (unsigned seed = 0; seed < 120; ++seed) {
    TestRandom random(seed);
    const int rows = random.Integer(1, 160);
    const LcpProblem problem = PlantedProblem(rows, random.Integer(rows / 4 + 1, rows), seed,
                                              static_cast<int>(seed % 3) * 4, random.Integer(0, 4))
                                   .problem;
    for (const MatrixForm form : {MatrixForm::kSparse, MatrixForm::kDense}) {
      const LcpProblem given = InForm(problem, form);
      for (const double tolerance : {1e-3, 1e-6, 1e-9}) {
        const LcpResult result = SolveArrays(ProblemArrays::Of(given), {.tolerance = tolerance});
        ExpectSolved(given, result, tolerance);
        by_band += result.detail == "band" ? 1 : 0;
      }
    }
  }
  EXPECT_GT(by_band, 50);
}

// Independent rows whose forces differ by far more than rounding: the tableau takes the small ones for none, the band
// judges row by row.
TEST(MatrixArrays, SmallForcesBesideLargeOnesAreForces) {
  const VectorXd b = Eigen::Vector3d(-1e-15, -1e2, 1e-15);
  const LcpProblem given = LcpProblem::FromDense("sizes", Eigen::Matrix3d::Identity(), b);
  const LcpResult result = SolveArrays(ProblemArrays::Of(given));
  ExpectSolved(given, result);
  EXPECT_EQ(result.detail, "band");
}

TEST(MatrixArrays, WhatCannotBeSolvedIsProved) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    const LcpProblem given = InForm(InfeasibleExactly(seed, 100), MatrixForm::kDense);
    ExpectRay(given, SolveArrays(ProblemArrays::Of(given)));
  }
}

TEST(MatrixArrays, OnlySymmetricMatricesInRangeAreTaken) {
  MatrixArrays matrix;
  for (const MatrixForm form : {MatrixForm::kSparse, MatrixForm::kDense}) {
    const ProblemArrays given = ProblemArrays::Of(InForm(Obstacle(10, 0), form));
    ASSERT_TRUE(matrix.Take(given));
    EXPECT_EQ(matrix.bandwidth(), form == MatrixForm::kSparse ? 10 : 99);
    const auto refused = [&](auto&& change) {
      ProblemArrays changed = given;
      change(changed);
      return !matrix.Take(changed);
    };
    EXPECT_TRUE(refused([](auto& a) { a.value[1] = std::nextafter(a.value[1], 0); }));
    EXPECT_TRUE(refused([](auto& a) { a.value[1] += 1e-9; }));
    EXPECT_TRUE(refused([](auto& a) { a.value[0] = 0; }));
    EXPECT_TRUE(refused([](auto& a) { a.value[0] = 0x1p200; }));
    EXPECT_TRUE(refused([](auto& a) { a.value[0] = std::numeric_limits<double>::quiet_NaN(); }));
    EXPECT_TRUE(refused([](auto& a) { a.b[3] = std::numeric_limits<double>::infinity(); }));
    EXPECT_TRUE(refused([](auto& a) { a.b.pop_back(); }));
    EXPECT_TRUE(refused([](auto& a) { a.value.pop_back(); }));
    EXPECT_TRUE(refused([](auto& a) { a.bilateral.assign(1, 0); }));
    if (form == MatrixForm::kDense) continue;
    EXPECT_TRUE(refused([](auto& a) { a.row_start.back() += 1; }));
    EXPECT_TRUE(refused([](auto& a) { a.row_start[1] = -5; }));
    EXPECT_TRUE(refused([](auto& a) { a.row_start[1] = 1000000; }));
    EXPECT_TRUE(refused([](auto& a) { a.column[1] = 100; }));
    EXPECT_TRUE(refused([](auto& a) { a.column[1] = -1; }));
    EXPECT_TRUE(refused([](auto& a) { std::swap(a.column[1], a.column[2]); }));
    EXPECT_TRUE(refused([](auto& a) { a.column[0] = 1; }));
  }
}

TEST(MatrixArrays, RowsAreThoseOfA) {
  MatrixArrays matrix;
  for (const MatrixForm form : {MatrixForm::kSparse, MatrixForm::kDense}) {
    const LcpProblem problem = InForm(Obstacle(7, 3), form);
    const ProblemArrays given = ProblemArrays::Of(problem);
    ASSERT_TRUE(matrix.Take(given));
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(matrix.size(), matrix.size());
    for (Index i = 0; i < matrix.size(); ++i) {
      Index before = matrix.first(i) - 1;
      matrix.ForEntries(i, [&](Index j, double a) {
        EXPECT_LT(before, j);
        A(i, j) = a;
        before = j;
      });
      EXPECT_EQ(matrix.diagonal()[static_cast<std::size_t>(i)], A(i, i));
    }
    EXPECT_EQ(A, problem.DenseA());
  }
}

// Symmetric but for rounding, or no symmetry at all, or no number: the long way decides.
TEST(MatrixArrays, TheLongWayTakesTheRest) {
  for (const int side : {5, 10}) {
    ProblemArrays arrays = ProblemArrays::Of(Obstacle(side, 1));
    arrays.value[1] = std::nextafter(arrays.value[1], 0);
    ExpectSolved(LcpProblem::FromArrays(arrays), SolveArrays(arrays));
    arrays.value[1] = -0.5;
    EXPECT_EQ(SolveArrays(arrays).status, LcpStatus::kUnsupported);
    arrays.value[1] = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(SolveArrays(arrays), InputError);
  }
}

TEST(MatrixArrays, ATimeLimitEndsTheExchanges) {
  const ProblemArrays arrays = ProblemArrays::Of(Obstacle(20, 2));
  ASSERT_GT(SolveArrays(arrays).iterations, 1);
  EXPECT_EQ(SolveArrays(arrays, {.time_limit_s = 0.5, .now = &TickingClock}).status, LcpStatus::kTimeLimit);
}

}  // namespace
}  // namespace lcpbench
