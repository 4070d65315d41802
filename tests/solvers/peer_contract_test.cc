// What every adapter of another project's solver promises. The solver behind it may fail, and may claim what is not so:
// then the verdict says so. The adapter may not: no answer of the wrong size, no status but the solver's own, no
// problem changed on the way, nothing left over from one solve to the next.

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "solvers/lcp/verify.h"
#include "solvers/registry.h"
#include "support/input_error.h"
#include "tests/solvers/solvers_under_test.h"
#include "tests/solvers/test_problems.h"

namespace lcpbench {
namespace {

class PeerContract : public SolverTest {
 protected:
  LcpResult Solve(const LcpProblem& problem, double tolerance, double limit_s = 2) {
    return SolverTest::Solve(problem, tolerance, limit_s);
  }

  void Judge(const TestProblem& test, double tolerance) {
    SCOPED_TRACE(test.problem.id());
    // Milliseconds are enough for what a peer solves; iterations on problems without solution end here.
    constexpr double kLimit = 0.05;  // s
    const LcpResult result = Solve(test.problem, tolerance, kLimit);
    EXPECT_NE(result.status, LcpStatus::kNotRun);
    EXPECT_EQ(result.f.size(), test.problem.size());
    EXPECT_TRUE(result.status != LcpStatus::kUnsupported || !result.detail.empty());
    const Verdict verdict = Verify(test.problem, result, tolerance, &test.reference);
    if (verdict.passes && test.reference.status == LcpReference::Status::kSolved && tolerance <= 1e-9 &&
        verdict.metrics.w_error >= 0) {
      EXPECT_LE(verdict.metrics.w_error, 1e-4);
    }
    Answers(verdict.passes);
  }

