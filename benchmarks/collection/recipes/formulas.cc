#include "benchmarks/collection/recipes/formulas.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "model/geometry/vec2.h"
#include "model/scenes/random.h"
#include "support/input_error.h"
#include "support/number_text.h"

namespace lcpbench {
namespace {

using Entry = Eigen::Triplet<double, int>;

// Symmetric positive definite.
constexpr MatrixFacts kDefinite{.symmetric = true, .positive_semidefinite = true, .rank = {}, .f_unique = true};
// All principal minors are positive, and f is unique for every b [Samelson, Thrall, Wesler 1958].
constexpr MatrixFacts kPMatrix{.symmetric = false, .positive_semidefinite = false, .rank = {}, .f_unique = true};

MatrixFacts OfRank(MatrixFacts facts, Index rank) {
  facts.rank = rank;
  return facts;
}

LcpProblem Sparse(const std::vector<Entry>& entries, Eigen::VectorXd b, const MatrixFacts& facts,
                  RowBounds bounds = {}) {
  const Index n = b.size();
  SparseMatrix A(n, n);
  A.setFromTriplets(entries.begin(), entries.end());
  return LcpProblem::FromSparse("", A, std::move(b), std::move(bounds), OfRank(facts, n));
}

LcpProblem Dense(Eigen::MatrixXd A, Eigen::VectorXd b, const MatrixFacts& facts) {
  const Index n = b.size();
  return LcpProblem::FromDense("", std::move(A), std::move(b), {}, OfRank(facts, n));
}

// The rows of a formula on a square grid; SideOf checks that they are a square.
constexpr std::pair kSquare{0, std::numeric_limits<int>::max()};
int SideOf(int rows) {
  const int side = static_cast<int>(std::lround(std::sqrt(rows)));
  if (side < 2 || side * side != rows) {
    throw InputError("expected the square of a number >= 2 as rows, found " + std::to_string(rows));
  }
  return side;
}

// A x, sums from left to right: the library's product may have another order, and other roundings.
Eigen::VectorXd Product(const std::vector<Entry>& entries, const Eigen::VectorXd& x) {
  SparseMatrix A(x.size(), x.size());
  A.setFromTriplets(entries.begin(), entries.end());
  Eigen::VectorXd product = Eigen::VectorXd::Zero(x.size());
  for (Index i = 0; i < x.size(); ++i) {
    for (SparseMatrix::InnerIterator it(A, i); it; ++it) product[i] += it.value() * x[it.col()];
  }
  return product;
}

// ----- discretized variational inequalities

// Entries of a five-point stencil on side x side points; `diagonal`, `down` (from (i, j) to (i + 1, j)) and `right` (to
// (i, j + 1)) are functions of i and j, the neighbours' entries symmetric.
std::vector<Entry> Stencil(int side, const auto& diagonal, const auto& down, const auto& right) {
  std::vector<Entry> entries;
  entries.reserve(static_cast<size_t>(side) * static_cast<size_t>(side) * 5);
  const auto couple = [&entries](int row, int column, double value) {
    entries.emplace_back(row, column, value);
    entries.emplace_back(column, row, value);
  };
  for (int i = 0; i < side; ++i) {
    for (int j = 0; j < side; ++j) {
      const int row = i * side + j;
      entries.emplace_back(row, row, diagonal(i, j));
      if (i + 1 < side) couple(row, row + side, down(i, j));
      if (j + 1 < side) couple(row, row + 1, right(i, j));
    }
  }
  return entries;
}

// A membrane over an obstacle, problem A:  min sum over inner points of 1/4 (differences to the four neighbours)^2 - c
// h^2 u,  u >= psi = sin(3.2 x) sin(3.3 y) on (0, 1)^2, u = 0 on the boundary. The formulation's upper bound, 2000, is
// never met: u stays below 2. Edges to the boundary belong to one inner point only: half of a unit in A_ii.
FormulaProblem Obstacle(int rows, double load, std::uint64_t /*seed*/) {
  const int side = SideOf(rows);
  const double h = 1.0 / (side + 1);
  const auto at_edge = [side](int k) { return (k == 0 ? 1 : 0) + (k == side - 1 ? 1 : 0); };
  const auto unit = [](int, int) { return -1.0; };
  std::vector<Entry> entries = Stencil(
      side, [&](int i, int j) { return 4 - 0.5 * (at_edge(i) + at_edge(j)); }, unit, unit);
  Eigen::VectorXd sine_x(side);
  Eigen::VectorXd sine_y(side);
  for (int k = 0; k < side; ++k) {
    sine_x[k] = SinCos(3.2 * ((k + 1) * h)).sin;
    sine_y[k] = SinCos(3.3 * ((k + 1) * h)).sin;
  }
  Eigen::VectorXd psi(rows);
  for (int i = 0; i < side; ++i) {
    for (int j = 0; j < side; ++j) psi[i * side + j] = sine_x[i] * sine_y[j];
  }
  // f = u - psi.
  Eigen::VectorXd b = Product(entries, psi);
  b.array() -= load * (h * h);
  return {Sparse(entries, std::move(b), kDefinite)};
}

// Torsion of an elastic-plastic bar:  min 1/2 |grad v|^2 - c v on (0, 1)^2,  |v| <= d, the distance to the boundary.
// With c > 0 the solution is positive, so v >= -d holds by itself. f = d - v, lengths in units of h: A d is integer.
FormulaProblem Torsion(int rows, double angle, std::uint64_t /*seed*/) {
  const int side = SideOf(rows);
  const double h = 1.0 / (side + 1);
  const auto unit = [](int, int) { return -1.0; };
  std::vector<Entry> entries = Stencil(
      side, [](int, int) { return 4.0; }, unit, unit);
  Eigen::VectorXd distance(rows);
  for (int i = 0; i < side; ++i) {
    for (int j = 0; j < side; ++j) distance[i * side + j] = 1 + std::min({i, side - 1 - i, j, side - 1 - j});
  }
  return {Sparse(entries, Eigen::VectorXd::Constant(rows, angle * h) - Product(entries, distance), kDefinite)};
}

// The pressure in a journal bearing of eccentricity e:  min 1/2 w |grad v|^2 - e sin(t) v on (0, 2 pi) x (0, 20), w =
// (1 + e cos t)^3,  v >= 0, by linear elements on triangles, w the mean over the corners of each.
FormulaProblem JournalBearing(int rows, double eccentricity, std::uint64_t /*seed*/) {
  const int side = SideOf(rows);
  constexpr double kAround = 6.283185307179586;
  constexpr double kAlong = 20;
  const double ht = kAround / (side + 1);
  const double hy = kAlong / (side + 1);
  Eigen::VectorXd w(side + 2);  // at points of the boundary, too
  Eigen::VectorXd sine(side + 2);
  for (int k = 0; k < w.size(); ++k) {
    const Rotation angle = SinCos(k * ht);
    const double film = 1 + eccentricity * angle.cos;
    w[k] = film * film * film;
    sine[k] = angle.sin;
  }
  const auto across = [&](int k) { return (w[k] + w[k + 1]) / 2 * (hy / ht); };  // from t_k to t_k+1
  const auto along = [&](int k) { return (4 * w[k] + w[k - 1] + w[k + 1]) / 6 * (ht / hy); };
  std::vector<Entry> entries = Stencil(
      side, [&](int i, int) { return across(i) + across(i + 1) + 2 * along(i + 1); },
      [&](int i, int) { return -across(i + 1); }, [&](int i, int) { return -along(i + 1); });
  Eigen::VectorXd b(rows);
  for (int row = 0; row < rows; ++row) b[row] = -(eccentricity * (ht * hy)) * sine[row / side + 1];
  return {Sparse(entries, std::move(b), kDefinite)};
}

// The block tridiagonal matrix with S = tridiag(-1 - skew, 4 + shift, -1 + skew) and -(1 + skew) I, -(1 - skew) I
// beside it, an M-matrix. f = (0, 1, 0, 1, ...), w = (1, 0, 1, 0, ...).
template <bool is_skew>
FormulaProblem BlockTridiagonal(int rows, double shift, std::uint64_t /*seed*/) {
  constexpr double skew = is_skew ? 0.5 : 0;
  const int side = SideOf(rows);
  std::vector<Entry> entries;
  for (int i = 0; i < side; ++i) {
    for (int j = 0; j < side; ++j) {
      const int row = i * side + j;
      const auto add = [&](bool inside, int column, double value) {
        if (inside) entries.emplace_back(row, column, value);
      };
      add(true, row, 4 + shift);
      add(j > 0, row - 1, -1 - skew);
      add(j + 1 < side, row + 1, -1 + skew);
      add(i > 0, row - side, -1 - skew);
      add(i + 1 < side, row + side, -1 + skew);
    }
  }
  Eigen::VectorXd f(rows);
  for (int row = 0; row < rows; ++row) f[row] = row % 2;
  const Eigen::VectorXd b = Eigen::VectorXd::Ones(rows) - f - Product(entries, f);
  return {Sparse(entries, b, is_skew ? kPMatrix : kDefinite), f};
}

// ----- bound constrained quadratic programs in one dimension

// min (x_1 - 1)^2 + (1 - x_n)^2 + sum (x_i+1 - x_i)^2,  0 <= x_i <= 0.9 for i < n. No x is near 0 at the solution,
// where all reach 0.9 but x_n = 0.95, which is free: f = 0.9 - x, row n bilateral. The objective is 0.015. w = f = 0 on
// all rows but three: nothing is strictly complementary.
FormulaProblem Biggsb1(int rows, double /*parameter*/, std::uint64_t /*seed*/) {
  std::vector<Entry> entries;
  for (int i = 0; i < rows; ++i) {
    entries.emplace_back(i, i, 4);
    if (i > 0) entries.emplace_back(i, i - 1, -2);
    if (i + 1 < rows) entries.emplace_back(i, i + 1, -2);
  }
  Eigen::VectorXd b = Eigen::VectorXd::Zero(rows);
  b[0] = b[rows - 1] = 2 * (1 - 0.9);
  Eigen::VectorXd f = Eigen::VectorXd::Zero(rows);
  f[rows - 1] = -b[rows - 1] / 4;
  return {Sparse(entries, std::move(b), kDefinite, RowBounds::WithBilateralRows(rows, {rows - 1})), std::move(f)};
}

// The biharmonic stencil 1 -4 6 -4 1, whose condition grows as n^4. f = 1 on the first half, w = 0 on it and on the
// next fifth, else 1.
FormulaProblem ChenHarker(int rows, double /*parameter*/, std::uint64_t /*seed*/) {
  constexpr std::array kStencil{1.0, -4.0, 6.0, -4.0, 1.0};
  std::vector<Entry> entries;
  for (int i = 0; i < rows; ++i) {
    for (int k = 0; k < 5; ++k) {
      const int column = i + k - 2;
      if (column >= 0 && column < rows) entries.emplace_back(i, column, kStencil[static_cast<size_t>(k)]);
    }
  }
  const int free = rows / 2;
  const int degenerate = rows / 5;
  Eigen::VectorXd f = Eigen::VectorXd::Zero(rows);
  f.head(free).setOnes();
  Eigen::VectorXd w = Eigen::VectorXd::Zero(rows);
  w.tail(rows - free - degenerate).setOnes();
  return {Sparse(entries, w - Product(entries, f), kDefinite), std::move(f)};
}

// ----- dense matrices

// 1 on the diagonal and `below` under it.
Eigen::MatrixXd LowerTriangle(int rows, double below) {
  Eigen::MatrixXd L = Eigen::MatrixXd::Identity(rows, rows);
  for (int j = 0; j < rows; ++j) L.col(j).tail(rows - j - 1).setConstant(below);
  return L;
}

Eigen::VectorXd FirstUnit(int rows) { return Eigen::VectorXd::Unit(rows, 0); }

// The answer of a lower triangular matrix with a unit diagonal, row after row; exact while its integers are.
Eigen::VectorXd Substitute(const Eigen::MatrixXd& L, const Eigen::VectorXd& b) {
  Eigen::VectorXd f = Eigen::VectorXd::Zero(b.size());
  for (Index i = 0; i < b.size(); ++i) f[i] = std::max(0.0, -(b[i] + L.row(i).head(i).dot(f.head(i))));
  return f;
}

// L, 2 below the diagonal: Murty's principal pivoting takes 2^n - 1 steps from b = -(1, ..., 1).
FormulaProblem Murty(int rows, double /*parameter*/, std::uint64_t /*seed*/) {
  return {Dense(LowerTriangle(rows, 2), -Eigen::VectorXd::Ones(rows), kPMatrix), FirstUnit(rows)};
}

// The same L with b_i = -(2^(n+1) - 2^i): Lemke's method takes 2^n pivots with the covering vector of ones.
FormulaProblem MurtyLemke(int rows, double /*parameter*/, std::uint64_t /*seed*/) {
  Eigen::VectorXd b(rows);
  for (int i = 0; i < rows; ++i) b[i] = std::ldexp(1, i + 1) - std::ldexp(1, rows + 1);
  const Eigen::MatrixXd L = LowerTriangle(rows, 2);
  Eigen::VectorXd f = Substitute(L, b);
  return {Dense(L, std::move(b), kPMatrix), std::move(f)};
}

// L L^T of Murty's L: symmetric positive definite, and both methods still take exponentially many steps.
FormulaProblem Fathi(int rows, double /*parameter*/, std::uint64_t /*seed*/) {
  Eigen::MatrixXd A(rows, rows);
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < rows; ++j) A(i, j) = 4 * std::min(i, j) + (i == j ? 1 : 2);
  }
  return {Dense(std::move(A), -Eigen::VectorXd::Ones(rows), kDefinite), FirstUnit(rows)};
}

