// Our QPS files and the reader of CoinUtils, which Clp has. Built where the library is.

#include <CoinMpsIO.hpp>

#include "benchmarks/collection/problem_formats.h"
#include "tests/solvers/test_problems.h"
#include "tests/support/refusal.h"

namespace lcpbench {
namespace {

class QpsReader : public FolderTest {};

TEST_F(QpsReader, ReadsTheProblemBitForBit) {
  int mixed = 0;
  for (const TestProblem& test : GeneratedProblems()) {
    const LcpProblem& problem = test.problem;
    if (problem.size() == 0) continue;
    SCOPED_TRACE(problem.id());
    mixed += problem.bilateral_rows().empty() ? 0 : 1;
    FormatNamed("qps").write(problem, Path("p.qps"));
    CoinMpsIO reader;
    reader.messageHandler()->setLogLevel(0);
    ASSERT_EQ(reader.readMps(Path("p.qps").c_str(), ""), 0);
    const auto n = static_cast<int>(problem.size());
    ASSERT_EQ(reader.getNumCols(), n);
    ASSERT_EQ(reader.getNumRows(), 0);
    for (int i = 0; i < n; ++i) {
      EXPECT_EQ(reader.getObjCoefficients()[i], problem.b()[i]);
      EXPECT_EQ(reader.getColLower()[i], problem.is_bilateral(i) ? -reader.getInfinity() : 0);
      EXPECT_EQ(reader.getColUpper()[i], reader.getInfinity());
    }
    int *starts = nullptr, *rows = nullptr;
    double* values = nullptr;
    ASSERT_EQ(reader.readQuadraticMps(nullptr, starts, rows, values, 0), 0);  // no symmetry is asked for
    const std::unique_ptr<int[]> starts_owner(starts), rows_owner(rows);
    const std::unique_ptr<double[]> values_owner(values);
    Eigen::MatrixXd P = Eigen::MatrixXd::Zero(n, n);
    for (int column = 0; column < n; ++column) {
      for (int k = starts[column]; k < starts[column + 1]; ++k) P(rows[k], column) = P(column, rows[k]) = values[k];
    }
    EXPECT_EQ(P, problem.DenseA());
  }
  EXPECT_GT(mixed, 10);
}

}  // namespace
}  // namespace lcpbench
