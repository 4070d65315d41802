#include "solvers/exact/least_norm.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "solvers/exact/exact_pivoting.h"
#include "solvers/exact/flint_matrix.h"

namespace lcpbench {
namespace {

constexpr int kMostExchangesOfBasis = 60;
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

// A basis of null(A) in the columns of an integer matrix: -A_RR^-1 A_RQ on independent rows R, I on the others, each
// column times its denominator.
IntegerMatrix NullBasis(const IntegerMatrix& A) {
  const Index n = A.rows();
  const std::vector<Index> independent = IndependentRows(A, AllRows(n));
  const std::vector<Index> others = OtherRows(n, independent);
  const RationalMatrix X = Solve(Block(A, independent, independent), Block(A, independent, others));
  IntegerMatrix N(n, X.columns()), scaled(X.rows(), X.columns()), scale(1, X.columns());
  fmpq_mat_get_fmpz_mat_colwise(scaled.get(), scale.at(0, 0), X.get());
  for (Index j = 0; j < N.columns(); ++j) {
    for (Index i = 0; i < X.rows(); ++i) fmpz_neg(N.at(independent[At(i)], j), scaled.at(i, j));
    fmpz_set(N.at(others[At(j)], j), scale.at(0, j));
  }
  return N;
}

// N (N^T N)^-1 N^T; false where the columns of N are dependent.
bool MakeProjector(const IntegerMatrix& N, RationalMatrix* projector) {
  const Index k = N.columns();
  const IntegerMatrix transposed = Transposed(N), gram = Product(transposed, N);
  if (fmpz_mat_rank(gram.get()) < k) return false;
  RationalMatrix left(N.rows(), k);
  fmpq_mat_set_fmpz_mat(left.get(), N.get());
  const RationalMatrix right = Solve(gram, transposed);
  fmpq_mat_mul(projector->get(), left.get(), right.get());
  return true;
}

// f of w = A f + b, f, w >= 0, f w = 0; nothing without a solution, or where the deadline passes.
struct Pivoted {
  ExactPivoting::End end;
  std::vector<Rational> f;
};
Pivoted Pivot(const RationalMatrix& A, const RationalMatrix& b, const Deadline& deadline) {
  Integer A_unit, b_unit;  // f = (A_unit / b_unit) f'
  const IntegerMatrix A_integer = Numerators(A, &A_unit);
  const IntegerMatrix b_integer = Numerators(b, &b_unit);
  const std::vector<char> none(At(A.rows()), 0);
  ExactPivoting pivoting(A_integer, b_integer, none);
  Pivoted pivoted{pivoting.Run(none, deadline), {}};
  if (pivoted.end != ExactPivoting::End::kSolved) return pivoted;
  const Rational unit = ToRational(A_unit.get(), b_unit.get());
  for (Index i = 0; i < A.rows(); ++i) {
    pivoted.f.push_back(ToRational(pivoting.f().at(i, 0), pivoting.denominator().get()) * unit);
  }
  return pivoted;
}

}  // namespace

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

std::optional<LeastNorm> FindLeastNorm(const SolutionSet& set, std::vector<char> positive, const Deadline& deadline) {
  const Index n = set.A.rows();
  const std::vector<Index> all = AllRows(n);
  for (int exchange = 0; exchange < kMostExchangesOfBasis && !deadline.Expired(); ++exchange) {
    std::vector<Index> acting;
    for (Index i = 0; i < n; ++i) {
      if (set.bilateral[At(i)] != 0 || positive[At(i)] != 0) acting.push_back(i);
    }
    // f = G^T l on the acting rows, G their columns of A: G G^T l = -b, on independent rows of G.
    const IntegerMatrix G = Block(set.A, all, acting), gram = Product(G, Transposed(G));
    const std::vector<Index> rows = IndependentRows(gram, all);
    IntegerMatrix right = Block(set.b, rows, {0});
    fmpz_mat_neg(right.get(), right.get());
    Integer denominator;
    const IntegerMatrix l = Numerators(Solve(Block(gram, rows, rows), right), &denominator);
    const IntegerMatrix product = Product(Block(set.A, all, rows), l);  // A l, in units of 1 / denominator
    IntegerMatrix f(n, 1);
    for (const Index i : acting) fmpz_set(f.at(i, 0), product.at(i, 0));
    IntegerMatrix gap = Product(set.A, f);
    Index unmet = 0;  // rows that these acting ones cannot close
    for (Index i = 0; i < n; ++i) {
      fmpz_addmul(gap.at(i, 0), denominator.get(), set.b.at(i, 0));
      if (fmpz_is_zero(gap.at(i, 0)) == 0) ++unmet;
    }
    size_t violated = 0;
    for (Index i = 0; i < n; ++i) {
      if (set.bilateral[At(i)] != 0) continue;
      const bool wrong = fmpz_sgn(product.at(i, 0)) * (positive[At(i)] != 0 ? -1 : 1) > 0;
      if (!wrong) continue;
      ++violated;
      positive[At(i)] = positive[At(i)] != 0 ? 0 : 1;
    }
    if (violated == 0 && unmet == 0) {
      LeastNorm found{std::vector<Rational>(At(n)), std::vector<Rational>(At(n))};
      for (Index i = 0; i < n; ++i) found.f[At(i)] = ToRational(f.at(i, 0), denominator.get());
      for (size_t r = 0; r < rows.size(); ++r) {
        found.multipliers[At(rows[r])] = ToRational(l.at(static_cast<Index>(r), 0), denominator.get());
      }
      return found;
    }
    if (violated == 0) return std::nullopt;
  }
  return std::nullopt;
}

std::optional<LeastNorm> ProjectOnSet(const SolutionSet& set, const Deadline& deadline) {
  const Index n = set.A.rows();
  const IntegerMatrix N = NullBasis(set.A);
  RationalMatrix P(n, n);
  if (!MakeProjector(N, &P)) return std::nullopt;
  RationalMatrix f(n, 1), least(n, 1);
  for (Index i = 0; i < n; ++i) Assign(f.at(i, 0), set.f[At(i)]);
  fmpq_mat_mul(least.get(), P.get(), f.get());
  fmpq_mat_sub(least.get(), f.get(), least.get());

  const std::vector<Index> unilateral = OtherRows(n, Marked(set.bilateral));
  const auto m = static_cast<Index>(unilateral.size());
  RationalMatrix block(m, m), right(m, 1);
  for (Index i = 0; i < m; ++i) {
    for (Index j = 0; j < m; ++j) fmpq_set(block.at(i, j), P.at(unilateral[At(i)], unilateral[At(j)]));
    fmpq_set(right.at(i, 0), least.at(unilateral[At(i)], 0));
  }
  const Pivoted pivoted = Pivot(block, right, deadline);
  if (pivoted.end != ExactPivoting::End::kSolved) return std::nullopt;
  RationalMatrix s(n, 1), moved(n, 1);
  for (Index i = 0; i < m; ++i) Assign(s.at(unilateral[At(i)], 0), pivoted.f[At(i)]);
  fmpq_mat_mul(moved.get(), P.get(), s.get());
  fmpq_mat_add(least.get(), least.get(), moved.get());

  // A l = f - s, which is orthogonal to null(A).
  const std::vector<Index> rows = IndependentRows(set.A, AllRows(n));
  RationalMatrix pull(static_cast<Index>(rows.size()), 1);
  for (size_t r = 0; r < rows.size(); ++r) {
    fmpq_sub(pull.at(static_cast<Index>(r), 0), least.at(rows[r], 0), s.at(rows[r], 0));
  }
  Integer pull_unit;
  const IntegerMatrix pull_integer = Numerators(pull, &pull_unit);
  const RationalMatrix l = Solve(Block(set.A, rows, rows), pull_integer);
  LeastNorm found{std::vector<Rational>(At(n)), std::vector<Rational>(At(n))};
  for (Index i = 0; i < n; ++i) found.f[At(i)] = ToRational(least.at(i, 0));
  for (size_t r = 0; r < rows.size(); ++r) {
    found.multipliers[At(rows[r])] = ToRational(l.at(static_cast<Index>(r), 0)) / ToRational(pull_unit.get());
  }
  return found;
}

std::optional<bool> IsOnlySolution(const SolutionSet& set, const std::vector<Rational>& f_least,
                                   const Deadline& deadline) {
  const IntegerMatrix N = NullBasis(set.A);
  const Index k = N.columns();
  if (k == 0) return true;
  std::vector<Index> zero;
  for (Index i = 0; i < set.A.rows(); ++i) {
    if (set.bilateral[At(i)] == 0 && f_least[At(i)] == 0) zero.push_back(i);
  }
  const auto m = static_cast<Index>(zero.size());
  if (m < k) return false;
  RationalMatrix projector(m, m);
  if (!MakeProjector(Block(N, zero, AllRows(k)), &projector)) return false;
  RationalMatrix Q(m, m);
  fmpq_mat_one(Q.get());
  fmpq_mat_sub(Q.get(), Q.get(), projector.get());
  RationalMatrix minus_one(m, 1);
  for (Index i = 0; i < m; ++i) fmpq_set_si(minus_one.at(i, 0), -1, 1);
  const ExactPivoting::End end = Pivot(Q, minus_one, deadline).end;
  if (end == ExactPivoting::End::kTimeLimit) return std::nullopt;
  return end == ExactPivoting::End::kSolved;
}

}  // namespace lcpbench
