#pragma once

#include <cstdint>
#include <span>

#include "solvers/lcp/step_rows.h"

namespace lcpbench {

/// One to three rows by trying active sets, the one of negative b first: what a tableau is too much for.
struct TinyRows {
  static constexpr std::size_t kMostRows = 3;

  /// Writes the entries `part` of f and w. False if no active set passes clearly: rho and the rounding of A f + b below
  /// `tolerance`, backward errors below `row_limit`, in double. Such rows are left to a tableau.
  /// @param part  at most kMostRows rows
  static bool Solve(const StepRows& all, std::span<const std::int32_t> part, double tolerance, double row_limit,
                    double* f, double* w, double* rho);
};

}  // namespace lcpbench
