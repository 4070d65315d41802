// How auto divides, chooses, verifies and falls back.

#include "solvers/auto/auto_solver.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <fstream>
#include <iterator>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "solvers/active_set/semismooth_newton.h"
#include "solvers/auto/auto_rules.h"
#include "support/input_error.h"
#include "support/number_text.h"
#include "tests/solvers/exact_problems.h"
#include "tests/solvers/solve_with.h"

namespace lcpbench {
namespace {

using Eigen::VectorXd;

LcpResult Solve(const LcpProblem& problem, const LcpOptions& options = {}) {
  AutoSolver solver;
  return SolveWith(&solver, problem, options);
}

// Parts of 5 to 90 rows: tableaus, and a portfolio for what is larger. By A, since rows on two bodies go another way.
LcpProblem Archipelago(unsigned seed) {
  TestRandom random(seed);
  std::vector<LcpProblem> parts;
  const int count = random.Integer(4, 12);
  for (int k = 0; k < count; ++k) {
    const int rows = random.Chance(0.2) ? random.Integer(70, 90) : random.Integer(5, 40);
    parts.push_back(PlantedProblem(rows, random.Integer(rows / 4 + 1, rows), 17 * seed + static_cast<unsigned>(k),
                                   random.Integer(0, 5), random.Integer(0, 4))
                        .problem);
  }
  return InForm(Compose(parts, seed), MatrixForm::kSparse);
}

TEST(AutoRules, TheDocumentShowsTheTableThatRuns) {
  std::ifstream file(LCPBENCH_SOURCE_DIR "/docs/solvers/auto.md");
  const std::string page{std::istreambuf_iterator<char>(file), {}};
  EXPECT_NE(page.find(AutoRulesAsMarkdown()), std::string::npos) << "expected what `lcpbench list rules` prints";
}

TEST(AutoLimits, HaveNamesOfTheirOwnAndAreDocumented) {
  std::ifstream file(LCPBENCH_SOURCE_DIR "/docs/solvers/auto.md");
  const std::string page{std::istreambuf_iterator<char>(file), {}};
  EXPECT_NE(page.find(AutoLimitsAsMarkdown()), std::string::npos) << "expected what `lcpbench list limits` prints";
  std::set<std::string_view> names;
  for (const AutoLimit& limit : kAutoLimits) {
    EXPECT_TRUE(names.insert(limit.name).second) << limit.name;
    EXPECT_FALSE(limit.meaning.empty() || limit.unit.empty()) << limit.name;
    // No two names are of one member: what is set is what is read, and nothing else changes.
    AutoLimits limits;
    limit.Set(limit.least == limit.Of(limits) ? limit.most : limit.least, &limits);
    for (const AutoLimit& other : kAutoLimits) {
      EXPECT_EQ(other.Of(limits) == other.Of(kDefaultLimits), other.name != limit.name) << limit.name << other.name;
    }
    const std::string name(limit.name);
    EXPECT_EQ(limit.Of(AutoOptions::FromSettings({{name, NumberText(limit.most)}}).limits), limit.most);
    EXPECT_THROW(AutoOptions::FromSettings({{name, NumberText(limit.most * 2)}}), InputError);
    EXPECT_THROW(AutoOptions::FromSettings({{name, "-1"}}), InputError);
  }
}

TEST(AutoLimits, OthersLeadToOtherMethods) {
  const LcpProblem problem = InForm(DiscPile(60, 1), MatrixForm::kSparse);
  AutoSolver small({.limits = {.tableau_rows = 0, .hard_tableau_rows = 0}});
  const LcpResult result = SolveWith(&small, problem);
  ExpectSolved(problem, result);
  EXPECT_EQ(Solve(problem).detail, "tableau");
  EXPECT_NE(result.detail, "tableau");
  EXPECT_THROW(AutoSolver({.limits = {.tableau_rows = 129}}), InputError);
}

// Whatever the facts are, one method or another is asked of a problem, and limits are granted.
TEST(AutoRules, SomeBackendIsAlwaysAsked) {
  for (unsigned bits = 0; bits < 512; ++bits) {
    const AutoFacts facts{.rows = 950,
                          .tableau_failed = (bits & 1U) != 0,
                          .is_redundant = (bits & 2U) != 0,
                          .is_large = (bits & 4U) != 0,
                          .is_wide_sparse = (bits & 8U) != 0,
                          .is_packing = (bits & 16U) != 0,
                          .has_dense_factor = (bits & 32U) != 0,
                          .has_dependent_rows = (bits & 64U) != 0,
                          .has_swept = (bits & 128U) != 0,
                          .factor_time = (bits & 256U) != 0 ? 100.0 : 1.0};
    int asked = 0;
    for (const AutoRule& rule : AutoRulesOf(AutoStage::kBackends)) {
      EXPECT_GE(rule.Grants(facts), 0);
      asked += rule.Grants(facts) == kOwnLimit ? 1 : 0;
    }
    EXPECT_GE(asked, 2);
  }
}

TEST(AutoSolver, SolvesIslandsOneByOne) {
  int divided = 0;
  int with_rest = 0;
  for (unsigned seed = 0; seed < 60; ++seed) {
    const LcpProblem problem = Archipelago(seed);
    for (const double tolerance : {1e-3, 1e-6, 1e-9}) {
      const LcpResult result = Solve(problem, {.tolerance = tolerance});
      ExpectSolved(problem, result, tolerance);
      const bool says_so = result.detail.find(" islands, largest ") != std::string::npos;
      divided += says_so ? 1 : 0;
      with_rest += says_so && result.detail.find("; ") != std::string::npos ? 1 : 0;
    }
  }
  EXPECT_GT(divided, 90);
  EXPECT_GT(with_rest, 10);
}

// Above AutoLimits::large_rows: one island or one that dominates stays whole, many are taken one by one, and a few
// large ones go to the portfolio together. Ladder takes none of them in place.
TEST(AutoSolver, DividesLargeProblemsWhereTheirColumnsDo) {
  const auto check = [](const LcpProblem& problem, bool divides) {
    AutoSolver solver({.limits = {.step_rows = 0}});
    const LcpResult result = SolveWith(&solver, problem, {});
    ExpectSolved(problem, result);
    EXPECT_EQ(result.detail.find(" islands, largest ") != std::string::npos, divides) << result.detail;
  };
  for (unsigned seed = 0; seed < 6; ++seed) {
    for (LcpProblem (*const generate)(Index, unsigned) : {&Column, &DiscPile}) {
      check(generate(1200, seed), false);
      check(Compose({generate(1200, seed), Column(50, seed)}, seed), false);
      check(Compose({generate(1200, seed), generate(1000, seed + 1)}, seed), false);
      std::vector<LcpProblem> parts;
      for (unsigned k = 0; k < 40; ++k) parts.push_back(generate(40, 40 * seed + k));
      check(Compose(parts, seed), true);
    }
  }
}

TEST(AutoSolver, TakesAProblemByFactorsByItsRows) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    const LcpProblem problem = DiscPile(20 + 8 * static_cast<Index>(seed), seed);
    AutoSolver solver;
    solver.Prepare(problem);
    for (const double factor : {1.0, -0.5, 3.0}) {  // one preparation serves every b
      const LcpProblem other = problem.WithB(factor * problem.b());
      const LcpResult result = SolveWith(&solver, other);
      ExpectSolved(other, result);
      EXPECT_EQ(result.detail, "rows");
      AutoSolver fresh;
      EXPECT_EQ(result.f, SolveArraysWith(&fresh, other).f);
    }
  }
}

