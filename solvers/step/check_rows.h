#pragma once

#include "solvers/lcp/step_rows.h"

namespace lcpbench {

/// Whether all numbers are in the range that methods square them in (LcpProblem::has_extreme_matrix, has_extreme_b).
/// Only the inverse masses of bodies that rows name are looked at.  O(n)
/// @param initial_f  n numbers, or nullptr
/// @throws InputError naming the array, the place and what was found: a size or p out of range, an array that is
///         missing, a body outside [-1, bodies), NaN or infinity, a negative inverse mass
bool CheckRows(const StepRows& rows, const double* initial_f);

}  // namespace lcpbench
