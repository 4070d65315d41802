// What is particular to ipm: one symbolic analysis, the proximal term on singular A, iteration counts that hardly grow,
// invariance under scaling, rays, limits. And to the hybrid: sweeps, then the interior point, where each is the last
// word, and limits of both together. The promises of every solver are in contract_test.cc.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "solvers/auto/hybrid.h"
#include "solvers/interior_point/ipm.h"
#include "support/input_error.h"
#include "tests/solvers/solve_with.h"
#include "tests/solvers/test_problems.h"

namespace lcpbench {
namespace {

using Space = IpmOptions::Space;

IpmOptions InSpace(Space space) { return {.space = space}; }

// Gaps are unique.
void ExpectSameGaps(const LcpProblem& problem, const LcpResult& a, const LcpResult& b) {
  ExpectSolved(problem, a);
  ExpectSolved(problem, b);
  const Eigen::VectorXd difference = ComputeMetrics(problem, a.f).w - ComputeMetrics(problem, b.f).w;
  EXPECT_LE(difference.cwiseAbs().maxCoeff(), 1e-8 * (1 + problem.b().cwiseAbs().maxCoeff()));
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
    const LcpProblem problem = DiscPile(200, 1);
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
    ExpectSameGaps(problem, SolveWith(&contact, problem), SolveWith(&body, problem));
    EXPECT_FALSE(contact.statistics().body_space);
    EXPECT_TRUE(body.statistics().body_space);
  }
}

TEST(Ipm, ProximalTermAndRefinementSolveSingularSystems) {
  for (const double proximal : {1e-9, 1e-10, 1e-11, 1e-12}) {
    IpmSolver solver({.proximal = proximal});
    for (unsigned seed = 0; seed < 50; ++seed) {
      const LcpProblem problem = Redundant(10 + seed, 4 + seed % 9, seed);
      ExpectSolved(problem, SolveWith(&solver, problem));
    }
  }
}

TEST(Ipm, JointsAloneAreOneLinearSystem) {
  const LcpProblem chain = Column(50, 3);
  const LcpProblem joints = LcpProblem::FromFactors("joints", chain.J(), chain.inverse_mass(), chain.b(),
                                                    RowBounds::WithBilateralRows(50, EveryRow(50)));
  IpmSolver solver;
  const LcpResult result = SolveWith(&solver, joints);
  ExpectSolved(joints, result);
  EXPECT_EQ(result.iterations, 1);
}

TEST(Ipm, IterationsHardlyGrowWithSize) {
  IpmSolver solver;
  for (LcpProblem (*const generate)(Index, unsigned) : {&Column, &DiscPile}) {
    for (unsigned seed = 0; seed < 3; ++seed) {
      for (const Index n : {100, 300, 1000, 3000}) {
        const LcpProblem problem = generate(n, seed);
        const LcpResult result = SolveWith(&solver, problem);
        ExpectSolved(problem, result);
        EXPECT_LE(result.iterations, 35) << problem.id();
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
      const LcpResult scaled_rows = SolveWith(&solver, ScaleRows(problem, scale, 1));
      EXPECT_EQ(scaled_rows.iterations, plain.iterations);
      EXPECT_EQ(scaled_rows.f.cwiseProduct(scale), plain.f);
      const double mass = std::exp2(-40);  // its root is a power of two as well
      const double load = std::exp2(33);
      const LcpProblem other_mass = ScaleRows(problem, Eigen::VectorXd::Ones(problem.size()), mass);
      const LcpResult scaled_units = SolveWith(&solver, other_mass.WithB(load * problem.b()));
      EXPECT_EQ(scaled_units.iterations, plain.iterations);
      EXPECT_EQ(mass / load * scaled_units.f, plain.f);
    }
  }
}

TEST(Ipm, IndependentGroupsOfAnyMagnitudeAreEachSolved) {
  // Two chains side by side, the loads of one 1e12 times those of the other: rho alone would not see the small one.
  const LcpProblem one = Column(20, 5);
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
  const LcpProblem both = LcpProblem::FromFactors("both", MatrixOf(40, 120, entries), Eigen::VectorXd::Ones(120), b);
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
      const LcpProblem jam = JammedColumn(10 + seed, seed);
      ExpectRay(jam, SolveWith(&solver, jam));
    }
  }
}

