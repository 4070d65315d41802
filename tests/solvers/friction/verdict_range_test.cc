// rho and its parts over the range of doubles, against exact rationals: docs/friction.md section 4.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <utility>
#include <vector>

#include "solvers/exact/rational.h"
#include "solvers/lcp/law_metrics.h"
#include "solvers/lcp/verify.h"
#include "tests/solvers/solve_with.h"

namespace lcpbench {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();

// Forces for rows of every kind, and what the rows allow. Rows come with a copy that has the same force and another b:
// A = (D, -D; -D, D), so that A f = 0 and w = b, exactly, whatever f.
class RowDraw {
 public:
  explicit RowDraw(unsigned seed) : random_(seed) {}

  void Draw() {
    bounds_ = {};
    f_.clear();
    for (int count = Integer(1, 2); count > 0; --count) AddRows();
    const auto n = static_cast<Index>(f_.size());
    bounds_.bilateral.resize(f_.size(), 0);
    const RowBounds one = bounds_;
    bounds_.bilateral.insert(bounds_.bilateral.end(), one.bilateral.begin(), one.bilateral.end());
    for (FrictionRow row : one.friction) {
      row.row += n;
      row.normal += n;
      bounds_.friction.push_back(row);
    }
    for (BoundedRow row : one.bounded) {
      row.row += n;
      bounds_.bounded.push_back(row);
    }
  }

  LcpProblem Problem() {
    const auto n = static_cast<Index>(f_.size());
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(2 * n, 2 * n);
    Eigen::VectorXd b(2 * n);
    for (Index i = 0; i < n; ++i) {
      // Squares, for rational roots.
      const double d = OneIn(8) ? 0 : std::ldexp(1, 2 * Integer(-10, 10));
      A(i, i) = A(i + n, i + n) = d;
      A(i, i + n) = A(i + n, i) = -d;
    }
    for (double& each : b) each = OneIn(8) ? 0 : Size();
    return LcpProblem::FromDense("drawn", A, b, bounds_);
  }
  Eigen::VectorXd Forces() const {
    const auto n = static_cast<Index>(f_.size());
    return Eigen::Map<const Eigen::VectorXd>(f_.data(), n).replicate(2, 1);
  }

 private:
  int Integer(int low, int high) { return std::uniform_int_distribution<int>(low, high)(random_); }
  bool OneIn(int chances) { return Integer(1, chances) == 1; }
  double Size() {
    const double size = std::ldexp(std::uniform_real_distribution<double>(1, 2)(random_), Integer(-500, 500));
    return OneIn(2) ? size : -size;
  }
  // At `end`, next to it, or anywhere.
  double Near(double end) {
    if (OneIn(4) || std::isinf(end)) return Size();
    return OneIn(2) ? end : std::nextafter(end, OneIn(2) ? kInfinite : -kInfinite);
  }

  void AddRows() {
    const auto row = static_cast<Index>(f_.size());
    const int kind = Integer(0, 4);
    if (kind == 0) {
      bounds_.bilateral.resize(f_.size(), 0);
      bounds_.bilateral.push_back(1);
      f_.push_back(Size());
    } else if (kind == 1) {
      double lower = Size(), upper = OneIn(8) ? lower : Size();
      if (lower > upper) std::swap(lower, upper);
      if (OneIn(4)) lower = -kInfinite;
      if (OneIn(4)) upper = kInfinite;
      bounds_.bounded.push_back({row, lower, upper});
      f_.push_back(Near(OneIn(2) ? lower : upper));
    } else {
      f_.push_back(OneIn(4) ? Near(0) : std::abs(Size()));
      if (kind == 2) return;
      const double mu =
          OneIn(8) ? 0 : std::ldexp(std::uniform_real_distribution<double>(1, 2)(random_), Integer(-9, 9));
      bounds_.friction.push_back({row + 1, row, mu, static_cast<signed char>(OneIn(4) ? 2 * Integer(0, 1) - 1 : 0)});
      f_.push_back(Near(OneIn(2) ? mu * f_.back() : -mu * f_.back()));
    }
  }

