#pragma once

#include <flint/fmpq_mat.h>
#include <flint/fmpz_mat.h>

#include <algorithm>
#include <iterator>
#include <numeric>
#include <utility>
#include <vector>

#include "solvers/exact/rational.h"

namespace lcpbench {

/// A matrix of FLINT's, owned. Internal to solvers/exact/.
template <typename Value, typename Entry, void (*init)(Value*, slong, slong), void (*clear)(Value*)>
class FlintMatrix {
 public:
  FlintMatrix(Index rows, Index columns) { init(&value_, rows, columns); }
  FlintMatrix(const FlintMatrix&) = delete;
  FlintMatrix(FlintMatrix&& other) noexcept : FlintMatrix(0, 0) { std::swap(value_, other.value_); }
  FlintMatrix& operator=(FlintMatrix other) {
    std::swap(value_, other.value_);
    return *this;
  }
  ~FlintMatrix() { clear(&value_); }

  Index rows() const { return value_.r; }
  Index columns() const { return value_.c; }
  Entry* at(Index i, Index j) { return value_.rows[i] + j; }
  const Entry* at(Index i, Index j) const { return value_.rows[i] + j; }
  Value* get() { return &value_; }
  const Value* get() const { return &value_; }

 private:
  Value value_;
};
using IntegerMatrix = FlintMatrix<fmpz_mat_struct, fmpz, &fmpz_mat_init, &fmpz_mat_clear>;
using RationalMatrix = FlintMatrix<fmpq_mat_struct, fmpq, &fmpq_mat_init, &fmpq_mat_clear>;

/// One integer, owned.
class Integer {
 public:
  Integer() { fmpz_init(value_); }
  Integer(const Integer&) = delete;
  Integer& operator=(const Integer&) = delete;
  ~Integer() { fmpz_clear(value_); }
  fmpz* get() { return value_; }
  const fmpz* get() const { return value_; }

 private:
  fmpz_t value_;
};

inline void Assign(fmpq* to, const Rational& from) { fmpq_set_mpq(to, from.backend().data()); }

inline Rational ToRational(const fmpq* from) {
  Rational to;
  fmpq_get_mpq(to.backend().data(), from);
  return to;
}

inline BigInteger ToInteger(const fmpz* from) {
  BigInteger to;
  fmpz_get_mpz(to.backend().data(), from);
  return to;
}
inline Rational ToRational(const fmpz* from) { return Rational(ToInteger(from)); }

/// numerator / denominator.
inline Rational ToRational(const fmpz* numerator, const fmpz* denominator) {
  return ToRational(numerator) / ToRational(denominator);
}

/// 0 to n - 1.
inline std::vector<Index> AllRows(Index n) {
  std::vector<Index> rows(At(n));
  std::iota(rows.begin(), rows.end(), Index{0});
  return rows;
}

/// The rows that are marked with a number other than 0.
inline std::vector<Index> Marked(const std::vector<char>& marks) {
  std::vector<Index> rows = AllRows(static_cast<Index>(marks.size()));
  std::erase_if(rows, [&](Index i) { return marks[At(i)] == 0; });
  return rows;
}

/// The rows and columns of A that are listed.
inline IntegerMatrix Block(const IntegerMatrix& A, const std::vector<Index>& rows, const std::vector<Index>& columns) {
  IntegerMatrix block(static_cast<Index>(rows.size()), static_cast<Index>(columns.size()));
  for (Index i = 0; i < block.rows(); ++i) {
    for (Index j = 0; j < block.columns(); ++j) {
      fmpz_set(block.at(i, j), A.at(rows[At(i)], columns[At(j)]));
    }
  }
  return block;
}

/// The rows 0 to n - 1 that are not among `rows`, which ascend.
inline std::vector<Index> OtherRows(Index n, const std::vector<Index>& rows) {
  std::vector<Index> others;
  const std::vector<Index> all = AllRows(n);
  std::set_difference(all.begin(), all.end(), rows.begin(), rows.end(), std::back_inserter(others));
  return others;
}

inline IntegerMatrix Transposed(const IntegerMatrix& A) {
  IntegerMatrix transposed(A.columns(), A.rows());
  fmpz_mat_transpose(transposed.get(), A.get());
  return transposed;
}

/// A B.
inline IntegerMatrix Product(const IntegerMatrix& A, const IntegerMatrix& B) {
  IntegerMatrix product(A.rows(), B.columns());
  fmpz_mat_mul(product.get(), A.get(), B.get());
  return product;
}

/// The least integer that makes integers of all values.
BigInteger CommonDenominator(const std::vector<Rational>& values);

/// values times `scale`, which makes integers of them, row after row.
IntegerMatrix Scaled(const std::vector<Rational>& values, Index rows, const BigInteger& scale);

/// X = A^-1 B for a nonsingular A. Some word operations for small A, p-adic lifting [Dixon 1982] for larger ones.
inline RationalMatrix Solve(const IntegerMatrix& A, const IntegerMatrix& B) {
  RationalMatrix X(A.rows(), B.columns());
  if (A.rows() > 0 && B.columns() > 0) fmpq_mat_solve_fmpz_mat(X.get(), A.get(), B.get());
  return X;
}

/// The numerators of X over one denominator.
inline IntegerMatrix Numerators(const RationalMatrix& X, Integer* denominator) {
  IntegerMatrix numerators(X.rows(), X.columns());
  fmpq_mat_get_fmpz_mat_matwise(numerators.get(), denominator->get(), X.get());
  return numerators;
}

/// Two primes of 62 bits that ranks are taken modulo; of no relation to any input.
inline constexpr mp_limb_t kPrimes[] = {4611686018427387847UL, 4611686018427387817UL};

/// The rows of a symmetric positive semidefinite A, in the order given, that do not depend on earlier ones.
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
