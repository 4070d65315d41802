#pragma once

#include <vector>

#include "solvers/exact/flint_matrix.h"

namespace lcpbench {

/// Of the rows of a symmetric positive semidefinite A, in the order given, those that do not depend on earlier ones.
/// They are independent for certain; one is left out by mistake with a probability below 2^-50.
///
/// Elimination with diagonal pivots modulo a prime of 62 bits, seeded: a PSD block is singular if and only if one of
/// its rows depends on the others, and what is nonsingular modulo a prime is nonsingular.  O(rows^3) word operations
std::vector<Index> IndependentRows(const IntegerMatrix& A, const std::vector<Index>& rows);

/// A_kk - A_kR A_RR^-1 A_Rk, R the rows and A_RR^-1 A_Rk the column of X.
Rational SchurDiagonal(const IntegerMatrix& A, const std::vector<Index>& rows, const RationalMatrix& X, Index column,
                       Index k);

/// Whether every one of `others` depends on the independent rows: Schur complements of a PSD matrix are PSD, and zero
/// where their diagonals are.  O(others) exact solves at a time
bool AllDepend(const IntegerMatrix& A, const std::vector<Index>& independent, const std::vector<Index>& others);

/// Whether a symmetric A is positive semidefinite: its eigenvalues are real, and none is negative if and only if the
/// coefficients of its characteristic polynomial alternate in sign [Descartes].  For some hundred rows.
bool IsPositiveSemidefinite(const IntegerMatrix& A);

}  // namespace lcpbench
