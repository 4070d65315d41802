#include "solvers/exact/flint_matrix.h"

#include <flint/fmpz_poly.h>
#include <flint/nmod_vec.h>
#include <flint/ulong_extras.h>

namespace lcpbench {
namespace {

std::vector<Index> IndependentModulo(const IntegerMatrix& A, const std::vector<Index>& rows, mp_limb_t prime) {
  nmod_t mod;
  nmod_init(&mod, prime);
  const size_t n = rows.size();
  std::vector<mp_limb_t> reduced(n * n);
  for (size_t i = 0; i < n; ++i) {
    for (size_t j = 0; j < n; ++j) reduced[i * n + j] = fmpz_fdiv_ui(A.at(rows[i], rows[j]), prime);
  }
  std::vector<Index> independent;
  for (size_t k = 0; k < n; ++k) {
    const mp_limb_t pivot = reduced[k * n + k];
    if (pivot == 0) continue;
    independent.push_back(rows[k]);
    const mp_limb_t inverse = n_invmod(pivot, prime);
    for (size_t i = k + 1; i < n; ++i) {
      const mp_limb_t factor = nmod_mul(reduced[i * n + k], inverse, mod);
      if (factor == 0) continue;
      _nmod_vec_scalar_addmul_nmod(&reduced[i * n + k + 1], &reduced[k * n + k + 1], static_cast<slong>(n - k - 1),
                                   nmod_neg(factor, mod), mod);
    }
  }
  return independent;
}

}  // namespace

std::vector<Index> IndependentRows(const IntegerMatrix& A, const std::vector<Index>& rows) {
  std::vector<Index> best;
  for (const mp_limb_t prime : kPrimes) {
    std::vector<Index> found = IndependentModulo(A, rows, prime);
    if (found.size() > best.size()) best = std::move(found);
  }
  return best;
}

Rational SchurDiagonal(const IntegerMatrix& A, const std::vector<Index>& rows, const RationalMatrix& X, Index column,
                       Index k) {
  Rational sum = ToRational(A.at(k, k));
  for (Index r = 0; r < X.rows(); ++r) sum -= ToRational(X.at(r, column)) * ToRational(A.at(k, rows[At(r)]));
  return sum;
}

bool AllDepend(const IntegerMatrix& A, const std::vector<Index>& independent, const std::vector<Index>& others) {
  if (others.empty()) return true;
  const RationalMatrix X = Solve(Block(A, independent, independent), Block(A, independent, others));
  for (size_t q = 0; q < others.size(); ++q) {
    if (SchurDiagonal(A, independent, X, static_cast<Index>(q), others[q]) != 0) return false;
  }
  return true;
}

bool IsPositiveSemidefinite(const IntegerMatrix& A) {
  if (A.rows() == 0) return true;  // FLINT ends the process
  fmpz_poly_t polynomial;
  fmpz_poly_init(polynomial);
  fmpz_mat_charpoly(polynomial, A.get());
  bool holds = true;
  for (Index k = 0; k <= A.rows(); ++k) {
    const int sign = fmpz_sgn(polynomial->coeffs + k);
    holds = holds && ((A.rows() - k) % 2 == 0 ? sign >= 0 : sign <= 0);
  }
  fmpz_poly_clear(polynomial);
  return holds;
}

BigInteger CommonDenominator(const std::vector<Rational>& values) {
  BigInteger common = 1;
  for (const Rational& value : values) common = lcm(common, denominator(value));
  return common;
}

IntegerMatrix Scaled(const std::vector<Rational>& values, Index rows, const BigInteger& scale) {
  const Index columns = rows == 0 ? 1 : static_cast<Index>(values.size()) / rows;
  IntegerMatrix scaled(rows, columns);
  for (Index i = 0; i < rows; ++i) {
    for (Index j = 0; j < columns; ++j) {
      const Rational& value = values[At(i * columns + j)];
      const BigInteger integer = numerator(value) * (scale / denominator(value));
      fmpz_set_mpz(scaled.at(i, j), integer.backend().data());
    }
  }
  return scaled;
}

}  // namespace lcpbench
