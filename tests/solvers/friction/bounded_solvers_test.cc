// Bounded rows, by all solvers that take them; and friction by bounds that lag: docs/friction.md sections 1, 2.6, 5.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "solvers/exact/modes/mode_search.h"
#include "solvers/lcp/verify.h"
#include "solvers/registry.h"
#include "tests/solvers/exact_problems.h"
#include "tests/solvers/friction/friction_records.h"
#include "tests/solvers/solve_with.h"

namespace lcpbench {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// A = G G^T of any rank with small integers, in one of the three forms. Bounds are finite, infinite, equal, or far;
// some rows are unilateral or joints. b = G v + c with c as solvability needs it, or, in one of four problems, any.
LcpProblem BoxProblem(unsigned seed, int largest) {
  TestRandom random(seed);
  const Index n = random.Integer(1, largest);
  const Index r = random.Integer(1, static_cast<int>(n) + 2);
  Triplets entries;
  const double density = std::min(1.0, 4.0 / static_cast<double>(r));
  for (int i = 0; i < n; ++i) {
    for (int k = 0; k < r; ++k) {
      if (random.Chance(density)) entries.emplace_back(i, k, random.Integer(-3, 3));
    }
  }
  const SparseMatrix G = MatrixOf(n, r, entries);
  Eigen::VectorXd v(r);
  for (double& x : v) x = random.Integer(-9, 9);
  Eigen::VectorXd b = G * v;
  const bool is_any = random.Chance(0.25);
  RowBounds bounds;
  bounds.bilateral.assign(static_cast<size_t>(n), 0);
  for (Index i = 0; i < n; ++i) {
    const double more = random.Integer(0, 4);
    if (is_any) b[i] += random.Integer(-3, 3);
    const int kind = random.Integer(0, 9);
    if (kind == 0) {
      b[i] += more;
    } else if (kind == 1) {
      bounds.bilateral[static_cast<size_t>(i)] = 1;
    } else if (kind == 2) {
      bounds.bounded.push_back({i, static_cast<double>(random.Integer(-5, 5)), kInfinity});
      b[i] += more;
    } else if (kind == 3) {
      bounds.bounded.push_back({i, -kInfinity, static_cast<double>(random.Integer(-5, 5))});
      b[i] -= more;
    } else if (kind == 4) {
      const double at = random.Integer(-5, 5);
      bounds.bounded.push_back({i, at, at});
    } else {
      const double size = kind == 5 ? 1e4 : 1;
      const double lower = random.Integer(-6, 4);
      bounds.bounded.push_back({i, size * lower, size * (lower + random.Integer(1, 8))});
    }
  }
  const std::string id = "box-" + std::to_string(seed);
  if (seed % 3 == 0) return LcpProblem::FromFactors(id, G, Eigen::VectorXd::Ones(r), b, bounds);
  const SparseMatrix A = G * SparseMatrix(G.transpose());
  if (seed % 3 == 1) return LcpProblem::FromSparse(id, A, b, bounds, SymmetricPsd());
  return LcpProblem::FromDense(id, A, b, bounds, SymmetricPsd());
}

// A method that cannot fail by its nature, or one that has a limit on its sweeps.
struct TakenBy {
  std::unique_ptr<LcpSolver> solver;
  bool is_direct;
  int solved = 0, infeasible = 0;
};

std::map<std::string, TakenBy> BoundedSolvers() {
  std::map<std::string, TakenBy> solvers;
  for (const SolverEntry& entry : AllSolvers()) {
    if (!entry.available || entry.origin != SolverOrigin::kOwn || !entry.takes_bounded || entry.takes_friction)
      continue;
    if (entry.method.ends_with("a method of auto alone")) continue;
    solvers[entry.key] = {MakeSolver(entry.key), entry.key != "nncg" && entry.key != "apgd", 0, 0};
  }
  for (const char* key : {"pgs", "psor"}) solvers[key] = {MakeSolver(key), false, 0, 0};
  return solvers;
}

void ExpectNear(const Eigen::VectorXd& one, const Eigen::VectorXd& other, const LcpProblem& problem,
                const std::string& what) {
  EXPECT_LE((one - other).cwiseAbs().maxCoeff(), 1e-6 * (1 + problem.b().cwiseAbs().maxCoeff())) << what;
}

TEST(BoundedSolvers, AgreeOnBoxProblems) {
  constexpr unsigned kProblems = 2000;
  std::map<std::string, TakenBy> solvers = BoundedSolvers();
  ASSERT_GE(solvers.size(), 8);
  int solvable = 0;
  for (unsigned seed = 1; seed <= kProblems; ++seed) {
    const LcpProblem problem = BoxProblem(seed, 40);
    std::optional<Eigen::VectorXd> w;
    bool is_infeasible = false;
    for (auto& [key, taken] : solvers) {
      if (!taken.is_direct && seed % 4 != 0) continue;
      const std::string what = key + " " + problem.id();
      const LcpResult result = SolveWith(taken.solver.get(), problem, {.max_iterations = taken.is_direct ? 0 : 1000});
      const Verdict verdict = Verify(problem, result, 1e-9);
      EXPECT_FALSE(verdict.false_success) << what << " " << verdict.reason;
      EXPECT_FALSE(verdict.false_infeasible) << what;
      if (result.status == LcpStatus::kInfeasible) {
        ++taken.infeasible;
        is_infeasible = true;
      }
      if (result.status != LcpStatus::kSolved) continue;
      ++taken.solved;
      if (w.has_value()) ExpectNear(*w, verdict.metrics.w, problem, what);
      w = verdict.metrics.w;
    }
    EXPECT_FALSE(is_infeasible && w.has_value()) << problem.id();
    if (w.has_value()) ++solvable;
  }
  for (const auto& [key, taken] : solvers) {
    RecordProperty(key, std::to_string(taken.solved) + " " + std::to_string(taken.infeasible));
    if (!taken.is_direct) continue;
    EXPECT_GE(taken.solved, 0.998 * solvable) << key;
    EXPECT_GE(taken.infeasible + solvable, 0.998 * kProblems) << key;
  }
}

TEST(BoundedSolvers, GiveTheExactAnswers) {
  std::map<std::string, TakenBy> solvers = BoundedSolvers();
  int compared = 0, infeasible = 0;
  for (unsigned seed = 1; seed <= 300; ++seed) {
    const LcpProblem problem = BoxProblem(seed, 5);
    const ExactAnswer exact = SolveByModes(ExactFrom(problem), {});
    ASSERT_NE(exact.status, ExactAnswer::Status::kUnknown);
    const bool is_solvable = exact.is_solved();
    for (auto& [key, taken] : solvers) {
      const LcpResult result = SolveWith(taken.solver.get(), problem, {.max_iterations = taken.is_direct ? 0 : 1000});
      const std::string what = key + " " + problem.id() + " " + result.detail;
      const LcpStatus right = is_solvable ? LcpStatus::kSolved : LcpStatus::kInfeasible;
      EXPECT_TRUE(result.status == right || (!taken.is_direct && result.status != LcpStatus::kSolved))
          << what << " " << result.status;
      if (result.status != LcpStatus::kSolved || !is_solvable) continue;
      Eigen::VectorXd w(problem.size());
      for (Index i = 0; i < w.size(); ++i) w[i] = exact.w[static_cast<size_t>(i)].convert_to<double>();
      ExpectNear(w, ComputeMetrics(problem, result.f).w, problem, what);
    }
    ++(is_solvable ? compared : infeasible);
  }
  EXPECT_GE(compared, 200);
  EXPECT_GE(infeasible, 3);
}

// From the answer itself one face is enough, and a start far from it does not mislead.
TEST(BoundedSolvers, StartWarm) {
  std::map<std::string, TakenBy> solvers = BoundedSolvers();
  for (unsigned seed = 1; seed <= 100; ++seed) {
    const LcpProblem problem = BoxProblem(seed, 20);
    for (auto& [key, taken] : solvers) {
      if (!taken.is_direct) continue;
      const LcpResult cold = SolveWith(taken.solver.get(), problem);
      if (cold.status != LcpStatus::kSolved) continue;
      const LcpResult warm = SolveWith(taken.solver.get(), problem, {.initial_f = &cold.f});
      EXPECT_EQ(warm.status, LcpStatus::kSolved) << key << " " << problem.id() << " " << warm.detail;
      const Eigen::VectorXd far = Eigen::VectorXd::Constant(problem.size(), seed % 2 == 0 ? 1e3 : -1e3);
      const LcpResult from_far = SolveWith(taken.solver.get(), problem, {.initial_f = &far});
      EXPECT_EQ(from_far.status, LcpStatus::kSolved) << key << problem.id();
    }
  }
}

// Powers of two in A, b and the bounds, within and beyond what products of doubles allow.
TEST(BoundedSolvers, SolveAtEveryScale) {
  std::map<std::string, TakenBy> solvers = BoundedSolvers();
  for (unsigned seed = 1; seed <= 120; ++seed) {
    const LcpProblem problem = BoxProblem(3 * seed, 12);
    const int of_rows = static_cast<int>(seed % 5) * 50 - 100, of_b = static_cast<int>(seed % 7) * 90 - 270;
    RowBounds bounds = problem.bounds();
    for (BoundedRow& row : bounds.bounded) {
      row.lower = std::ldexp(row.lower, of_b - 2 * of_rows);
      row.upper = std::ldexp(row.upper, of_b - 2 * of_rows);
    }
    const LcpProblem scaled =
        LcpProblem::FromFactors(problem.id(), std::ldexp(1.0, of_rows) * problem.J(), problem.inverse_mass(),
                                std::ldexp(1.0, of_b) * problem.b(), bounds);
    for (auto& [key, taken] : solvers) {
      if (!taken.is_direct) continue;
      const LcpResult result = SolveWith(taken.solver.get(), scaled);
      const Verdict verdict = Verify(scaled, result, 1e-9);
      EXPECT_FALSE(verdict.false_success || verdict.false_infeasible) << key << " " << problem.id();
      EXPECT_EQ(result.status, SolveWith(taken.solver.get(), problem).status) << key << " " << problem.id();
    }
  }
}

// ODE's findex: normal forces without friction, whose bounds are frozen for one more solve.
TEST(BoundedSolvers, OnePassIsThatOfTheRecords) {
  const std::unique_ptr<LcpSolver> solver = MakeSolver("auto");
  int compared = 0;
  for (const FrictionRecord& record : FrictionRecords()) {
    if (!record.json.contains("models") || !record.json["models"].contains("one-pass")) continue;
    const LcpProblem& problem = record.problem();
    Eigen::VectorXd f = Eigen::VectorXd::Zero(problem.size());
    LcpResult result;
    for (int pass = 0; pass < 2; ++pass) {
      RowBounds bounds = problem.bounds();
      for (const FrictionRow& row : bounds.friction) {
        bounds.bounded.push_back({row.row, -row.mu * f[row.normal], row.mu * f[row.normal]});
      }
      bounds.friction.clear();
      result = SolveWith(solver.get(), problem.WithBounds(bounds));
      ASSERT_EQ(result.status, LcpStatus::kSolved) << problem.id() << " " << result.detail;
      f = result.f;
    }
    const auto& model = record.json["models"]["one-pass"];
    // Where normal forces are not unique there is more than one pass.
    if ((f - ToVector(model["f_exact"])).norm() > 1e-6) continue;
    ExpectNear(ToVector(model["w_exact"]), ComputeMetrics(problem, f).w, problem, problem.id());
    EXPECT_NEAR(ComputeMetrics(problem, f).rho, model["rho"].get<double>(), 1e-7) << problem.id();
    ++compared;
  }
  EXPECT_GE(compared, 30);
}

// mu |A_nt| < A_nn in every contact.
bool HasWeakCoupling(const LcpProblem& problem) {
  const Eigen::MatrixXd A = InForm(problem, MatrixForm::kDense).DenseA();
  return std::ranges::all_of(problem.friction_rows(), [&](const FrictionRow& row) {
    return row.mu * std::abs(A(row.normal, row.row)) < A(row.normal, row.normal);
  });
}

TEST(LaggedBounds, SolveWhereNormalForcesDependLittleOnFriction) {
  const std::unique_ptr<LcpSolver> solver = MakeSolver("lagged-bounds");
  int right = 0, weak = 0;
  for (const FrictionRecord& record : FrictionRecords()) {
    const LcpResult result = SolveWith(solver.get(), record.problem());
    const Verdict verdict = Verify(record.problem(), result, 1e-9, &record.parsed.reference);
    EXPECT_FALSE(verdict.false_success) << record.problem().id() << " " << verdict.reason;
    EXPECT_FALSE(verdict.false_infeasible) << record.problem().id();
    if (!record.is_solved() || !HasWeakCoupling(record.problem())) continue;
    ++weak;
    if (result.status == LcpStatus::kSolved) ++right;
  }
  EXPECT_GE(weak, 40);
  EXPECT_GE(right, 0.85 * weak);
}

// Random contacts of two rows, of any rank, with coefficients far beyond what contracts.
TEST(LaggedBounds, ClaimNothingFalse) {
  const std::unique_ptr<LcpSolver> solver = MakeSolver("lagged-bounds");
  int solved = 0;
  for (unsigned seed = 1; seed <= 250; ++seed) {
    TestRandom random(seed);
    const LcpProblem box = BoxProblem(seed, 24);
    RowBounds bounds;
    for (Index i = 1; i < box.size(); i += 2) {
      const double mus[] = {0, 0.1, 0.5, 1, 5, 1e6};
      bounds.friction.push_back({i, i - 1, mus[random.Integer(0, 5)], 0});
    }
    const LcpProblem problem = box.WithBounds(bounds);
    const LcpResult result = SolveWith(solver.get(), problem);
    const Verdict verdict = Verify(problem, result, 1e-9);
    EXPECT_FALSE(verdict.false_success || verdict.false_infeasible) << problem.id() << " " << verdict.reason;
    if (result.status == LcpStatus::kSolved) ++solved;
  }
  RecordProperty("solved", solved);
  EXPECT_GE(solved, 150);
}

}  // namespace
}  // namespace lcpbench
