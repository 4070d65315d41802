#pragma once

#include <ostream>
#include <string>

#include "solvers/lcp/problem.h"

namespace lcpbench {

/// The quadratic program whose optimality conditions are the LCP of a symmetric positive semidefinite A,
///     minimize 1/2 f^T A f + b^T f,   f_i >= 0 on unilateral rows, free on bilateral ones, in the bounds of bounded
///     ones,
/// as a QPS file [Maros, Meszaros, A repository of convex quadratic programming problems, 1999]: columns f1 to fn, b in
/// the objective row, the lower triangle of A without zeros in QUADOBJ, FR for bilateral rows, LO or MI and UP for
/// bounded ones. Free format: numbers have 17 significant digits, which read back to the same bits, and names no
/// spaces.
/// @throws InputError for friction rows, for A that is not symmetric bit for bit, and where the product of factors
/// overflows
void WriteQpsText(const LcpProblem& problem, std::ostream& output);
/// @throws InputError also where the file cannot be written
void WriteQpsProblem(const LcpProblem& problem, const std::string& path);

/// @throws InputError for friction rows, and where A is not symmetric bit for bit
void RequireQp(const LcpProblem& problem);

}  // namespace lcpbench
