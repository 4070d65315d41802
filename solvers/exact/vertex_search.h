#pragma once

#include <optional>
#include <vector>

#include "solvers/exact/dyadic_lcp.h"

namespace lcpbench {

/// Of FindVertex.
struct Vertex {
  std::vector<Index> basis;   ///< G, ascending: the active rows
  std::vector<BigInteger> f;  ///< by the digits of DyadicScale
};

/// Where rows depend on others to the rounding of doubles, the problem as its doubles say it still tells which of them
/// are active: at the last digits of b, forces being moved along each other by any amount. This finds out, by pivots as
/// of the primal simplex method. Internal to solvers/exact/.
///
/// Dependent rows are first brought to f = 0, each by the ray of forces that leaves the gaps of a basis G of
/// independent rows alone, up to the first force of G that becomes 0, whose place it takes. Then, with gaps in
/// integers, the row of the most negative gap enters G in the same way, until there is none.
/// @param f       forces >= 0 with small gaps on all rows with f > 0
/// @param pivots  how many were made
/// @return nothing where pivots come to no end, or where the problem may have no solution
/// O(fill) of a sparse factor a pivot, some hundred pivots per hundred dependent rows
std::optional<Vertex> FindVertex(const LcpProblem& problem, const DyadicLcp& lcp, const DyadicScale& scale,
                                 const std::vector<Index>& independent, const std::vector<Index>& dependent,
                                 std::vector<BigInteger> f, const Deadline& deadline, int* pivots);

}  // namespace lcpbench
