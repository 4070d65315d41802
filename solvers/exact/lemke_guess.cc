#include "solvers/exact/lemke_guess.h"

#include <Eigen/Core>
#include <algorithm>
#include <boost/multiprecision/eigen.hpp>
#include <boost/multiprecision/mpfr.hpp>
#include <numeric>

namespace lcpbench {
namespace {

using Float = boost::multiprecision::number<
    boost::multiprecision::mpfr_float_backend<kGuessDigits, boost::multiprecision::allocate_stack>,
    boost::multiprecision::et_off>;

constexpr Index kMostPivotsPerRow = 20;

Float ToFloat(const fmpz* integer) { return Float(ToInteger(integer)); }

using Matrix = Eigen::Matrix<Float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// basic = T nonbasic + q, q the last column; the variable of the column before it is the artificial one.
struct Dictionary {
  Matrix values;
  std::vector<int> basic, nonbasic;

  void Pivot(Index row, Index column) {
    const Float inverse = 1 / values(row, column);
    values.row(row) *= -inverse;
    values(row, column) = inverse;
    for (Index i = 0; i < values.rows(); ++i) {
      const Float factor = values(i, column);
      if (i == row || factor == 0) continue;
      values(i, column) = 0;
      values.row(i) += factor * values.row(row);
    }
    std::swap(basic[At(row)], nonbasic[At(column)]);
  }
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
  Matrix S(all, all + 1);
  Float largest = 0;
  for (Index i = 0; i < all; ++i) {
    for (Index j = 0; j < all; ++j) S(i, j) = ToFloat(A.at(rows[At(i)], rows[At(j)])) / (root[At(i)] * root[At(j)]);
    S(i, all) = ToFloat(b.at(rows[At(i)], 0)) / root[At(i)];
    largest = std::max(largest, Float(abs(S(i, all))));
  }
  if (largest == 0) return LemkeGuess{std::vector<char>(At(size), 0), {}};
  std::vector<char> done(At(joints), 0);
  for (Index step = 0; step < joints; ++step) {
    Index k = -1;
    for (Index c = 0; c < joints; ++c) {
      if (done[At(c)] == 0 && (k < 0 || S(n + c, n + c) > S(n + k, n + k))) k = c;
    }
    done[At(k)] = 1;
    const Index p = n + k;
    if (!(S(p, p) > 0) || deadline.Expired()) return std::nullopt;
    for (Index i = 0; i < all; ++i) {
      if (i == p || (i >= n && done[At(i - n)] != 0)) continue;
      const Float factor = S(i, p) / S(p, p);
      if (factor == 0) continue;
      S.row(i) -= factor * S.row(p);
    }
  }

  // Variables: w_i is i, f_i is n + i, the artificial one 2 n.
  const Float tiny = pow(Float(10), -2 * kGuessDigits / 3);
  Dictionary dictionary{Matrix(n, n + 2), std::vector<int>(At(n)), std::vector<int>(At(n + 1))};
  Matrix& T = dictionary.values;
  T.leftCols(n) = S.topLeftCorner(n, n);
  T.col(n).setOnes();
  const auto constant = [&T, n](Index i) -> const Float& { return T(i, n + 1); };
  for (Index i = 0; i < n; ++i) T(i, n + 1) = S(i, all) / largest;
  std::iota(dictionary.basic.begin(), dictionary.basic.end(), 0);
  std::iota(dictionary.nonbasic.begin(), dictionary.nonbasic.end(), static_cast<int>(n));
  Index row = -1;
  for (Index i = 0; i < n; ++i) {
    if (constant(i) < 0 && (row < 0 || constant(i) < constant(row))) row = i;
  }
  LemkeGuess guess{std::vector<char>(At(size), 0), {}};
  if (row < 0) return guess;
  Index column = n;
  for (Index pivots = 0; pivots < kMostPivotsPerRow * (n + 1); ++pivots) {
    if (deadline.Expired()) return std::nullopt;
    const int left = dictionary.basic[At(row)];
    dictionary.Pivot(row, column);
    if (left == 2 * n) {
      for (Index i = 0; i < n; ++i) {
        const int variable = dictionary.basic[At(i)];
        if (variable >= n && variable < 2 * n) guess.active[At(rows[At(variable - n)])] = 1;
      }
      return guess;
    }
    // The complement of what has left comes in.
    const int entering = left < n ? left + static_cast<int>(n) : left - static_cast<int>(n);
    column = 0;
    while (dictionary.nonbasic[At(column)] != entering) ++column;
    row = -1;
    for (Index i = 0; i < n; ++i) {
      const Float& slope = T(i, column);
      if (!(slope < -tiny)) continue;
      if (row < 0) {
        row = i;
        continue;
      }
      const Float mine = constant(i) * T(row, column);
      const Float other = constant(row) * slope;
      // Ratios q / -slope: the smaller one leaves, and of equal ones the artificial variable.
      const Float difference = other - mine;
      if (difference < 0 || (difference == 0 && dictionary.basic[At(i)] == 2 * n)) row = i;
    }
    if (row < 0) {
      guess.support.assign(At(size), 0);
      if (entering >= n) guess.support[At(rows[At(entering - n)])] = 1;
      for (Index i = 0; i < n; ++i) {
        const int variable = dictionary.basic[At(i)];
        if (variable < n || variable >= 2 * n) continue;
        if (T(i, column) > tiny) guess.support[At(rows[At(variable - n)])] = 1;
      }
      for (const Index joint : bilateral_basis) guess.support[At(joint)] = 1;
      return guess;
    }
  }
  return std::nullopt;
}

}  // namespace lcpbench