  std::mt19937 random_;
  RowBounds bounds_;
  std::vector<double> f_;
};

Rational Square(const Rational& x) { return x * x; }
Rational Smaller(const Rational& x, const Rational& y) { return y < x ? y : x; }
Rational Larger(const Rational& x, const Rational& y) { return x < y ? y : x; }
Rational Clamped(const Rational& x, const Rational& lower, const Rational& upper) {
  return Smaller(Larger(x, lower), upper);
}
// phi - clamp(phi - omega, lower, upper)
Rational NaturalResidual(const Rational& phi, const Rational& omega, const Rational& lower, const Rational& upper) {
  return phi - Clamped(phi - omega, lower, upper);
}
// Infinity as a number beyond all others.
Rational Exactly(double x) {
  if (std::isinf(x)) return Shifted(x > 0 ? 1 : -1, 3000);
  return Rational(x);
}

// Squares of the parts and of rho, where w = b.
class ExactParts {
 public:
  ExactParts(const LcpProblem& problem, const Eigen::VectorXd& f) : problem_(problem) {
    for (Index i = 0; i < f.size(); ++i) {
      const double d = problem.DiagonalA()[i];
      root_.push_back(Exactly(d == 0 ? 1 : std::sqrt(d)));
      phi_.push_back(Exactly(f[i]) * root_.back());
      omega_.push_back(Exactly(problem.b()[i]) / root_.back());
    }
    AddLaws();
    FindScale();
  }

  Rational rho() const { return sum_ / scale_; }
  Rational cone() const { return cone_ / scale_; }
  Rational dissipation() const { return dissipation_ / scale_; }
  Rational joints() const { return joints_ / scale_; }
  Rational beyond_bounds() const { return bounds_ / scale_; }

  // phi less the projection of phi - omega to cones; of contacts with one tangent.
  Rational Relaxed() const {
    std::vector<Rational> residual = omega_;
    ForPlainRows([&](std::size_t i) { residual[i] = Smaller(phi_[i], omega_[i]); }, [](std::size_t) {});
    for (const BoundedRow& row : problem_.bounded_rows()) residual[At(row.row)] = OfBounded(row);
    for (const FrictionRow& row : problem_.friction_rows()) {
      const std::size_t t = At(row.row), n = At(row.normal);
      const Rational mu = Mu(row);
      if (row.slip != 0) {
        residual[t] = phi_[t] + int{row.slip} * mu * (phi_[n] - residual[n]);
        continue;
      }
      const Rational normal = phi_[n] - omega_[n], tangent = phi_[t] - omega_[t];
      if (normal >= 0 && abs(tangent) <= mu * normal) continue;  // omega on both
      const Rational side = tangent < 0 ? Rational(-mu) : mu;
      const Rational on_normal = Larger((normal + side * tangent) / (1 + mu * mu), 0);
      residual[n] = phi_[n] - on_normal;
      residual[t] = phi_[t] - side * on_normal;
    }
    Rational sum = 0;
    for (const Rational& each : residual) sum += Square(each);
    return sum / scale_;
  }

 private:
  static std::size_t At(Index i) { return static_cast<std::size_t>(i); }
  Rational Mu(const FrictionRow& row) const { return Exactly(row.mu) * root_[At(row.row)] / root_[At(row.normal)]; }
  Rational OfBounded(const BoundedRow& row) const {
    const std::size_t i = At(row.row);
    return NaturalResidual(phi_[i], omega_[i], root_[i] * Exactly(row.lower), root_[i] * Exactly(row.upper));
  }
  template <typename Unilateral, typename Bilateral>
  void ForPlainRows(const Unilateral& unilateral, const Bilateral& bilateral) const {
    for (std::size_t i = 0; i < phi_.size(); ++i) {
      const RowKind kind = problem_.kind(static_cast<Index>(i));
      if (kind == RowKind::kUnilateral) unilateral(i);
      if (kind == RowKind::kBilateral) bilateral(i);
    }
  }

  void AddLaws() {
    ForPlainRows([this](std::size_t i) { sum_ += Square(Smaller(phi_[i], omega_[i])); },
                 [this](std::size_t i) { joints_ += Square(omega_[i]); });
    for (const BoundedRow& row : problem_.bounded_rows()) bounds_ += Square(OfBounded(row));
    for (const FrictionRow& row : problem_.friction_rows()) {
      const std::size_t t = At(row.row), n = At(row.normal);
      if (row.slip != 0) {
        joints_ += Square(phi_[t] + int{row.slip} * Mu(row) * phi_[n]);
        continue;
      }
      const Rational most = Mu(row) * Larger(phi_[n], 0), least = -most;
      const Rational inside = Clamped(phi_[t], least, most);
      sum_ += Square(NaturalResidual(phi_[t], omega_[t], least, most));
      cone_ += Square(phi_[t] - inside);
      dissipation_ += Square(NaturalResidual(inside, omega_[t], least, most));
    }
    sum_ += joints_ + bounds_;
  }

