#pragma once

#include <optional>
#include <vector>

#include "solvers/exact/flint_matrix.h"
#include "solvers/lcp/solver.h"

namespace lcpbench {

/// The solutions of an LCP whose w is known: A f = -b on the rows `active` (w = 0), f >= 0 on the unilateral ones among
/// them, f = 0 elsewhere. Internal to solvers/exact/; rows are numbered within `active`.
struct SolutionSet {
  IntegerMatrix A;  ///< on the active rows
  IntegerMatrix b;  ///< one column
  std::vector<char> bilateral;
  std::vector<Rational> f;  ///< one solution
};

struct LeastNorm {
  std::vector<Rational> f;
  std::vector<Rational> multipliers;  ///< l: f - A l >= 0, = 0 where f > 0 and on bilateral rows
};

/// min |f|^2 over the set. Its active set is guessed in doubles, and put right by exact exchanges in blocks; where
/// those do not settle, or not by the deadline, nothing. Every answer is proved by its multipliers.
/// @param positive  a guess at the unilateral rows with f > 0
std::optional<LeastNorm> FindLeastNorm(const SolutionSet& set, std::vector<char> positive, const Deadline& deadline);

/// The same by a method that ends, if the deadline lets it: with N a basis of null(A) and P = N (N^T N)^-1 N^T, the
/// least-norm f is the w of the LCP  w = P s + (f - P f)  on the unilateral rows, for any solution f. For some tens of
/// rows: the numbers in P are long.
std::optional<LeastNorm> ProjectOnSet(const SolutionSet& set, const Deadline& deadline);

/// Whether f_least is the only solution. A direction that keeps all rows is d in null(A), d_i >= 0 where f_i = 0; there
/// is none but 0 if and only if N of full column rank and the LCP (I - N (N^T N)^-1 N^T, -1) is solvable, N being a
/// basis of null(A) on these rows (Gordan's alternative, as a projection). O(nullity) exact solves, and that LCP;
/// nothing where the deadline ends it.
std::optional<bool> IsOnlySolution(const SolutionSet& set, const std::vector<Rational>& f_least,
                                   const Deadline& deadline);

/// A guess for FindLeastNorm, in doubles, by proximal projection on the set.
std::vector<char> GuessPositive(const SolutionSet& set);

}  // namespace lcpbench
