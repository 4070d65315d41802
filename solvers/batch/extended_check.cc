#include "solvers/batch/extended_check.h"

#include <numeric>
#include <span>

#include "solvers/rows/row_sums.h"

namespace lcpbench {

bool PassesExtended(const StepRows& rows, double tolerance, double row_limit, const double* f, double* rho) {
  const Index p = rows.columns_per_body;
  // Bodies in the order in which rows name them.
  std::int32_t names[2 * kMostExtendedRows];
  Index slots[2 * kMostExtendedRows];  // by side of a row
  long double velocity[2 * kMostExtendedRows * 6];
  double size[2 * kMostExtendedRows * 6];
  Index count = 0;
  for (Index side = 0; side < 2 * rows.rows; ++side) {
    Index at = rows.body[side] < 0 ? -1 : count - 1;
    while (at >= 0 && names[at] != rows.body[side]) --at;
    if (at < 0 && rows.body[side] >= 0) {
      at = count++;
      names[at] = rows.body[side];
      std::fill_n(velocity + at * p, p, 0.0L);
      std::fill_n(size + at * p, p, 0.0);
    }
    slots[side] = at * p;
  }
  std::int32_t all[kMostExtendedRows];
  std::iota(all, all + rows.rows, 0);
  return WithNumbers(rows, [&](const auto* J, auto width) {
    const auto slot = [&](Index side) { return slots[side]; };
    const auto no_more = [](std::int32_t /*row*/) { return 0.0; };
    const std::span<const std::int32_t> part(all, static_cast<std::size_t>(rows.rows));
    return SumRows<width>(rows, J, part, row_limit, f, nullptr, slot, no_more, velocity, size)
               .Judge(tolerance, kRoundingOfTwoBodies<long double>, rho) == LawSums<double>::Known::kRight;
  });
}

}  // namespace lcpbench
