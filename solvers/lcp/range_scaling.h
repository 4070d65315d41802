#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "solvers/lcp/problem.h"
#include "solvers/lcp/solver.h"

namespace lcpbench {

/// Brings a problem whose numbers are extreme (LcpProblem::has_extreme_matrix, has_extreme_b) into the range in which
/// doubles can be squared: A~ = S A S, b~ = t S b, f = S f~ / t, with powers of two. The largest |J_ik| m_k^1/2 of each
/// row becomes about 1 (A_ii in the other forms), and so does the largest |b~_i|, and that of every row of zeros, whose
/// b says only whether there is an answer. Coefficients of friction and bounds go along. Nothing is rounded but what is
/// 2^-1000 of the largest number of its row, or of b~.
class RangeScaling {
 public:
  /// Scales the matrix, without b. A matrix in range is taken as it is.  O(nnz of the given form)
  explicit RangeScaling(const LcpProblem& problem);

  /// The scaled matrix with b = 0.
  const LcpProblem& matrix() const { return matrix_; }

  /// Solves the problem of the b given by `solve`, which is handed a scaled problem, options and a result. What is
  /// claimed must hold for the problem as it is given, by the verifier's measures: else, and where forces leave the
  /// doubles' range, the status is kNumericalFailure.
  /// @param problem  shares the matrix given to the constructor
  template <typename Solve>
  void SolveScaled(const LcpProblem& problem, const LcpOptions& options, LcpResult* result, const Solve& solve) const {
    const Load load = Scale(problem);
    const std::optional<Eigen::VectorXd> start = ScaledStart(options, load);
    LcpOptions scaled = options;
    scaled.initial_f = start ? &*start : nullptr;
    solve(load.problem, scaled, result);
    GiveBack(problem, options, load, result);
  }

 private:
  struct Load {
    LcpProblem problem;
    std::vector<int> rows;  // S_ii = 2^rows[i]
    int unit;               // t = 2^unit
  };
  Load Scale(const LcpProblem& problem) const;
  static std::optional<Eigen::VectorXd> ScaledStart(const LcpOptions& options, const Load& load);
  static void GiveBack(const LcpProblem& problem, const LcpOptions& options, const Load& load, LcpResult* result);

  std::vector<int> row_;  // exponents of S; of rows of zeros none, there b decides
  LcpProblem matrix_;
};

}  // namespace lcpbench
