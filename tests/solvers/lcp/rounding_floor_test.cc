
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "solvers/lcp/verify.h"
#include "tests/solvers/test_problems.h"

namespace lcpbench {
namespace {

constexpr double kUnitRoundoff = 0x1p-53;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Seeded problems by factors, some rows bilateral, magnitudes over six decades, some forces 0.
struct Case {
  SparseMatrix J;
  Eigen::VectorXd inverse_mass;
  Eigen::VectorXd b;
  RowBounds bounds;
  Eigen::VectorXd f;

  LcpProblem Factors() const { return LcpProblem::FromFactors("factors", J, inverse_mass, b, bounds); }
  Eigen::MatrixXd A() const { return Eigen::MatrixXd(J) * inverse_mass.asDiagonal() * Eigen::MatrixXd(J).transpose(); }
};

Case RandomCase(unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  const auto spread = [&] { return std::pow(10.0, 6 * std::generate_canonical<double, 53>(random) - 3); };
  Case c;
  const Index n = 1 + static_cast<Index>(random() % 9);
  const Index columns = 3 * (1 + static_cast<Index>(random() % 4));
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(n, columns);
  for (double& x : J.reshaped()) x = random() % 3 == 0 ? 0.0 : normal(random);
  J.col(0).setConstant(1);  // no row of zeros
  c.J = J.sparseView();
  c.inverse_mass.resize(columns);
  for (double& m : c.inverse_mass) m = random() % 5 == 0 ? 0.0 : spread();
  c.inverse_mass[0] = spread();
  c.b.resize(n);
  c.f.resize(n);
  std::vector<Index> bilateral;
  for (Index i = 0; i < n; ++i) {
    c.b[i] = normal(random) * spread();
    c.f[i] = random() % 3 == 0 ? 0.0 : normal(random) * spread();
    if (random() % 4 == 0) bilateral.push_back(i);
  }
  c.bounds = RowBounds::WithBilateralRows(n, bilateral);
  return c;
}

// The formula, written out.
double ByFormula(const Eigen::MatrixXd& magnitudes, const Eigen::MatrixXd& A, const Eigen::VectorXd& b,
                 const Eigen::VectorXd& f) {
  long double change = 0;
  long double scale = 0;
  for (Index i = 0; i < b.size(); ++i) {
    long double sum = 0;
    for (Index j = 0; j < b.size(); ++j) sum += std::abs(static_cast<long double>(magnitudes(i, j)) * f[j]);
    const long double d = A(i, i) == 0 ? 1 : std::abs(A(i, i));
    change += sum * sum / d;
    scale += static_cast<long double>(b[i]) * b[i] / d;
  }
  return static_cast<double>(kUnitRoundoff * std::sqrt(scale == 0 ? change : change / scale));
}

TEST(RoundingFloor, FollowsItsFormulaInEveryForm) {
  for (unsigned seed = 0; seed < 200; ++seed) {
    const Case c = RandomCase(seed);
    Eigen::MatrixXd A = c.A();
    const Eigen::MatrixXd J = Eigen::MatrixXd(c.J).cwiseAbs();
    const double by_factors = ByFormula(J * c.inverse_mass.asDiagonal() * J.transpose(), A, c.b, c.f);
    EXPECT_NEAR(RoundingFloor(c.Factors(), c.f), by_factors, 1e-13 * by_factors) << seed;
    // The other forms need neither symmetry nor a positive diagonal.
    if (seed % 2 == 0) A(0, A.cols() - 1) += 1;
    if (seed % 3 == 0) A(0, 0) = -A(0, 0);
    if (seed % 5 == 0) A(A.rows() - 1, A.rows() - 1) = 0;
    const double by_entries = ByFormula(A, A, c.b, c.f);
    EXPECT_NEAR(RoundingFloor(LcpProblem::FromDense("d", A, c.b), c.f), by_entries, 1e-13 * by_entries) << seed;
    EXPECT_NEAR(RoundingFloor(LcpProblem::FromSparse("s", A.sparseView(), c.b), c.f), by_entries, 1e-13 * by_entries)
        << seed;
  }
}

TEST(RoundingFloor, FactorsBoundTheFloorOfTheirMatrix) {
  int larger = 0;
  for (unsigned seed = 0; seed < 200; ++seed) {
    const Case c = RandomCase(seed);
    const double by_factors = RoundingFloor(c.Factors(), c.f);
    const double by_entries = RoundingFloor(LcpProblem::FromDense("d", c.A(), c.b), c.f);
    EXPECT_GE(by_factors, by_entries * (1 - 1e-13)) << seed;
    larger += by_factors > by_entries * (1 + 1e-9) ? 1 : 0;
  }
  EXPECT_GT(larger, 50);  // a bound, not the same thing
}

TEST(RoundingFloor, IsIndependentOfUnitsAndRowScaling) {
  for (unsigned seed = 0; seed < 100; ++seed) {
    const Case c = RandomCase(seed);
    const double floor = RoundingFloor(c.Factors(), c.f);
    const double floor_of_matrix = RoundingFloor(LcpProblem::FromDense("d", c.A(), c.b), c.f);
    std::mt19937 random(seed);
    // Powers of two: nothing rounds. Squares of the last two leave the range of double.
    for (const int exponent : {-3, 40, 530, -530}) {
      Eigen::VectorXd rows(c.b.size());
      for (double& s : rows) s = std::ldexp(1.0, static_cast<int>(random() % 80) - 40);
      Case scaled = c;
      scaled.J = rows.asDiagonal() * c.J;
      scaled.b = std::ldexp(1.0, exponent) * rows.cwiseProduct(c.b);
      scaled.f = std::ldexp(1.0, exponent) * c.f.cwiseQuotient(rows);
      EXPECT_DOUBLE_EQ(RoundingFloor(scaled.Factors(), scaled.f), floor) << seed;
      const LcpProblem dense = LcpProblem::FromDense("d", rows.asDiagonal() * c.A() * rows.asDiagonal(), scaled.b);
      EXPECT_DOUBLE_EQ(RoundingFloor(dense, scaled.f), floor_of_matrix) << seed;
      // Another unit of mass: 1/m and f in opposite directions.
      scaled.inverse_mass *= std::ldexp(1.0, 21);
      scaled.f *= std::ldexp(1.0, -21);
      EXPECT_DOUBLE_EQ(RoundingFloor(scaled.Factors(), scaled.f), floor) << seed;
    }
  }
}

TEST(RoundingFloor, BoundsWhatRelativeChangesOfForcesDoToRho) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> within(-1, 1);
  for (unsigned seed = 0; seed < 400; ++seed) {
    const Case c = RandomCase(seed);
    const LcpProblem dense = LcpProblem::FromDense("d", c.A(), c.b, c.bounds);
    for (const LcpProblem& problem : {c.Factors(), dense}) {
      for (const double size : {1e-2, 1e-5, 1e-8}) {
        Eigen::VectorXd changed = c.f;
        for (double& x : changed) x *= 1 + size * within(random);
        const double before = ComputeMetrics(problem, c.f).rho;
        const double after = ComputeMetrics(problem, changed).rho;
        const double bound = size / kUnitRoundoff * RoundingFloor(problem, c.f);
        EXPECT_LE(std::abs(after - before), bound * (1 + 1e-6) + 1e-14 * before) << seed;
      }
    }
  }
}

TEST(RoundingFloor, IsAttainedWhereNothingCancels) {
  // A >= 0 and f > 0 with w = 0: forces that all grow alike.
  for (unsigned seed = 0; seed < 50; ++seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> uniform(0.1, 1);
    Eigen::MatrixXd A(5, 5);
    Eigen::VectorXd f(5);
    for (double& x : A.reshaped()) x = uniform(random);
    for (double& x : f) x = uniform(random);
    A.diagonal().array() += 5;
    const LcpProblem problem = LcpProblem::FromDense("d", A, -A * f);
    const double rho = ComputeMetrics(problem, 1.001 * f).rho;
    EXPECT_NEAR(rho, 0.001 / kUnitRoundoff * RoundingFloor(problem, f), 1e-9 * rho);
    EXPECT_NEAR(rho, 0.001, 1e-12);  // then the floor is u itself, the least there is
  }
}

TEST(RoundingFloor, GrowsWithTheMassRatioOfAColumnAndTheRoundedExactAnswerIsBelowIt) {
  double previous = 0;
  for (const double ratio : {1.0, 1e2, 1e4, 1e6}) {
    const StackedColumn column = MakeStackedColumn(1000, ratio);
    Eigen::VectorXd f(1000);
    for (Index i = 0; i < 1000; ++i) f[i] = static_cast<double>(column.f[static_cast<size_t>(i)]);
    const double floor = RoundingFloor(column.problem, f);
    EXPECT_GT(floor, 20 * previous);
    previous = floor;
    // No answer in double comes much nearer than the exact one, rounded; the bound is no empty one.
    const double rho = ComputeMetrics(column.problem, f).rho;
    EXPECT_LE(rho, 1.01 * floor) << ratio;
    EXPECT_GE(rho, 0.05 * floor) << ratio;
  }
  EXPECT_GT(previous, 1e-9);
}

TEST(RoundingFloor, AnswersThatAreNoneHaveAnInfiniteFloor) {
  const LcpProblem problem = LcpProblem::FromDense("d", Eigen::Matrix2d::Identity(), Eigen::Vector2d(-1, 0));
  EXPECT_EQ(RoundingFloor(problem, Eigen::Vector2d(1, kNaN)), kInfinity);
  EXPECT_EQ(RoundingFloor(problem, Eigen::Vector2d(1, kInfinity)), kInfinity);
  EXPECT_EQ(RoundingFloor(problem, Eigen::VectorXd::Ones(3)), kInfinity);
  EXPECT_EQ(RoundingFloor(problem, Eigen::Vector2d::Zero()), 0);
  EXPECT_EQ(RoundingFloor(LcpProblem::FromDense("0", Eigen::MatrixXd(0, 0), Eigen::VectorXd(0)), Eigen::VectorXd(0)),
            0);
  // Absolute where b = 0, as rho is.
  const LcpProblem homogeneous = LcpProblem::FromDense("h", 4 * Eigen::Matrix2d::Identity(), Eigen::Vector2d::Zero());
  EXPECT_DOUBLE_EQ(RoundingFloor(homogeneous, Eigen::Vector2d(3, 4)), 10 * kUnitRoundoff);
}

// --- verdicts relative to a floor

LcpResult Claim(Eigen::VectorXd f) {
  LcpResult result;
  result.status = LcpStatus::kSolved;
  result.f = std::move(f);
  return result;
}

LcpReference WithFloor(double floor) {
  LcpReference reference;
  reference.floor = floor;
  return reference;
}

// w = f - 1: rho is |f - 1| for f near 1.
LcpProblem One() { return LcpProblem::FromDense("one", Eigen::MatrixXd::Ones(1, 1), -Eigen::VectorXd::Ones(1)); }
LcpResult Off(double error) { return Claim(Eigen::VectorXd::Constant(1, 1 - error)); }

TEST(VerdictAtTheFloor, PassesUpToTheFloorAndSaysSo) {
  const LcpReference reference = WithFloor(1e-7);
  const Verdict at_floor = Verify(One(), Off(0.5e-7), 1e-9, &reference);
  EXPECT_TRUE(at_floor.passes);
  EXPECT_TRUE(at_floor.at_floor);
  EXPECT_FALSE(at_floor.false_success);
  EXPECT_EQ(at_floor.best_tier, 1e-9);
  EXPECT_EQ(at_floor.reason, "");
  EXPECT_EQ(at_floor.metrics.floor, 1e-7);

  const Verdict above = Verify(One(), Off(2e-7), 1e-9, &reference);
  EXPECT_FALSE(above.passes);
  EXPECT_FALSE(above.at_floor);
  EXPECT_TRUE(above.false_success);
  EXPECT_EQ(above.best_tier, 1e-6);
  EXPECT_NE(above.reason.find("> 1e-07 (rounding floor)"), std::string::npos) << above.reason;

  EXPECT_FALSE(Verify(One(), Off(0.5e-7), 1e-9).passes);
  // What meets the tier anyway does not lean on the floor.
  EXPECT_FALSE(Verify(One(), Off(0.5e-9), 1e-9, &reference).at_floor);
}

TEST(VerdictAtTheFloor, AFloorBelowTheTierOrNoneChangesNothing) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> exponent(-13, -1);
  for (int k = 0; k < 300; ++k) {
    const LcpResult result = Off(std::pow(10, exponent(random)));
    for (const double tier : kTiers) {
      const Verdict strict = Verify(One(), result, tier);
      EXPECT_EQ(strict.metrics.floor, -1);
      for (const double floor : {0.0, 1e-16, 0.99 * kTiers[0], kNaN, kInfinity, -1.0, -kInfinity}) {
        const LcpReference reference = WithFloor(floor);
        const Verdict verdict = Verify(One(), result, tier, &reference);
        EXPECT_EQ(verdict.passes, strict.passes);
        EXPECT_FALSE(verdict.at_floor);
        EXPECT_EQ(verdict.best_tier, strict.best_tier);
        EXPECT_EQ(verdict.false_success, strict.false_success);
        EXPECT_EQ(verdict.reason, strict.reason);
      }
    }
  }
}