// What arrays of another problem leave behind is not what was prepared.
TEST(AutoSolver, ArraysOfAnotherProblemDoNotSpoilWhatWasPrepared) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    const LcpProblem problem = DiscPile(20 + static_cast<Index>(seed), seed);
    AutoSolver solver;
    SolveWith(&solver, problem);
    SolveArraysWith(&solver, DiscPile(40, seed + 100));
    const LcpProblem with_b = problem.WithB(2 * problem.b());
    ExpectSolved(with_b, SolveWith(&solver, with_b));
  }
}

TEST(AutoSolver, AWarmStartChangesTheWayAndNotTheAnswer) {
  for (unsigned seed = 100; seed < 130; ++seed) {
    const LcpProblem problem = seed % 2 == 0 ? Archipelago(seed) : PlantedProblem(150, 60, seed, 5, 4).problem;
    const LcpResult cold = Solve(problem);
    ExpectSolved(problem, cold);
    const LcpResult warm = Solve(problem, {.initial_f = &cold.f});
    ExpectSolved(problem, warm);
    TestRandom random(seed);
    VectorXd wrong(problem.size());
    for (Index i = 0; i < wrong.size(); ++i) wrong[i] = random.Integer(-5, 5);
    ExpectSolved(problem, Solve(problem, {.initial_f = &wrong}));
  }
}

