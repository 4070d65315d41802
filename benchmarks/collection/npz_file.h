#pragma once

#include <string>

#include "solvers/lcp/problem.h"

namespace lcpbench {

/// The QP of solvers/io/qps_text.h as a file that numpy.load, and Problem.load of qpsolvers 2 and later, read: an
/// archive (zip, deflated) of arrays of 64-bit numbers
///     P (n x n, dense), q (n), lb (n: 0 on unilateral rows, -inf on bilateral ones, bounds of bounded ones),
/// where there are bounded rows of ub (n), else None as G, h, A and b are, as Problem.save writes it: an array of
/// Python's objects, which numpy.load reads with allow_pickle only and Problem.load takes for "not there". The same
/// problem gives the same bytes.
/// @throws InputError for friction rows, for A that is not symmetric bit for bit, of more than 23,000 rows (4 GB), or
/// where the file cannot be written; MemoryRefusal where a dense A is more than there is memory
void WriteNpzProblem(const LcpProblem& problem, const std::string& path);

}  // namespace lcpbench
