#include "solvers/exact/least_norm.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "solvers/exact/exact_pivoting.h"
#include "solvers/exact/flint_matrix.h"

namespace lcpbench {
namespace {

constexpr double kNull = 1e-11;      // eigenvalues below this part of the largest
constexpr int kGuessSweeps = 20000;  // of the guess; some ms for some tens of rows
constexpr double kGuessDone = 1e-15;

// A in doubles, each row and column divided by a power of two so that the diagonal is near 1, and f by the same.
Eigen::MatrixXd ToDoubles(const IntegerMatrix& A) {
  Eigen::MatrixXd result(A.rows(), A.columns());
  slong exponent = 0;
  for (Index i = 0; i < A.rows(); ++i) exponent = std::max(exponent, static_cast<slong>(fmpz_bits(A.at(i, i))));
  for (Index i = 0; i < A.rows(); ++i) {
    for (Index j = 0; j < A.columns(); ++j) {
      slong own = 0;
      const double mantissa = fmpz_get_d_2exp(&own, A.at(i, j));
      result(i, j) = std::ldexp(mantissa, static_cast<int>(own - exponent));
    }
  }
  return result;
}

// A guess at the unilateral rows with f > 0, in doubles, by proximal projection on the set.
std::vector<char> GuessPositive(const SolutionSet& set) {
  const Index n = set.A.rows();
  Eigen::VectorXd f(n);
  double largest = 0;
  for (Index i = 0; i < n; ++i) {
    f[i] = set.f[At(i)].convert_to<double>();
    largest = std::max(largest, std::abs(f[i]));
  }
  std::vector<char> positive(At(n), 0);
  if (!(largest > 0) || !std::isfinite(largest)) return positive;
  f /= largest;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(ToDoubles(set.A));
  const double least = kNull * eigen.eigenvalues()[n - 1];
  Index nullity = 0;
  while (nullity < n && eigen.eigenvalues()[nullity] <= least) ++nullity;
  // min |f + N z|^2 with f + N z >= 0: sweeps over the multipliers s of w = P s + (f - P f), P = N N^T.
  const Eigen::MatrixXd P = eigen.eigenvectors().leftCols(nullity) * eigen.eigenvectors().leftCols(nullity).transpose();
  Eigen::VectorXd w = f - P * f;
  Eigen::VectorXd s = Eigen::VectorXd::Zero(n);
  for (int sweep = 0; sweep < kGuessSweeps && nullity > 0; ++sweep) {
    double moved = 0;
    for (Index i = 0; i < n; ++i) {
      if (set.bilateral[At(i)] != 0 || P(i, i) <= kNull) continue;
      const double next = std::max(0.0, s[i] - w[i] / P(i, i));
      const double change = next - s[i];
      if (change == 0) continue;
      s[i] = next;
      w += change * P.col(i);
      moved = std::max(moved, std::abs(change));
    }
    if (moved <= kGuessDone) break;
  }
  for (Index i = 0; i < n; ++i) positive[At(i)] = w[i] > s[i] ? 1 : 0;
  return positive;
}

}  // namespace

std::optional<LeastNorm> FindLeastNorm(const SolutionSet& set, const Deadline& deadline) {
  const std::vector<Index> unilateral = OtherRows(set.A.rows(), Marked(set.bilateral));
  const auto n = set.A.rows(), joints = static_cast<Index>(set.independent.size());
  const auto rows = joints + static_cast<Index>(unilateral.size());
  IntegerMatrix J(rows, n), b(rows, 1);
  std::vector<char> is_joint(At(rows), 0), start(At(rows), 0);
  for (Index i = 0; i < joints; ++i) {
    const Index row = set.independent[At(i)];
    for (Index j = 0; j < n; ++j) fmpz_set(J.at(i, j), set.A.at(row, j));
    fmpz_set(b.at(i, 0), set.b.at(row, 0));
    is_joint[At(i)] = 1;
  }
  const std::vector<char> positive = GuessPositive(set);
  for (Index i = joints; i < rows; ++i) {
    const Index row = unilateral[At(i - joints)];
    fmpz_one(J.at(i, row));
    start[At(i)] = positive[At(row)] == 0 ? 1 : 0;
  }
  const IntegerMatrix transposed = Transposed(J), G = Product(J, transposed);
  ExactPivoting pivoting(G, b, is_joint);
  if (pivoting.Pivot(start, deadline) != ExactPivoting::End::kSolved) return std::nullopt;
  const IntegerMatrix f = Product(transposed, pivoting.f());
  const fmpz* const denominator = pivoting.denominator().get();
  LeastNorm found{{}, std::vector<Rational>(At(n))};
  for (Index i = 0; i < n; ++i) found.f.push_back(ToRational(f.at(i, 0), denominator));
  for (Index i = 0; i < joints; ++i) {
    found.multipliers[At(set.independent[At(i)])] = ToRational(pivoting.f().at(i, 0), denominator);
  }
  return found;
}

std::optional<bool> IsOnlySolution(const SolutionSet& set, const std::vector<Rational>& f_least,
                                   const Deadline& deadline) {
  const Index n = set.A.rows();
  std::vector<char> is_free = set.bilateral;
  for (Index i = 0; i < n; ++i) is_free[At(i)] = is_free[At(i)] != 0 || f_least[At(i)] != 0 ? 1 : 0;
  const std::vector<Index> all = AllRows(n), free = Marked(is_free);
  if (fmpz_mat_rank(Block(set.A, all, free).get()) < static_cast<Index>(free.size())) return false;
  IntegerMatrix M = Product(set.A, set.A), minus_e(n, 1);
  const std::vector<Index> zero = OtherRows(n, free);
  for (const Index i : zero) {
    fmpz_set_si(minus_e.at(i, 0), -1);
    for (const Index j : zero) fmpz_add_ui(M.at(i, j), M.at(i, j), 1);
  }
  ExactPivoting pivoting(M, minus_e, is_free);
  if (pivoting.Pivot(std::vector<char>(At(n), 0), deadline) != ExactPivoting::End::kSolved) return std::nullopt;
  Integer sum;
  for (const Index i : zero) fmpz_add(sum.get(), sum.get(), pivoting.f().at(i, 0));
  return fmpz_equal(sum.get(), pivoting.denominator().get()) == 0;
}

}  // namespace lcpbench
