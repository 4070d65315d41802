#include "solvers/rows/row_judge.h"

#include <cmath>
#include <type_traits>
#include <utility>

#include "solvers/rows/row_sums.h"

namespace lcpbench {
namespace {

// Bodies in space have so many columns.
constexpr Index kMostColumns = 6;
// A row's backward error with all that rounding may hide of it, in parts of what is allowed.
constexpr double kPartOfRowLimit = 0.99;

}  // namespace

void RowJudge::Reserve(Index max_rows, Index max_bodies) {
  sides_.Reserve(max_rows, max_bodies);
  const auto size = static_cast<std::size_t>(kMostColumns * max_bodies);
  if (velocity_.size() >= size) return;
  velocity_.resize(size, 0.0);
  size_.resize(size, 0.0);
  extended_velocity_.resize(size, 0.0L);
}

// change(body, side) for all sides of the rows `part` that are on a body.
template <typename Change>
void RowJudge::ForSides(const StepRows& rows, std::span<const std::int32_t> part, const Change& change) {
  for (const std::int32_t row : part) {
    for (std::int32_t side = 2 * row; side < 2 * row + 2; ++side) {
      if (rows.body[side] >= 0) change(Index{rows.body[side]}, side);
    }
  }
}

// (|A| |f|)_row, A_ij as the verifier has it.  O(rows on its bodies)
template <int p, typename Real>
double RowJudge::SizeOfGap(const StepRows& rows, const Real* J, const double* f, std::int32_t row) const {
  const std::int32_t* const own = rows.body + Index{2} * row;
  const auto entry = [&](const std::int32_t* its, std::int32_t other) {
    long double sum = 0;
    for (int k = 0; k < 4; ++k) {
      if (own[k / 2] < 0 || own[k / 2] != its[k % 2]) continue;
      const double* const inverse_mass = rows.inverse_mass + static_cast<Index>(own[k / 2]) * p;
      const Real* const mine = J + (Index{2} * row + k / 2) * p;
      const Real* const others = J + (Index{2} * other + k % 2) * p;
      for (int c = 0; c < p; ++c) sum += static_cast<long double>(mine[c]) * inverse_mass[c] * others[c];
    }
    return sum;
  };
  double size = 0;
  for (int s = 0; s < 2; ++s) {
    if (own[s] < 0 || (s == 1 && own[1] == own[0])) continue;
    sides_.ForEach(own[s], [&](std::int32_t side) {
      const std::int32_t other = side / 2;
      const std::int32_t* const its = rows.body + Index{2} * other;
      const bool is_second_here = side % 2 == 1 && its[0] == its[1];
      const bool was_on_first = s == 1 && own[0] >= 0 && (its[0] == own[0] || its[1] == own[0]);
      if (f[other] == 0 || is_second_here || was_on_first) return;
      size += static_cast<double>(std::abs(entry(its, other) * f[other]));
    });
  }
  return size;
}

bool RowJudge::Passes(const StepRows& rows, std::span<const std::int32_t> part, double tolerance, const double* f,
                      double* w, double* rho) {
  using Known = LawSums<double>::Known;
  const double row_limit = kPartOfRowLimit * std::sqrt(tolerance);
  bool has_sides = false;
  const auto judge = [&](auto* velocity) {
    using Sum = std::remove_pointer_t<decltype(velocity)>;
    return WithNumbers(rows, [&](const auto* J, auto width) {
      constexpr int p = width;
      const auto slot = [&](Index side) { return static_cast<Index>(rows.body[side]) * p; };
      const auto size_of_gap = [&](std::int32_t row) {
        if (!std::exchange(has_sides, true)) {
          ForSides(rows, part, [this](Index body, std::int32_t of_body) { sides_.Add(body, of_body); });
        }
        return SizeOfGap<p>(rows, J, f, row);
      };
      const LawSums<double> sums =
          SumRows<p>(rows, J, part, row_limit, f, w, slot, size_of_gap, velocity, size_.data());
      ForSides(rows, part, [&](Index body, std::int32_t /*side*/) {
        for (Index c = body * p; c < (body + 1) * p; ++c) velocity[c] = size_[static_cast<std::size_t>(c)] = 0;
      });
      return sums.Judge(tolerance, kRoundingOfTwoBodies<Sum>, rho);
    });
  };
  const Known known = judge(velocity_.data());
  const bool passes =
      known == Known::kRight || (known == Known::kUnclear && judge(extended_velocity_.data()) == Known::kRight);
  if (has_sides) ForSides(rows, part, [this](Index body, std::int32_t /*side*/) { sides_.Forget(body); });
  return passes;
}

}  // namespace lcpbench
