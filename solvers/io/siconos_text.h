#pragma once

#include <istream>
#include <ostream>
#include <string>

#include "solvers/lcp/problem.h"

namespace lcpbench {

// Text files of Siconos' numerics (.dat): linear complementarity problems (LCP) and mixed ones (MLCP), as
// linearComplementarity_newFromFile and mixedLinearComplementarity_newFromFile read them (Siconos 4.4, in parentheses
// what stands in the file; any spaces and line ends between the words).
//
//   LCP     n, matrix M, the n numbers of q:             w = M z + q, 0 <= z, w, z w = 0
//   MLCP    (1 or 0) whether M and q follow, (1 or 0) whether A, B, C, D, a, b follow, the number n of equations, the
//           number m of complementarity rows;
//           for M and q: the first row of every block and n + m after the last; for every block 0 (equations, z free
//           and w = 0) or 1 (complementarity); matrix M; the n + m numbers of q;
//           for A to b: A (n x n), B (m x m), C (n x m), D (m x n), row by row, a (n), b (m); M = [A C; D B], q = [a;
//           b]
//   matrix  storage, rows, columns, and
//           storage 0, dense: rows, columns once more, the entries *column by column*;
//           storage 2, sparse: (1) a line that begins with CSparse, (triplet: 3-by-3, nzmax: 4 nnz: 4), and for every
//           entry (row column : value) from 0; or (2) such a line, (3-by-3, nzmax: 4 nnz: 4, ...), and for every
//           column (col 0 : locations 0 to 1) and its entries (row : value). Entries of one place add up.
//
// Which of the two a file is, its first five words tell. Our bilateral rows are the equations; blocks keep the order of
// rows. Text after the last number is passed over where it begins with a word; so are up to n + 2m numbers after an
// MLCP, the known answer in Siconos' own test files.

/// Dense storage gives a dense problem, sparse storage a sparse one. Memory is in proportion to what the file holds.
/// @param name  of the file, for error texts
/// @throws InputError naming file, line, what was expected and what was found: another layout or storage (sparse
/// blocks, compressed rows), sizes that are negative, do not fit each other or are not square, what is no finite
/// number, too few numbers or too many, both storages of an MLCP where they differ
LcpProblem ReadSiconosText(std::istream& input, const std::string& name, const std::string& id);
/// The problem's id is the file's name without its extension.
LcpProblem ReadSiconosProblem(const std::string& path);

/// An LCP, or where there are bilateral rows an MLCP of M and q alone with its blocks in the order of our rows (some of
/// Siconos' MLCP solvers want the equations first). Dense problems as dense matrices, sparse ones as triplets with all
/// stored entries: both are read back bit for bit. Of factors the rounded A is written: the format has no place for J.
/// @throws InputError for bounds that are neither unilateral nor bilateral, and where the product of factors overflows
void WriteSiconosText(const LcpProblem& problem, std::ostream& output);
/// @throws InputError also where the file cannot be written
void WriteSiconosProblem(const LcpProblem& problem, const std::string& path);

}  // namespace lcpbench
