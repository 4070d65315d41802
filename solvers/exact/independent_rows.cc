#include "solvers/exact/independent_rows.h"

#include <flint/nmod_vec.h>
#include <flint/ulong_extras.h>

#include <cstdint>

#include "solvers/exact/primes.h"

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

bool AllDepend(const IntegerMatrix& A, const std::vector<Index>& independent, const std::vector<Index>& others) {
  if (others.empty()) return true;
  const RationalMatrix X = Solve(Block(A, independent, independent), Block(A, independent, others));
  fmpq_t sum, term;
  fmpq_init(sum);
  fmpq_init(term);
  bool all = true;
  for (size_t q = 0; q < others.size() && all; ++q) {
    fmpq_set_fmpz(sum, A.at(others[q], others[q]));
    for (size_t r = 0; r < independent.size(); ++r) {
      fmpq_mul_fmpz(term, X.at(static_cast<Index>(r), static_cast<Index>(q)), A.at(others[q], independent[r]));
      fmpq_sub(sum, sum, term);
    }
    all = fmpq_is_zero(sum) != 0;
  }
  fmpq_clear(sum);
  fmpq_clear(term);
  return all;
}

bool IsPositiveSemidefinite(const IntegerMatrix& A) {
  const Index n = A.rows();
  IntegerMatrix rest(A);
  std::vector<char> done(static_cast<size_t>(n), 0);
  const auto left = [&done](Index i) { return done[static_cast<size_t>(i)] == 0; };
  Integer previous, product;
  fmpz_one(previous.get());
  for (;;) {
    Index k = n;
    for (Index i = 0; i < n && k == n; ++i) {
      if (!left(i)) continue;
      if (fmpz_sgn(rest.at(i, i)) < 0) return false;
      if (fmpz_sgn(rest.at(i, i)) > 0) k = i;
    }
    if (k == n) break;
    done[static_cast<size_t>(k)] = 1;
    for (Index i = 0; i < n; ++i) {
      for (Index j = 0; j < n && left(i); ++j) {
        if (!left(j)) continue;
        fmpz_mul(product.get(), rest.at(i, k), rest.at(k, j));
        fmpz_mul(rest.at(i, j), rest.at(i, j), rest.at(k, k));
        fmpz_sub(rest.at(i, j), rest.at(i, j), product.get());
        fmpz_divexact(rest.at(i, j), rest.at(i, j), previous.get());
      }
    }
    fmpz_set(previous.get(), rest.at(k, k));
  }
  // What is left has a zero diagonal, and must be zero.
  for (Index i = 0; i < n; ++i) {
    for (Index j = 0; j < n; ++j) {
      if (left(i) && left(j) && fmpz_is_zero(rest.at(i, j)) == 0) return false;
    }
  }
  return true;
}

}  // namespace lcpbench
