#pragma once

#include <cstdint>
#include <span>
#include <type_traits>

#include "solvers/lcp/problem.h"

namespace lcpbench {

/// One problem as an engine's arrays hold it, read in place: rows that act on at most two bodies.
///     w = A f + b,   A = J M^-1 J^T,   unilateral rows: 0 <= f _|_ w >= 0,   bilateral rows: w = 0, f free,
/// friction and bounded rows as FrictionRow and BoundedRow say: as LcpProblem, with its units. p = columns_per_body
/// numbers a body: 3 in the plane (x, y, rotation), 6 in space in principal axes (three translations, three rotations
/// about the principal axes), so that M^-1 is diagonal.
///
/// Nothing is owned or copied; the arrays must not change during a call. Rows that act on more than two bodies are for
/// LcpProblem.
struct StepRows {
  int columns_per_body = 3;                  ///< p, 3 or 6
  Index rows = 0;                            ///< n
  Index bodies = 0;                          ///< how many `inverse_mass` has
  const std::int32_t* body = nullptr;        ///< 2 n: the bodies of a row, in [0, bodies); -1: none (the ground)
  const double* J = nullptr;                 ///< 2 p n: of each row the p numbers of its first, then of its second body
  const float* J_single = nullptr;           ///< the same in single precision, instead of J; sums are in double
  const double* b = nullptr;                 ///< n
  const unsigned char* bilateral = nullptr;  ///< n, 1: a joint; nullptr: every row is unilateral
  const double* inverse_mass = nullptr;      ///< p bodies, >= 0; 0: cannot move
  std::span<const FrictionRow> friction = {};  ///< as RowBounds; read by StepSolver and RowIslands, as `bounded`
  std::span<const BoundedRow> bounded = {};    ///< as RowBounds
};

/// visit(J, p) with the J of the step, in its precision, and its p as a constant: std::integral_constant<int, p>.
template <typename Visit>
auto WithNumbers(const StepRows& rows, const Visit& visit) {
  const auto by = [&](const auto* J) {
    return rows.columns_per_body == 3 ? visit(J, std::integral_constant<int, 3>())
                                      : visit(J, std::integral_constant<int, 6>());
  };
  return rows.J != nullptr ? by(rows.J) : by(rows.J_single);
}

/// A_ii = sum of m^-1 j^2 over a row's bodies; where both are the same one, over the sum of its sides.
double DiagonalOf(const StepRows& rows, std::int64_t row);
/// Whether no A_ii is extreme: small numbers do no harm beside others of their row.  O(n)
bool HasDiagonalInRange(const StepRows& rows);
/// A, as AssembleDenseA of problem.h: into n rows of `stride` >= n numbers each, padding zero. By bodies that rows
/// share.  O(n^2)
void AssembleDenseA(const StepRows& rows, double* A, Index stride);
/// The rows first to last - 1 of plain rows alone.
StepRows PartOf(const StepRows& rows, std::int64_t first, std::int64_t last);

/// The same problem by factors. Allocates.
/// @param rows  checked (CheckRows)
LcpProblem ProblemOf(const StepRows& rows);

}  // namespace lcpbench
