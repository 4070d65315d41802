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
  std::vector<Row> pivots(At(matrix.cols()));
  Index rank = 0;
  for (Index i = 0; i < matrix.rows(); ++i) {
    Row row;
    for (SparseMatrix::InnerIterator it(matrix, i); it; ++it) {
      const mp_limb_t value = it.value() == 0 ? 0 : Residue(it.value(), mod);
      if (value != 0) row.push_back({static_cast<int>(it.col()), value});
    }
    std::sort(row.begin(), row.end(), [](const Term& a, const Term& b) { return a.column < b.column; });
    while (!row.empty()) {
      Row& pivot = pivots[At(row.front().column)];
      // The sparser one stays as pivot.
      if (pivot.empty() || row.size() < pivot.size()) {
        const mp_limb_t inverse = n_invmod(row.front().value, prime);
        for (Term& term : row) term.value = nmod_mul(term.value, inverse, mod);
        std::swap(row, pivot);
        if (row.empty()) ++rank;
      }
      if (!row.empty()) row = Eliminated(row, pivot, row.front().value, mod);
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

Index RankOfRows(const LcpProblem& problem, const std::vector<Index>& rows) {
  const SparseMatrix& given = problem.has_factors() ? problem.J() : problem.SparseA();
  std::vector<Index> place(At(given.cols()), -1);
  if (problem.has_factors()) {
    for (Index k = 0; k < given.cols(); ++k) {
      if (problem.inverse_mass()[k] > 0) place[At(k)] = k;
    }
  } else {
    for (size_t k = 0; k < rows.size(); ++k) place[At(rows[k])] = static_cast<Index>(k);
  }
  std::vector<Eigen::Triplet<double, int>> entries;
  for (size_t k = 0; k < rows.size(); ++k) {
    for (SparseMatrix::InnerIterator it(given, rows[k]); it; ++it) {
      const Index column = place[At(it.col())];
      if (column >= 0) entries.emplace_back(static_cast<int>(k), static_cast<int>(column), it.value());
    }
  }
  SparseMatrix part(static_cast<Index>(rows.size()),
                    problem.has_factors() ? given.cols() : static_cast<Index>(rows.size()));
  part.setFromTriplets(entries.begin(), entries.end());
  return SparseRank(part);
}

std::optional<Index> RankOf(const LcpProblem& problem, Index most_rows) {
  if (!problem.has_factors() && problem.size() > most_rows) return std::nullopt;
  return RankOfRows(problem, AllRows(problem.size()));
}

}  // namespace lcpbench
