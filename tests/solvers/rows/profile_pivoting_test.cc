#include "solvers/rows/profile_pivoting.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <random>
#include <span>
#include <vector>

#include "benchmarks/studies/step_arrays.h"
#include "solvers/first_order/sweeps/row_kernel.h"
#include "solvers/linear_algebra/islands.h"
#include "solvers/rows/body_order.h"
#include "solvers/rows/central_path.h"
#include "solvers/rows/profile_factor.h"
#include "tests/solvers/step/random_step.h"

namespace lcpbench {
namespace {

constexpr Index kMostRows = 400;

struct Case {
  Index rows, bodies;
  int columns_per_body;
  bool single;
};

// Full rank and redundant, in the plane and in space.
const std::vector<Case> kCases = {{30, 40, 3, false}, {60, 12, 3, false}, {200, 90, 3, true},
                                  {25, 30, 6, false}, {80, 9, 6, true},   {300, 200, 6, false}};

// Calls visit(rows, part) for every island whose rows all move something.
template <typename Visit>
void ForEachIsland(Visit&& visit) {
  for (const Case& c : kCases) {
    for (unsigned seed = 1; seed <= 5; ++seed) {
      StepArrays arrays = RandomStep(c.rows, c.bodies, c.columns_per_body, seed);
      arrays.Round();
      const StepRows rows = arrays.View(c.single);
      RowIslands islands;
      islands.Reserve(rows.rows, rows.bodies);
      islands.Find(rows);
      for (Index k = 0; k < islands.count(); ++k) {
        const auto part = islands.rows(k);
        if (std::all_of(part.begin(), part.end(), [&](std::int32_t row) { return DiagonalOf(rows, row) > 0; })) {
          visit(rows, part);
        }
      }
    }
  }
}

// The scaled rows of one island.
struct Island {
  Island() {
    order.Reserve(kMostRows, kMostRows);
    scaled.Reserve(kMostRows);
    form.Reserve(kMostRows, 2 * kMostRows);
    in_plane = MakeTwoBodyRows(scaled, 3, false, &form);
    in_space = MakeTwoBodyRows(scaled, 6, false, &form);
    x.f.setZero(kMostRows + 8);
    x.image.setZero(ScaledRows::MostImage(2 * kMostRows));
    w.setZero(kMostRows + 8);
  }

  bool Load(const StepRows& rows, std::span<const std::int32_t> part) {
    if (!order.Find(rows, part, &scaled.order)) return false;
    scaled.Take(rows);
    if (!form.Take(rows, order.bodies(), order.number(), &scaled)) return false;
    scaled.SetB(rows.b);
    kernel = rows.columns_per_body == 3 ? in_plane.get() : in_space.get();
    kernel->SetB();
    return true;
  }

  // D^-1/2 A D^-1/2 in this order, from A as LcpProblem assembles it.
  Eigen::MatrixXd ScaledA(const StepRows& rows) const {
    const LcpProblem problem = ProblemOf(rows);
    const Index n = scaled.size;
    Eigen::MatrixXd A(n, n);
    for (Index i = 0; i < n; ++i) {
      for (Index j = 0; j < n; ++j) {
        A(i, j) = problem.DenseA()(scaled.Given(i), scaled.Given(j)) * scaled.inverse_root[i] * scaled.inverse_root[j];
      }
    }
    return A;
  }

