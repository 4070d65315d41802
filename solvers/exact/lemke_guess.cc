#include "solvers/exact/lemke_guess.h"

#include <algorithm>
#include <boost/multiprecision/mpfr.hpp>

namespace lcpbench {
namespace {

using Float = boost::multiprecision::number<
    boost::multiprecision::mpfr_float_backend<kGuessDigits, boost::multiprecision::allocate_stack>,
    boost::multiprecision::et_off>;

constexpr Index kMostPivotsPerRow = 20;

size_t At(Index i) { return static_cast<size_t>(i); }

Float ToFloat(const fmpz* integer) {
  mpz_t value;
  mpz_init(value);
  fmpz_get_mpz(value, integer);
  Float result;
  mpfr_set_z(result.backend().data(), value, MPFR_RNDN);
  mpz_clear(value);
  return result;
}

// Dictionary: basic = T nonbasic + q; the variable of column n is the artificial one.
class Dictionary {
 public:
  Dictionary(Index rows, Index columns)
      : rows_(rows), columns_(columns), values_(At(rows * (columns + 1))), basic_(At(rows)), nonbasic_(At(columns)) {}

  Float& at(Index i, Index j) { return values_[At(i * (columns_ + 1) + j)]; }
  Float& constant(Index i) { return at(i, columns_); }
  int& basic(Index i) { return basic_[At(i)]; }
  int& nonbasic(Index j) { return nonbasic_[At(j)]; }

  void Pivot(Index row, Index column) {
    const Float inverse = 1 / at(row, column);
    for (Index j = 0; j <= columns_; ++j) at(row, j) = j == column ? inverse : Float(-at(row, j) * inverse);
    for (Index i = 0; i < rows_; ++i) {
      if (i == row) continue;
      const Float factor = at(i, column);
      if (factor == 0) continue;
      for (Index j = 0; j <= columns_; ++j) {
        if (j == column) {
          at(i, j) = factor * at(row, j);
        } else {
          at(i, j) += factor * at(row, j);
        }
      }
    }
    std::swap(basic_[At(row)], nonbasic_[At(column)]);
  }

 private:
  Index rows_, columns_;
  std::vector<Float> values_;
  std::vector<int> basic_, nonbasic_;
};

}  // namespace

std::optional<LemkeGuess> GuessByLemke(const IntegerMatrix& A, const IntegerMatrix& b,
                                       const std::vector<char>& bilateral, const std::vector<Index>& bilateral_basis,
                                       const Deadline& deadline) {
  const Index size = A.rows();
  // Without their units: rows and columns by the root of the diagonal, b by its largest entry.
  std::vector<Index> rows;
  for (Index i = 0; i < size; ++i) {
    if (bilateral[At(i)] == 0 && fmpz_sgn(A.at(i, i)) > 0) rows.push_back(i);
  }
  const auto n = static_cast<Index>(rows.size());
  const auto joints = static_cast<Index>(bilateral_basis.size());
  rows.insert(rows.end(), bilateral_basis.begin(), bilateral_basis.end());
  const auto all = static_cast<Index>(rows.size());
  std::vector<Float> root(At(all));
  for (Index i = 0; i < all; ++i) root[At(i)] = sqrt(ToFloat(A.at(rows[At(i)], rows[At(i)])));

  // Joints out of the way: block elimination of the last rows.
  std::vector<Float> S(At(all * (all + 1)));
  const auto entry = [&](Index i, Index j) -> Float& { return S[At(i * (all + 1) + j)]; };
  Float largest = 0;
  for (Index i = 0; i < all; ++i) {
    for (Index j = 0; j < all; ++j) entry(i, j) = ToFloat(A.at(rows[At(i)], rows[At(j)])) / (root[At(i)] * root[At(j)]);
    entry(i, all) = ToFloat(b.at(rows[At(i)], 0)) / root[At(i)];
    largest = std::max(largest, Float(abs(entry(i, all))));
  }
  if (largest == 0) return LemkeGuess{std::vector<char>(At(size), 0), {}};
  std::vector<char> done(At(joints), 0);
  for (Index step = 0; step < joints; ++step) {
    Index k = -1;
    for (Index c = 0; c < joints; ++c) {
      if (done[At(c)] == 0 && (k < 0 || entry(n + c, n + c) > entry(n + k, n + k))) k = c;
    }
    done[At(k)] = 1;
    const Index p = n + k;
    if (!(entry(p, p) > 0) || deadline.Expired()) return std::nullopt;
    for (Index i = 0; i < all; ++i) {
      if (i == p || (i >= n && done[At(i - n)] != 0)) continue;
      const Float factor = entry(i, p) / entry(p, p);
      if (factor == 0) continue;
      for (Index j = 0; j <= all; ++j) entry(i, j) -= factor * entry(p, j);
    }
  }

  // Variables: w_i is i, f_i is n + i, the artificial one 2 n.
  const Float tiny = pow(Float(10), -2 * kGuessDigits / 3);
  Dictionary dictionary(n, n + 1);
  for (Index i = 0; i < n; ++i) {
    for (Index j = 0; j < n; ++j) dictionary.at(i, j) = entry(i, j);
    dictionary.at(i, n) = 1;
    dictionary.constant(i) = entry(i, all) / largest;
    dictionary.basic(i) = static_cast<int>(i);
  }
  for (Index j = 0; j <= n; ++j) dictionary.nonbasic(j) = static_cast<int>(n + j);
  Index row = -1;
  for (Index i = 0; i < n; ++i) {
    if (dictionary.constant(i) < 0 && (row < 0 || dictionary.constant(i) < dictionary.constant(row))) row = i;
  }
  LemkeGuess guess{std::vector<char>(At(size), 0), {}};
  if (row < 0) return guess;
  Index column = n;
  for (Index pivots = 0; pivots < kMostPivotsPerRow * (n + 1); ++pivots) {
    if (deadline.Expired()) return std::nullopt;
    const int left = dictionary.basic(row);
    dictionary.Pivot(row, column);
    if (left == 2 * n) {
      for (Index i = 0; i < n; ++i) {
        const int variable = dictionary.basic(i);
        if (variable >= n && variable < 2 * n) guess.active[At(rows[At(variable - n)])] = 1;
      }
      return guess;
    }
    // The complement of what has left comes in.
    const int entering = left < n ? left + static_cast<int>(n) : left - static_cast<int>(n);
    column = 0;
    while (dictionary.nonbasic(column) != entering) ++column;
    row = -1;
    for (Index i = 0; i < n; ++i) {
      const Float& slope = dictionary.at(i, column);
      if (!(slope < -tiny)) continue;
      if (row < 0) {
        row = i;
        continue;
      }
      const Float mine = dictionary.constant(i) * dictionary.at(row, column);
      const Float other = dictionary.constant(row) * slope;
      // Ratios q / -slope: the smaller one leaves, and of equal ones the artificial variable.
      const Float difference = other - mine;
      if (difference < 0 || (difference == 0 && dictionary.basic(i) == 2 * n)) row = i;
    }
    if (row < 0) {
      guess.support.assign(At(size), 0);
      if (entering >= n) guess.support[At(rows[At(entering - n)])] = 1;
      for (Index i = 0; i < n; ++i) {
        const int variable = dictionary.basic(i);
        if (variable < n || variable >= 2 * n) continue;
        if (dictionary.at(i, column) > tiny) guess.support[At(rows[At(variable - n)])] = 1;
      }
      for (const Index joint : bilateral_basis) guess.support[At(joint)] = 1;
      return guess;
    }
  }
  return std::nullopt;
}

}  // namespace lcpbench