TEST(Ipm, ARowThatIsNonzeroBesideAZeroDiagonalIsUnsupported) {
  const Eigen::MatrixXd A = (Eigen::MatrixXd(2, 2) << 2, 1, 1, 0).finished();
  IpmSolver solver;
  const LcpProblem indefinite = LcpProblem::FromDense("indefinite", A, Eigen::Vector2d(-1, -0.5));
  EXPECT_EQ(SolveWith(&solver, indefinite).status, LcpStatus::kUnsupported);
}

// Other masses and loads on the same rows.
LcpProblem WithFactors(const LcpProblem& before, const Eigen::VectorXd& of_masses, const Eigen::VectorXd& push) {
  return LcpProblem::FromFactors("later", before.J(), before.inverse_mass().cwiseProduct(of_masses),
                                 before.b() + before.J() * push, before.bounds());
}

// Masses and loads a little later.
LcpProblem Drifted(const LcpProblem& before, double drift, unsigned seed) {
  std::mt19937_64 random(seed);
  const Index columns = before.J().cols();
  const Eigen::VectorXd of_masses = UniformVector(&random, columns, 1 - 0.5 * drift, 1 + 0.5 * drift);
  return WithFactors(before, of_masses, drift * UniformVector(&random, columns, -5, 5));
}

// Another set is tried only where the first one is nearly right.
TEST(Ipm, AGuessThatIsFarOffCostsOneFactorization) {
  IpmSolver cold;
  IpmSolver solver;
  solver.UseWarmStart(IpmSolver::WarmStart::kGuessOnly);
  int missed = 0;
  for (unsigned seed = 0; seed < 20; ++seed) {
    const LcpProblem before = Redundant(200, 60, seed);
    const Eigen::VectorXd f = SolveWith(&cold, before).f;
    const LcpResult result = SolveWith(&solver, Drifted(before, 0.3, seed), {.initial_f = &f});
    if (result.status == LcpStatus::kSolved) continue;
    EXPECT_EQ(result.status, LcpStatus::kIterationLimit);
    EXPECT_EQ(result.iterations, 1) << seed;
    ++missed;
  }
  EXPECT_GE(missed, 10);
}

TEST(Ipm, WarmStartsCostFewFactorizationsMoreThanColdOnes) {
  // Six of the guessed active set at most; where the start is near it is far less.
  constexpr std::int64_t kMostOfAGuess = 6;
  for (const double drift : {1e-4, 1e-2, 0.1, 0.3, 1.0}) {
    std::int64_t all_cold = 0, all_warm = 0;
    IpmSolver solver;
    for (unsigned seed = 0; seed < 20; ++seed) {
      const LcpProblem before = seed % 2 == 0 ? DiscPile(300, seed) : Redundant(60, 20, seed);
      const Eigen::VectorXd f = SolveWith(&solver, before).f;
      const LcpProblem after = Drifted(before, drift, seed);
      const LcpResult cold = SolveWith(&solver, after);
      const LcpResult warm = SolveWith(&solver, after, {.initial_f = &f});
      ExpectSolved(after, cold);
      ExpectSolved(after, warm);
      EXPECT_LE(warm.iterations, cold.iterations + kMostOfAGuess) << drift << " " << seed;
      all_cold += cold.iterations;
      all_warm += warm.iterations;
    }
    if (drift <= 1e-2) {
      EXPECT_LE(2 * all_warm, all_cold) << drift;
    }
  }
}

