#pragma once

#include "solvers/lcp/problem.h"

namespace lcpbench {

/// Unit masses on a vertical line, each resting on the one below, pushed by random loads: some contacts open. A is
/// tridiagonal.
LcpProblem Column(Index n, unsigned seed);

/// Discs in rows of ten on a floor, each touching the two below: as many contacts as translations, and side loads that
/// open some of them.
LcpProblem DiscPile(Index n, unsigned seed);

/// A solvable column of n rows, and two opposed rows on its top body that both demand to open: infeasible.
LcpProblem JammedColumn(Index n, unsigned seed);

}  // namespace lcpbench
