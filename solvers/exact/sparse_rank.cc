#include "solvers/exact/sparse_rank.h"

#include <flint/nmod_vec.h>
#include <flint/ulong_extras.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "solvers/exact/flint_matrix.h"

namespace lcpbench {
namespace {

// x = m 2^e with an integer m of 53 bits.
mp_limb_t Residue(double x, nmod_t mod) {
  constexpr int kDigitsOfPrime = 53;
  int exponent = 0;
  const double fraction = std::frexp(std::abs(x), &exponent);
  const auto m = static_cast<mp_limb_t>(std::ldexp(fraction, kDigitsOfPrime));
  exponent -= kDigitsOfPrime;
  mp_limb_t power = n_powmod2_preinv(2, std::abs(exponent), mod.n, mod.ninv);
  if (exponent < 0) power = n_invmod(power, mod.n);
  const mp_limb_t residue = nmod_mul(m % mod.n, power, mod);
  return x < 0 ? nmod_neg(residue, mod) : residue;
}

struct Term {
  int column;
  mp_limb_t value;
};
using Row = std::vector<Term>;  // by columns, ascending; no zeros

// a - factor b, both with the same first column, which cancels.
Row Eliminated(const Row& a, const Row& b, mp_limb_t factor, nmod_t mod) {
  Row sum;
  sum.reserve(a.size() + b.size());
  size_t i = 1;
  size_t j = 1;
  while (i < a.size() || j < b.size()) {
    const int column = std::min(i < a.size() ? a[i].column : b[j].column, j < b.size() ? b[j].column : a[i].column);
    mp_limb_t value = 0;
    if (i < a.size() && a[i].column == column) value = a[i++].value;
    if (j < b.size() && b[j].column == column) value = nmod_sub(value, nmod_mul(factor, b[j++].value, mod), mod);
    if (value != 0) sum.push_back({column, value});
  }
  return sum;
}

Index RankModulo(const SparseMatrix& matrix, mp_limb_t prime) {
  nmod_t mod;
  nmod_init(&mod, prime);
  // The row that begins with a column, its first entry 1.
  std::vector<Row> pivots(static_cast<size_t>(matrix.cols()));
  Index rank = 0;
  for (Index i = 0; i < matrix.rows(); ++i) {
    Row row;
    for (SparseMatrix::InnerIterator it(matrix, i); it; ++it) {
      const mp_limb_t value = it.value() == 0 ? 0 : Residue(it.value(), mod);
      if (value != 0) row.push_back({static_cast<int>(it.col()), value});
    }
    std::sort(row.begin(), row.end(), [](const Term& a, const Term& b) { return a.column < b.column; });
    while (!row.empty()) {
      Row& pivot = pivots[static_cast<size_t>(row.front().column)];
      if (pivot.empty()) {
        const mp_limb_t inverse = n_invmod(row.front().value, prime);
        for (Term& term : row) term.value = nmod_mul(term.value, inverse, mod);
        pivot = std::move(row);
        ++rank;
        break;
      }
      // The sparser one stays as pivot.
      if (row.size() < pivot.size()) {
        const mp_limb_t inverse = n_invmod(row.front().value, prime);
        for (Term& term : row) term.value = nmod_mul(term.value, inverse, mod);
        std::swap(row, pivot);
      }
      row = Eliminated(row, pivot, row.front().value, mod);
    }
  }
  return rank;
}

}  // namespace

Index SparseRank(const SparseMatrix& matrix) {
  Index rank = 0;
  for (const mp_limb_t prime : kPrimes) rank = std::max(rank, RankModulo(matrix, prime));
  return rank;
}

std::optional<Index> RankOf(const LcpProblem& problem, Index most_rows) {
  if (!problem.has_factors()) {
    if (problem.size() > most_rows) return std::nullopt;
    return SparseRank(problem.SparseA());
  }
  SparseMatrix movable = problem.J();
  movable.prune([&problem](Index, Index column, double) { return problem.inverse_mass()[column] > 0; });
  return SparseRank(movable);
}

}  // namespace lcpbench
