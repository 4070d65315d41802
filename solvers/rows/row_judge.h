#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "solvers/lcp/step_rows.h"
#include "solvers/linear_algebra/sides_of_bodies.h"
#include "solvers/linear_algebra/tableau_rules.h"

namespace lcpbench {

/// Whether forces pass for rows of a step: rho, with a bound of what rounding hides of it, and the backward error of
/// each row, by the given numbers. Sums are in double, and in extended precision where rounding may hide more than the
/// tolerance, as with large ratios of masses. Only Reserve allocates.
class RowJudge {
 public:
  /// For steps of up to `max_rows` rows with up to `max_bodies` bodies.
  void Reserve(Index max_rows, Index max_bodies);
  /// @param part  rows that share no moving body with others; f is read and w = A f + b written there
  /// @param rho   written
  /// @param margin  part of the backward error that a row is allowed which it may have, as summed; rounding may add the
  ///                rest
  bool Passes(const StepRows& rows, std::span<const std::int32_t> part, double tolerance, const double* f, double* w,
              double* rho, double margin = tableau::kMargin);

 private:
  template <int p, typename Real>
  double SizeOfGap(const StepRows& rows, const Real* J, const double* f, std::int32_t row) const;
  template <typename Change>
  static void ForSides(const StepRows& rows, std::span<const std::int32_t> part, const Change& change);

  SidesOfBodies sides_;  // of the part at hand; none between calls
  // By body, 0 between calls.
  std::vector<double> velocity_, size_;
  std::vector<long double> extended_velocity_;
};

}  // namespace lcpbench
