// Methods for friction on generated time steps, each of which has a solution: docs/friction.md sections 5 and 11.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include "solvers/friction/shift.h"
#include "solvers/lcp/verify.h"
#include "solvers/registry.h"
#include "tests/solvers/friction/friction_records.h"
#include "tests/solvers/friction/friction_suite.h"

namespace lcpbench {
namespace {

// By iterations, not by the clock, so that the outcome is the same on every machine.
LcpResult SolveTo(LcpSolver* solver, const LcpProblem& problem, double tolerance = 1e-9) {
  LcpOptions options;
  options.tolerance = tolerance;
  options.time_limit_s = 60;
  LcpResult result;
  solver->Solve(problem, options, &result);
  return result;
}

// Rows scaled by `scale`, in the order `order`: row k of the new problem is row order[k] of the old one.
LcpProblem Rearranged(const LcpProblem& problem, const std::vector<Index>& order, const Eigen::VectorXd& scale) {
  const Index n = problem.size();
  std::vector<Index> place(static_cast<size_t>(n));
  SparseMatrix P(n, n);
  std::vector<Eigen::Triplet<double, int>> entries;
  for (Index k = 0; k < n; ++k) {
    const Index row = order[static_cast<size_t>(k)];
    place[static_cast<size_t>(row)] = k;
    entries.emplace_back(static_cast<int>(k), static_cast<int>(row), scale[row]);
  }
  P.setFromTriplets(entries.begin(), entries.end());
  std::vector<Index> bilateral;
  for (const Index row : problem.bilateral_rows()) bilateral.push_back(place[static_cast<size_t>(row)]);
  RowBounds bounds = RowBounds::WithBilateralRows(n, bilateral);
  for (FrictionRow row : problem.friction_rows()) {
    row.mu *= std::abs(scale[row.normal] / scale[row.row]);
    row.row = place[static_cast<size_t>(row.row)];
    row.normal = place[static_cast<size_t>(row.normal)];
    bounds.friction.push_back(row);
  }
  for (BoundedRow row : problem.bounded_rows()) {
    row.lower /= scale[row.row];
    row.upper /= scale[row.row];
    if (row.lower > row.upper) std::swap(row.lower, row.upper);
    row.row = place[static_cast<size_t>(row.row)];
    bounds.bounded.push_back(row);
  }
  return LcpProblem::FromFactors(problem.id(), P * problem.J(), problem.inverse_mass(), P * problem.b(), bounds);
}

std::vector<Index> InOrder(Index n) {
  std::vector<Index> order(static_cast<size_t>(n));
  std::iota(order.begin(), order.end(), 0);
  return order;
}

std::vector<LcpProblem> SomeProblems() {
  constexpr Index kMostContacts = 24;
  std::vector<LcpProblem> problems = StructuredFrictionProblems(7, kMostContacts);
  for (unsigned seed = 0; seed < 100; ++seed) problems.push_back(RandomFrictionProblem(seed, kMostContacts));
  return problems;
}

TEST(FrictionMethods, AutoSolvesTheRecords) {
  const std::unique_ptr<LcpSolver> solver = MakeSolver("auto");
  for (const FrictionRecord& record : FrictionRecords()) {
    const LcpResult result = SolveTo(solver.get(), record.problem());
    const Verdict verdict = Verify(record.problem(), result, 1e-9, &record.parsed.reference);
    if (!record.is_solved()) {
      EXPECT_NE(result.status, LcpStatus::kSolved) << record.problem().id();
      continue;
    }
    EXPECT_EQ(result.status, LcpStatus::kSolved) << record.problem().id() << " " << result.detail;
    EXPECT_TRUE(verdict.passes) << record.problem().id() << " " << verdict.reason;
    if (record.parsed.reference.w) {
      EXPECT_LE((verdict.metrics.w - *record.parsed.reference.w).cwiseAbs().maxCoeff(),
                1e-9 * (1 + record.problem().b().cwiseAbs().maxCoeff()))
          << record.problem().id();
    }
  }
}

TEST(FrictionMethods, AutoSolvesEveryTimeStep) {
  const std::unique_ptr<LcpSolver> solver = MakeSolver("auto");
  for (const LcpProblem& problem : SomeProblems()) {
    for (const MatrixForm form : {MatrixForm::kFactors, MatrixForm::kSparse}) {
      const LcpProblem given = form == MatrixForm::kFactors ? problem : InForm(problem, form);
      const LcpResult result = SolveTo(solver.get(), given);
      EXPECT_EQ(result.status, LcpStatus::kSolved) << problem.id() << " " << result.detail;
      EXPECT_TRUE(Verify(given, result, 1e-9).passes) << problem.id();
    }
  }
}

TEST(FrictionMethods, OthersSolveMostTimeStepsAndClaimNothingFalse) {
  for (const auto& [key, percent] : {std::pair("lemke", 99), {"shift", 97}, {"mode-newton", 95}}) {
    const std::unique_ptr<LcpSolver> solver = MakeSolver(key);
    int right = 0, all = 0;
    for (const LcpProblem& problem : SomeProblems()) {
      const LcpResult result = SolveTo(solver.get(), problem);
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
    const LcpResult result = SolveTo(solver.get(), problem);
    EXPECT_TRUE(Verify(problem, result, 1e-9).passes) << problem.id() << " " << result.detail;
  }
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
        const LcpResult result = SolveTo(solver.get(), given);
        EXPECT_TRUE(Verify(given, result, 1e-9).passes) << id << " seed " << seed << " " << result.detail;
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
    const LcpResult by_sweeps = SolveTo(sweeps.get(), problem, 1e-3);
    if (by_sweeps.status != LcpStatus::kSolved || by_sweeps.iterations > 400) continue;
    const LcpResult result = SolveTo(solver.get(), problem, 1e-3);
    EXPECT_TRUE(Verify(problem, result, 1e-3).passes) << problem.id() << " " << result.detail;
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
      if (SolveTo(solver.get(), problem).status != LcpStatus::kSolved) continue;
      Eigen::VectorXd scale(problem.size());
      const int middle = std::uniform_int_distribution<>(-290, 290)(random);
      for (double& s : scale) s = std::exp2(middle + std::uniform_int_distribution<>(-8, 8)(random));
      const LcpProblem scaled = Rearranged(problem, InOrder(problem.size()), scale);
      const LcpResult result = SolveTo(solver.get(), scaled);
      EXPECT_TRUE(Verify(scaled, result, 1e-9).passes) << key << " " << problem.id() << " " << result.detail;
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
      std::vector<Index> order = InOrder(n);
      std::ranges::shuffle(order, random);
      Eigen::VectorXd scale(n);
      for (double& s : scale) s = std::exp2(std::uniform_int_distribution<>(-8, 8)(random));
      for (const FrictionRow& row : problem.friction_rows()) scale[row.row] *= -1;  // the mirror
      const LcpProblem other = Rearranged(problem, order, scale);
      const LcpResult result = SolveTo(solver.get(), other);
      if (result.status != LcpStatus::kSolved) continue;
      LcpResult back = result;
      for (Index k = 0; k < n; ++k) {
        back.f[order[static_cast<size_t>(k)]] = scale[order[static_cast<size_t>(k)]] * result.f[k];
      }
      EXPECT_TRUE(Verify(problem, back, 1.01e-9).passes) << key << " " << problem.id();
    }
  }
}

TEST(FrictionMethods, WarmStartsAtAnAnswerStayThere) {
  for (const char* key : {"auto", "mode-newton"}) {
    const std::unique_ptr<LcpSolver> solver = MakeSolver(key);
    for (unsigned seed = 0; seed < 40; ++seed) {
      const LcpProblem problem = RandomFrictionProblem(6000 + seed, 16);
      const LcpResult cold = SolveTo(solver.get(), problem);
      if (cold.status != LcpStatus::kSolved) continue;
      LcpOptions options;
      options.initial_f = &cold.f;
      LcpResult warm;
      solver->Solve(problem, options, &warm);
      EXPECT_EQ(warm.status, LcpStatus::kSolved) << key << " " << problem.id();
      EXPECT_LE(warm.iterations, 3 * static_cast<std::int64_t>(problem.size())) << key << " " << problem.id();
    }
  }
}

// Without friction the normal forces of what is built on `auto` are those of `auto`, bit by bit.
TEST(FrictionMethods, WithoutFrictionTheBitsArePlainOnes) {
  const std::unique_ptr<LcpSolver> plain = MakeSolver("auto");
  for (const char* key : {"auto", "shift", "relaxation", "lemke", "mode-newton"}) {
    const std::unique_ptr<LcpSolver> solver = MakeSolver(key);
    const bool same_bits = std::string(key) != "lemke" && std::string(key) != "mode-newton";
    for (unsigned seed = 0; seed < 60; ++seed) {
      const LcpProblem problem = RandomFrictionProblem(7000 + seed, 20);
      RowBounds bounds = problem.bounds();
      std::vector<Eigen::Triplet<double, int>> kept;
      std::vector<Index> rows, bilateral;
      for (Index i = 0; i < problem.size(); ++i) {
        if (problem.kind(i) == RowKind::kFriction) continue;
        if (problem.is_bilateral(i)) bilateral.push_back(static_cast<Index>(rows.size()));
        kept.emplace_back(static_cast<int>(rows.size()), static_cast<int>(i), 1);
        rows.push_back(i);
      }
      SparseMatrix P(static_cast<Index>(rows.size()), problem.size());
      P.setFromTriplets(kept.begin(), kept.end());
      const LcpProblem without =
          LcpProblem::FromFactors("plain", P * problem.J(), problem.inverse_mass(), P * problem.b(),
                                  RowBounds::WithBilateralRows(P.rows(), bilateral));
      for (FrictionRow& row : bounds.friction) row.mu = 0;
      const LcpResult known = SolveTo(plain.get(), without);
      const LcpResult result = SolveTo(solver.get(), problem.WithBounds(bounds));
      if (known.status != LcpStatus::kSolved || result.status != LcpStatus::kSolved) continue;
      for (const FrictionRow& row : bounds.friction) EXPECT_EQ(result.f[row.row], 0) << key;
      if (same_bits) {
        EXPECT_EQ(P * result.f, known.f) << key << " " << problem.id();
      } else {
        const Eigen::VectorXd w = ComputeMetrics(problem, result.f).w;
        const Eigen::VectorXd expected = ComputeMetrics(without, known.f).w;
        EXPECT_LE((P * w - expected).cwiseAbs().maxCoeff(), 1e-7 * (1 + problem.b().cwiseAbs().maxCoeff())) << key;
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
    SparseMatrix twice(2 * n, problem.J().cols());
    std::vector<Eigen::Triplet<double, int>> entries;
    for (Index i = 0; i < n; ++i) {
      for (SparseMatrix::InnerIterator it(problem.J(), i); it; ++it) {
        entries.emplace_back(static_cast<int>(i), static_cast<int>(it.col()), it.value());
        entries.emplace_back(static_cast<int>(n + i), static_cast<int>(it.col()), -it.value());
      }
    }
    twice.setFromTriplets(entries.begin(), entries.end());
    RowBounds bounds = problem.bounds();
    bounds.bilateral.clear();
    std::vector<Index> bilateral;
    for (const Index row : problem.bilateral_rows()) bilateral.insert(bilateral.end(), {row, n + row});
    RowBounds both = RowBounds::WithBilateralRows(2 * n, bilateral);
    both.friction = bounds.friction;
    for (const FrictionRow& row : bounds.friction) both.friction.push_back({n + row.row, n + row.normal, row.mu});
    Eigen::VectorXd b(2 * n);
    b << problem.b(), -problem.b();
    for (const FrictionRow& row : bounds.friction) b[n + row.normal] -= 0.125;
    const LcpProblem opposed =
        LcpProblem::FromFactors(problem.id() + "-opposed", twice, problem.inverse_mass(), b, both);
    const LcpResult result = SolveTo(solver.get(), opposed);
    ASSERT_EQ(result.status, LcpStatus::kInfeasible) << problem.id() << " " << result.detail;
    ASSERT_TRUE(result.farkas_ray.has_value());
    EXPECT_TRUE(VerifyFarkasRay(opposed, *result.farkas_ray).accepted);
  }
}

// Two motors that pull against each other without a limit, beside contacts that have a solution.
TEST(FrictionMethods, InfeasibleByARayOfBoundedRows) {
  constexpr double kUnlimited = std::numeric_limits<double>::infinity();
  for (unsigned seed = 0; seed < 20; ++seed) {
    const LcpProblem problem = RandomFrictionProblem(8000 + seed, 6);
    const Index n = problem.size();
    SparseMatrix J = problem.J();
    J.conservativeResize(n + 2, J.cols());
    for (SparseMatrix::InnerIterator it(problem.J(), 0); it; ++it) {
      J.coeffRef(n, it.col()) = it.value();
      J.coeffRef(n + 1, it.col()) = -it.value();
    }
    RowBounds bounds = RowBounds::WithBilateralRows(n + 2, problem.bilateral_rows());
    bounds.friction = problem.friction_rows();
    bounds.bounded = {{n, 0, kUnlimited}, {n + 1, 0, kUnlimited}};
    Eigen::VectorXd b(n + 2);
    b << problem.b(), -1, -1;
    const LcpProblem pulled =
        LcpProblem::FromFactors(problem.id() + "-pulled", J, problem.inverse_mass(), b, std::move(bounds));
    const LcpResult result = SolveTo(MakeSolver("auto").get(), pulled);
    ASSERT_EQ(result.status, LcpStatus::kInfeasible) << problem.id() << " " << result.detail;
    EXPECT_TRUE(VerifyFarkasRay(pulled, result.farkas_ray.value()).accepted);
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
      const LcpResult result = SolveTo(entry.make({}).get(), problem);
      EXPECT_EQ(result.status, LcpStatus::kUnsupported) << entry.key;
      EXPECT_EQ(result.detail, "plain rows: the method is made for friction") << entry.key;
    }
    if (!entry.takes_bounded) continue;
    bounds.bounded = {{1, -1, 1}};
    const LcpProblem bounded = LcpProblem::FromDense("bounded", A, Eigen::Vector2d(-1, -2), bounds);
    const LcpResult result = SolveTo(entry.make({}).get(), bounded);
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
    const LcpResult result = SolveTo(MakeSolver("relaxation").get(), problem);
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
    const LcpResult result = SolveTo(&solver, problem);
    EXPECT_EQ(result.status, LcpStatus::kNumericalFailure) << result.detail;
    EXPECT_TRUE(result.f.allFinite());
  }
}

}  // namespace
}  // namespace lcpbench