TEST(VerdictAtTheFloor, PassesExactlyWhatMeetsTheLargerOfTierAndFloor) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> exponent(-12, -3);
  for (int k = 0; k < 1000; ++k) {
    const LcpResult result = Off(std::pow(10, exponent(random)));
    const LcpReference reference = WithFloor(std::pow(10, exponent(random)));
    const double tier = kTiers[k % 3];
    const Verdict verdict = Verify(One(), result, tier, &reference);
    EXPECT_EQ(verdict.passes, Verify(One(), result, std::max(tier, *reference.floor)).passes);
    EXPECT_EQ(verdict.at_floor, verdict.passes && !Verify(One(), result, tier).passes);
  }
}

TEST(VerdictAtTheFloor, NoFloorIsLargeEnoughForNothing) {
  for (const double floor : {1.0, 1e3, 1e300}) {
    const LcpReference reference = WithFloor(floor);
    EXPECT_FALSE(Verify(One(), Claim(Eigen::VectorXd::Zero(1)), 1e-9, &reference).passes);
    EXPECT_FALSE(Verify(One(), Off(2 * kLargestFloor), 1e-9, &reference).passes);
    EXPECT_TRUE(Verify(One(), Off(kLargestFloor / 2), 1e-9, &reference).passes);
    EXPECT_FALSE(Verify(One(), Claim(Eigen::VectorXd::Constant(1, kNaN)), 1e-9, &reference).passes);
    EXPECT_FALSE(Verify(One(), Claim(Eigen::VectorXd::Constant(1, kInfinity)), 1e-9, &reference).passes);
  }
}

