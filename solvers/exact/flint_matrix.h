#pragma once

#include <flint/fmpq_mat.h>
#include <flint/fmpz_mat.h>

#include <cstddef>
#include <numeric>
#include <utility>
#include <vector>

#include "solvers/exact/exact_lcp.h"

namespace lcpbench {

/// FLINT's matrices of integers and of rationals, owned. Internal to solvers/exact/.
class IntegerMatrix {
 public:
  IntegerMatrix(Index rows, Index columns) { fmpz_mat_init(value_, rows, columns); }
  IntegerMatrix(const IntegerMatrix& other) { fmpz_mat_init_set(value_, other.value_); }
  IntegerMatrix(IntegerMatrix&& other) noexcept : IntegerMatrix(0, 0) { fmpz_mat_swap(value_, other.value_); }
  IntegerMatrix& operator=(IntegerMatrix other) {
    fmpz_mat_swap(value_, other.value_);
    return *this;
  }
  ~IntegerMatrix() { fmpz_mat_clear(value_); }

  Index rows() const { return fmpz_mat_nrows(value_); }
  Index columns() const { return fmpz_mat_ncols(value_); }
  fmpz* at(Index i, Index j) { return fmpz_mat_entry(value_, i, j); }
  const fmpz* at(Index i, Index j) const { return fmpz_mat_entry(value_, i, j); }
  fmpz_mat_struct* get() { return value_; }
  const fmpz_mat_struct* get() const { return value_; }

 private:
  fmpz_mat_t value_;
};

class RationalMatrix {
 public:
  RationalMatrix(Index rows, Index columns) { fmpq_mat_init(value_, rows, columns); }
  RationalMatrix(const RationalMatrix& other) : RationalMatrix(other.rows(), other.columns()) {
    fmpq_mat_set(value_, other.value_);
  }
  RationalMatrix(RationalMatrix&& other) noexcept : RationalMatrix(0, 0) { fmpq_mat_swap(value_, other.value_); }
  RationalMatrix& operator=(RationalMatrix other) {
    fmpq_mat_swap(value_, other.value_);
    return *this;
  }
  ~RationalMatrix() { fmpq_mat_clear(value_); }

  Index rows() const { return fmpq_mat_nrows(value_); }
  Index columns() const { return fmpq_mat_ncols(value_); }
  fmpq* at(Index i, Index j) { return fmpq_mat_entry(value_, i, j); }
  const fmpq* at(Index i, Index j) const { return fmpq_mat_entry(value_, i, j); }
  fmpq_mat_struct* get() { return value_; }
  const fmpq_mat_struct* get() const { return value_; }

 private:
  fmpq_mat_t value_;
};

/// One integer, owned.
class Integer {
 public:
  Integer() { fmpz_init(value_); }
  Integer(const Integer& other) { fmpz_init_set(value_, other.value_); }
  Integer& operator=(const Integer& other) {
    fmpz_set(value_, other.value_);
    return *this;
  }
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

/// numerator / denominator.
inline Rational ToRational(const fmpz* numerator, const fmpz* denominator) {
  fmpq_t quotient;
  fmpq_init(quotient);
  fmpq_set_fmpz_frac(quotient, numerator, denominator);
  Rational to = ToRational(quotient);
  fmpq_clear(quotient);
  return to;
}

/// 0 to n - 1.
inline std::vector<Index> AllRows(Index n) {
  std::vector<Index> rows(static_cast<std::size_t>(n));
  std::iota(rows.begin(), rows.end(), Index{0});
  return rows;
}

/// The rows and columns of A that are listed.
inline IntegerMatrix Block(const IntegerMatrix& A, const std::vector<Index>& rows, const std::vector<Index>& columns) {
  IntegerMatrix block(static_cast<Index>(rows.size()), static_cast<Index>(columns.size()));
  for (Index i = 0; i < block.rows(); ++i) {
    for (Index j = 0; j < block.columns(); ++j) {
      fmpz_set(block.at(i, j), A.at(rows[static_cast<size_t>(i)], columns[static_cast<size_t>(j)]));
    }
  }
  return block;
}

/// X = A^-1 B for a nonsingular A. Some word operations for small A, p-adic lifting [Dixon 1982] for larger ones.
inline RationalMatrix Solve(const IntegerMatrix& A, const IntegerMatrix& B) {
  RationalMatrix X(A.rows(), B.columns());
  if (A.rows() > 0 && B.columns() > 0) fmpq_mat_solve_fmpz_mat(X.get(), A.get(), B.get());
  return X;
}

}  // namespace lcpbench
