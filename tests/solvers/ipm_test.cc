// What is particular to the sparse backend: one symbolic analysis, the proximal term on singular A, iteration counts
// that hardly grow, invariance under scaling, rays, limits. The promises of every solver are in contract_test.cc.

#include "solvers/ipm.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "solvers/lcp/input_error.h"
#include "solvers/lcp/verify.h"
#include "tests/solvers/test_problems.h"

namespace lcpbench {
namespace {

using Space = IpmOptions::Space;
using Triplets = std::vector<Eigen::Triplet<double, int>>;

LcpResult SolveWith(IpmSolver* solver, const LcpProblem& problem, const LcpOptions& options = {}) {
  LcpResult result;
  solver->Solve(problem, options, &result);
  return result;
}

IpmOptions InSpace(Space space) {
  IpmOptions options;
  options.space = space;
  return options;
}

void ExpectSolved(const LcpProblem& problem, const LcpResult& result) {
  const Verdict verdict = Verify(problem, result, LcpOptions{}.tolerance);
  EXPECT_EQ(result.status, LcpStatus::kSolved) << problem.id() << ": " << result.detail;
  EXPECT_TRUE(verdict.passes) << problem.id() << ": " << verdict.reason;
}

double Uniform(std::mt19937_64* random, double low, double high) {
  return low + (high - low) * static_cast<double>((*random)() >> 11) * 0x1p-53;
}

// Unit masses on a vertical line, each resting on the one below, pushed by random loads: some contacts open.
LcpProblem Chain(Index n, unsigned seed) {
  std::mt19937_64 random(seed);
  Triplets entries;
  Eigen::VectorXd acceleration(3 * n);
  for (int k = 0; k < n; ++k) {
    entries.emplace_back(k, 3 * k + 1, 1.0);
    if (k > 0) entries.emplace_back(k, 3 * (k - 1) + 1, -1.0);
    acceleration.segment<3>(Index{3} * k) << 0.0, -10.0 + Uniform(&random, -8.0, 8.0), 0.0;
  }
  SparseMatrix J(n, 3 * n);
  J.setFromTriplets(entries.begin(), entries.end());
  return LcpProblem::FromFactors("chain-" + std::to_string(n), J, Eigen::VectorXd::Ones(3 * n), J * acceleration);
}

// Discs in rows of ten on a floor, each touching the two below: as many contacts as translations, and side loads that
// open some of them.
LcpProblem Pile(Index n, unsigned seed) {
  constexpr int kWidth = 10;
  const double half = 0.5;
  const double height = std::sqrt(0.75);
  std::mt19937_64 random(seed);
  Triplets entries;
  int row = 0;
  int disc = 0;
  for (; row < n; ++disc) {
    const int below = disc - kWidth;
    for (const double side : {-half, half}) {
      if (row >= n) break;
      entries.emplace_back(row, 3 * disc, -side);
      entries.emplace_back(row, 3 * disc + 1, height);
      const int neighbour = below + (side > 0 ? 1 : 0);
      if (neighbour >= 0 && neighbour < disc) {
        entries.emplace_back(row, 3 * neighbour, side);
        entries.emplace_back(row, 3 * neighbour + 1, -height);
      }
      ++row;
    }
  }
  Eigen::VectorXd acceleration = Eigen::VectorXd::Zero(Index{3} * disc);
  for (Index k = 0; k < disc; ++k) {
    acceleration[3 * k] = Uniform(&random, -3.0, 3.0);
    acceleration[3 * k + 1] = -10.0;
  }
  SparseMatrix J(n, Index{3} * disc);
  J.setFromTriplets(entries.begin(), entries.end());
  return LcpProblem::FromFactors("pile-" + std::to_string(n), J, Eigen::VectorXd::Ones(Index{3} * disc),
                                 J * acceleration);
}

// Planted solution of a problem whose rows are drawn with repetition from few distinct ones, so that A is singular,
// A_FF included; every seventh row is bilateral, every fifth has f = w = 0.
LcpProblem Redundant(Index n, Index columns, unsigned seed) {
  std::mt19937_64 random(seed);
  Eigen::MatrixXd J(n, columns);
  for (Index i = 0; i < n; ++i) {
    if (i >= columns / 2) {
      J.row(i) = J.row(static_cast<Index>(random() % static_cast<std::uint64_t>(i)));
      continue;
    }
    for (Index k = 0; k < columns; ++k) J(i, k) = std::floor(Uniform(&random, -4, 5));
    J(i, i % columns) += 9;
  }
  Eigen::VectorXd f = Eigen::VectorXd::Zero(n);
  std::vector<Index> bilateral;
  for (Index i = 0; i < n; ++i) {
    if (i % 7 == 3) bilateral.push_back(i);
    if (i % 5 != 0) f[i] = Uniform(&random, 0, 2);
  }
  const Eigen::VectorXd inverse_mass = Eigen::VectorXd::Constant(columns, 0.5);
  const Eigen::VectorXd b = -J * inverse_mass.cwiseProduct(J.transpose() * f);
  return LcpProblem::FromFactors("redundant-" + std::to_string(seed), J.sparseView(), inverse_mass, b,
                                 RowBounds::WithBilateralRows(n, bilateral));
}

TEST(Ipm, AnalysesOnceForAllSolvesOfAProblem) {
  for (const Space space : {Space::kAutomatic, Space::kContact, Space::kBody}) {
    IpmSolver solver(InSpace(space));
    const LcpProblem problem = Pile(200, 1);
    solver.Prepare(problem);
    EXPECT_EQ(solver.statistics().analyses, 1);
    const LcpResult first = SolveWith(&solver, problem);
    ExpectSolved(problem, first);
    EXPECT_GT(solver.statistics().factorizations, 3);
    EXPECT_EQ(solver.statistics().factorizations, first.iterations);
    const LcpResult second = SolveWith(&solver, problem);
    EXPECT_EQ(solver.statistics().analyses, 1);
    EXPECT_EQ(first.f, second.f);
    EXPECT_EQ(first.iterations, second.iterations);
  }
}

TEST(Ipm, BothSpacesGiveTheSameGaps) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    const LcpProblem problem = PlantedProblem(40, 8, seed + 1, static_cast<int>(seed % 4), 5).problem;
    IpmSolver contact(InSpace(Space::kContact));
    IpmSolver body(InSpace(Space::kBody));
    const LcpResult a = SolveWith(&contact, problem);
    const LcpResult b = SolveWith(&body, problem);
    ExpectSolved(problem, a);
    ExpectSolved(problem, b);
    EXPECT_FALSE(contact.statistics().body_space);
    EXPECT_TRUE(body.statistics().body_space);
    Eigen::VectorXd w_a;
    Eigen::VectorXd w_b;
    problem.ComputeW(a.f, &w_a);
    problem.ComputeW(b.f, &w_b);
    EXPECT_LE((w_a - w_b).cwiseAbs().maxCoeff(), 1e-8 * (1 + problem.b().cwiseAbs().maxCoeff()));
  }
}

