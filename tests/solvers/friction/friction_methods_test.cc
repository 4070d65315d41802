// Methods for friction on generated time steps, each of which has a solution: docs/friction.md sections 5 and 11.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "solvers/friction/coulomb_path.h"
#include "solvers/friction/shift.h"
#include "solvers/lcp/verify.h"
#include "solvers/registry.h"
#include "tests/solvers/friction/friction_records.h"
#include "tests/solvers/friction/friction_suite.h"
#include "tests/solvers/solve_with.h"
#include "tests/solvers/test_problems.h"

namespace lcpbench {
namespace {

std::vector<LcpProblem> SomeProblems() {
  constexpr Index kMostContacts = 24;
  std::vector<LcpProblem> problems = StructuredFrictionProblems(7, kMostContacts);
  for (unsigned seed = 0; seed < 100; ++seed) problems.push_back(RandomFrictionProblem(seed, kMostContacts));
  return problems;
}

TEST(FrictionMethods, AutoSolvesTheRecords) {
  const std::unique_ptr<LcpSolver> solver = MakeSolver("auto");
  for (const FrictionRecord& record : FrictionRecords()) {
    const LcpResult result = SolveWith(solver.get(), record.problem());
    if (record.is_solved()) {
      ExpectSolved(record.problem(), result);
      EXPECT_LE(ComputeMetrics(record.problem(), result.f, &record.parsed.reference).w_error, 1e-9);
    } else {
      EXPECT_NE(result.status, LcpStatus::kSolved) << record.problem().id();
    }
  }
}

TEST(FrictionMethods, AutoSolvesEveryTimeStep) {
  const std::unique_ptr<LcpSolver> solver = MakeSolver("auto");
  for (const LcpProblem& problem : SomeProblems()) {
    for (const MatrixForm form : {MatrixForm::kFactors, MatrixForm::kSparse}) {
      const LcpProblem given = form == MatrixForm::kFactors ? problem : InForm(problem, form);
      ExpectSolved(given, SolveWith(solver.get(), given));
    }
  }
}

TEST(FrictionMethods, OthersSolveMostTimeStepsAndClaimNothingFalse) {
  for (const auto& [key, percent] : {std::pair("lemke", 99), {"shift", 97}, {"mode-newton", 95}}) {
    const std::unique_ptr<LcpSolver> solver = MakeSolver(key);
    int right = 0, all = 0;
    for (const LcpProblem& problem : SomeProblems()) {
      const LcpResult result = SolveWith(solver.get(), problem);
      const Verdict verdict = Verify(problem, result, 1e-9);
      EXPECT_FALSE(verdict.false_success) << key << " " << problem.id();
      EXPECT_NE(result.status, LcpStatus::kInfeasible) << key << " " << problem.id();
      ++all;
      right += verdict.passes;
    }
    EXPECT_GE(100 * right, percent * all) << key << ": " << right << " of " << all;
  }
}

// The path has no secondary ray where gaps do not shrink (docs/friction.md section 2, fact 1).
TEST(FrictionMethods, ThePathHasNoRayWhereASolutionExists) {
  const std::unique_ptr<LcpSolver> solver = MakeSolver("lemke");
  for (unsigned seed = 0; seed < 1000; ++seed) {
    const LcpProblem problem = RandomFrictionProblem(1000 + seed, 32);
    ExpectSolved(problem, SolveWith(solver.get(), problem));
  }
}

// Joints, contacts without friction and mu of up to 5 among them.
TEST(FrictionMethods, TheCentralPathOfCoulombsLawEndsMostlyAtAnAnswer) {
  int right = 0, all = 0;
  CoulombPath path;
  for (const LcpProblem& problem : SomeProblems()) {
    ContactRows rows;
    rows.Prepare(problem);
    if (!rows.can_relax()) continue;
    const LcpOptions options{.tolerance = 1e-9, .time_limit_s = 10};
    LcpResult result;
    result.f.setZero(problem.size());
    FrictionAnswer answer(rows, &problem, options, &result);
    ModeSteps newton;
    PaddedVector phi;
    const bool found = path.Follow(rows, 2000, &newton, &phi, &answer);
    EXPECT_EQ(found, Verify(problem, result, 1e-9).passes && result.status == LcpStatus::kSolved) << problem.id();
    right += found ? 1 : 0;
    ++all;
  }
  EXPECT_GE(100 * right, 95 * all) << right << " of " << all;
}

// With more unknowns than a dense factor takes: through the bodies from factors, by K itself from A. Drums are answered
// by paths of the normal map, where the residual of Newton steps has local minima.
TEST(FrictionMethods, AutoSolvesManyContactsFromEveryForm) {
  constexpr Index kMostContacts = 250;
  const std::unique_ptr<LcpSolver> solver = MakeSolver("auto");
  int solved = 0;
  for (const unsigned seed : {2U, 3U}) {
    for (const LcpProblem& problem : StructuredFrictionProblems(seed, kMostContacts)) {
      const std::string& id = problem.id();
      if (!id.starts_with("drum-100") && !id.starts_with("pile-100") && !id.starts_with("ramp-100")) continue;
      for (const MatrixForm form : {MatrixForm::kFactors, MatrixForm::kSparse}) {
        const LcpProblem given = form == MatrixForm::kFactors ? problem : InForm(problem, form);
        ExpectSolved(given, SolveWith(solver.get(), given));
        ++solved;
      }
    }
  }
  EXPECT_GE(solved, 40);
}

// Where sweeps alone meet a loose tolerance, `auto` asks for no relaxation, which may take longer than all its time.
TEST(FrictionMethods, LooseTolerancesAreMetBySweepsInLargeIslands) {
  const std::unique_ptr<LcpSolver> solver = MakeSolver("auto"), sweeps = MakeSolver("pgs");
  int swept = 0;
  for (const LcpProblem& problem : StructuredFrictionProblems(2, 250)) {
    if (problem.size() < 400) continue;
    const LcpResult by_sweeps = SolveWith(sweeps.get(), problem, {.tolerance = 1e-3});
    if (by_sweeps.status != LcpStatus::kSolved || by_sweeps.iterations > 400) continue;
    const LcpResult result = SolveWith(solver.get(), problem, {.tolerance = 1e-3});
    ExpectSolved(problem, result, 1e-3);
    EXPECT_EQ(result.detail.find("proximal"), std::string::npos) << problem.id() << " " << result.detail;
    if (result.detail.find("sweeps") != std::string::npos) ++swept;
  }
  EXPECT_GE(swept, 5);
}

// Such problems are brought into range first, and their coefficients of friction and bounds with them.
TEST(FrictionMethods, ExtremeUnitsHideNoAnswer) {
  std::mt19937 random(5);
  int solved = 0;
  for (const char* key : {"auto", "lemke", "mode-newton", "pgs", "lagged-bounds"}) {
    const std::unique_ptr<LcpSolver> solver = MakeSolver(key);
    for (const FrictionRecord& record : FrictionRecords()) {
      const LcpProblem& problem = record.problem();
      if (!record.is_solved() || !problem.has_factors()) continue;
      if (SolveWith(solver.get(), problem).status != LcpStatus::kSolved) continue;
      Eigen::VectorXd scale(problem.size());
      const int middle = std::uniform_int_distribution<>(-290, 290)(random);
      for (double& s : scale) s = std::exp2(middle + std::uniform_int_distribution<>(-8, 8)(random));
      SCOPED_TRACE(key);
      const LcpProblem scaled = ScaleRows(problem, scale, 1);
      ExpectSolved(scaled, SolveWith(solver.get(), scaled));
      ++solved;
    }
  }
  EXPECT_GE(solved, 200);
}

// Both its answers are right where w is not unique, so that laws are about the answer that follows from the other.
TEST(FrictionMethods, AnswersFollowUnitsOrderAndMirror) {
  std::mt19937 random(3);
  for (const char* key : {"auto", "lemke", "shift", "mode-newton"}) {
    const std::unique_ptr<LcpSolver> solver = MakeSolver(key);
    for (unsigned seed = 0; seed < 40; ++seed) {
      const LcpProblem problem = RandomFrictionProblem(5000 + seed, 8);
      const Index n = problem.size();
      std::vector<Index> order = EveryRow(n);
      std::ranges::shuffle(order, random);
      Eigen::VectorXd scale(n);
      for (double& s : scale) s = std::exp2(std::uniform_int_distribution<>(-8, 8)(random));
      for (const FrictionRow& row : problem.friction_rows()) scale[row.row] *= -1;  // the mirror
      const Eigen::VectorXd factor = scale(order);
      LcpResult back = SolveWith(solver.get(), RowsOf(problem, order, factor));
      if (back.status != LcpStatus::kSolved) continue;
      const Eigen::VectorXd f = factor.cwiseProduct(back.f);
      back.f(order) = f;
      EXPECT_TRUE(Verify(problem, back, 1.01e-9).passes) << key << " " << problem.id();
    }
  }
}

TEST(FrictionMethods, WarmStartsAtAnAnswerStayThere) {
  for (const char* key : {"auto", "mode-newton"}) {
    const std::unique_ptr<LcpSolver> solver = MakeSolver(key);
    for (unsigned seed = 0; seed < 40; ++seed) {
      const LcpProblem problem = RandomFrictionProblem(6000 + seed, 16);
      const LcpResult cold = SolveWith(solver.get(), problem);
      if (cold.status != LcpStatus::kSolved) continue;
      const LcpResult warm = SolveWith(solver.get(), problem, {.initial_f = &cold.f});
      EXPECT_EQ(warm.status, LcpStatus::kSolved) << key << " " << problem.id();
      EXPECT_LE(warm.iterations, 3 * static_cast<std::int64_t>(problem.size())) << key << " " << problem.id();
    }
  }
}

// Without friction the normal forces of what is built on `auto` are those of `auto`, bit by bit.
TEST(FrictionMethods, WithoutFrictionTheBitsArePlainOnes) {
  const std::unique_ptr<LcpSolver> plain = MakeSolver("auto");
  for (const auto& [key, error_of_w] : {std::pair("auto", 0.0),
                                        {"shift", 0.0},
                                        {"relaxation", 0.0},
                                        {"lemke", 1e-7},
                                        {"mode-newton", 1e-7},
                                        {"pgs", 1e-6},
                                        {"psor", 1e-6}}) {
    const std::unique_ptr<LcpSolver> solver = MakeSolver(key);
    for (unsigned seed = 0; seed < 60; ++seed) {
      const LcpProblem problem = RandomFrictionProblem(7000 + seed, 20);
      RowBounds bounds = problem.bounds();
      std::vector<Index> rows;
      for (Index i = 0; i < problem.size(); ++i) {
        if (problem.kind(i) != RowKind::kFriction) rows.push_back(i);
      }
      const LcpProblem without = RowsOf(problem, rows);
      for (FrictionRow& row : bounds.friction) row.mu = 0;
      const LcpResult known = SolveWith(plain.get(), without);
      const LcpResult result = SolveWith(solver.get(), problem.WithBounds(bounds));
      if (known.status != LcpStatus::kSolved || result.status != LcpStatus::kSolved) continue;
      for (const FrictionRow& row : bounds.friction) EXPECT_EQ(result.f[row.row], 0) << key;
      if (error_of_w == 0) {
        EXPECT_EQ(result.f(rows), known.f) << key << " " << problem.id();
      } else {
        const Eigen::VectorXd w = ComputeMetrics(problem, result.f).w;
        const Eigen::VectorXd expected = ComputeMetrics(without, known.f).w;
        EXPECT_LE((w(rows) - expected).cwiseAbs().maxCoeff(), error_of_w * (1 + problem.b().cwiseAbs().maxCoeff()))
            << key;
      }
    }
  }
}

// A wedge that gravity drives apart between moving walls: no normal forces hold it.
TEST(FrictionMethods, InfeasibleOnlyByARayOfNormalForces) {
  const std::unique_ptr<LcpSolver> solver = MakeSolver("auto");
  for (unsigned seed = 0; seed < 20; ++seed) {
    const LcpProblem problem = RandomFrictionProblem(8000 + seed, 6);
    // Each contact once more with the opposite normal: both gaps cannot grow.
    const Index n = problem.size();
    std::vector<Index> rows = EveryRow(n);
    for (Index i = 0; i < n; ++i) rows.push_back(i);
    Eigen::VectorXd side = Eigen::VectorXd::Ones(2 * n);
    side.tail(n) *= -1;
    LcpProblem opposed = RowsOf(problem, rows, side);
    Eigen::VectorXd b = opposed.b();
    for (const FrictionRow& row : problem.friction_rows()) b[n + row.normal] -= 0.125;
    opposed = opposed.WithB(b);
    ExpectRay(opposed, SolveWith(solver.get(), opposed));
  }
}

// Two motors that pull against each other without a limit, beside contacts that have a solution.
TEST(FrictionMethods, InfeasibleByARayOfBoundedRows) {
  constexpr double kUnlimited = std::numeric_limits<double>::infinity();
  for (unsigned seed = 0; seed < 20; ++seed) {
    const LcpProblem problem = RandomFrictionProblem(8000 + seed, 6);
    const Index n = problem.size();
    std::vector<Index> rows = EveryRow(n);
    rows.insert(rows.end(), {0, 0});
    Eigen::VectorXd side = Eigen::VectorXd::Ones(n + 2);
    side[n + 1] = -1;
    LcpProblem pulled = RowsOf(problem, rows, side);
    RowBounds bounds = pulled.bounds();
    bounds.bounded = {{n, 0, kUnlimited}, {n + 1, 0, kUnlimited}};
    Eigen::VectorXd b = pulled.b();
    b.tail(2).setConstant(-1);
    pulled = pulled.WithBounds(bounds).WithB(b);
    ExpectRay(pulled, SolveBy("auto", pulled));
  }
}

TEST(FrictionMethods, MadeForFrictionRefusePlainProblemsByName) {
  const Eigen::Matrix2d A{{2, 1}, {1, 2}};
  const LcpProblem plain = LcpProblem::FromDense("plain", A, Eigen::Vector2d(-1, -2));
  RowBounds bounds;
  bounds.bilateral = {1, 0};
  const LcpProblem with_joint = LcpProblem::FromDense("joint", A, Eigen::Vector2d(-1, -2), bounds);
  int refusing = 0;
  for (const SolverEntry& entry : AllSolvers()) {
    if (entry.takes_plain || !entry.available) continue;
    ++refusing;
    for (const LcpProblem& problem : {plain, with_joint}) {
      const LcpResult result = SolveWith(entry.make({}).get(), problem);
      EXPECT_EQ(result.status, LcpStatus::kUnsupported) << entry.key;
      EXPECT_EQ(result.detail, "plain rows: the method is made for friction") << entry.key;
    }
    if (!entry.takes_bounded) continue;
    bounds.bounded = {{1, -1, 1}};
    const LcpProblem bounded = LcpProblem::FromDense("bounded", A, Eigen::Vector2d(-1, -2), bounds);
    const LcpResult result = SolveWith(entry.make({}).get(), bounded);
    EXPECT_EQ(result.status, LcpStatus::kSolved) << entry.key << ": " << result.detail;
    bounds.bounded.clear();
  }
  EXPECT_GE(refusing, 4);
}

// A contact that sticks obeys both laws, one that slips the relaxed one only: f = (2, 1), w = (.5, -1) and Coulomb's
// f = (2, 1), w = (0, -1) differ by the opening mu |w_t|.
TEST(FrictionMethods, ARelaxedAnswerSaysWhoseLawItObeys) {
  RowBounds bounds;
  bounds.friction = {{.row = 1, .normal = 0, .mu = 0.5}};
  for (const double pull : {-0.25, -3.0}) {
    const LcpProblem problem =
        LcpProblem::FromDense("block", Eigen::Matrix2d::Identity(), Eigen::Vector2d(-2, pull), bounds);
    const LcpResult result = SolveWith(MakeSolver("relaxation").get(), problem);
    EXPECT_EQ(result.status, LcpStatus::kSolved) << result.detail;
    EXPECT_NE(result.detail.find("the relaxed law's answer"), std::string::npos) << result.detail;
    const Verdict verdict = Verify(problem, result, 1e-9);
    EXPECT_EQ(verdict.passes, pull > -1);
    EXPECT_FALSE(verdict.false_success);
  }
}

// A solver of plain problems that breaks down.
class Broken final : public LcpSolver {
  void DoPrepare(const LcpProblem& /*problem*/) override {}
  void DoSolve(const LcpProblem& /*problem*/, const LcpOptions& /*options*/, LcpResult* result) override {
    result->f.setConstant(std::numeric_limits<double>::quiet_NaN());
  }
};

TEST(FrictionMethods, ARelaxationWithoutForcesEndsTheRoundsOfShift) {
  for (const Index contacts : {1, 3, 40}) {
    const LcpProblem problem = RandomFrictionProblem(7, contacts);
    ShiftSolver solver(WithinOptions{[] { return std::make_unique<Broken>(); }});
    const LcpResult result = SolveWith(&solver, problem);
    EXPECT_EQ(result.status, LcpStatus::kNumericalFailure) << result.detail;
    EXPECT_TRUE(result.f.allFinite());
  }
}

}  // namespace
}  // namespace lcpbench
