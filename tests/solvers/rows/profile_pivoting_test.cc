#include "solvers/rows/profile_pivoting.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "benchmarks/studies/step_arrays.h"
#include "solvers/rows/profile_factor.h"
#include "solvers/rows/row_islands.h"
#include "solvers/rows/scaled_rows.h"
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

// D^-1/2 A D^-1/2 of the rows in the order of `scaled`, from A as LcpProblem assembles it.
Eigen::MatrixXd ScaledA(const StepRows& rows, const ScaledRows& scaled) {
  const LcpProblem problem = ProblemOf(rows);
  const Index n = scaled.size();
  Eigen::MatrixXd A(n, n);
  for (Index i = 0; i < n; ++i) {
    for (Index j = 0; j < n; ++j) {
      A(i, j) = problem.DenseA()(scaled.given(i), scaled.given(j)) * scaled.scale(i) * scaled.scale(j);
    }
  }
  return A;
}

template <Index p>
Eigen::MatrixXd Product(const ScaledRows& scaled) {
  const Index n = scaled.size();
  Eigen::MatrixXd A(n, n);
  Eigen::VectorXd y(scaled.bodies() * kBodyWidth<p>);
  for (Index j = 0; j < n; ++j) {
    const Eigen::VectorXd unit = Eigen::VectorXd::Unit(n, j);
    scaled.ComputeMomenta<p>(unit.data(), y.data());
    for (Index i = 0; i < n; ++i) A(i, j) = scaled.Gap<p>(i, y.data()) - scaled.b()[i];
  }
  return A;
}

TEST(ScaledRows, GGTIsTheScaledDelassusMatrix) {
  ScaledRows scaled;
  scaled.Reserve(kMostRows, kMostRows);
  int islands = 0;
  ForEachIsland([&](const StepRows& rows, auto part) {
    ++islands;
    ASSERT_TRUE(scaled.Load(rows, part));
    std::vector<std::int32_t> given;
    for (Index i = 0; i < scaled.size(); ++i) given.push_back(scaled.given(i));
    EXPECT_TRUE(std::is_permutation(given.begin(), given.end(), part.begin(), part.end()));
    const Eigen::MatrixXd A = rows.columns_per_body == 3 ? Product<3>(scaled) : Product<6>(scaled);
    EXPECT_LT((A - ScaledA(rows, scaled)).cwiseAbs().maxCoeff(), 1e-12);
    for (Index i = 0; i < scaled.size(); ++i) {
      EXPECT_DOUBLE_EQ(scaled.b()[i], rows.b[scaled.given(i)] * scaled.scale(i));
      EXPECT_EQ(scaled.is_joint(i), rows.bilateral != nullptr && rows.bilateral[scaled.given(i)] != 0);
    }
  });
  EXPECT_GT(islands, 30);
}

TEST(ScaledRows, RefusesRowsThatMoveNothing) {
  ScaledRows scaled;
  scaled.Reserve(kMostRows, kMostRows);
  StepArrays arrays;
  arrays.inverse_mass = {0, 0, 0, 1, 1, 1};
  arrays.Add(1, -1, {1, 0, 0, 0, 0, 0}, 1);
  arrays.Add(0, -1, {1, 0, 0, 0, 0, 0}, 1);
  const StepRows rows = arrays.View();
  const std::vector<std::int32_t> all{0, 1};
  EXPECT_FALSE(scaled.Load(rows, all));
  EXPECT_TRUE(scaled.Load(rows, std::span(all).first(1)));
}

TEST(ProfileFactor, SolvesAsEigenForEveryActiveSet) {
  ScaledRows scaled;
  ProfileFactor factor;
  scaled.Reserve(kMostRows, kMostRows);
  factor.Reserve(kMostRows);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(-1, 1);
  int solves = 0;
  ForEachIsland([&](const StepRows& rows, auto part) {
    ASSERT_TRUE(scaled.Load(rows, part));
    ASSERT_TRUE(factor.FindProfile(scaled));
    if (rows.columns_per_body == 3) {
      factor.Assemble<3>(scaled);
    } else {
      factor.Assemble<6>(scaled);
    }
    const Index n = scaled.size();
    const Eigen::MatrixXd A = ScaledA(rows, scaled);
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
      const Eigen::VectorXd expected = shifted.ldlt().solve(x(active));
      factor.Factorize(is_active.data(), shift.data());
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
    solver.Polish(rows, 1e-13, f.data());
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
