// What carries over from one problem to another in one solver object: with the
// same matrix all that was found out about it, and otherwise workspace only.

#include <gtest/gtest.h>

#include <memory>
#include <set>
#include <string>
#include <vector>

#include "benchmarks/measure/allocation_count.h"
#include "solvers/lcp/factor_clock.h"
#include "solvers/lcp/problem.h"
#include "solvers/lcp/verify.h"
#include "solvers/registry.h"
#include "support/input_error.h"
#include "tests/solvers/exact_problems.h"
#include "tests/solvers/solvers_under_test.h"
#include "tests/solvers/test_problems.h"

namespace lcpbench {
namespace {

class Reuse : public SolverTest {
 protected:
  void SetUp() override {
    SolverTest::SetUp();
    static const std::set<std::string> kSweeps = {"pgs", "psor", "nncg", "apgd"};
    if (kSweeps.contains(GetParam().key)) options_.max_iterations = 200;  // they have no end on redundant rows
  }
  static std::unique_ptr<LcpSolver> Make() { return GetParam().make({}); }
  LcpResult Solve(LcpSolver* solver, const LcpProblem& problem) const { return SolveWith(solver, problem, options_); }

  LcpOptions options_;
};

void ExpectSame(const LcpResult& result, const LcpResult& expected, const std::string& id) {
  EXPECT_EQ(result.status, expected.status) << id << ": " << result.detail << " against " << expected.detail;
  EXPECT_EQ(result.iterations, expected.iterations) << id;
  EXPECT_TRUE((result.f.array() == expected.f.array()).all()) << id;
}

// b as they come in the next step, in other units, in a step where most loads are
// gone, and one that f = 0 solves.
std::vector<Eigen::VectorXd> OtherLoads(const LcpProblem& problem, unsigned seed) {
  TestRandom random(seed);
  const Index n = problem.size();
  // In the range of A, so that what was solvable stays so.
  Eigen::VectorXd f(n), image(n);
  for (double& value : f) value = 0.125 * random.Integer(-8, 8);
  problem.ComputeW(f, &image);
  image -= problem.b();
  return {problem.b() + image, 0x1p-300 * problem.b(), 0x1p-20 * problem.b() + image, problem.b().cwiseAbs()};
}

std::vector<LcpProblem> SmallProblems() {
  std::vector<LcpProblem> problems;
  for (const ExactFamily& family : SolvableFamilies()) {
    for (unsigned seed = 1; seed <= 3; ++seed) problems.push_back(family.make(seed).problem);
  }
  for (unsigned seed = 1; seed <= 3; ++seed) {
    problems.push_back(PlantedProblem(80, 20, seed, 7, 3).problem);  // redundant
    problems.push_back(PlantedProblem(150, 100, seed, 0, 4).problem);
    problems.push_back(DiscPile(120, seed));
    const LcpProblem pile = DiscPile(60, seed);
    problems.push_back(LcpProblem::FromDense("dense", pile.DenseA(), pile.b(), {}, pile.facts()));
    problems.push_back(LcpProblem::FromSparse("sparse", pile.SparseA(), pile.b(), {}, pile.facts()));
  }
  return problems;
}

// Prepare looks at A only: what it was given as b, and what was solved with
// another b, leaves no trace.
TEST_P(Reuse, AnotherBGivesTheBitsOfAFreshProblem) {
  const std::unique_ptr<LcpSolver> kept = Make();
  unsigned seed = 0;
  for (const LcpProblem& problem : SmallProblems()) {
    kept->Prepare(problem);
    Solve(kept.get(), problem);
    for (const Eigen::VectorXd& b : OtherLoads(problem, ++seed)) {
      const LcpProblem other = problem.WithB(b);
      ExpectSame(Solve(kept.get(), other), Solve(Make().get(), other.CopyOfGivenForm()), problem.id());
    }
  }
}

TEST_P(Reuse, AnotherBOfALargeProblemNeedsNoOtherAnalysis) {
  const Index rows = GetParam().key == "lemke" || GetParam().key == "dantzig" ? 600 : 3000;  // dense
  for (const LcpProblem& problem : {DiscPile(rows, 1), PlantedProblem(rows / 3, 300, 1, 0, 5).problem}) {
    const std::unique_ptr<LcpSolver> kept = Make();
    Solve(kept.get(), problem);
    const LcpProblem other = problem.WithB(OtherLoads(problem, 3).front());
    const WorkCounts before = WorkCounts::OfThread();
    const LcpResult again = Solve(kept.get(), other);
    const std::int64_t analyses = (WorkCounts::OfThread() - before).analyses;
    ExpectSame(again, Solve(Make().get(), other.CopyOfGivenForm()), problem.id());
    EXPECT_TRUE(analyses == 0 || again.detail.find(';') != std::string::npos) << again.detail;
  }
}

// What one solve took, from the caller's arrays on.
struct Effort {
  WorkCounts work;
  long allocations = 0;
  LcpResult result;
};

// Chains of joints beside piles whose rows outnumber the degrees of freedom of the
// bodies, so that block pivoting and sweeps hand over to others.
ProblemArrays Family(int which, Index n, unsigned seed) {
  switch (which) {
    case 0:
      return ProblemArrays::Of(DiscPile(n, seed));
    case 1: {
      // Each body of a column pushed up by four rows that are almost the same.
      const LcpProblem column = Column(n / 4, seed);
      std::vector<Eigen::Triplet<double, int>> entries;
      Eigen::VectorXd b(column.size() * 4);
      for (Index i = 0; i < b.size(); ++i) {
        for (SparseMatrix::InnerIterator it(column.J(), i / 4); it; ++it) {
          entries.emplace_back(static_cast<int>(i), static_cast<int>(it.col()), it.value());
          entries.emplace_back(static_cast<int>(i), static_cast<int>(it.col() + 1),
                               it.value() * 0.125 * static_cast<double>(i % 4 - 1));
        }
        b[i] = column.b()[i / 4];
      }
      const SparseMatrix J = MatrixOf(b.size(), column.J().cols(), entries);
      return ProblemArrays::Of(LcpProblem::FromFactors("wall", J, column.inverse_mass(), b));
    }
    default:
      return ProblemArrays::Of(PlantedProblem(n, static_cast<int>(n / 4), seed, 9, 4).problem);
  }
}

constexpr int kFamilies = 3;

Effort SolveFresh(LcpSolver* solver, const ProblemArrays& arrays, const LcpOptions& options) {
  Effort effort;
  const WorkCounts before = WorkCounts::OfThread();
  const long allocated = AllocationCount();
  CountAllocations(true);
  {
    const LcpProblem problem = LcpProblem::FromArrays(arrays);
    solver->Prepare(problem);
    solver->Solve(problem, options, &effort.result);
  }
  CountAllocations(false);
  effort.allocations = AllocationCount() - allocated;
  effort.work = WorkCounts::OfThread() - before;
  return effort;
}

// An object that has solved others does all the work that a new one does, and
// has its workspace from the first one of that size.
TEST_P(Reuse, NothingIsKeptOfOtherProblemsButWorkspace) {
  // Dense methods and Ipopt take seconds at 3000 rows.
  static const std::set<std::string> kSlow = {"dantzig", "lemke", "ipopt-qp", "ipopt-ncp"};
  const bool is_slow = kSlow.contains(GetParam().key);
  for (const Index n : {300, 3000}) {
    if (is_slow && n == 3000) continue;
    constexpr int kOthers = 7;
    for (int which = 0; which < (n == 300 ? kFamilies : kFamilies - 1); ++which) {
      const ProblemArrays arrays = Family(which, n, 1);
      const Effort fresh = SolveFresh(Make().get(), arrays, options_);
      const std::unique_ptr<LcpSolver> after_one = Make();
      SolveFresh(after_one.get(), Family(which, n, 2), options_);
      const Effort second = SolveFresh(after_one.get(), arrays, options_);
      const std::unique_ptr<LcpSolver> used = Make();
      for (int k = 0; k < kOthers; ++k) {
        SolveFresh(used.get(), Family((which + k) % (n == 300 ? kFamilies : kFamilies - 1), n, 2U + unsigned(k)),
                   options_);
      }
      const Effort late = SolveFresh(used.get(), arrays, options_);
      const std::string what = arrays.id + ", " + std::to_string(n) + " rows: " + fresh.result.detail;
      ExpectSame(late.result, fresh.result, what);
      EXPECT_EQ(late.work.factorizations, fresh.work.factorizations) << what;
      EXPECT_EQ(late.work.analyses, fresh.work.analyses) << what;
      EXPECT_EQ(second.work, fresh.work) << what;
      if (!AllocationsAreCounted()) continue;
      EXPECT_LE(second.allocations, fresh.allocations) << what;
      EXPECT_LE(late.allocations, fresh.allocations) << what;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Solvers, Reuse, testing::ValuesIn(PlainSolversOf(SolverOrigin::kOwn)), SolverTestName);

}  // namespace
}  // namespace lcpbench
