// QPS files: the text, and what is refused. tests/data/test_qp_files.py and qps_reader_test.cc read them.

#include "solvers/io/qps_text.h"

#include <gtest/gtest.h>

#include <limits>
#include <sstream>

#include "tests/support/refusal.h"

namespace lcpbench {
namespace {

std::string Format(const LcpProblem& problem) {
  std::ostringstream stream;
  WriteQpsText(problem, stream);
  return stream.str();
}

TEST(QpsText, HasTheLowerTriangleAndFreeJoints) {
  Eigen::MatrixXd A(3, 3);
  A << 0.1, -1, 0, -1, 3, 2, 0, 2, 4;
  const LcpProblem problem =
      LcpProblem::FromDense("a b\n", A, Eigen::Vector3d(-1, 0, 0.1), RowBounds::WithBilateralRows(3, {1}));
  EXPECT_EQ(Format(problem),
            "NAME a_b_\nROWS\n N obj\nCOLUMNS\n f1 obj -1\n f2 obj 0\n f3 obj 0.10000000000000001\nRHS\nBOUNDS\n"
            " FR bounds f2\nQUADOBJ\n f1 f1 0.10000000000000001\n f1 f2 -1\n f2 f2 3\n f2 f3 2\n f3 f3 4\nENDATA\n");
}

TEST(QpsText, BoundedRowsHaveTheirBoundsAndFrictionIsOfNoQp) {
  const double infinity = std::numeric_limits<double>::infinity();
  const LcpProblem plain = LcpProblem::FromDense("p", Eigen::MatrixXd::Identity(4, 4), Eigen::VectorXd::Zero(4));
  const std::string text = Format(plain.WithBounds({{}, {}, {{0, -1, 0.5}, {1, -infinity, -2}, {3, 1, infinity}}}));
  EXPECT_NE(text.find("BOUNDS\n LO bounds f1 -1\n UP bounds f1 0.5\n MI bounds f2\n UP bounds f2 -2\n"
                      " LO bounds f4 1\nQUADOBJ\n"),
            std::string::npos)
      << text;
  ExpectRefused(
      [&] {
        Format(plain.WithBounds({{}, {{1, 0, 0.5}}, {}}));
      },
      "has friction rows, which the format has no place for; expected JSON lines", "problem 'p' ");
}

TEST(QpsText, AnUnsymmetricMatrixIsOfNoQp) {
  const LcpProblem problem =
      LcpProblem::FromDense("u", (Eigen::Matrix2d() << 1, 2, 3, 1).finished(), Eigen::Vector2d(1, 1));
  ExpectRefused([&] { Format(problem); }, "expected a symmetric A, as that of a QP is, found an asymmetry of 1",
                "problem 'u': ");
}

}  // namespace
}  // namespace lcpbench
