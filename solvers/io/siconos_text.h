#pragma once

#include <istream>
#include <ostream>
#include <string>

#include "solvers/io/contact_rows.h"
#include "solvers/lcp/problem.h"

namespace lcpbench {

// Text files of Siconos' numerics (.dat): linear complementarity problems (LCP) and mixed ones (MLCP), as
// linearComplementarity_newFromFile and mixedLinearComplementarity_newFromFile read them (Siconos 4.4), and contact
// problems with friction (frictionContact_newFromFile), which are read and not written: of each contact its normal row
// and, where its coefficient is not 0, its tangents.
// docs/formats.md has the layout. Our bilateral rows are the equations; blocks keep the order of rows.

/// Dense storage gives a dense problem, sparse storage and sparse blocks a sparse one. An MLCP whose M has more or
/// fewer equations than free unknowns is made square by rows and columns 0 (docs/formats.md), and sparse. Memory is in
/// proportion to what the file holds.
/// @param name  of the file, for error texts
/// @param tangents  what is read of problems with friction
/// @throws InputError naming file, line, what was expected and what was found: another layout or storage
/// (compressed rows), sizes that are negative or do not fit each other, numbers that are not
/// finite, too few numbers or too many, friction coefficients < 0, or > 0 of contacts with two tangents, both storages
/// of an MLCP where they differ
LcpProblem ReadSiconosText(std::istream& input, const std::string& name, const std::string& id,
                           TangentRows tangents = TangentRows::kOne);
/// Reads a file, plain or compressed by gzip. The problem's id is the file's name without its ending.
LcpProblem ReadSiconosProblem(const std::string& path, TangentRows tangents = TangentRows::kOne);

/// An LCP, or where there are bilateral rows an MLCP of M and q alone with its blocks in the order of our rows (some of
/// Siconos' MLCP solvers want the equations first). Dense problems as dense matrices, sparse ones as triplets with all
/// stored entries: both are read back bit for bit. Of factors the rounded A is written: the format has no place for J.
/// @throws InputError for bounds that are neither unilateral nor bilateral, and where the product of factors overflows
void WriteSiconosText(const LcpProblem& problem, std::ostream& output);
/// @throws InputError also where the file cannot be written
void WriteSiconosProblem(const LcpProblem& problem, const std::string& path);

}  // namespace lcpbench
