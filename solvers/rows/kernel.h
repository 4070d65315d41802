#pragma once

#include <cstddef>
#include <cstdint>

#include "solvers/lcp/step_rows.h"
#include "solvers/linear_algebra/instruction_set.h"

/// Internal to solvers/rows/: what is compiled for each instruction set. This header is compiled with every set of
/// flags, so that kernels call no function that it includes but those that are inlined whatever the flags.
namespace lcpbench {

/// L of ProfileFactor: `rows` rows, of which row a begins in whole registers of 8 numbers, aligned to them.
struct ProfileWork {
  std::ptrdiff_t rows;
  double* L;                       ///< column k of row a: L[begin[a] + k]
  const std::int64_t* begin;       ///< n
  const std::int32_t* first;       ///< n: the first column of row a
  const std::int32_t* last_below;  ///< n: the lowest row that reaches column a or one before
  const double* floor;             ///< n: a pivot at most so large is rounding
  double* columns;                 ///< room for kProfilePanel columns of `stride` numbers, aligned as L
  std::ptrdiff_t stride;           ///< whole registers
};
/// Columns that are subtracted from the rows below together; divides a register.
inline constexpr std::ptrdiff_t kProfilePanel = 4;

/// The rows `part`, FixedSizeBpp::kMostRows at most, and what is asked of their forces.
struct FewRows {
  const StepRows* all;
  const std::int32_t* part;
  std::size_t size;
  double tolerance;
  double row_limit;
};

/// The kernels of one instruction set.
struct RowsKernel {
  bool (*solve_few)(const FewRows& rows, double* f, double* w, double* rho);  ///< FixedSizeBpp::Solve
  bool (*factorize)(const ProfileWork& work);                                 ///< L D L^T in place of L; is it whole?
  void (*solve)(const ProfileWork& work, double* y);  ///< y := (L D L^T)^-1 y, aligned as L, in whole registers
};
extern const RowsKernel kRowsKernelSse2, kRowsKernelAvx2, kRowsKernelAvx512;

/// @throws InputError if this machine lacks the instructions
const RowsKernel& FindRowsKernel(InstructionSet instructions);

}  // namespace lcpbench
