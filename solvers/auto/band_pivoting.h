#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "solvers/auto/matrix_arrays.h"
#include "solvers/lcp/law.h"
#include "solvers/lcp/solver.h"
#include "solvers/rows/profile_factor.h"

namespace lcpbench {

/// Block principal pivoting [Kostreva 1978; Portugal, Judice, Vicente 1994] on a banded factor, for matrices of some
/// hundred rows straight from arrays: projected Gauss-Seidel guesses the active set F, and all rows of wrong sign
/// change sides together after each factorization of A_FF. On M-matrices, as of obstacle problems, that converges from
/// any F, monotonically after the first exchange [Hintermueller, Ito, Kunisch 2002]; elsewhere it may cycle, and gives
/// up.
///
/// A_FF = L D L^T is made within the profile of A (ProfileFactor): rows keep their order, no analysis.
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
  void Reserve(Index n);
  void GuessActiveRows(const Eigen::VectorXd* initial_f);
  bool SweepRow(Index i);
  void FindGaps();
  bool LoadFactor();
  bool FindBasicPoint();
  Index ExchangeViolated();
  void ClipForces();
  bool Meets(double tolerance);
  template <typename Visit>
  void ForEntries(Index i, const Visit& visit) const;
  template <typename Real>
  Real Gap(Index i, double* size) const;
  template <typename Real, typename OfRow>
  LawSums<double>::Known Judge(double tolerance, const OfRow& gap) const;

  const MatrixArrays* A_ = nullptr;
  Index n_ = 0;
  std::vector<unsigned char> is_active_;
  Eigen::VectorXd f_, w_, size_, correction_;  // w = A f + b; |A| |f| + |b|
  ProfileFactor factor_;
};

}  // namespace lcpbench
