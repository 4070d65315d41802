#pragma once

#include <vector>

#include "solvers/lcp/problem.h"

/// Internal to solvers/.
namespace lcpbench {

/// Rows per block of a coloured order. Colours span a block and not the whole problem, so that the bodies that a block
/// works on stay in the first-level cache from colour to colour. Measured: 512 to 4096 rows are alike, 128 make the
/// sets of independent rows so small that a sweep takes a sixth longer.
inline constexpr Index kColourBlock = 512;

/// An order of the rows in which blocks of kColourBlock rows follow each other as given, and within a block rows of one
/// colour stand together, in the given order; no two rows of a colour touch the same movable body (`by_bodies`; needs
/// factors) or have A_ij != 0 (otherwise; reads SparseA, whose pattern must be symmetric). Each row takes the first
/// colour that is free (greedy). O(nnz) and a word per 64 colours.
std::vector<Index> ColouredOrder(const LcpProblem& problem, bool by_bodies);

}  // namespace lcpbench
