#include "solvers/lcp/problem.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <random>

#include "benchmarks/measure/allocation_count.h"
#include "support/input_error.h"
#include "tests/solvers/lcp/same_problem.h"
#include "tests/solvers/test_problems.h"
#include "tests/support/refusal.h"

namespace lcpbench {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

enum class Entries { kIntegers, kReals, kScattered };

// Two bodies per row, as contact rows are, and of integers, so that every product is exact; or of any numbers, or of
// any columns.
LcpProblem RandomFactors(Index n, int bodies, unsigned seed, Entries entries = Entries::kIntegers) {
  std::mt19937 random(seed);
  const auto integer = [&](int low, int high) { return low + static_cast<int>(random() % unsigned(high - low + 1)); };
  const auto number = [&](int low, int high) {
    return integer(low, high) * (entries == Entries::kIntegers ? 1 : std::generate_canonical<double, 53>(random));
  };
  SparseMatrix J(n, 3 * bodies);
  for (int i = 0; i < n; ++i) {
    const int first = integer(0, bodies - 1);
    const int second = bodies > 1 ? (first + integer(1, bodies - 1)) % bodies : first;
    for (int k = 0; k < 6; ++k) {
      const int column =
          entries == Entries::kScattered ? integer(0, 3 * bodies - 1) : 3 * (k < 3 ? first : second) + k % 3;
      J.coeffRef(i, column) = number(-3, 3);
    }
  }
  const auto vector = [&](Index size, int low, int high) {
    return Eigen::VectorXd(Eigen::VectorXd::NullaryExpr(size, [&] { return number(low, high); }));
  };
  const Eigen::VectorXd inverse_mass = vector(3 * bodies, 0, 4);
  return LcpProblem::FromFactors("factors", J, inverse_mass, vector(n, -9, 9));
}

// What DenseA and SparseA document, rounding and all, in the plainest words; so A is symmetric bit for bit.
Eigen::MatrixXd SumOverColumns(const Eigen::MatrixXd& J, const Eigen::VectorXd& inverse_mass) {
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(J.rows(), J.rows());
  for (Index k = 0; k < J.cols(); ++k) {
    for (Index i = 0; i < J.rows(); ++i) {
      for (Index j = 0; j < J.rows(); ++j) A(i, j) += inverse_mass[k] * (J(i, k) * J(j, k));
    }
  }
  return A;
}

// By every form, and in rows of a caller that have room for more.
void ExpectA(const LcpProblem& problem, const Eigen::MatrixXd& expected) {
  constexpr Index kMore = 5;
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  EXPECT_EQ(problem.DenseA(), expected);
  EXPECT_EQ(Eigen::MatrixXd(problem.SparseA()), expected);
  EXPECT_EQ(problem.DiagonalA(), expected.diagonal());
  Rows padded = Rows::Constant(problem.size(), problem.size() + kMore, -1);
  AssembleDenseA(ProblemArrays::Of(problem), padded.data(), padded.cols());
  EXPECT_EQ(padded.leftCols(problem.size()), expected);
  EXPECT_TRUE(padded.rightCols(kMore).isZero(0));
}

TEST(LcpProblem, EveryEntryOfASumsOverAscendingColumnsOfJ) {
  for (unsigned seed = 0; seed < 50; ++seed) {
    for (const Entries entries : {Entries::kIntegers, Entries::kReals, Entries::kScattered}) {
      const LcpProblem problem = RandomFactors(1 + seed % 17, 1 + static_cast<int>(seed % 6), seed, entries);
      Eigen::MatrixXd A = SumOverColumns(Eigen::MatrixXd(problem.J()), problem.inverse_mass());
      ExpectA(problem, A);
      EXPECT_TRUE(problem.has_two_body_rows() || entries == Entries::kScattered);
      EXPECT_TRUE(problem.facts().symmetric && problem.facts().positive_semidefinite);
      A(0, A.cols() - 1) += 17;  // rows after rows
      ExpectA(LcpProblem::FromDense("d", A, problem.b()), A);
      ExpectA(LcpProblem::FromSparse("s", A.sparseView(), problem.b()), A);
    }
  }
  EXPECT_FALSE(RandomFactors(40, 10, 7, Entries::kScattered).has_two_body_rows());
}

// A full J goes by tiles: the same sums in the same order, whatever the share of entries, the rest of the last tile,
// and columns that cannot move.
TEST(LcpProblem, FullJacobiansGiveTheSameBits) {
  std::mt19937_64 random(11);
  for (const Index n : {31, 32, 33, 47, 64, 90}) {
    for (const Index columns : {1, 6, 33, 64}) {
      for (const double share : {0.2, 0.3, 0.6, 1.0}) {
        Eigen::MatrixXd J(n, columns);
        Eigen::VectorXd inverse_mass(columns);
        for (Index k = 0; k < columns; ++k) {
          inverse_mass[k] = Uniform(&random, 0, 1) < 0.2 ? 0 : Uniform(&random, 0.1, 10);
          for (Index i = 0; i < n; ++i) J(i, k) = Uniform(&random, 0, 1) < share ? Uniform(&random, -1, 1) : 0;
        }
        const LcpProblem problem = LcpProblem::FromFactors("", J.sparseView(), inverse_mass, Eigen::VectorXd::Zero(n));
        ExpectA(problem, SumOverColumns(J, inverse_mass));
        EXPECT_TRUE(problem.SparseA().nonZeros() == n * n || share < 1 || inverse_mass.isZero(0));
      }
    }
  }
}

// An engine that makes a problem a step pays for one piece of memory, and for the kinds of rows while they are checked.
TEST(LcpProblem, ArraysMakeTheProblemTheyWereTakenOfInOnePiece) {
  const LcpProblem plain = RandomFactors(9, 4, 3);
  RowBounds bounds = RowBounds::WithBilateralRows(9, {0, 4});
  bounds.friction = {{3, 2, 0.5}, {1, 2, 0.5}};
  bounds.bounded = {{8, -1, 1}, {6, 0, 2}};
  MatrixFacts facts;
  facts.rank = 7;
  const std::string id = "a name too long to be kept within a string";
  for (const LcpProblem& problem :
       {plain, LcpProblem::FromFactors(id, plain.J(), plain.inverse_mass(), plain.b(), bounds),
        LcpProblem::FromSparse(id, plain.SparseA(), plain.b(), bounds, facts),
        LcpProblem::FromDense(id, plain.DenseA(), plain.b(), bounds, facts)}) {
    const ProblemArrays arrays = ProblemArrays::Of(problem);
    const long before = AllocationCount();
    CountAllocations(true);
    const LcpProblem made = LcpProblem::FromArrays(arrays);
    CountAllocations(false);
    EXPECT_LE(AllocationCount() - before, 2);
    EXPECT_EQ(made.view().value.data(), made.WithB(made.b()).view().value.data());
    for (const LcpProblem& copy : {made, problem.CopyOfGivenForm()}) {
      EXPECT_FALSE(copy.SharesMatrixWith(problem));
      EXPECT_EQ(copy.id(), problem.id());
      EXPECT_EQ(copy.given_form(), problem.given_form());
      EXPECT_EQ(DifferenceOfProblems(copy, problem), "");
      EXPECT_EQ(copy.facts().rank, problem.facts().rank);
      EXPECT_EQ(copy.facts().symmetric, problem.facts().symmetric);
    }
  }
}

TEST(LcpProblem, ArraysThatDoNotFitAreRefused) {
  const ProblemArrays good = ProblemArrays::Of(RandomFactors(5, 4, 3));
  EXPECT_NO_THROW(LcpProblem::FromArrays(good));
  const std::function<void(ProblemArrays*)> spoils[] = {
      [](ProblemArrays* arrays) { arrays->rows = 4; },
      [](ProblemArrays* arrays) { arrays->rows = -1; },
      [](ProblemArrays* arrays) { arrays->columns = 11; },
      [](ProblemArrays* arrays) { arrays->columns = -1; },
      [](ProblemArrays* arrays) { arrays->row_start.clear(); },
      [](ProblemArrays* arrays) { arrays->row_start[0] = 1; },
      [](ProblemArrays* arrays) { arrays->row_start[2] = 1 << 30; },
      [](ProblemArrays* arrays) { arrays->row_start[2] = -1; },
      [](ProblemArrays* arrays) { arrays->column[3] = arrays->column[2]; },
      [](ProblemArrays* arrays) { arrays->column[0] = -1; },
      [](ProblemArrays* arrays) { arrays->column.back() = 12; },
      [](ProblemArrays* arrays) { arrays->value.pop_back(); },
      [](ProblemArrays* arrays) { arrays->value[1] = kNaN; },
      [](ProblemArrays* arrays) { arrays->inverse_mass[1] = -1; },
      [](ProblemArrays* arrays) { arrays->inverse_mass[1] = kInfinity; },
      [](ProblemArrays* arrays) { arrays->inverse_mass.pop_back(); },
      [](ProblemArrays* arrays) { arrays->b[1] = -kInfinity; },
      [](ProblemArrays* arrays) { arrays->b.push_back(1); },
      [](ProblemArrays* arrays) { arrays->bilateral.assign(4, 1); },
      [](ProblemArrays* arrays) { arrays->form = MatrixForm::kDense; },
      [](ProblemArrays* arrays) { arrays->form = MatrixForm::kSparse; },
  };
  for (const auto& spoil : spoils) {
    ProblemArrays arrays = good;
    spoil(&arrays);
    EXPECT_THROW(LcpProblem::FromArrays(arrays), InputError) << &spoil - spoils;
  }
}

TEST(LcpProblem, AnotherBSharesTheMatrix) {
  const LcpProblem problem = RandomFactors(9, 4, 3);
  const Eigen::VectorXd b = Eigen::VectorXd::LinSpaced(9, -1, 1);
  const LcpProblem other = problem.WithB(b);
  EXPECT_TRUE(other.SharesMatrixWith(problem));
  EXPECT_EQ(other.b(), b);
  EXPECT_NE(problem.b(), b);
  EXPECT_EQ(&other.DenseA(), &problem.DenseA());
  EXPECT_EQ(&other.SparseA(), &problem.SparseA());
  Eigen::VectorXd w;
  other.ComputeW(Eigen::VectorXd::Zero(9), &w);
  EXPECT_EQ(w, b);
  EXPECT_THROW((void)problem.WithB(Eigen::VectorXd::Zero(8)), InputError);
  EXPECT_THROW((void)problem.WithB(Eigen::VectorXd::Constant(9, kNaN)), InputError);
}

TEST(LcpProblem, EveryFormGivesTheSameW) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    const LcpProblem factors = RandomFactors(12, 5, seed);
    const Eigen::VectorXd f = Eigen::VectorXd::LinSpaced(12, 0, 11);
    Eigen::VectorXd expected, w;
    factors.ComputeW(f, &expected);
    for (const MatrixForm form : {MatrixForm::kDense, MatrixForm::kSparse}) {
      InForm(factors, form).ComputeW(f, &w);
      EXPECT_EQ(w, expected);
    }
  }
}

