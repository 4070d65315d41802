#pragma once

#include <cstdint>
#include <span>

#include "solvers/lcp/law.h"
#include "solvers/lcp/step_rows.h"

/// Internal to solvers/rows/.
namespace lcpbench {

/// Adds up the rows `part` at f by their given numbers. w, unless it is nullptr, becomes A f + b.
/// @tparam Sum   what gaps are summed in
/// @param J      rows.J or rows.J_single
/// @param slot   of a row's side, 2 row + (0 or 1): where the p numbers of its body begin in `velocity` and `size`;
///               negative: none
/// @param size_of_gap  of a row: (|A| |f|)_row, asked only where that is not clearly large enough
/// @param velocity, size  0 for these bodies; become M^-1 J^T f and the sums of its absolute values
template <int p, typename Sum, typename Real, typename Slot, typename SizeOfGap>
LawSums<double> SumRows(const StepRows& rows, const Real* J, std::span<const std::int32_t> part, double row_limit,
                        const double* f, double* w, const Slot& slot, const SizeOfGap& size_of_gap, Sum* velocity,
                        double* size) {
  const auto for_sides = [&](Index row, auto&& visit) {
    for (Index side = 2 * row; side < 2 * row + 2; ++side) {
      const Index at = slot(side);
      if (at >= 0) visit(J + side * p, rows.inverse_mass + static_cast<Index>(rows.body[side]) * p, at);
    }
  };
  for (const std::int32_t row : part) {
    if (f[row] == 0) continue;
    for_sides(row, [&](const Real* j, const double* inverse_mass, Index at) {
      for (int c = 0; c < p; ++c) {
        const Sum change = inverse_mass[c] * (static_cast<Sum>(j[c]) * f[row]);
        velocity[at + c] += change;
        size[at + c] += static_cast<double>(std::abs(change));
      }
    });
  }
  LawSums<double> sums(row_limit);
  for (const std::int32_t row : part) {
    double d = 0;
    Sum gap = rows.b[row];
    double magnitude = std::abs(rows.b[row]);
    for_sides(row, [&](const Real* jacobian, const double* inverse_mass, Index at) {
      for (int c = 0; c < p; ++c) {
        const auto j = static_cast<double>(jacobian[c]);
        d += inverse_mass[c] * (j * j);
        gap += static_cast<Sum>(j) * velocity[at + c];
        magnitude += std::abs(j) * size[at + c];
      }
    });
    const std::int32_t* const bodies = rows.body + Index{2} * row;
    if (bodies[0] == bodies[1]) d = DiagonalOf(rows, row);
    const bool is_joint = rows.bilateral != nullptr && rows.bilateral[row] != 0;
    const auto w_row = static_cast<double>(gap);
    sums.Add(d, rows.b[row], w_row, f[row], is_joint, magnitude);
    // `magnitude` is more than (|A| |f|)_i where rows on a body do not act on each other. That is at least both
    // |A f|_i and |A_ii f_i|, by which alone most rows pass.
    const double b = std::abs(rows.b[row]);
    const double defect = std::abs(LawSums<double>::Defect(w_row, d * f[row], is_joint));
    const double least = row_limit * (b + std::max(std::abs(w_row - rows.b[row]), std::abs(d * f[row])));
    // What rounding of the terms may add to the defect of a row whose terms cancel.
    const double hidden = kRoundingOfTwoBodies<Sum> * magnitude;
    if (!(defect + hidden <= least)) {
      const double limit = row_limit * (b + size_of_gap(row));
      if (!(defect <= limit)) sums.RefuseRow();
      if (!(defect + hidden <= limit)) sums.DoubtRow();
    }
    if (w != nullptr) w[row] = w_row;
  }
  return sums;
}

}  // namespace lcpbench
