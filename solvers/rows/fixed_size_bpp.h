#pragma once

#include <cstdint>
#include <span>

#include "solvers/lcp/step_rows.h"
#include "solvers/rows/kernel.h"

namespace lcpbench {

/// One to six rows, by L D L^T of A_FF for one active set F after the other: all in registers, without the branches
/// that fresh problems mispredict. Block principal pivoting [Judice, Pires 1994] from the rows with negative b finds F
/// with one or two factors as a rule; then single rows enter, and where A_FF becomes singular the row whose force
/// vanishes first leaves [Keller 1973].
class FixedSizeBpp {
 public:
  static constexpr int kMostRows = 6;

  /// @throws InputError if this machine lacks the instructions
  explicit FixedSizeBpp(InstructionSet instructions = InstructionSet::kBest) : kernel_(FindRowsKernel(instructions)) {}

  /// Writes the entries `part` of f and w. False if no active set passes clearly: rho and the rounding of A f + b below
  /// `tolerance`, backward errors below `row_limit`, in double. Such rows are left to a tableau.
  /// @param part  at most kMostRows rows
  bool Solve(const StepRows& all, std::span<const std::int32_t> part, double tolerance, double row_limit, double* f,
             double* w, double* rho) const {
    return kernel_.solve_few({&all, part.data(), part.size(), tolerance, row_limit}, f, w, rho);
  }

 private:
  const RowsKernel& kernel_;
};

}  // namespace lcpbench
