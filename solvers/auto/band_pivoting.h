#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "solvers/auto/matrix_arrays.h"
#include "solvers/lcp/residual_sums.h"
#include "solvers/lcp/solver.h"

namespace lcpbench {

/// Block principal pivoting [Kostreva 1978; Portugal, Judice, Vicente 1994] on a banded factor, for matrices of some
/// hundred rows straight from arrays: projected Gauss-Seidel guesses the active set F, and all rows of wrong sign
/// change sides together after each factorization of A_FF. On M-matrices, as of obstacle problems, that converges from
/// any F, monotonically after the first exchange [Hintermueller, Ito, Kunisch 2002]; elsewhere it may cycle, and gives
/// up.
///
/// A_FF = L D L^T is made column after column, as wide as the rows of F that are left reach; a column is padded to
/// vector registers. Rows keep their order: no analysis, no fill outside the band.
///
/// Cost: n (bandwidth)^2 / 2 multiply-adds a factorization at most. Memory: a band of F, kept for the next problem.
class BandPivoting {
 public:
  /// True with result->status kSolved and an f that passes in sums with a bound of their rounding, or kTimeLimit.
  /// False, with f anything, where the exchanges do not get ahead, rows depend on others, or f does not pass.
  bool Solve(const MatrixArrays& A, const LcpOptions& options, LcpResult* result);

 private:
  void Reserve(Index n);
  void GuessActiveRows(const Eigen::VectorXd* initial_f);
  bool SweepRow(Index i);
  void FindGaps();
  bool Factorize();
  void LoadFactor();
  void SolveFactor();
  Index ExchangeViolated();
  void ClipForces();
  bool Meets(double tolerance);
  bool MeetsInExtended(double tolerance);
  template <typename Real>
  ResidualSums<double>::Known Judge(double tolerance, const Real* w, double epsilon) const;

  const MatrixArrays* A_ = nullptr;
  Index n_ = 0, active_count_ = 0, band_ = 0, stride_ = 0;
  std::vector<unsigned char> is_active_;
  std::vector<std::int32_t> active_rows_, place_;  // place_: by row its place among the active ones, -1: not active
  Eigen::VectorXd f_, w_, size_;                   // w = A f + b; |A| |f| + |b|
  Eigen::VectorXd factor_, inverse_pivot_, y_;     // column k of L D from k stride_, its diagonal first
  std::vector<long double> extended_w_;
};

}  // namespace lcpbench