TEST(Ipm, ProximalTermAndRefinementSolveSingularSystems) {
  for (const double proximal : {1e-9, 1e-10, 1e-11, 1e-12}) {
    IpmOptions options;
    options.proximal = proximal;
    IpmSolver solver(options);
    for (unsigned seed = 0; seed < 50; ++seed) {
      const LcpProblem problem = Redundant(10 + seed, 4 + seed % 9, seed);
      ExpectSolved(problem, SolveWith(&solver, problem));
    }
  }
}

TEST(Ipm, JointsAloneAreOneLinearSystem) {
  const LcpProblem chain = Chain(50, 3);
  std::vector<Index> every(50);
  for (Index i = 0; i < 50; ++i) every[static_cast<size_t>(i)] = i;
  const LcpProblem joints = LcpProblem::FromFactors("joints", chain.J(), chain.inverse_mass(), chain.b(),
                                                    RowBounds::WithBilateralRows(50, every));
  IpmSolver solver;
  const LcpResult result = SolveWith(&solver, joints);
  ExpectSolved(joints, result);
  EXPECT_EQ(result.iterations, 1);
}

TEST(Ipm, IterationsHardlyGrowWithSize) {
  IpmSolver solver;
  for (LcpProblem (*const generate)(Index, unsigned) : {&Chain, &Pile}) {
    for (unsigned seed = 0; seed < 3; ++seed) {
      for (const Index n : {100, 300, 1000, 3000}) {
        const LcpProblem problem = generate(n, seed);
        const LcpResult result = SolveWith(&solver, problem);
        ExpectSolved(problem, result);
        EXPECT_LE(result.iterations, 30) << problem.id();
      }
    }
  }
}

