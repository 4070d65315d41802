#pragma once

#include <optional>
#include <vector>

#include "solvers/lcp/problem.h"

namespace lcpbench {

/// The rank of a matrix of doubles, each taken as the rational that it is. Of A = J M^-1 J^T it is that of J on the
/// columns with M^-1 > 0, see RankOf.
///
/// Elimination by rows modulo two primes of 62 bits, the larger result: at least this for certain, more with a
/// probability below 2^-50.  O(rows * columns * rank) word operations at most, far less where the matrix is sparse
Index SparseRank(const SparseMatrix& matrix);

/// The rank of the block of A on some rows; of its factors, as far as columns can move.
Index RankOfRows(const LcpProblem& problem, const std::vector<Index>& rows);

/// The rank of A. From factors it costs little at any size, as J has at most six entries a row and fills in slowly.
/// @param most_rows  without factors there is no answer above this many rows: A itself fills up
std::optional<Index> RankOf(const LcpProblem& problem, Index most_rows);

}  // namespace lcpbench
