#pragma once

#include "benchmarks/studies/step_arrays.h"

namespace lcpbench {

/// n rows on random bodies, also on one that cannot move, on none, and with both sides on one body; some rows are
/// copies of others with either sign, some are joints. Solvable: b is A f planted.
/// @param bodies              fewer than n / p make the rows redundant
/// @param is_exact_in_single  rounding J to single precision changes nothing
StepArrays RandomStep(Index n, Index bodies, int columns_per_body, unsigned seed, bool is_exact_in_single = false);

}  // namespace lcpbench
