#include "solvers/rows/row_judge.h"

#include <cmath>
#include <type_traits>

#include "solvers/pivoting/tableau_rules.h"
#include "solvers/rows/row_sums.h"

namespace lcpbench {
namespace {

// Of bodies in space.
constexpr Index kMostColumns = 6;

}  // namespace

void RowJudge::Reserve(Index max_bodies) {
  const auto size = static_cast<std::size_t>(kMostColumns * max_bodies);
  if (velocity_.size() >= size) return;
  velocity_.resize(size, 0.0);
  size_.resize(size, 0.0);
  extended_velocity_.resize(size, 0.0L);
}

bool RowJudge::Passes(const StepRows& rows, std::span<const std::int32_t> part, double tolerance, const double* f,
                      double* w, double* rho) {
  using Known = ResidualSums<double>::Known;
  const double row_limit = tableau::kMargin * std::sqrt(tolerance);
  const auto judge = [&](auto* velocity) {
    using Sum = std::remove_pointer_t<decltype(velocity)>;
    return WithNumbers(rows, [&](const auto* J, auto width) {
      constexpr int p = width;
      const auto slot = [&](Index side) { return static_cast<Index>(rows.body[side]) * p; };
      const ResidualSums<double> sums = SumRows<p>(rows, J, part, row_limit, f, w, slot, velocity, size_.data());
      for (const std::int32_t row : part) {
        for (Index side = Index{2} * row; side < Index{2} * row + 2; ++side) {
          for (Index c = 0; c < p && rows.body[side] >= 0; ++c)
            velocity[slot(side) + c] = size_[static_cast<std::size_t>(slot(side) + c)] = 0;
        }
      }
      *rho = sums.rho();
      return sums.Judge(tolerance, kRoundingOfTwoBodies<Sum>);
    });
  };
  const Known known = judge(velocity_.data());
  return known == Known::kRight || (known == Known::kUnclear && judge(extended_velocity_.data()) == Known::kRight);
}

}  // namespace lcpbench
