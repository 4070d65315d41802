#pragma once

#include <cstdint>
#include <span>

#include "solvers/lcp/step_rows.h"

/// Internal to solvers/.
namespace lcpbench {

/// Islands of one to six contacts with friction, and no other rows, in arrays of fixed size: Newton steps on modes of
/// full length, as ModeSteps::TakeFullSteps, judged as by ContactRows::Judge; an initial_f that passes is kept but
/// for rounding.
class FewContacts {
 public:
  static constexpr Index kMostContacts = 6;

  /// False where the island is of another kind, its friction rows are wrong or on other bodies than their normal rows,
  /// a row moves nothing, or no answer passes for certain; then nothing is written.
  /// @param rows       the step, numbers in range (CheckRows)
  /// @param size       rows of the island
  /// @param friction   those of the island, counted in the step
  /// @param initial_f  of the step, or nullptr: where the steps start
  /// @param f, w       of the step, written in the island; w may be nullptr
  /// @param rho, iterations  written
  static bool Solve(const StepRows& rows, Index size, std::span<const FrictionRow> friction, double tolerance,
                    const double* initial_f, double* f, double* w, double* rho, std::int64_t* iterations);
};

}  // namespace lcpbench