// -1 below the diagonal: an M-matrix whose handicap grows as 4^n, which interior-point methods pay for. b alternates.
FormulaProblem Csizmadia(int rows, double /*parameter*/, std::uint64_t /*seed*/) {
  Eigen::VectorXd b(rows);
  for (int i = 0; i < rows; ++i) b[i] = i % 3 == 2 ? std::ldexp(1, i) : -1;
  const Eigen::MatrixXd L = LowerTriangle(rows, -1);
  Eigen::VectorXd f = Substitute(L, b);
  return {Dense(L, std::move(b), kPMatrix), std::move(f)};
}

// Hilbert's matrix 1 / (i + j - 1), in units that make it integer: times the least common multiple of 1 ... 2 n - 1,
// below 2^53 for 20 rows.
FormulaProblem Hilbert(int rows, double /*parameter*/, std::uint64_t /*seed*/) {
  std::int64_t multiple = 1;
  for (std::int64_t k = 2; k < std::int64_t{2} * rows; ++k) {
    std::int64_t a = multiple;
    std::int64_t divisor = k;
    while (a != 0) divisor = std::exchange(a, divisor % a);
    multiple *= k / divisor;
  }
  Eigen::MatrixXd A(rows, rows);
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < rows; ++j) {
      const std::int64_t entry = multiple / (i + j + 1);  // without a remainder
      A(i, j) = static_cast<double>(entry);
    }
  }
  return {Dense(std::move(A), -Eigen::VectorXd::Ones(rows), kDefinite)};
}