// An impact on one body of many that rest: b is rounding in all rows but one, and the rows that pushed before do not
// any more. Their forces are rounding, too, but signs still count.
TEST(AutoSolver, AWarmStartIntoAnImpactIsJudgedByWhatItReturns) {
  for (unsigned seed = 0; seed < 400; ++seed) {
    TestRandom random(seed);
    const int rest = random.Integer(2, 12);
    const int n = rest + random.Integer(1, 3);
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(n, n);
    VectorXd b(n);
    const auto couple = [&](int begin, int end) {
      for (int i = begin; i < end; ++i) {
        A(i, i) = 2;
        b[i] = 1e-16 * random.Integer(-1000, 1000) / 1000.0;
        if (i + 1 < end) A(i, i + 1) = A(i + 1, i) = random.Integer(-9, 9) / 10.0;
      }
    };
    couple(0, rest);
    couple(rest, n);
    b[n - 1] = -random.Integer(1, 10) / 10.0;
    const VectorXd start = VectorXd::Ones(n);
    const LcpProblem problem = LcpProblem::FromDense("impact-" + std::to_string(seed), A, b);
    for (const double tolerance : {1e-3, 1e-6, 1e-9}) {
      ExpectSolved(problem, Solve(problem, {.tolerance = tolerance, .initial_f = &start}), tolerance);
    }
  }
}

// One unsolvable island among many solvable ones: the ray is of the whole problem.
TEST(AutoSolver, ProvesThatOneIslandHasNoSolution) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    std::vector<LcpProblem> parts;
    for (unsigned k = 0; k < 8; ++k) parts.push_back(PlantedProblem(15, 8, 9 * seed + k, 0, 3).problem);
    // Two opposed rows on one body that would both have to give way.
    SparseMatrix J(2, 3);
    J.insert(0, 0) = 1;
    J.insert(1, 0) = -1;
    parts.push_back(LcpProblem::FromFactors("squeezed", J, VectorXd::Ones(3), Eigen::Vector2d(-1, -0.5)));
    const LcpProblem problem = Compose(parts, seed);
    ExpectRay(problem, Solve(problem));
  }
}

// The Newton method comes first here and goes on from the start it is given, which Dantzig pivoting, the last, leaves.
TEST(AutoSolver, ReturnsTheBestPointWhereNoBackendArrives) {
  int unsolved = 0;
  for (unsigned seed = 0; seed < 40; ++seed) {
    const int rows = 60 + static_cast<int>(seed);
    const LcpProblem problem = PlantedProblem(rows, rows / 4, seed, 0, 5).problem;
    TestRandom random(seed);
    VectorXd near_f = Solve(problem).f;
    for (Index i = 0; i < near_f.size(); ++i) near_f[i] += 0.1 * random.Integer(0, 10);
    for (const std::int64_t most : {1, 2, 3}) {
      const LcpOptions options{.tolerance = 1e-12, .max_iterations = most, .initial_f = &near_f};
      const LcpResult all = Solve(problem, options);
      if (all.status == LcpStatus::kSolved) continue;
      ++unsolved;
      ASSERT_EQ(all.detail.rfind("semismooth-newton", 0), 0U) << all.detail;
      SemismoothNewtonSolver newton;
      const LcpResult first = SolveWith(&newton, problem, options);
      EXPECT_LE(Verify(problem, all, 1e-12).metrics.rho, Verify(problem, first, 1e-12).metrics.rho * (1 + 1e-9))
          << "seed " << seed << ", " << most << " iterations: " << all.detail;
    }
  }
  EXPECT_GT(unsolved, 40);
}

TEST(AutoSolver, SolvesByEveryInstructionSet) {
  for (const InstructionSet set : AvailableInstructionSets()) {
    const AutoOptions options = AutoOptions::FromSettings({{"instructions", std::string(ToString(set))}});
    EXPECT_EQ(options.instructions, set);
    AutoSolver solver(options);
    for (unsigned seed = 0; seed < 10; ++seed) {
      const LcpProblem problem = Archipelago(seed);
      ExpectSolved(problem, SolveWith(&solver, problem));
    }
  }
}

}  // namespace
}  // namespace lcpbench
