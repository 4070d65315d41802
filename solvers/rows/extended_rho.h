#pragma once

#include "solvers/lcp/step_rows.h"

namespace lcpbench {

/// rho of f (verify.h) by the rows themselves, in extended precision: what decides where rounding may hide more than
/// the tolerance in double, with large ratios of masses above all. Allocates nothing.  O(n bodies)
/// @param rows  at most kMostExtendedRows, checked
long double ExtendedRho(const StepRows& rows, const double* f);

inline constexpr Index kMostExtendedRows = 128;

}  // namespace lcpbench