// M^T M + B + D with entries of M in (-5, 5), B skew and D in (0, 0.3), b in (-500, 0): in integers, D in 64ths.
template <bool is_skew>
FormulaProblem RandomDefinite(int rows, double /*parameter*/, std::uint64_t seed) {
  constexpr int kMost = 5;
  Random random(seed);
  Eigen::MatrixXd M(rows, rows);
  for (Index k = 0; k < M.size(); ++k) M.data()[k] = random.Integer(-kMost, kMost);
  Eigen::MatrixXd A = M.transpose() * M;  // sums of integers: exact in any order
  for (int i = 0; i < rows; ++i) A(i, i) += random.Integer(1, 19) / 64.0;
  for (int i = 0; is_skew && i < rows; ++i) {
    for (int j = 0; j < i; ++j) {
      const int value = random.Integer(-kMost, kMost);
      A(i, j) += value;
      A(j, i) -= value;
    }
  }
  Eigen::VectorXd b(rows);
  for (double& value : b) value = -random.Integer(1, 499);
  return {Dense(std::move(A), std::move(b), is_skew ? kPMatrix : kDefinite)};
}

// ----- neither semidefinite nor with one answer

// 1 on the diagonal and 2 beside it: symmetric, indefinite and strictly copositive, so that Lemke's method ends with an
// answer, one of 2^n - 1: f = 1 / (2 k - 1) on any k rows.
FormulaProblem Clique(int rows, double /*parameter*/, std::uint64_t /*seed*/) {
  Eigen::MatrixXd A = Eigen::MatrixXd::Constant(rows, rows, 2);
  A.diagonal().setOnes();
  const MatrixFacts symmetric{.symmetric = true, .positive_semidefinite = false, .rank = {}, .f_unique = false};
  return {Dense(std::move(A), -Eigen::VectorXd::Ones(rows), symmetric), FirstUnit(rows)};
}