TEST(LcpProblem, SparseMatrixStoresTheWholeDiagonal) {
  SparseMatrix A(3, 3);
  A.insert(0, 1) = A.insert(1, 0) = 2;
  const LcpProblem problem = LcpProblem::FromSparse("s", A, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(problem.SparseA().nonZeros(), 5);
  EXPECT_EQ(problem.DiagonalA(), Eigen::Vector3d::Zero());
  EXPECT_EQ(LcpProblem::FromDense("no rows", {}, {}).SparseA().nonZeros(), 0);
}

TEST(LcpProblem, BadInputIsRefusedAtTheDoor) {
  const Eigen::MatrixXd A = Eigen::MatrixXd::Identity(2, 2);
  const Eigen::Vector2d b(1, 2);
  EXPECT_THROW(LcpProblem::FromDense("x", Eigen::MatrixXd::Identity(3, 3), b), InputError);
  EXPECT_THROW(LcpProblem::FromDense("x", A, Eigen::Vector2d(1, kNaN)), InputError);
  EXPECT_THROW(LcpProblem::FromDense("x", kInfinity * A, b), InputError);
  EXPECT_THROW(LcpProblem::FromDense("x", A, b, RowBounds::WithBilateralRows(3, {2})), InputError);
  EXPECT_THROW(RowBounds::WithBilateralRows(2, {2}), InputError);
  EXPECT_THROW(RowBounds::WithBilateralRows(2, {1, 1}), InputError);
  SparseMatrix J(2, 3);
  J.insert(0, 0) = 1;
  EXPECT_THROW(LcpProblem::FromFactors("x", J, Eigen::Vector3d(1, -1, 1), b), InputError);
  EXPECT_THROW(LcpProblem::FromFactors("x", J, Eigen::Vector2d(1, 1), b), InputError);
}

// In one line that names the row and the field, whichever way the rows come.
TEST(LcpProblem, BadLawsAreRefusedByRowAndField) {
  const Index n = 4;
  const Eigen::MatrixXd A = Eigen::MatrixXd::Identity(n, n);
  const Eigen::VectorXd b = Eigen::VectorXd::Ones(n);
  const LcpProblem plain = LcpProblem::FromDense("x", A, b, RowBounds::WithBilateralRows(n, {3}));
  const auto expect = [&](std::vector<FrictionRow> friction, std::vector<BoundedRow> bounded,
                          const std::string& words) {
    RowBounds bounds{plain.bounds().bilateral, std::move(friction), std::move(bounded)};
    const std::string text = "problem 'x': " + words;
    ExpectRefused([&] { LcpProblem::FromDense("x", A, b, bounds); }, words, text);
    ExpectRefused([&] { plain.WithBounds(bounds); }, words, text);
    ProblemArrays arrays = ProblemArrays::Of(plain);
    arrays.friction = bounds.friction;
    arrays.bounded = bounds.bounded;
    ExpectRefused([&] { LcpProblem::FromArrays(arrays); }, words, text);
  };
  EXPECT_NO_THROW(plain.WithBounds({{}, {{2, 0, 0, 1}, {1, 0, 0.5}}, {{3, -kInfinity, kInfinity}}}));
  expect({{1, 0, -1e-9}}, {}, "friction: row 1: mu is -1e-09, expected a finite number >= 0");
  expect({{1, 0, kNaN}}, {}, "friction: row 1: mu is nan");
  expect({{1, 0, kInfinity}}, {}, "friction: row 1: mu is inf");
  expect({{1, 0, 1, 2}}, {}, "friction: row 1: slip is 2, expected -1, 0 or 1");
  for (const Index normal : {Index{-1}, Index{1}, Index{3}, n}) {
    expect({{1, normal, 1}}, {},
           "friction: row 1: normal is " + std::to_string(normal) + ", expected a unilateral row");
  }
  expect({{2, 1, 1}, {1, 0, 1}}, {}, "friction: row 2: normal is 1, expected a unilateral row");
  expect({{1, 0, 1}}, {{0, 0, 1}}, "friction: row 1: normal is 0, expected a unilateral row");
  expect({{1, 0, 1}, {2, 0, 1}, {1, 0, 1}}, {}, "friction: row 1 is listed twice");
  expect({{4, 0, 1}}, {}, "friction: row 4 is outside [0, 4)");
  expect({{3, 0, 1}}, {}, "friction: row 3 is a bilateral row already");
  expect({{1, 0, 1}}, {{1, 0, 1}}, "bounded: row 1 is a friction row already");
  expect({}, {{3, 0, 1}}, "bounded: row 3 is a bilateral row already");
  expect({}, {{1, 0, 1}, {1, 0, 1}}, "bounded: row 1 is listed twice");
  expect({}, {{-1, 0, 1}}, "bounded: row -1 is outside [0, 4)");
  expect({}, {{1, 1, 0}}, "bounded: row 1: lower is 1 and upper 0, expected a number between them");
  expect({}, {{1, kNaN, 0}}, "bounded: row 1: lower is nan and upper 0");
  expect({}, {{1, 0, kNaN}}, "bounded: row 1: lower is 0 and upper nan");
  expect({}, {{1, kInfinity, kInfinity}}, "bounded: row 1: lower is inf and upper inf");
  expect({}, {{1, -kInfinity, -kInfinity}}, "bounded: row 1: lower is -inf and upper -inf");
}

TEST(LcpProblem, SymmetryIsToldAtAnyScale) {
  const Eigen::Matrix2d A = (Eigen::Matrix2d() << 1, 0.5, -0.5, 1).finished();
  for (const double unit : {0x1p-900, 0x1p-540, 1.0, 0x1p540, 0x1p900}) {
    const auto with = [&](const Eigen::Matrix2d& scaled) {
      return LcpProblem::FromDense("p", scaled, Eigen::Vector2d::Ones());
    };
    EXPECT_FALSE(with(unit * A).IsNumericallySymmetric()) << unit;
    EXPECT_TRUE(with(unit * A.cwiseAbs()).IsNumericallySymmetric()) << unit;
  }
}

}  // namespace
}  // namespace lcpbench