TEST(Ipm, ScalingByPowersOfTwoChangesNoPivot) {
  for (const Space space : {Space::kContact, Space::kBody}) {
    IpmSolver solver(InSpace(space));
    for (unsigned seed = 0; seed < 10; ++seed) {
      const LcpProblem problem = Redundant(25, 10, seed);
      const LcpResult plain = SolveWith(&solver, problem);
      std::mt19937_64 random(seed);
      Eigen::VectorXd scale(problem.size());
      for (double& s : scale) s = std::exp2(std::floor(Uniform(&random, -20, 20)));
      const RowBounds bounds = RowBounds::WithBilateralRows(problem.size(), problem.bilateral_rows());
      const LcpProblem rows = LcpProblem::FromFactors("rows", SparseMatrix(scale.asDiagonal() * problem.J()),
                                                      problem.inverse_mass(), scale.cwiseProduct(problem.b()), bounds);
      const LcpResult scaled_rows = SolveWith(&solver, rows);
      EXPECT_EQ(scaled_rows.iterations, plain.iterations);
      EXPECT_EQ(scaled_rows.f.cwiseProduct(scale), plain.f);
      const double mass = std::exp2(-40);  // its root is a power of two as well
      const double load = std::exp2(33);
      const LcpProblem units =
          LcpProblem::FromFactors("units", problem.J(), mass * problem.inverse_mass(), load * problem.b(), bounds);
      const LcpResult scaled_units = SolveWith(&solver, units);
      EXPECT_EQ(scaled_units.iterations, plain.iterations);
      EXPECT_EQ(mass / load * scaled_units.f, plain.f);
    }
  }
}

TEST(Ipm, IndependentGroupsOfAnyMagnitudeAreEachSolved) {
  // Two chains side by side, the loads of one 1e12 times those of the other: rho alone would not see the small one.
  const LcpProblem one = Chain(20, 5);
  SparseMatrix J(40, 120);
  Triplets entries;
  Eigen::VectorXd b(40);
  for (Index i = 0; i < 20; ++i) {
    for (SparseMatrix::InnerIterator it(one.J(), i); it; ++it) {
      entries.emplace_back(static_cast<int>(i), static_cast<int>(it.col()), it.value());
      entries.emplace_back(static_cast<int>(20 + i), static_cast<int>(60 + it.col()), it.value());
    }
    b[i] = one.b()[i];
    b[20 + i] = 1e-12 * one.b()[i];
  }
  J.setFromTriplets(entries.begin(), entries.end());
  const LcpProblem both = LcpProblem::FromFactors("both", J, Eigen::VectorXd::Ones(120), b);
  IpmSolver solver;
  const LcpResult result = SolveWith(&solver, both);
  ExpectSolved(both, result);
  EXPECT_LE((1e12 * result.f.tail(20) - result.f.head(20)).cwiseAbs().maxCoeff(),
            1e-9 * result.f.cwiseAbs().maxCoeff());
}

TEST(Ipm, InfeasibleProblemsComeWithAnAcceptedRay) {
  for (const Space space : {Space::kContact, Space::kBody}) {
    IpmSolver solver(InSpace(space));
    for (unsigned seed = 0; seed < 30; ++seed) {
      // A solvable chain, and two opposed rows on its top body that both demand to open.
      const LcpProblem chain = Chain(10 + seed, seed);
      const Index n = chain.size() + 2;
      Triplets entries;
      for (Index i = 0; i < chain.size(); ++i) {
        for (SparseMatrix::InnerIterator it(chain.J(), i); it; ++it) {
          entries.emplace_back(static_cast<int>(i), static_cast<int>(it.col()), it.value());
        }
      }
      const int column = 3 * static_cast<int>(chain.size() - 1);
      entries.emplace_back(static_cast<int>(n - 2), column, 1.0);
      entries.emplace_back(static_cast<int>(n - 1), column, -1.0);
      SparseMatrix J(n, chain.J().cols());
      J.setFromTriplets(entries.begin(), entries.end());
      Eigen::VectorXd b(n);
      b << chain.b(), -1.0, 0.5;
      const LcpProblem jam = LcpProblem::FromFactors("jam", J, chain.inverse_mass(), b);
      const LcpResult result = SolveWith(&solver, jam);
      EXPECT_EQ(result.status, LcpStatus::kInfeasible) << seed << ": " << result.detail;
      ASSERT_TRUE(result.farkas_ray.has_value());
      EXPECT_TRUE(VerifyFarkasRay(jam, *result.farkas_ray).accepted);
    }
  }
}