  // A library's own options may be meant for games, and the key promises not to touch them. MuJoCo's Newton method
  // stops where its cost rounds, and f is w over R.
  static double EasyTier() {
    return GetParam().key.ends_with("-default") || GetParam().key == "mujoco-newton" ? 1e-3 : 1e-6;
  }
};

INSTANTIATE_TEST_SUITE_P(AllPeers, PeerContract, testing::ValuesIn(PlainSolversOf(SolverOrigin::kPeer)),
                         SolverTestName);
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(PeerContract);

// How many of them a peer must answer rightly was measured where it was in the build, else it is one.
TEST_P(PeerContract, AnswersProblemsRightly) {
  for (const TestProblem& test : TextbookProblems()) Judge(test, 1e-9);
  for (const TestProblem& test : OracleProblems()) Judge(test, 1e-9);
  for (const TestProblem& test : GeneratedProblems()) Judge(test, 1e-6);
}

// Unit contacts that do not see each other: what no solver gets wrong, unless its adapter confuses a sign.
TEST_P(PeerContract, IsolatedContactsAreSolved) {
  const Index n = 9;
  Eigen::VectorXd b(n);
  for (Index i = 0; i < n; ++i) b[i] = static_cast<double>(i % 5) - 2.5;
  LcpProblem problem = LcpProblem::FromDense("isolated", Eigen::MatrixXd::Identity(n, n), b, {}, SymmetricPsd());
  LcpResult result = Solve(problem, EasyTier());
  if (result.detail == "more than 6 contacts") return;
  if (result.status == LcpStatus::kUnsupported) {
    // An engine's solver has bodies or nothing: unit masses, each on a contact of its own.
    EXPECT_FALSE(result.detail.empty());
    Triplets entries;
    for (Index i = 0; i < n; ++i) entries.emplace_back(i, 3 * i + 1, 1);
    problem = LcpProblem::FromFactors("isolated", MatrixOf(n, 3 * n, entries), Eigen::VectorXd::Ones(3 * n), b);
    result = Solve(problem, EasyTier());
  }
  if (GetParam().key.starts_with("mujoco-") && GetParam().key.ends_with("-default")) {
    // What the engine makes of it: each contact gives way by a ninth of A_ii.
    const Eigen::MatrixXd soft = (1 + 1.0 / 9) * Eigen::MatrixXd::Identity(n, n);
    problem = LcpProblem::FromDense("soft", soft, b, {}, SymmetricPsd());
  }
  EXPECT_TRUE(Verify(problem, result, EasyTier()).passes) << ToString(result.status) << " " << result.detail;
  EXPECT_GT(result.own_fresh_s, 0);
}

TEST_P(PeerContract, RowKindsAreTakenOrRefusedByName) { ExpectRowKindsAreTakenOrRefused(); }

// A well-conditioned joint system: either refused by name, or solved.
TEST_P(PeerContract, BilateralRowsAreSolvedOrRefused) {
  Eigen::Matrix3d A;
  A << 2, 1, 0, 1, 2, 1, 0, 1, 2;
  const LcpProblem problem = LcpProblem::FromDense("joint", A, Eigen::Vector3d(-1, 2, -1),
                                                   RowBounds::WithBilateralRows(3, {1}), SymmetricPsd());
  const LcpResult result = Solve(problem, EasyTier());
  if (result.status == LcpStatus::kUnsupported) {
    EXPECT_FALSE(result.detail.empty());
    return;
  }
  EXPECT_TRUE(Verify(problem, result, EasyTier()).passes) << ToString(result.status) << " " << result.detail;
}

TEST_P(PeerContract, RepeatedSolvesAreBitwiseIdentical) {
  for (const TestProblem& test : {PlantedProblem(20, 8, 1, 0, 0), PlantedProblem(30, 12, 2, 0, 3)}) {
    const LcpResult first = Solve(test.problem, 1e-6);
    Solve(PlantedProblem(7, 3, 9, 0, 0).problem, 1e-6);
    const LcpResult again = Solve(test.problem, 1e-6);
    EXPECT_EQ(first.status, again.status);
    EXPECT_TRUE(first.f == again.f || first.status == LcpStatus::kTimeLimit);
  }
}

// Whatever an adapter keeps of a matrix, the answer to another b is that of a problem never seen before.
TEST_P(PeerContract, AnotherBOnTheSameMatrixIsANewProblem) {
  for (const TestProblem& test : {PlantedProblem(12, 6, 1, 0, 0), PlantedProblem(20, 8, 2, 0, 2)}) {
    Solve(test.problem, 1e-6);
    const Eigen::VectorXd b = 0.5 * test.problem.b() - Eigen::VectorXd::Ones(test.problem.size());
    const LcpResult again = Solve(test.problem.WithB(b), 1e-6);
    solver_ = GetParam().make({});
    const LcpResult fresh = Solve(test.problem.CopyOfGivenForm().WithB(b), 1e-6);
    EXPECT_EQ(again.status, fresh.status) << again.detail << fresh.detail;
    if (fresh.status == LcpStatus::kTimeLimit || fresh.status == LcpStatus::kUnsupported) continue;
    EXPECT_EQ(again.f, fresh.f);
    EXPECT_GT(again.own_fresh_s, 0);
  }
}

// From the forces of a step with other loads, under which other rows are active, a solver may take another way, but
// must come to an answer where it does from none.
TEST_P(PeerContract, AWarmStartIsAnsweredWhereAColdOneIs) {
  if (GetParam().key.starts_with("qpalm-primal")) GTEST_SKIP() << "the library aborts at times";
  if (GetParam().library_defaults) GTEST_SKIP() << "where its own measure is content depends on the start";
  for (unsigned seed = 1; seed <= 8; ++seed) {
    // Half of them with rows that depend on each other. Another velocity of the bodies keeps them solvable.
    const TestProblem test = PlantedProblem(12, seed % 2 == 0 ? 2 : 6, seed, 0, 0);
    Eigen::VectorXd velocity = Eigen::VectorXd::Ones(test.problem.J().cols());
    for (Index i = 0; i < velocity.size(); i += 2) velocity[i] = -1;
    const LcpProblem next = test.problem.WithB(test.problem.b() + test.problem.J() * velocity);
    const LcpResult before = Solve(test.problem, EasyTier());
    const LcpResult cold = Solve(next, EasyTier());
    if (!before.f.allFinite() || !Answers(Verify(next, cold, EasyTier()).passes)) continue;
    const LcpResult warm =
        SolverTest::Solve(next, {.tolerance = EasyTier(), .time_limit_s = 2, .initial_f = &before.f});
    EXPECT_TRUE(Verify(next, warm, EasyTier()).passes) << seed << ": " << ToString(warm.status) << " " << warm.detail;
  }
}

TEST_P(PeerContract, PartsAreTimedWhereTheyAreWanted) {
  const LcpProblem problem = PlantedProblem(20, 8, 1, 0, 0).problem;
  const LcpResult result = SolverTest::Solve(problem, {.tolerance = 1e-6, .time_limit_s = 2, .time_parts = true});
  EXPECT_GE(result.own_solve_s, 0);
  EXPECT_LE(result.own_solve_s + std::max(0.0, result.own_convert_s), result.own_fresh_s);
}

TEST_P(PeerContract, NoRowsIsSolvedAndUnknownSettingsAreRefused) {
  EXPECT_EQ(Solve(LcpProblem::FromDense("empty", Eigen::MatrixXd(0, 0), Eigen::VectorXd(0)), 1e-9).status,
            LcpStatus::kSolved);
  EXPECT_THROW(GetParam().make({{"no-such-option", "1"}}), InputError);
}

// A factorization with a shift is what a user of PETSc takes where A is singular, as redundant rows make it.
TEST(PeerSettings, AShiftedFactorizationSolvesMoreOfTheSingularProblems) {
  for (const char* key : {"petsc-rsls", "petsc-ssls"}) {
    if (!FindSolver(key).available) GTEST_SKIP() << key << " is not in this build";
    const auto count = [&](const Settings& settings) {
      const auto solver = MakeSolver(key, settings);
      int passed = 0;
      for (const TestProblem& test : GeneratedProblems()) {
        const LcpResult result = SolveWith(solver.get(), test.problem, {.tolerance = 1e-6, .time_limit_s = 0.5});
        if (Verify(test.problem, result, 1e-6).passes) ++passed;
      }
      return passed;
    };
    EXPECT_GT(count({{"linear_solver", "lu"}, {"shift", "1e-8"}}), count({})) << key;
  }
}

TEST(PeerFacts, ToleranceIsSaid) {
  for (const SolverEntry& peer : AllSolvers()) {
    if (peer.origin != SolverOrigin::kPeer || !peer.base.empty()) continue;
    // So many sweeps are no answer to a tolerance either.
    EXPECT_EQ(peer.tolerance() == "default", peer.key.ends_with("-default") || peer.key.starts_with("bullet-si-"))
        << peer.key;
  }
  RegisterExternalSolver("auto-baseline", {"/no/such/build/lcpbench", "serve", "auto"});
  EXPECT_EQ(FindSolver("auto-baseline").base, "auto");
  EXPECT_EQ(FindSolver("auto-baseline").origin, SolverOrigin::kExternal);
}

}  // namespace
}  // namespace lcpbench
