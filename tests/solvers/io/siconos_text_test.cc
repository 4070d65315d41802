// Siconos' text files: round trips bit for bit, and one line for whatever is wrong with a file.

#include "solvers/io/siconos_text.h"

#include <gtest/gtest.h>

#include <random>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "tests/solvers/lcp/same_problem.h"
#include "tests/solvers/test_problems.h"
#include "tests/support/refusal.h"

namespace lcpbench {
namespace {

LcpProblem Parse(const std::string& text) {
  std::istringstream stream(text);
  return ReadSiconosText(stream, "file.dat", "id");
}

std::string Format(const LcpProblem& problem) {
  std::ostringstream stream;
  WriteSiconosText(problem, stream);
  return stream.str();
}

TEST(SiconosText, ProblemsComeBackBitForBit) {
  int mixed = 0, plain = 0;
  for (const TestProblem& test : GeneratedProblems()) {
    SCOPED_TRACE(test.problem.id());
    (test.problem.bilateral_rows().empty() ? plain : mixed) += 1;
    const LcpProblem sparse = InForm(test.problem, MatrixForm::kSparse);
    const LcpProblem sparse_back = Parse(Format(sparse));
    EXPECT_EQ(sparse_back.given_form(), MatrixForm::kSparse);
    EXPECT_EQ(DifferenceOfProblems(sparse_back, sparse), "");
    const LcpProblem dense = InForm(test.problem, MatrixForm::kDense);
    const LcpProblem dense_back = Parse(Format(dense));
    EXPECT_EQ(dense_back.given_form(), MatrixForm::kDense);
    EXPECT_EQ(DifferenceOfProblems(dense_back, dense), "");
    // Factors are written as their rounded matrix.
    EXPECT_EQ(DifferenceOfProblems(Parse(Format(test.problem)), sparse), "");
  }
  EXPECT_GT(mixed, 10);
  EXPECT_GT(plain, 10);
}

TEST(SiconosText, WithoutRowsOrUnsymmetricTheProblemComesBackToo) {
  const LcpProblem none = Parse(Format(LcpProblem::FromDense("none", {}, {})));
  EXPECT_EQ(none.size(), 0);
  for (const LcpProblem& problem : {EndsOfTheRange(), EndsOfTheRange({0, 1})}) {
    EXPECT_EQ(DifferenceOfProblems(Parse(Format(problem)), problem), "");
  }
}

TEST(SiconosText, ReadsWhatTheLibraryWrites) {
  // By columns, and a remark behind.
  const LcpProblem dense = Parse("2\n0\n2\n2\n2\t2\n1 2\n3 4\n-1 1\n\nRemark 4 of a book\n");
  EXPECT_EQ(dense.DenseA()(1, 0), 2);
  EXPECT_EQ(dense.DenseA()(0, 1), 3);
  EXPECT_EQ(dense.b()[1], 1);
  const LcpProblem columns = Parse(
      "2\n2\n2\n2\n2\nCSparse Version 3.2.0, Sept 12, 2017.\n2-by-2, nzmax: 3 nnz: 3, 1-norm: 3.25\n"
      "    col 0 : locations 0 to 1\n      1 : 2\n      0 : 1.25\n    col 1 : locations 2 to 2\n      1 : 3\n1 1\n");
  EXPECT_EQ(columns.DenseA()(1, 0), 2);
  EXPECT_EQ(columns.DenseA()(0, 1), 0);
  const LcpProblem summed = Parse("1\n2\n1\n1\n1\nCSparse\ntriplet: 1-by-1, nzmax: 2 nnz: 2\n 0 0 : 1\n 0 0 : 2\n1\n");
  EXPECT_EQ(summed.DenseA()(0, 0), 3);
  // A, C, D, B and their vectors alone, row by row: equations come first.
  const LcpProblem parts = Parse("0 1 1 2   9   1 2 3 4   5 6   7 8   -1   -2 -3");
  Eigen::MatrixXd expected(3, 3);
  expected << 9, 5, 6, 7, 1, 2, 8, 3, 4;
  EXPECT_EQ(parts.DenseA(), expected);
  EXPECT_EQ(parts.b(), Eigen::Vector3d(-1, -2, -3));
  EXPECT_EQ(parts.bilateral_rows(), std::vector<Index>{0});
  // Both storages, the equation in the middle.
  const std::string both = "1 1 1 2\n0 1 2 3\n1 0 1\n0 3 3 3 3\n4 1 0\n1 3 0\n0 0 2\n-1 1 -2\n";
  EXPECT_EQ(Parse(both + "3  4 0 0 2  1 0  1 0  1  -1 -2").bilateral_rows(), std::vector<Index>{1});
  // A known answer behind.
  EXPECT_EQ(Parse(both + "3  4 0 0 2  1 0  1 0  1  -1 -2   1 2 3 4 5").size(), 3);
  EXPECT_THROW(Parse(both + "3  4 0 0 2  1 0  1 0  1  -1 -2   1 2 3 4 5 6"), InputError);
  EXPECT_THROW(Parse(both + "3  4 0 0 2  1 0  1 0  1  -1 -2   1 2 3e999"), InputError);
  // Sparse blocks of 1 and 2 rows, column by column; rows of blocks at the end may have none.
  const LcpProblem blocks = Parse("3 1 3 3  3  2 2  1 3  1 3  3 3  0 2 3  0 1 1  0 4  1 5 6  2 1 2 3 4  -1 -2 -3");
  EXPECT_EQ(blocks.given_form(), MatrixForm::kSparse);
  EXPECT_EQ(blocks.DenseA(), (Eigen::Matrix3d() << 4, 5, 6, 0, 1, 3, 0, 2, 4).finished());
  EXPECT_EQ(blocks.b(), Eigen::Vector3d(-1, -2, -3));
  const LcpProblem above = Parse("2 1 2 2  1  2 2  1 2  1 2  2 1  0 1  1  0 7  1 2");
  EXPECT_EQ(above.DenseA(), (Eigen::Matrix2d() << 0, 7, 0, 0).finished());
  EXPECT_EQ(Parse("2 1 2 2  0  1 2").DenseA(), Eigen::MatrixXd::Zero(2, 2));
  const LcpProblem mixed = Parse("1 0 1 1  0 1 2  0 1  1 2 2  1 1 1 2 2 2 1 0 1 0  0 1 2 3 4  -1 -2");
  EXPECT_EQ(mixed.DenseA(), (Eigen::Matrix2d() << 1, 3, 2, 4).finished());
  EXPECT_EQ(mixed.bilateral_rows(), std::vector<Index>{0});
  // One row: an LCP or an MLCP.
  EXPECT_TRUE(Parse("1 0 1 1 1 1 2 -1").bilateral_rows().empty());
  EXPECT_EQ(Parse("1 0 1 1  0 1 2  0 1  0 2 2 2 2  1 0 0 1  -1 -2").bilateral_rows(), std::vector<Index>{0});
  EXPECT_EQ(Parse("1 1 1 0  0 1  0  0 1 1 1 1  2 -1  2 -1").bilateral_rows(), std::vector<Index>{0});
}

// M has one row more, or less, than columns; q is printed with as many numbers as M has columns.
TEST(SiconosText, OtherNumbersOfEquationsThanOfFreeUnknownsAreMadeSquare) {
  // u - v = 0, -u - v + 1 = 0, 0 <= v, u + v - 1 >= 0: an unknown that acts on nothing beside u.
  const LcpProblem more = Parse("1 1 1 1  0 1 2  0 1  0 3 2 3 2  1 -1 1  -1 -1 1  0 1  1 1 -1 1  0 -1  9 9 9");
  EXPECT_EQ(more.DenseA(), (Eigen::Matrix3d() << 1, 0, -1, -1, 0, -1, 1, 0, 1).finished());
  EXPECT_EQ(more.b(), Eigen::Vector3d(0, 1, -1));
  EXPECT_EQ(more.bilateral_rows(), (std::vector<Index>{0, 1}));
  // No equation: 0 = 0 for u. What Siconos prints of q beyond its rows means nothing.
  const LcpProblem fewer =
      Parse("1 0 1 1  0 1 2  0 1  2 1 2  1\nCSparse\ntriplet: 1-by-2, nzmax: 1 nnz: 1\n 0 1 : 5\n -2 8");
  EXPECT_EQ(fewer.DenseA(), (Eigen::Matrix2d() << 0, 0, 0, 5).finished());
  EXPECT_EQ(fewer.b(), Eigen::Vector2d(0, -2));
  EXPECT_EQ(fewer.bilateral_rows(), std::vector<Index>{0});
  // A promise of many equations costs nothing.
  EXPECT_THROW(Parse("1 0 2000000000 0  0 2000000000  0  0 0 2000000000 0 2000000000"), InputError);
}

TEST(SiconosText, OfContactsNormalRowsAreReadAndWithFrictionTangents) {
  const std::string W = "2 2 0 4 4 4 4  4 9 1 9  9 9 9 9  1 9 3 9  9 9 9 9  -1 8 -2 8  ";
  const LcpProblem dense = Parse(W + "0 0 1");
  EXPECT_EQ(dense.DenseA(), (Eigen::Matrix2d() << 4, 1, 1, 3).finished());
  EXPECT_EQ(dense.b(), Eigen::Vector2d(-1, -2));
  EXPECT_TRUE(dense.bilateral_rows().empty());
  const LcpProblem friction = Parse(W + "0 0.5");
  EXPECT_EQ(friction.DenseA(), (Eigen::Matrix3d() << 4, 1, 9, 1, 3, 9, 9, 9, 9).finished());
  EXPECT_EQ(friction.b(), Eigen::Vector3d(-1, -2, 8));
  EXPECT_EQ(friction.friction_rows(), (std::vector<FrictionRow>{{2, 1, 0.5}}));
  EXPECT_THROW(Format(friction), InputError);
  ExpectRefused([&] { Parse(W + "0 -0.5"); }, "expected friction coefficients >= 0, found '-0.5'", "file.dat:1: ");
  EXPECT_THROW(Parse(W + "0"), InputError);
  EXPECT_THROW(Parse(W + "0 0 1 1"), InputError);
  std::istringstream blocks(
      "3 2 1 6 6  2 2 2 3 6 3 6 3 2 0 1 2 0 1  0 5 1 1 1 1 1 1 1 1  1 6 1 1 1 1 1 1 1 1  -1 7 7 -2 7 7  0.7 0");
  const std::string space = blocks.str();
  ExpectRefused([&] { Parse(space); }, "of contacts with two tangents, or `lcpbench convert --box-friction`",
                "file.dat:1: ");
  std::istringstream again(space);
  const LcpProblem box = ReadSiconosText(again, "file.dat", "id", TangentRows::kBox);
  EXPECT_EQ(box.b(), Eigen::Vector4d(-1, 7, 7, -2));
  EXPECT_EQ(box.friction_rows(), (std::vector<FrictionRow>{{1, 0, 0.7}, {2, 0, 0.7}}));
  const LcpProblem sparse = ReadSiconosText(blocks, "file.dat", "id", TangentRows::kNone);
  EXPECT_EQ(sparse.given_form(), MatrixForm::kSparse);
  EXPECT_EQ(sparse.DenseA(), (Eigen::Matrix2d() << 5, 0, 0, 6).finished());
  EXPECT_EQ(sparse.b(), Eigen::Vector2d(-1, -2));
  // What is a problem of contacts and an LCP by its first words is an LCP.
  EXPECT_EQ(Parse("2 1 2 2  1 1 1 2 2 2 1 0 1 0  0 1 2 3 4  -1 -2").size(), 2);
}

TEST(SiconosText, WhatIsWrongIsOneLineWithItsPlace) {
  for (const auto& refused : RefusalCases("siconos_text")) {
    ExpectRefused([&] { Parse(refused[0]); }, refused[1], "file.dat:");
  }
}

TEST(SiconosText, WhatTheFormatCannotHoldIsNotWritten) {
  SparseMatrix J(1, 3);
  J.insert(0, 0) = 1e200;
  EXPECT_THROW(Format(LcpProblem::FromFactors("overflow", J, Eigen::Vector3d::Ones(), Eigen::VectorXd::Ones(1))),
               InputError);
}

TEST(SiconosText, FilesAreReadAndWrittenByTheirNames) {
  const std::string path = testing::TempDir() + "siconos-name.dat";
  const LcpProblem given = GeneratedProblems()[5].problem;
  WriteSiconosProblem(given, path);
  const LcpProblem back = ReadSiconosProblem(path);
  EXPECT_EQ(back.id(), "siconos-name");
  EXPECT_EQ(DifferenceOfRows(back, given), "");
  EXPECT_THROW(ReadSiconosProblem(testing::TempDir() + "absent.dat"), InputError);
  EXPECT_THROW(ReadSiconosProblem(testing::TempDir()), InputError);
  EXPECT_THROW(WriteSiconosProblem(given, "/nowhere/x.dat"), InputError);
}

}  // namespace
}  // namespace lcpbench
