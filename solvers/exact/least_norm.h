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
  std::vector<Index> independent;  ///< rows that the others depend on
  std::vector<Rational> f;         ///< one solution
};

struct LeastNorm {
  std::vector<Rational> f;
  std::vector<Rational> multipliers;  ///< l: f - A l >= 0, = 0 where f > 0 and on bilateral rows
};

/// min |f|^2 over the set, which is an LCP itself: f = A l + s = J^T x, J of the independent rows of A and of a unit
/// vector a unilateral row, x = (l, s); J J^T x + (b, 0) is 0 on the former, which are bilateral, and the f of the
/// latter. It starts from a guess in doubles; nothing where the deadline ends it. Every answer is proved by its
/// multipliers.
std::optional<LeastNorm> FindLeastNorm(const SolutionSet& set, const Deadline& deadline);

/// Whether f_least is the only solution. A direction that keeps all rows is d in null(A), d_i >= 0 on Z, the unilateral
/// rows with f_i = 0. There is none but 0 if and only if the columns of A off Z are independent and no such d has the
/// sum 1 on Z: min |A d|^2 + (sum - 1)^2, again an LCP, is then > 0. It is 1 - sum. Nothing where the deadline ends it.
std::optional<bool> IsOnlySolution(const SolutionSet& set, const std::vector<Rational>& f_least,
                                   const Deadline& deadline);

}  // namespace lcpbench