// Other masses, other loads, the same contacts.
LcpProblem OtherValues(const LcpProblem& problem, unsigned seed) {
  std::mt19937_64 random(seed);
  const Eigen::VectorXd scale = UniformVector(&random, problem.size(), 0.9, 1.1);
  const Eigen::VectorXd of_masses = UniformVector(&random, problem.J().cols(), 0.1, 10);
  return WithFactors(ScaleRows(problem, scale, 1), of_masses, UniformVector(&random, problem.J().cols(), -1, 1));
}

void ExpectGapsOfAFreshSolver(const LcpProblem& problem, Space space, const LcpResult& result) {
  IpmSolver fresh(InSpace(space));
  ExpectSameGaps(problem, result, SolveWith(&fresh, problem));
  EXPECT_EQ(fresh.statistics().analyses, 1);
}

LcpProblem WithoutRow(const LcpProblem& problem, Index row) {
  std::vector<Index> rows = EveryRow(problem.size());
  rows.erase(rows.begin() + row);
  return RowsOf(problem, rows);
}

// A body of row 199 leans on another neighbour.
LcpProblem WithANewPair(const LcpProblem& problem) {
  const SparseMatrix& J = problem.J();
  Triplets entries;
  for (Index i = 0; i < J.rows(); ++i) {
    for (SparseMatrix::InnerIterator it(J, i); it; ++it) {
      const bool moved = i == 199 && it.col() < 3 * 50;
      entries.emplace_back(static_cast<int>(i), static_cast<int>(it.col()) + (moved ? 6 : 0), it.value());
    }
  }
  entries.emplace_back(150, 0, 0.25);
  return LcpProblem::FromFactors("new pair", MatrixOf(J.rows(), J.cols(), entries), problem.inverse_mass(),
                                 problem.b());
}

TEST(Ipm, InASequenceKeepsTheAnalysisWhileTheContactGraphIsTheSame) {
  for (const Space space : {Space::kContact, Space::kBody}) {
    for (unsigned seed = 0; seed < 10; ++seed) {
      const LcpProblem before = DiscPile(200, seed);
      IpmSolver kept(InSpace(space));
      kept.SetInSequence(true);
      SolveWith(&kept, before);
      for (const LcpProblem& problem : {OtherValues(before, seed), before}) {
        const LcpResult result = SolveWith(&kept, problem);
        EXPECT_EQ(kept.statistics().analyses, 0);
        IpmSolver fresh(InSpace(space));
        const LcpResult expected = SolveWith(&fresh, problem);
        EXPECT_EQ(result.f, expected.f);
        EXPECT_EQ(result.iterations, expected.iterations);
      }
    }
  }
}

// In a sequence whose contacts change, answers are those of a fresh solver.
TEST(Ipm, ContactGraphsThatChangeALittleGiveTheSameGaps) {
  constexpr int kRows = 300;
  for (const Space space : {Space::kContact, Space::kBody}) {
    for (unsigned seed = 0; seed < 4; ++seed) {
      const LcpProblem before = DiscPile(kRows, seed);
      std::vector<Index> order(kRows);
      for (Index i = 0; i < kRows; ++i) order[static_cast<size_t>(i)] = (i * 77 + 5) % kRows;
      IpmSolver kept(InSpace(space));
      kept.SetInSequence(true);
      SolveWith(&kept, before);
      for (const LcpProblem& problem : {WithoutRow(before, 199), before, RowsOf(before, order), WithANewPair(before),
                                        before, DiscPile(kRows, seed + 1), DiscPile(kRows - 10, seed)}) {
        ExpectGapsOfAFreshSolver(problem, space, SolveWith(&kept, problem));
      }
    }
  }
}

