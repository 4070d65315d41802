// Our text files and Siconos' own reader and writer: the same numbers. Built where the library is.

#include <LinearComplementarityProblem.h>
#include <MixedLinearComplementarityProblem.h>
#include <NumericsMatrix.h>

#include <cstdio>

#include "benchmarks/collection/problem_formats.h"
#include "tests/solvers/lcp/same_problem.h"
#include "tests/solvers/test_problems.h"
#include "tests/support/refusal.h"

namespace lcpbench {
namespace {

class SiconosLibrary : public FolderTest {
 protected:
  const std::string path_ = Path("p.dat");
};

void ExpectSame(const LcpProblem& problem, NumericsMatrix* M, const double* q) {
  const auto n = static_cast<int>(problem.size());
  ASSERT_EQ(M->size0, n);
  ASSERT_EQ(M->size1, n);
  for (int i = 0; i < n; ++i) {
    EXPECT_EQ(q[i], problem.b()[i]);
    for (int j = 0; j < n; ++j) EXPECT_EQ(NM_get_value(M, i, j), problem.DenseA()(i, j)) << i << ' ' << j;
  }
}

void ExpectReadByTheLibrary(const LcpProblem& problem, const std::string& path) {
  FormatNamed("dat").write(problem, path);
  if (problem.bilateral_rows().empty()) {
    LinearComplementarityProblem* read = newLCP();
    linearComplementarity_newFromFilename(read, path.c_str());
    ASSERT_EQ(read->size, problem.size());
    ExpectSame(problem, read->M, read->q);
    freeLinearComplementarityProblem(read);
    return;
  }
  MixedLinearComplementarityProblem* read = mixedLinearComplementarity_new();
  mixedLinearComplementarity_newFromFilename(read, path.c_str());
  const auto equations = static_cast<int>(problem.bilateral_rows().size());
  ASSERT_EQ(read->n, equations);
  ASSERT_EQ(read->m, problem.size() - equations);
  for (int block = 0; read->blocksRows[block] < read->n + read->m; ++block) {
    for (int row = read->blocksRows[block]; row < read->blocksRows[block + 1]; ++row) {
      EXPECT_EQ(read->blocksIsComp[block] == 0, problem.is_bilateral(row)) << row;
    }
  }
  ExpectSame(problem, read->M, read->q);
  mixedLinearComplementarity_free(read);
}

TEST_F(SiconosLibrary, ReadsOurFiles) {
  for (const TestProblem& test : GeneratedProblems()) {
    SCOPED_TRACE(test.problem.id());
    ExpectReadByTheLibrary(InForm(test.problem, MatrixForm::kDense), path_);
    ExpectReadByTheLibrary(InForm(test.problem, MatrixForm::kSparse), path_);
  }
}

TEST_F(SiconosLibrary, WritesFilesThatWeRead) {
  for (const TestProblem& test : GeneratedProblems()) {
    const LcpProblem problem = InForm(test.problem, MatrixForm::kDense);
    if (!problem.bilateral_rows().empty()) continue;
    SCOPED_TRACE(problem.id());
    const auto n = static_cast<int>(problem.size());
    LinearComplementarityProblem* given = newLCP();
    given->size = n;
    given->M = NM_create(NM_DENSE, n, n);
    std::copy_n(problem.DenseA().data(), n * n, given->M->matrix0);
    given->q = static_cast<double*>(std::malloc(sizeof(double) * static_cast<size_t>(n)));
    std::copy_n(problem.b().data(), n, given->q);
    std::FILE* file = std::fopen(path_.c_str(), "w");
    ASSERT_NE(file, nullptr);
    linearComplementarity_printInFile(given, file);
    std::fclose(file);
    freeLinearComplementarityProblem(given);
    EXPECT_EQ(DifferenceOfProblems(ReadProblemFile(path_, {}), problem), "");
  }
}

TEST_F(SiconosLibrary, WritesMixedFilesThatWeRead) {
  // Columns of M, equations in the middle.
  double M[] = {4, 1, 0, 0, 3, 7, -1, 0, 2};
  double q[] = {-1, 0.1, -2};
  int first_rows[] = {0, 1, 2, 3};
  int kinds[] = {1, 0, 1};
  MixedLinearComplementarityProblem given{};
  given.isStorageType1 = 1;
  given.n = 1;
  given.m = 2;
  given.blocksRows = first_rows;
  given.blocksIsComp = kinds;
  given.M = NM_create_from_data(NM_DENSE, 3, 3, M);
  given.q = q;
  std::FILE* file = std::fopen(path_.c_str(), "w");
  ASSERT_NE(file, nullptr);
  mixedLinearComplementarity_printInFile(&given, file);
  std::fclose(file);
  std::free(given.M);
  const LcpProblem read = ReadProblemFile(path_, {});
  EXPECT_EQ(read.DenseA(), (Eigen::Map<const Eigen::Matrix3d>(M)));
  EXPECT_EQ(read.b(), (Eigen::Map<const Eigen::Vector3d>(q)));
  EXPECT_EQ(read.bilateral_rows(), std::vector<Index>{1});
}

}  // namespace
}  // namespace lcpbench
