#pragma once

#include <optional>
#include <vector>

#include "solvers/exact/flint_matrix.h"
#include "solvers/lcp/solver.h"

namespace lcpbench {

/// Active rows by Lemke's method in floating point of kGuessDigits digits. Internal to solvers/exact/.
///
/// In doubles, rows that depend on others to rounding are all alike; in exact numbers only some of them can be active,
/// and which ones is decided at 1e-17 of the forces. More digits see that.
struct LemkeGuess {
  std::vector<char> active;   ///< unilateral rows with f > 0
  std::vector<char> support;  ///< of a ray, where Lemke's method ends on one; else empty
};

inline constexpr int kGuessDigits = 60;

/// @param bilateral_basis  independent bilateral rows, which are eliminated first
/// O(n^2) operations of some 0.1 us a pivot, about n to 2 n pivots. Nothing where it comes to no end, or
/// not by the deadline, which is looked at before every pivot.
std::optional<LemkeGuess> GuessByLemke(const IntegerMatrix& A, const IntegerMatrix& b,
                                       const std::vector<char>& bilateral, const std::vector<Index>& bilateral_basis,
                                       const Deadline& deadline);

}  // namespace lcpbench