TEST(VerdictAtTheFloor, TheBackwardErrorIsJudgedByTheSameTier) {
  // Row 1 makes |b| large, so that rho is small; row 0 has the backward error e / (2 - e).
  const auto verdict = [](double e, double floor) {
    const LcpProblem problem = LcpProblem::FromDense("d", Eigen::Matrix2d::Identity(), Eigen::Vector2d(-1, 1e9));
    const LcpReference reference = WithFloor(floor);
    return Verify(problem, Claim(Eigen::Vector2d(1 - e, 0)), 1e-9, &reference);
  };
  EXPECT_FALSE(verdict(1e-3, 1e-10).passes);
  EXPECT_TRUE(verdict(1e-3, 1e-6).passes);
  EXPECT_TRUE(verdict(1e-3, 1e-6).at_floor);
  EXPECT_FALSE(verdict(3e-3, 1e-6).passes);
  EXPECT_NE(verdict(3e-3, 1e-6).reason.find("backward error"), std::string::npos);
}

TEST(VerdictAtTheFloor, AHugeSelfStressDoesNotLoosenAVerdict) {
  // A body between two walls: f = (1, 0) + t (1, 1) for any t >= 0.
  Eigen::Matrix2d A;
  A << 1, -1, -1, 1;
  const LcpProblem problem = LcpProblem::FromDense("walls", A, Eigen::Vector2d(-1, 1), {}, SymmetricPsd());
  const LcpReference reference = WithFloor(RoundingFloor(problem, Eigen::Vector2d(1, 0)));
  int loosened = 0;
  for (double t = 1; t < 1e14; t *= 3) {
    const double ulp = std::nextafter(t, 2 * t) - t;
    for (const double error : {0.0, ulp, -ulp}) {
      const Eigen::Vector2d f(t + 1 + error, t);
      const Verdict strict = Verify(problem, Claim(f), 1e-9);
      const Verdict verdict = Verify(problem, Claim(f), 1e-9, &reference);
      EXPECT_EQ(verdict.passes, strict.passes) << t;
      EXPECT_EQ(verdict.reason, strict.reason) << t;
      EXPECT_FALSE(verdict.at_floor) << t;
      EXPECT_DOUBLE_EQ(verdict.metrics.answer_floor, RoundingFloor(problem, f));
      // Its own floor would have let it pass.
      const LcpReference own = WithFloor(RoundingFloor(problem, f));
      loosened += Verify(problem, Claim(f), 1e-9, &own).passes && !strict.passes ? 1 : 0;
    }
  }
  EXPECT_GT(loosened, 10);
}

}  // namespace
}  // namespace lcpbench