// The answer of a problem with other contacts, as a start: whatever it is worth, the problem is solved.
TEST(Ipm, StartsWarmAfterContactsHaveComeAndGone) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    const LcpProblem whole = DiscPile(400, seed);
    std::mt19937 random(seed);
    std::vector<Index> before, after;
    for (Index i = 0; i < whole.size(); ++i) {
      if (random() % 20 != 0) before.push_back(i);
      if (random() % 20 != 0) after.push_back(i);
    }
    IpmSolver solver(IpmOptions{});
    const LcpResult first = SolveWith(&solver, RowsOf(whole, before));
    Eigen::VectorXd all = Eigen::VectorXd::Zero(whole.size());
    for (size_t k = 0; k < before.size(); ++k) all[before[k]] = first.f[static_cast<Index>(k)];
    Eigen::VectorXd start(static_cast<Index>(after.size()));
    for (size_t k = 0; k < after.size(); ++k) start[static_cast<Index>(k)] = all[after[k]];
    const LcpProblem problem = RowsOf(whole, after);
    ExpectSolved(problem, SolveWith(&solver, problem, {.initial_f = &start}));
  }
}

TEST(Ipm, LimitsAreCheckedBeforeEveryFactorization) {
  const LcpProblem problem = DiscPile(100, 4);
  IpmSolver solver;
  const std::int64_t needed = SolveWith(&solver, problem).iterations;
  for (std::int64_t limit = 1; limit < needed; ++limit) {
    const LcpResult counted = SolveWith(&solver, problem, {.max_iterations = limit});
    EXPECT_EQ(counted.status, LcpStatus::kIterationLimit);
    EXPECT_EQ(counted.iterations, limit);

    ticks = 0;  // the clock is read at the start, then before each factorization
    const LcpResult timed =
        SolveWith(&solver, problem, {.time_limit_s = static_cast<double>(limit) + 1, .now = &TickingClock});
    EXPECT_EQ(timed.status, LcpStatus::kTimeLimit);
    EXPECT_EQ(timed.iterations, limit);
    EXPECT_EQ(timed.f, counted.f);
  }
}

constexpr Index kRows = 600;  // above the size from which the hybrid uses sweeps

// Sweeps that do not last: the interior point has to finish.
HybridSolver WithFewSweeps() { return HybridSolver({.least_iterations = 5, .most_iterations = 6}); }

TEST(Hybrid, SweepsAloneSolveWhatTheyConvergeOn) {
  HybridSolver solver;
  for (unsigned seed = 0; seed < 10; ++seed) {
    const LcpProblem problem = DiscPile(kRows, seed);
    const LcpResult result = SolveWith(&solver, problem);
    ExpectSolved(problem, result);
    if (result.detail == "nncg") {
      EXPECT_GT(result.iterations, 10);
    }
  }
}

TEST(Hybrid, BothPhasesTogetherSolveWhatSweepsDoNot) {
  HybridSolver solver = WithFewSweeps();
  for (LcpProblem (*const generate)(Index, unsigned) : {&Column, &DiscPile}) {
    for (unsigned seed = 0; seed < 5; ++seed) {
      const LcpProblem problem = generate(kRows, seed);
      const LcpResult result = SolveWith(&solver, problem);
      ExpectSolved(problem, result);
      EXPECT_EQ(result.detail, "nncg; ipm");
      EXPECT_GT(result.iterations, solver.statistics().factorizations);
    }
  }
}

TEST(Hybrid, LimitsOfIterationsAreMetExactlyInEitherPhase) {
  const LcpProblem problem = Column(kRows, 3);
  HybridSolver solver = WithFewSweeps();
  const LcpResult whole = SolveWith(&solver, problem);
  ExpectSolved(problem, whole);
  for (std::int64_t limit = 1; limit < whole.iterations; ++limit) {
    const LcpResult result = SolveWith(&solver, problem, {.max_iterations = limit});
    EXPECT_EQ(result.iterations, limit);
    EXPECT_TRUE(result.f.allFinite());
    if (limit + 1 == whole.iterations && result.status == LcpStatus::kSolved) {
      ExpectSolved(problem, result);  // what the last iteration would only confirm may be accepted without it
    } else {
      EXPECT_EQ(result.status, LcpStatus::kIterationLimit) << limit;
    }
  }
}