// The knapsack  a.x = s, x_i in {0, 1},  of k = n - 2 weights as an LCP: f_i is 0 or a_i. NP-complete in general. With
// `solvable` 0 all weights are even and s is odd: there is no answer.
FormulaProblem Knapsack(int rows, double solvable, std::uint64_t seed) {
  if (solvable != 0 && solvable != 1) throw InputError("expected solvable 0 or 1, found " + NumberText(solvable));
  const int k = rows - 2;
  Random random(seed);
  Eigen::VectorXd f = Eigen::VectorXd::Zero(rows);
  Eigen::VectorXd b(rows);
  double sum = 0;
  for (int i = 0; i < k; ++i) {
    b[i] = 2 * random.Integer(1, 500);
    if (random.Integer(2) == 1) f[i] = b[i];
    sum += f[i];
  }
  if (solvable == 0) sum += 1;
  b[k] = -sum;
  b[k + 1] = sum;
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(rows, rows);
  A.diagonal().head(k).setConstant(-1);
  A.diagonal().tail(2).setConstant(-k);
  A.row(k).head(k).setOnes();
  A.row(k + 1).head(k).setConstant(-1);
  FormulaProblem made{Dense(std::move(A), std::move(b), {})};
  if (solvable == 1) made.f = std::move(f);
  return made;
}

