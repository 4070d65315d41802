// Formats that the Python program reads and writes: problems come back bit for bit, and so do refusals.
// python/tests/formats/ tests the formats themselves.

#include "benchmarks/collection/format_program.h"

#include "tests/solvers/lcp/same_problem.h"
#include "tests/solvers/test_problems.h"
#include "tests/support/refusal.h"

namespace lcpbench {
namespace {

// Each file is read by a process of its own, which takes a while. Ranks, joints and degenerate rows take turns of 16,
// so that every fifth problem has all of them together.
std::vector<TestProblem> EveryFifthProblem() {
  const std::vector<TestProblem> all = GeneratedProblems();
  std::vector<TestProblem> some;
  for (std::size_t k = 0; k < all.size(); k += 5) some.push_back(all[k]);
  return some;
}

class FormatProgram : public FolderTest {
 protected:
  LcpProblem Back(const LcpProblem& problem, const std::string& ending) const {
    const std::string path = Path("p." + ending);
    FormatNamed(ending).write(problem, path);
    return ReadProblemFile(path, {});
  }
};

TEST_F(FormatProgram, ProblemsComeBackBitForBit) {
  int mixed = 0, plain = 0;
  for (const TestProblem& test : EveryFifthProblem()) {
    SCOPED_TRACE(test.problem.id());
    (test.problem.bilateral_rows().empty() ? plain : mixed) += 1;
    const LcpProblem sparse = InForm(test.problem, MatrixForm::kSparse);
    const LcpProblem dense = InForm(test.problem, MatrixForm::kDense);
    const LcpProblem back = Back(test.problem, "hdf5");
    EXPECT_EQ(back.id(), test.problem.id());
    EXPECT_EQ(DifferenceOfProblems(back, test.problem), "");
    EXPECT_EQ(DifferenceOfProblems(Back(sparse, "hdf5"), sparse), "");
    EXPECT_EQ(DifferenceOfProblems(Back(dense, "dat"), dense), "");
    EXPECT_EQ(Back(dense, "dat").given_form(), MatrixForm::kDense);
    // Others hold the rounded matrix of factors.
    EXPECT_EQ(DifferenceOfProblems(Back(test.problem, "dat"), sparse), "");
    EXPECT_EQ(Back(test.problem, "npz").DenseA(), dense.DenseA());
    const LcpProblem program = Back(sparse, "qps");
    EXPECT_EQ(program.DenseA(), dense.DenseA());
    EXPECT_EQ(program.bilateral_rows(), sparse.bilateral_rows());
  }
  EXPECT_GT(mixed, 8);
  EXPECT_GT(plain, 8);
}

TEST_F(FormatProgram, TheEndsOfTheRangeComeBackToo) {
  // Unsymmetric where all rows are of one kind.
  for (const LcpProblem& dense : {EndsOfTheRange(), EndsOfTheRange({0, 1})}) {
    const LcpProblem problem = InForm(dense, MatrixForm::kSparse);
    for (const char* ending : {"hdf5", "dat"}) EXPECT_EQ(DifferenceOfProblems(Back(problem, ending), problem), "");
    EXPECT_EQ(Back(problem, "hdf5").id(), problem.id());
  }
  for (const char* ending : {"hdf5", "dat", "qps", "npz"}) {
    EXPECT_EQ(Back(LcpProblem::FromSparse("none", SparseMatrix(), {}), ending).size(), 0) << ending;
  }
}

// In any order of rows, and with contacts that have none.
TEST_F(FormatProgram, FrictionInThePlaneAndBoundsComeBackBitForBit) {
  std::mt19937 random(7);
  for (const TestProblem& test : EveryFifthProblem()) {
    std::vector<Index> unilateral;
    for (Index row = 0; row < test.problem.size(); ++row) {
      if (!test.problem.is_bilateral(row)) unilateral.push_back(row);
    }
    std::shuffle(unilateral.begin(), unilateral.end(), random);
    RowBounds friction = test.problem.bounds(), bounded = friction;
    for (std::size_t k = 0; k + 2 < unilateral.size(); k += 3) {
      friction.friction.push_back({unilateral[k], unilateral[k + 1], 0.1 * static_cast<double>(k + 1)});
      bounded.bounded.push_back({unilateral[k], -0.1 * static_cast<double>(k), 0.5});
    }
    const LcpProblem contacts = test.problem.WithBounds(friction);
    EXPECT_EQ(DifferenceOfProblems(Back(contacts, "hdf5"), contacts), "") << contacts.id();
    const LcpProblem limits = InForm(test.problem, MatrixForm::kDense).WithBounds(bounded);
    EXPECT_EQ(DifferenceOfProblems(Back(limits, "npz"), limits), "") << limits.id();
  }
}

TEST_F(FormatProgram, TellsWhatItRefusesAndGoesOn) {
  const LcpProblem problem = GeneratedProblems()[5].problem;
  Write("wrong.dat", "2\n0\n2\n2\n2 2\n1 2\n3");
  for (const std::string& bytes : {std::string("a\xe4\n"), std::string("plain")}) {  // names are any bytes
    const std::string path = Path(bytes + ".dat");
    FormatNamed("dat").write(problem, path);
    ExpectRefused([&] { ReadProblemFile(Path("wrong.dat"), {}); }, "expected number 4 of the 4 of a matrix",
                  Path("wrong.dat") + ":7: ");
    EXPECT_EQ(ReadProblemFile(path, {}).size(), problem.size());
  }
  // What is no problem: the program reads it, and LcpProblem refuses.
  Write("row.dat", "1 0 1 1 1 1 1e999 1");
  ExpectRefused([&] { ReadProblemFile(Path("row.dat"), {}); }, "to be finite, found '1e999'", Path("row.dat") + ":1: ");
}

}  // namespace
}  // namespace lcpbench
