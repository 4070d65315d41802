#pragma once

#include <vector>

#include "solvers/exact/active_factor.h"
#include "solvers/exact/dyadic_lcp.h"
#include "solvers/lcp/solver.h"

namespace lcpbench {

/// The digits of forces and gaps, and what they are measured by. Internal to solvers/exact/.
struct DyadicScale {
  long force_bits = 0;     ///< forces are integers times 2^-force_bits
  long load_exponent = 0;  ///< |D^-1/2 b|_inf is below 2^load_exponent, and not far
};

/// w = `target` on the rows of the factor, by iterative refinement: residuals without rounding, changes in doubles.
/// Until |D^-1/2 (w - target)|_inf <= 2^(load_exponent - goal_bits), or refinements gain nothing any more.
/// @param target  one integer per row of the factor, digits as of w; empty for zeros
/// @param w       of the f that is left
/// @return the number of refinements
int RefineForces(const LcpProblem& problem, const DyadicLcp& lcp, const DyadicScale& scale,
                 const ProximalFactor& factor, const std::vector<BigInteger>& target, long goal_bits,
                 const Deadline& deadline, std::vector<BigInteger>* f, std::vector<BigInteger>* w);

/// number 2^-bits as a double, nearly.
double ToDouble(const BigInteger& number, long bits);

/// The exponent that frexp finds.
long Exponent(double value);

/// D_ii^1/2, 1 where A_ii = 0.
double RootOfDiagonal(const LcpProblem& problem, Index i);

}  // namespace lcpbench
