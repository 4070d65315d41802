#pragma once

#include <cstdint>
#include <vector>

#include "solvers/exact/flint_matrix.h"
#include "solvers/lcp/solver.h"

namespace lcpbench {

/// The exact method of SolveExactly on an LCP in integers: a basis F of independent rows, f_F = -A_FF^-1 b_F, f = 0
/// elsewhere, and exchanges between F and the rest. Internal to solvers/exact/.
class ExactPivoting {
 public:
  enum class End { kSolved, kRay, kNotSemidefinite, kTimeLimit, kSolveLimit };

  /// Not owned; must outlive this.
  ExactPivoting(const IntegerMatrix& A, const IntegerMatrix& b, const std::vector<char>& bilateral)
      : A_(A), b_(b), bilateral_(bilateral) {}

  /// @param start  rows that may be in the first basis; bilateral rows are, as far as they are independent
  /// @param most_solves  0 for no limit
  End Pivot(const std::vector<char>& start, const Deadline& deadline, std::int64_t most_solves = 0);

  /// Takes y > 0 of a guessed ray for the support of one, if it holds exactly.
  bool TryRay(const std::vector<char>& support);

  // f_i = f_numerator / denominator, denominator > 0, and w likewise.
  const IntegerMatrix& f() const { return f_; }
  const IntegerMatrix& w() const { return w_; }
  const Integer& denominator() const { return denominator_; }
  /// y with b.y < 0.
  const std::vector<Rational>& ray() const { return ray_; }
  std::int64_t solves() const { return solves_; }

 private:
  Index size() const { return A_.rows(); }
  bool is_bilateral(Index i) const { return bilateral_[static_cast<size_t>(i)] != 0; }
  bool in_basis(Index i) const { return in_basis_[static_cast<size_t>(i)] != 0; }
  void SetBasis(const std::vector<Index>& wanted);
  void SolveBasis();
  std::vector<Index> Violated() const;
  void Exchange(const std::vector<Index>& violated);
  End PivotOnLeastIndex(Index k);
  bool MakeRay(const std::vector<Index>& independent, Index k, const RationalMatrix& d);

  const IntegerMatrix& A_;
  const IntegerMatrix& b_;
  const std::vector<char>& bilateral_;
  std::vector<Index> basis_;  // bilateral rows first
  std::vector<char> in_basis_;
  IntegerMatrix f_{0, 0}, w_{0, 0};
  Integer denominator_;
  std::vector<Rational> ray_;
  std::int64_t solves_ = 0;
};

}  // namespace lcpbench