  BodyOrder order;
  ScaledProblem scaled;
  ScaledRows form;
  std::unique_ptr<RowKernel> in_plane, in_space;
  RowKernel* kernel = nullptr;
  Point x;
  Array w;
};

TEST(ScaledRows, GGTIsTheScaledDelassusMatrix) {
  Island island;
  const ScaledProblem& scaled = island.scaled;
  int islands = 0;
  ForEachIsland([&](const StepRows& rows, auto part) {
    ++islands;
    ASSERT_TRUE(island.Load(rows, part));
    EXPECT_TRUE(std::is_permutation(scaled.order.begin(), scaled.order.end(), part.begin(), part.end()));
    const Index n = scaled.size;
    Eigen::MatrixXd A(n, n);
    for (Index j = 0; j < n; ++j) {
      island.x.f.head(n) = Eigen::VectorXd::Unit(n, j);
      island.kernel->MakeImage(n, &island.x);
      island.kernel->ResidualSquares(0, n, island.x, &island.w);
      A.col(j) = island.w.head(n) - scaled.b.head(n);
    }
    EXPECT_LT((A - island.ScaledA(rows)).cwiseAbs().maxCoeff(), 1e-12);
    for (Index i = 0; i < n; ++i) {
      const Index given = scaled.Given(i);
      EXPECT_NEAR(scaled.b[i] * scaled.unit[i], rows.b[given] * scaled.inverse_root[i] * scaled.inverse_root[i], 1e-12);
      EXPECT_EQ(scaled.IsFree(i), rows.bilateral != nullptr && rows.bilateral[given] != 0);
    }
  });
  EXPECT_GT(islands, 30);
}

TEST(ScaledRows, RefusesRowsThatMoveNothing) {
  Island island;
  StepArrays arrays;
  arrays.inverse_mass = {0, 0, 0, 1, 1, 1};
  arrays.Add(1, -1, {1, 0, 0, 0, 0, 0}, 1);
  arrays.Add(0, -1, {1, 0, 0, 0, 0, 0}, 1);
  const StepRows rows = arrays.View();
  const std::vector<std::int32_t> all{0, 1};
  EXPECT_FALSE(island.Load(rows, all));
  EXPECT_TRUE(island.Load(rows, std::span<const std::int32_t>(all).first(1)));
}

class ProfileFactorTest : public ::testing::TestWithParam<InstructionSet> {};

TEST_P(ProfileFactorTest, SolvesAsEigenForEveryActiveSet) {
  Island island;
  ProfileFactor factor(GetParam());
  factor.Reserve(kMostRows);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(-1, 1);
  int solves = 0;
  ForEachIsland([&](const StepRows& rows, auto part) {
    ASSERT_TRUE(island.Load(rows, part));
    ASSERT_TRUE(factor.FindProfile(island.form));
    factor.Assemble(island.form);
    const Index n = island.scaled.size;
    const Eigen::MatrixXd A = island.ScaledA(rows);
    for (int round = 0; round < 3; ++round) {
      std::vector<unsigned char> is_active(static_cast<std::size_t>(n));
      Eigen::VectorXd shift(n);
      Eigen::VectorXd x = Eigen::VectorXd::Zero(n + 8);
      std::vector<Index> active;
      for (Index i = 0; i < n; ++i) {
        shift[i] = 0.01 + std::abs(uniform(random));
        if (round > 0 && uniform(random) < 0) continue;
        is_active[static_cast<std::size_t>(i)] = 1;
        active.push_back(i);
        x[i] = uniform(random);
      }
      Eigen::MatrixXd shifted = A(active, active);
      shifted.diagonal() += shift(active);
      shifted.diagonal().array() += 0.5;
      const Eigen::VectorXd expected = shifted.ldlt().solve(x(active));
      EXPECT_TRUE(factor.Factorize(is_active.data(), 0.5, shift.data()));
      factor.Solve(x.data());
      EXPECT_LT((x(active) - expected).norm(), 1e-11 * (1 + expected.norm()));
      for (Index i = 0; i < n; ++i) {
        EXPECT_TRUE(is_active[static_cast<std::size_t>(i)] != 0 || x[i] == 0);
      }
      ++solves;
    }
  });
  EXPECT_GT(solves, 100);
}

INSTANTIATE_TEST_SUITE_P(EveryInstructionSet, ProfileFactorTest, ::testing::ValuesIn(AvailableInstructionSets()),
                         ::testing::PrintToStringParamName());

// From no force at all: the fewer the residual may be, the more steps, and the gaps end at those of the solution.
// Whether all rows are right in the end where these many are wrong after each basic point.
bool Ends(const std::vector<Index>& wrong, int patience, Index few) {
  std::size_t round = 0;
  return ExchangeBlocks(
      static_cast<int>(wrong.size()), patience, [] { return true; }, [&] { return wrong[round++]; }, few);
}

TEST(ExchangeBlocks, HasOneRoundMoreWhereFewRowsAreWrong) {
  EXPECT_TRUE(Ends({30, 12, 3, 1, 0}, 1, 0));
  EXPECT_FALSE(Ends({30, 12, 3, 3, 0}, 1, 0));
  EXPECT_FALSE(Ends({30, 12, 3, 3, 0}, 1, 2));
  EXPECT_TRUE(Ends({30, 12, 3, 3, 0}, 1, 3));
  EXPECT_FALSE(Ends({30, 12, 3, 3, 3, 0}, 1, 3));
  EXPECT_TRUE(Ends({30, 12, 3, 4, 1, 2, 0}, 1, 3));
  EXPECT_FALSE(Ends({30, 12, 3}, 3, 3));
}

TEST(CentralPath, LeadsToTheSolution) {
  Island island;
  ProfileFactor factor;
  factor.Reserve(kMostRows);
  CentralPath path;
  path.Reserve(kMostRows);
  ProfilePivoting pivoting;
  pivoting.Reserve(kMostRows, kMostRows);
  int islands = 0;
  ForEachIsland([&](const StepRows& rows, auto part) {
    ASSERT_TRUE(island.Load(rows, part));
    const ScaledProblem& scaled = island.scaled;
    const Index n = scaled.size;
    if (n < 20) return;
    ++islands;
    ASSERT_TRUE(factor.FindProfile(island.form));
    factor.Assemble(island.form);
    std::int64_t steps_before = 0;
    double before = std::numeric_limits<double>::infinity();
    for (const double rho : {1e-1, 1e-3, 1e-5, 1e-7, 1e-9}) {
      island.x.f.setZero();
      const std::int64_t steps = path.Follow(scaled, *island.kernel, rho * scaled.b_norm, nullptr, &factor, &island.x);
      const double found = std::sqrt(island.kernel->ResidualSquares(0, n, island.x, &island.w)) / scaled.b_norm;
      EXPECT_LE(found, rho);
      EXPECT_LE(found, before);
      EXPECT_GE(steps, steps_before);
      EXPECT_LE(steps, 30);
      for (Index i = 0; i < n; ++i) EXPECT_TRUE(scaled.IsFree(i) || island.x.f[i] > 0);
      before = found;
      steps_before = steps;
    }
    std::vector<double> f(static_cast<std::size_t>(rows.rows));
    pivoting.Solve(rows, part, {1e-12, nullptr, nullptr}, f.data());
    scaled.Start(f.data(), &island.x.f);
    const Array gaps = island.w;
    island.kernel->MakeImage(n, &island.x);
    island.kernel->ResidualSquares(0, n, island.x, &island.w);
    EXPECT_LT((gaps - island.w).head(n).norm(), 1e-4 * scaled.b_norm);
  });
  EXPECT_GT(islands, 15);
}

// A clock that stands still for so many looks, then is far ahead.
int looks_left = 0;
double StoppingClock() { return looks_left-- > 0 ? 0.0 : 1e9; }

// Between two looks at the clock there is one factorization, or sixteen sweeps, at most.
TEST(ProfilePivoting, LooksAtTheClockBeforeEveryFactorization) {
  constexpr int kMostBetweenLooks = 17;
  const StepArrays arrays = RandomStep(kMostRows, 60, 3, 3);
  const StepRows rows = arrays.View();
  RowIslands islands;
  islands.Reserve(rows.rows, rows.bodies);
  islands.Find(rows);
  std::vector<std::int32_t> part;
  for (Index k = 0; k < islands.count(); ++k) {
    if (islands.rows(k).size() > part.size()) part.assign(islands.rows(k).begin(), islands.rows(k).end());
  }
  ASSERT_GT(part.size(), 200U);
  ProfilePivoting solver;
  solver.Reserve(kMostRows, rows.bodies);
  std::vector<double> f(static_cast<std::size_t>(rows.rows));
  std::int64_t before = 0;
  std::int64_t most = 0;
  for (int looks = 0; looks < 400; ++looks) {
    LcpOptions options;
    options.time_limit_s = 1;
    options.now = &StoppingClock;
    looks_left = looks + 1;  // one when the deadline is made
    const Deadline deadline(options);
    solver.Solve(rows, part, {1e-14, nullptr, &deadline}, f.data());
    solver.Polish(1e-13, f.data());
    EXPECT_LE(solver.iterations() - before, kMostBetweenLooks) << looks;
    before = solver.iterations();
    most = std::max(most, before);
    for (const double force : f) EXPECT_TRUE(std::isfinite(force));
    if (looks_left > 0) break;
  }
  EXPECT_GT(most, 40);  // interior points were reached
}

}  // namespace
}  // namespace lcpbench
