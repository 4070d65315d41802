#pragma once

#include "solvers/lcp/step_rows.h"

namespace lcpbench {

/// Whether f passes by the rows themselves, in extended precision: rho and the backward error of each row. For what
/// rounding may hide in double, with large ratios of masses and in rows whose terms cancel. Allocates nothing. False,
/// too, for rows that pass only by (|A| |f|)_i, which it does not know.  O(n bodies)
/// @param rows       at most kMostExtendedRows, checked
/// @param row_limit  of a row's backward error
/// @param rho        written
bool PassesExtended(const StepRows& rows, double tolerance, double row_limit, const double* f, double* rho);

inline constexpr Index kMostExtendedRows = 64;

}  // namespace lcpbench