TEST(Ipm, RowsWithoutMobilityAreDecidedByTheirGap) {
  Eigen::MatrixXd A(3, 3);
  A << 2, 0, 1, 0, 0, 0, 1, 0, 2;
  IpmSolver solver;
  const LcpProblem open = LcpProblem::FromDense("open", A, Eigen::Vector3d(-1, 0.5, -1));
  ExpectSolved(open, SolveWith(&solver, open));
  const LcpProblem closed = LcpProblem::FromDense("closed", A, Eigen::Vector3d(-1, -0.5, -1));
  const LcpResult result = SolveWith(&solver, closed);
  EXPECT_EQ(result.status, LcpStatus::kInfeasible);
  ASSERT_TRUE(result.farkas_ray.has_value());
  EXPECT_EQ(*result.farkas_ray, Eigen::Vector3d(0, 1, 0));
  A(1, 0) = A(0, 1) = 1;
  const LcpProblem indefinite = LcpProblem::FromDense("indefinite", A, Eigen::Vector3d(-1, -0.5, -1));
  EXPECT_EQ(SolveWith(&solver, indefinite).status, LcpStatus::kUnsupported);
}

TEST(Ipm, WarmStartAtTheSolutionCostsNothingAndNearItLittle) {
  const LcpProblem problem = Pile(300, 2);
  IpmSolver solver;
  const LcpResult cold = SolveWith(&solver, problem);
  ExpectSolved(problem, cold);
  LcpOptions options;
  options.initial_f = &cold.f;
  EXPECT_EQ(SolveWith(&solver, problem, options).iterations, 0);
  const LcpProblem next = LcpProblem::FromFactors("next", problem.J(), problem.inverse_mass(), 1.001 * problem.b());
  const LcpResult warm = SolveWith(&solver, next, options);
  ExpectSolved(next, warm);
  EXPECT_LE(warm.iterations, 3);
}

double ticks = 0;

TEST(Ipm, LimitsAreCheckedBeforeEveryFactorization) {
  const LcpProblem problem = Pile(100, 4);
  IpmSolver solver;
  const std::int64_t needed = SolveWith(&solver, problem).iterations;
  for (std::int64_t limit = 1; limit < needed; ++limit) {
    LcpOptions by_count;
    by_count.max_iterations = limit;
    const LcpResult counted = SolveWith(&solver, problem, by_count);
    EXPECT_EQ(counted.status, LcpStatus::kIterationLimit);
    EXPECT_EQ(counted.iterations, limit);

    LcpOptions by_time;  // the clock moves one second per look: once at the start, then before each factorisation
    ticks = 0;
    by_time.now = [] { return ticks += 1.0; };
    by_time.time_limit_s = static_cast<double>(limit) + 1;
    const LcpResult timed = SolveWith(&solver, problem, by_time);
    EXPECT_EQ(timed.status, LcpStatus::kTimeLimit);
    EXPECT_EQ(timed.iterations, limit);
    EXPECT_EQ(timed.f, counted.f);
  }
}

TEST(Ipm, OptionsHaveNamesAndRanges) {
  const IpmOptions options = IpmOptions::FromSettings({{"space", "body"}, {"proximal", "1e-10"}, {"correctors", "0"}});
  EXPECT_EQ(options.space, Space::kBody);
  EXPECT_EQ(options.proximal, 1e-10);
  EXPECT_EQ(options.correctors, 0);
  EXPECT_THROW(IpmOptions::FromSettings({{"space", "phase"}}), InputError);
  EXPECT_THROW(IpmOptions::FromSettings({{"proximal", "1"}}), InputError);
  EXPECT_THROW(IpmOptions::FromSettings({{"ordering", "amd"}}), InputError);
  IpmSolver without(options);
  const LcpProblem problem = Pile(100, 6);
  ExpectSolved(problem, SolveWith(&without, problem));
}

}  // namespace
}  // namespace lcpbench