TEST(Hybrid, TheDeadlineHoldsForBothPhasesTogether) {
  const LcpProblem problem = Column(kRows, 4);
  HybridSolver solver = WithFewSweeps();
  SolveWith(&solver, problem);
  LcpOptions options;
  ticks = 0;
  options.now = &TickingClock;
  options.time_limit_s = 1e9;
  ExpectSolved(problem, SolveWith(&solver, problem, options));
  const double looks = ticks;
  for (double limit = 1; limit < looks / 2; limit *= 1.5) {
    ticks = 0;
    options.time_limit_s = limit;
    const LcpResult result = SolveWith(&solver, problem, options);
    EXPECT_EQ(result.status, LcpStatus::kTimeLimit) << limit;
    EXPECT_TRUE(result.f.allFinite());
  }
}

// In factorizations, but for the one that tries the active set of the start; how many sweeps go before depends on when
// their rate shows that they will not do.
TEST(Hybrid, ASmallDriftTakesNoMoreFactorizationsThanACold) {
  for (LcpProblem (*const generate)(Index, unsigned) : {&Column, &DiscPile}) {
    for (unsigned seed = 0; seed < 10; ++seed) {
      HybridSolver solver;
      const LcpProblem before = generate(kRows, seed);
      const Eigen::VectorXd f = SolveWith(&solver, before).f;
      const LcpProblem after =
          LcpProblem::FromFactors("after", before.J(), 1.01 * before.inverse_mass(), 0.995 * before.b());
      SolveWith(&solver, after);
      const auto cold = std::max(solver.statistics().factorizations, decltype(IpmStatistics::factorizations){1});
      const LcpResult warm = SolveWith(&solver, after, {.initial_f = &f});
      ExpectSolved(after, warm);
      EXPECT_LE(solver.statistics().factorizations, cold);
    }
  }
}

// As many iterations as without it, and the same bits.
void ExpectPassedOver(LcpSolver* solver, const LcpProblem& problem, const Eigen::VectorXd& start) {
  const LcpResult cold = SolveWith(solver, problem);
  const LcpResult warm = SolveWith(solver, problem, {.initial_f = &start});
  EXPECT_EQ(warm.f, cold.f);
  EXPECT_EQ(warm.iterations, cold.iterations);
}

TEST(Starts, ThatSayNothingArePassedOver) {
  for (const Space space : {Space::kContact, Space::kBody}) {
    IpmSolver solver(InSpace(space));
    for (unsigned seed = 0; seed < 10; ++seed) {
      std::mt19937_64 random(seed);
      ExpectPassedOver(&solver, DiscPile(200, seed), UniformVector(&random, 200, 0, 1e4));
    }
  }
  for (LcpProblem (*const generate)(Index, unsigned) : {&Column, &DiscPile}) {
    const LcpProblem problem = generate(kRows, 6);
    HybridSolver solver;
    for (const double size : {1.0, 1e6}) {
      ExpectPassedOver(&solver, problem, Eigen::VectorXd::Constant(kRows, size * problem.b().cwiseAbs().maxCoeff()));
    }
  }
}

TEST(Hybrid, InfeasibleProblemsComeWithAnAcceptedRay) {
  HybridSolver solver;
  for (unsigned seed = 0; seed < 5; ++seed) {
    const LcpProblem jam = JammedColumn(kRows, seed);
    const Eigen::VectorXd start = Eigen::VectorXd::Ones(jam.size());
    for (const Eigen::VectorXd* initial_f : {static_cast<const Eigen::VectorXd*>(nullptr), &start}) {
      ExpectRay(jam, SolveWith(&solver, jam, {.initial_f = initial_f}));
    }
  }
}

}  // namespace
}  // namespace lcpbench