  // S^2, 1 where it is 0.
  void FindScale() {
    Rational plain = 0, all = 0, answered = 0;
    const auto add = [&](std::size_t i) {
      plain += Square(omega_[i]);
      all += Square(omega_[i]);
    };
    ForPlainRows(add, add);
    for (const BoundedRow& row : problem_.bounded_rows()) {
      const std::size_t i = At(row.row);
      const Rational largest = Larger(Square(Exactly(row.lower)), Square(Exactly(row.upper)));
      plain += Smaller(Square(omega_[i]), Square(root_[i]) * largest);
      all += Square(omega_[i]);
    }
    for (const FrictionRow& row : problem_.friction_rows()) {
      if (row.slip != 0) continue;
      answered += Smaller(Square(omega_[At(row.row)]), Square(Mu(row)) * plain);
      all += Square(omega_[At(row.row)]);
    }
    scale_ = Larger(plain + answered, Shifted(all, -40));
    if (scale_ == 0) scale_ = 1;
  }

  const LcpProblem& problem_;
  std::vector<Rational> root_, phi_, omega_;
  Rational sum_ = 0, cone_ = 0, dissipation_ = 0, joints_ = 0, bounds_ = 0, scale_ = 1;
};

// A number and the square that it should have; doubles have no smaller ones than 2^-1074.
void ExpectRoot(double found, const Rational& square, const char* what) {
  ASSERT_TRUE(std::isfinite(found)) << what;
  const Rational error = abs(Square(Rational(found)) - square);
  EXPECT_LE(error, Shifted(square, -45) + Shifted(1, -2000)) << what << " " << found;
}

TEST(VerdictOverTheRange, IsThatOfExactRationals) {
  RowDraw draw(57);
  int plain = 0, wrong = 0;
  for (int round = 0; round < 3000; ++round) {
    SCOPED_TRACE(round);
    draw.Draw();
    const LcpProblem problem = draw.Problem();
    const Eigen::VectorXd f = draw.Forces();
    const Metrics m = ComputeMetrics(problem, f);
    ASSERT_EQ(m.w, problem.b());
    const ExactParts exact(problem, f);
    ExpectRoot(m.rho, exact.rho(), "rho");
    ExpectRoot(RelaxationResidual(problem, f, m.w), exact.Relaxed(), "of the relaxation");
    if (m.rho > 1e-3) ++wrong;
    if (problem.is_plain()) {
      ++plain;
      continue;
    }
    ExpectRoot(m.cone, exact.cone(), "cone");
    ExpectRoot(m.dissipation, exact.dissipation(), "dissipation");
    ExpectRoot(m.joints, exact.joints(), "joints");
    ExpectRoot(m.beyond_bounds, exact.beyond_bounds(), "bounds");
    if (::testing::Test::HasFailure()) return;
  }
  EXPECT_GT(plain, 300);
  EXPECT_GT(wrong, 1000);
}

// w = (1, -2) at an upper bound: the first row is wrong by all of its w.
TEST(VerdictOverTheRange, AGapBesideALargeForceCounts) {
  for (const double size : {1.0, 1e10, 1e20, 1e100}) {
    const LcpProblem problem = LcpProblem::FromDense("large", Eigen::Matrix2d{{1, -1}, {-1, 1}}, Eigen::Vector2d(1, -2),
                                                     {.bounded = {{0, 0, size}, {1, 0, size}}});
    const Verdict verdict = Verify(problem, Claim(Eigen::Vector2d::Constant(size)), 1e-6);
    EXPECT_FALSE(verdict.passes);
    EXPECT_TRUE(verdict.false_success);
    EXPECT_NEAR(verdict.metrics.rho, std::sqrt(size > 1 ? 0.2 : 0.5), 1e-15);
  }
}

}  // namespace
}  // namespace lcpbench
