#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <ostream>
#include <string>
#include <vector>

#include "solvers/lcp/settings.h"
#include "solvers/registry.h"
#include "tests/solvers/exact_problems.h"
#include "tests/solvers/solve_with.h"

namespace lcpbench {

/// A solver for symmetric PSD A that ends with an answer or a proof, and what its tests ask of it beyond that.
struct DirectSolver {
  const char* name;
  const char* key;
  Settings settings = {};
  /// Largest rho on exact problems; 1e-9 is what was asked for, direct methods aim at rounding.
  double rho = 1e-11;
  /// Iterations on a problem of n rows are at most this many times n + 1; 0: its own tests bound them.
  int iterations_per_row = 0;
  /// Mean number of iterations, at most, from the answer of a problem of full rank, and ...
  double warm_iterations = 1;
  /// ... of redundant ones as a part of those from f = 0.
  double warm_part = 1;
  /// Largest part of the problems of a test that may end without an answer or a proof, saying so: exact ones, and
  /// unsolvable ones whose A was rounded.
  double undecided = 0;
  double undecided_rounded = 0;
  /// Rows with A_ii = 0 are judged in the units of b, by some in the course of the method.
  bool powers_of_two_leave_zero_rows = true;
  bool allocates = false;
  /// The setting that names the largest number of rows; nullptr where there is none.
  const char* row_limit = nullptr;
};

inline std::ostream& operator<<(std::ostream& out, const DirectSolver& direct) { return out << direct.name; }

/// Dantzig's two orders, Lemke, both forms of block pivoting, the active set, semismooth Newton, `auto`, and ipm;
/// those of this build.
const std::vector<DirectSolver>& DirectSolvers();

/// Name of the parametrised test.
std::string NameOf(const testing::TestParamInfo<DirectSolver>& info);

class DirectSolverTest : public testing::TestWithParam<DirectSolver> {
 protected:
  void SetUp() override;

  LcpResult Solve(const LcpProblem& problem, const LcpOptions& options = {}) {
    return SolveWith(solver_.get(), problem, options);
  }

  /// Solved, verified at 1e-9 and at the rho that is asked for, and w is the known one.
  void ExpectSolved(const TestProblem& test, const LcpResult& result);
  void ExpectSolved(const LcpProblem& problem, const LcpResult& result) { ExpectSolved({problem, {}}, result); }

  /// As ExpectSolved or ExpectRay asks; but the solver may have failed where it says so, which is counted.
  void Judge(const TestProblem& test, const LcpResult& result);
  /// At most `part` of the judged problems were left undecided.
  void ExpectUndecided(double part) const;

  std::unique_ptr<LcpSolver> solver_;

 private:
  int judged_ = 0;
  std::string undecided_;  // ids
  int undecided_count_ = 0;
};

}  // namespace lcpbench
