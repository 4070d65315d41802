#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "solvers/first_order/sweeps/conjugate_sweeps.h"
#include "solvers/first_order/sweeps/scaled_rows.h"
#include "solvers/lcp/solver.h"
#include "solvers/lcp/step_rows.h"
#include "solvers/rows/body_order.h"
#include "solvers/rows/central_path.h"
#include "solvers/rows/matrix_arrays.h"
#include "solvers/rows/profile_factor.h"

namespace lcpbench {

/// Block principal pivoting [Kostreva 1978; Judice, Pires 1994]: all rows of wrong sign change sides after each basic
/// point, while their number falls. (BlockPivoting, which proves infeasibility and goes on row by row, has more ends
/// and its own loop.)
/// @param most_rounds  basic points
/// @param patience     rounds without fewer wrong rows than ever before that end it; one more where they are few
/// @param find         makes the basic point of the active rows; false: it could not, or time is up
/// @param exchange     lets the wrong rows change sides, and returns how many they are
/// @param few          so many wrong rows
/// @returns whether no row is wrong at the last basic point
template <typename Find, typename Exchange>
bool ExchangeBlocks(int most_rounds, int patience, const Find& find, const Exchange& exchange, Index few = 0) {
  Index least = std::numeric_limits<Index>::max();
  int left = patience;
  for (int round = 0; round < most_rounds && find(); ++round) {
    const Index wrong = exchange();
    if (wrong == 0) return true;
    left = wrong >= least ? left - 1 : patience + (wrong <= few ? 1 : 0);
    if (left == 0) return false;
    least = std::min(least, wrong);
  }
  return false;
}

/// One island of a step with more rows than a dense tableau is good for: nonsmooth conjugate gradients
/// (ConjugateSweeps) find most of the active set, and block principal pivoting [Judice, Pires 1994] on a sparse factor
/// the rest.
///
/// Rows are ordered (BodyOrder) and scaled (ScaledRows); A~_FF + delta I is factorized within its profile
/// (ProfileFactor). A hyperstatic A_FF is singular: the shift delta makes each solve a proximal step from the sweeps'
/// point [Rockafellar 1976], which leaves delta |x - x_sweeps| in w and is repeated where that is too much.
///
/// Iterations and pivoting rounds alternate, each granted about what the other one costs, until f passes or the limits
/// of profile_pivoting.cc are reached; from the second alternation on interior points (CentralPath) go before the
/// rounds, in the second one in place of iterations. The deadline is looked at before every factorization and once in
/// sixteen iterations. Guaranteed class: symmetric PSD, as nncg; no promise on the number of iterations. Cost: O(n) an
/// iteration, and that of ProfileFactor. Only Reserve allocates.
class ProfilePivoting {
 public:
  struct Request {
    double tolerance;          ///< on rho
    const double* initial_f;   ///< by row of the whole step, or nullptr
    const Deadline* deadline;  ///< or nullptr
  };

  /// @throws InputError if this machine lacks the instructions
  explicit ProfilePivoting(InstructionSet instructions = InstructionSet::kBest)
      : instructions_(instructions), factor_(instructions) {}
  ProfilePivoting(const ProfilePivoting&) = delete;
  ProfilePivoting& operator=(const ProfilePivoting&) = delete;

  /// @param max_rows  of an island; one whose profile needs more than ProfileFactor::kMostProfile numbers a row on
  ///                  average is solved by sweeps alone
  void Reserve(Index max_rows, Index max_bodies);

  /// Writes the entries `part` of f. Returns rho as the scaled sums have it; the caller judges f by the given rows.
  double Solve(const StepRows& all, std::span<const std::int32_t> part, const Request& request, double* f);

  /// The last Solve goes on by some more iterations, which make single rows of small forces exact. False, and f as it
  /// was, where the last Solve met no row or the time is up.
  bool SweepOn(double* f);

  /// The last Solve's f made as exact as its active set allows, where single rows have too large an error. Returns rho.
  /// @param rounding  forces of at most this part of the largest one become 0
  double Polish(double rounding, double* f);

  /// Iterations of conjugate gradients and factorizations of the last Solve, together.
  std::int64_t iterations() const { return iterations_; }

 private:
  bool Load(const StepRows& all, std::span<const std::int32_t> part);
  double SweepBothWays();
  double Residual();
  bool Pivot(int most_patience);
  void FindBasicPoint();
  Index ExchangeViolated();
  void TakeBasicPoint();
  bool TimeIsUp() const { return deadline_ != nullptr && deadline_->Expired(); }

  const InstructionSet instructions_;
  BodyOrder order_;
  ScaledProblem scaled_;
  ScaledRows form_;
  std::unique_ptr<RowKernel> in_plane_, in_space_;
  const RowKernel* rows_ = nullptr;  // one of these; nullptr: the island could not be loaded
  ProfileFactor factor_;
  bool has_profile_ = false;
  bool is_polished_ = false;  // by pivoting, since the last Solve
  Index n_ = 0;               // of the island
  std::int64_t iterations_ = 0;
  const Deadline* deadline_ = nullptr;
  double violation_ = 0;  // what counts as one

  ConjugateSweeps sweeps_;
  CentralPath central_path_;
  // By row in the scaled order: x, and which rows are active; the basic point, its gaps, and a refinement.
  Point x_;
  std::vector<unsigned char> is_active_;
  Point basic_;
  Array gaps_, correction_;
};

/// The same for a matrix of some hundred rows straight from arrays, in its own units: projected Gauss-Seidel guesses
/// the active set F, and A_FF is factorized within the profile of A, rows in the given order. On M-matrices, as of
/// obstacle problems, that converges from any F, monotonically after the first exchange [Hintermueller, Ito, Kunisch
/// 2002]; elsewhere it may cycle, and gives up.
///
/// Cost: n (bandwidth)^2 / 2 multiply-adds a factorization at most. Memory: twice the profile, kept for the next
/// problem.
class BandPivoting {
 public:
  /// @throws InputError if this machine lacks the instructions
  explicit BandPivoting(InstructionSet instructions = InstructionSet::kBest) : factor_(instructions) {}

  /// True with result->status kSolved and an f that passes in sums with a bound of their rounding, or kTimeLimit.
  /// False, with f anything, where the exchanges do not get ahead, rows depend on others, or f does not pass.
  /// @param deadline  of the solve, or nullptr for none
  bool Solve(const MatrixArrays& A, const LcpOptions& options, const Deadline* deadline, LcpResult* result);

 private:
  void Start(const Eigen::VectorXd* initial_f);
  bool SweepRow(Index i);
  void FindGaps();
  void Correct();
  Index ExchangeViolated();
  void ClipForces();
  bool Meets(double tolerance);

  const MatrixArrays* A_ = nullptr;
  std::vector<unsigned char> is_active_;
  Eigen::VectorXd f_, w_, size_, correction_;  // w = A f + b; |A| |f| + |b|
  ProfileFactor factor_;
};

}  // namespace lcpbench
