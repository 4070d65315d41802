#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "solvers/lcp/law.h"

namespace lcpbench {

/// The equations of a choice of sides [docs/friction.md section 5]: unknowns y are the forces of the rows inside their
/// range, equations E say that the gaps of the same rows are 0, f = B y + c with c the ends of ranges that are
/// constant, and B the ends that follow a normal force. K = A_E B: square, and nonsymmetric where a contact slips; of
/// plain rows A_FF of the active set F. The one coding of these. Internal to solvers/.
/// @tparam Number  double, or a rational
template <typename Number>
struct ModeEquations {
  std::vector<Index> equation;             ///< E, ascending
  std::vector<Index> unknown;              ///< n: the place of the row's unknown, -1: its force is constant
  std::vector<Number> coefficient, fixed;  ///< n: f_i = coefficient_i y_unknown + fixed_i

  /// O(n); allocates where it has met no problem as large
  /// @param side      n
  /// @param friction  rows as FrictionRow, mu a Number
  /// @param bounded   rows as BoundedRow, bounds Numbers
  template <typename FrictionRows, typename BoundedRows>
  void Set(std::span<const RangeSide> side, const FrictionRows& friction, const BoundedRows& bounded) {
    const std::size_t n = side.size();
    equation.clear();
    unknown.assign(n, -1);
    coefficient.assign(n, Number(0));
    fixed.assign(n, Number(0));
    for (std::size_t i = 0; i < n; ++i) {
      if (side[i] != RangeSide::kInside) continue;
      unknown[i] = static_cast<Index>(equation.size());
      coefficient[i] = Number(1);
      equation.push_back(static_cast<Index>(i));
    }
    for (const auto& row : bounded) {
      const auto i = static_cast<std::size_t>(row.row);
      if (side[i] != RangeSide::kInside) fixed[i] = EndOf(side[i] == RangeSide::kLower ? row.lower : row.upper);
    }
    for (const auto& row : friction) {
      const auto i = static_cast<std::size_t>(row.row), normal = static_cast<std::size_t>(row.normal);
      if (side[i] == RangeSide::kInside || side[normal] != RangeSide::kInside) continue;
      unknown[i] = unknown[normal];
      const int slope = row.slip != 0 ? -row.slip : static_cast<int>(side[i]);
      coefficient[i] = slope * row.mu;
    }
  }
  /// The force of a row, of the unknowns y.
  template <typename Vector>
  Number ForceOf(Index row, const Vector& y) const {
    const auto i = static_cast<std::size_t>(row);
    return unknown[i] < 0 ? fixed[i] : Number(fixed[i] + coefficient[i] * y[unknown[i]]);
  }
  /// Whether the force of a row is an unknown.
  bool IsUnknown(Index row) const {
    const Index place = unknown[static_cast<std::size_t>(row)];
    return place >= 0 && equation[static_cast<std::size_t>(place)] == row;
  }
  /// visit(row, unknown, coefficient) of the rows whose forces are not constant.
  template <typename Visit>
  void VisitFollowers(const Visit& visit) const {
    for (std::size_t i = 0; i < unknown.size(); ++i) {
      if (unknown[i] >= 0 && coefficient[i] != 0) visit(static_cast<Index>(i), unknown[i], coefficient[i]);
    }
  }
  /// m
  Index size() const { return static_cast<Index>(equation.size()); }
  /// For up to so many rows.
  void Reserve(Index max_rows) {
    const auto rows = static_cast<std::size_t>(max_rows);
    for (std::vector<Index>* const numbers : {&equation, &unknown}) numbers->reserve(rows);
    for (std::vector<Number>* const numbers : {&coefficient, &fixed}) numbers->reserve(rows);
  }

 private:
  static const Number& EndOf(const Number& bound) { return bound; }
  static const Number& EndOf(const std::optional<Number>& bound) { return *bound; }
};

}  // namespace lcpbench