constexpr std::array kFormulas{
    Formula{"obstacle", "Dembo, Tulowitzki, WP 71, Yale University, 1983, problem A; CUTE OBSTCLAE", &Obstacle, kSquare,
            "load", 1, -1e3, 1e3},
    Formula{"torsion", "More, Toraldo, SIAM J. Optim. 1 (1991) 93-113; MINPACK-2 DEPT; CUTE TORSION1-6", &Torsion,
            kSquare, "angle", 5, 1e-3, 1e3},
    Formula{"journal-bearing", "More, Toraldo, SIAM J. Optim. 1 (1991) 93-113; MINPACK-2 DPJB; CUTE JNLBRNG1-2",
            &JournalBearing, kSquare, "eccentricity", 0.1, 1e-3, 0.99},
    Formula{"biggsb1", "Biggs, Hernandez: CUTE BIGGSB1", &Biggsb1, {4, 1'000'000}},
    Formula{"chen-harker",
            "Chen, Harker, SIAM J. Matrix Anal. Appl. 14 (1993) 1168-1190; CUTE CHENHARK",
            &ChenHarker,
            {10, 1'000'000}},
    Formula{"block-tridiagonal", "Bai, Numer. Linear Algebra Appl. 17 (2010) 917-933, sec. 5", &BlockTridiagonal<false>,
            kSquare, "shift", 4, 0, 1e3},
    Formula{"fathi", "Fathi, Math. Program. 17 (1979) 335-344", &Fathi},
    Formula{"hilbert", "Hilbert, Acta Math. 18 (1894) 155-159", &Hilbert, {2, 20}},
    Formula{"harker-pang", "Harker, Pang, Lect. Appl. Math. 26 (1990) 265-284, without its skew part",
            &RandomDefinite<false>},
    Formula{"block-tridiagonal-skew", "Bai, Numer. Linear Algebra Appl. 17 (2010) 917-933, sec. 5",
            &BlockTridiagonal<true>, kSquare, "shift", 4, 0, 1e3},
    Formula{"murty", "Murty, Math. Program. Study 7 (1978) 61-73", &Murty},
    Formula{"murty-lemke", "Murty, Linear Complementarity, 1988, ch. 6", &MurtyLemke, {2, 50}},
    Formula{"csizmadia", "E. Zs. Csizmadia: the handicap of lower triangular matrices, 2007", &Csizmadia, {2, 50}},
    Formula{"harker-pang-skew", "Harker, Pang, Lect. Appl. Math. 26 (1990) 265-284", &RandomDefinite<true>},
    Formula{"clique", "Cottle, Pang, Stone, The Linear Complementarity Problem, 1992: strictly copositive matrices",
            &Clique},
    Formula{"knapsack", "Chung, J. Optim. Theory Appl. 60 (1989) 393-399", &Knapsack, {4, 400}, "solvable", 1, 0, 1},
};

}  // namespace

const Formula* FindFormula(std::string_view key) {
  const auto* found =
      std::find_if(kFormulas.begin(), kFormulas.end(), [key](const Formula& f) { return f.key == key; });
  return found == kFormulas.end() ? nullptr : found;
}

FormulaProblem MakeFormula(const Formula& formula, const Recipe& recipe) {
  double value = formula.standard;
  for (const auto& [name, amount] : recipe.changes) {
    if (name != formula.parameter || !(amount >= formula.least && amount <= formula.most)) {
      throw InputError(formula.parameter.empty()
                           ? "expected no change, found '" + name + "'"
                           : "expected " + std::string(formula.parameter) + " from " + NumberText(formula.least) +
                                 " to " + NumberText(formula.most) + ", found " + name + " " + NumberText(amount));
    }
    value = amount;
  }
  const auto [least, most] = formula.rows;
  if (recipe.rows < least || recipe.rows > most) {
    throw InputError("expected " + std::to_string(least) + " to " + std::to_string(most) + " rows, found " +
                     std::to_string(recipe.rows));
  }
  return formula.generate(recipe.rows, value, recipe.seed);
}

}  // namespace lcpbench
