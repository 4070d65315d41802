// Matrix Market files: round trips bit for bit, and one line for whatever is wrong with a file.

#include "solvers/io/matrix_market.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <random>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "solvers/io/json_lines.h"
#include "solvers/io/same_bits.h"
#include "support/output_error.h"
#include "tests/solvers/lcp/same_problem.h"
#include "tests/solvers/test_problems.h"
#include "tests/support/full_disk.h"
#include "tests/support/refusal.h"

namespace lcpbench {
namespace {

using MatrixMarket = FolderTest;

MarketMatrix ParseMarket(const std::string& text) {
  std::istringstream stream(text);
  return ReadMarketMatrix(stream, "file.mtx");
}

TEST_F(MatrixMarket, ProblemsComeBackBitForBit) {
  std::vector<LcpProblem> problems;
  for (const TestProblem& test : GeneratedProblems()) {
    problems.push_back(test.problem);
    problems.push_back(InForm(test.problem, MatrixForm::kSparse));
  }
  // Files of the same name take each other's place.
  for (const LcpProblem& given : problems) {
    SCOPED_TRACE(given.id());
    const std::string path = Path("p.mtx");
    WriteMarketProblem(given, path);
    const LcpProblem back = ReadMarketProblem(path).problem;
    EXPECT_EQ(DifferenceOfProblems(back, given), "");
    if (!given.has_factors()) continue;
    // name.mtx alone has the rounded matrix.
    std::ifstream file(path);
    EXPECT_TRUE(SameBits(ReadMarketMatrix(file, path).ToSparse(), given.SparseA()));
  }
}

TEST_F(MatrixMarket, AProblemIsWrittenCompletelyOrNotAtAll) {
  const std::string path = Path("p.mtx");
  const LcpProblem old = LcpProblem::FromDense("p", Eigen::MatrixXd::Identity(1, 1), Eigen::VectorXd::Zero(1));
  WriteMarketProblem(old, path);
  const std::vector<TestProblem> problems = GeneratedProblems();
  const LcpProblem& given = std::max_element(problems.begin(), problems.end(), [](const auto& a, const auto& b) {
                              return a.problem.size() < b.problem.size();
                            })->problem;
  for (const rlim_t bytes : {0, 100, 500, 1000}) {
    {
      const FullDisk full(bytes);
      EXPECT_THROW(WriteMarketProblem(given, path), OutputError) << bytes;
    }
    EXPECT_EQ(DifferenceOfProblems(ReadMarketProblem(path).problem, InForm(old, MatrixForm::kSparse)), "");
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_), {}), 2);
  }
  // The last file cannot be written, the others could.
  std::filesystem::remove(Path("p_b.mtx"));
  std::filesystem::create_directory(Path("p_b.mtx"));
  const std::string before = Bytes("p.mtx");
  EXPECT_THROW(WriteMarketProblem(given, path), InputError);
  EXPECT_EQ(Bytes("p.mtx"), before);
}

TEST_F(MatrixMarket, ReadsWhatTheFormatAllows) {
  const MarketMatrix general = ParseMarket(
      "%%MatrixMarket MATRIX Coordinate Real General\n% a comment\n\n 2 3  2 \r\n1 3 +1.5\n%another\n2 1 -2e-1\n\n");
  EXPECT_EQ(general.rows, 2);
  EXPECT_EQ(general.columns, 3);
  EXPECT_EQ(general.ToSparse().coeff(0, 2), 1.5);
  EXPECT_EQ(general.ToSparse().coeff(1, 0), -0.2);
  const MarketMatrix symmetric =
      ParseMarket("%%MatrixMarket matrix coordinate integer symmetric\n2 2 2\n1 1 3\n2 1 -4\n");
  EXPECT_EQ(symmetric.ToSparse().coeff(0, 1), -4);
  const MarketMatrix array = ParseMarket("%%MatrixMarket matrix array real symmetric\n2 2\n1\n2\n3\n");
  EXPECT_EQ(array.ToSparse().coeff(0, 1), 2);
  EXPECT_EQ(array.ToSparse().coeff(1, 1), 3);
  EXPECT_EQ(ParseMarket("%%MatrixMarket matrix array real general\n0 1\n").ToVector("x").size(), 0);
}

// The same bits, or refused in both.
TEST_F(MatrixMarket, NumbersAreThoseOfJson) {
  std::vector<std::string> words = {
      "1e-400", "-1e-400", "1e400",   "-1e400", "2e-324", "3e-324",  "2.4703282292062327e-324",
      "0e999",  "0.0",     "1e-9999", "1e9999", "-0.0",   "1.7e308", "1.8e308"};
  for (const std::string& zeros : {std::string(400, '0'), std::string(5000, '0')}) {
    for (const std::string& mantissa : {"0." + zeros + "1", "1" + zeros}) {
      words.push_back(mantissa);
      for (const char* exponent : {"e399", "e-399", "e401", "e-401", "e5001", "e-5001", "e9999", "e-9999"}) {
        words.push_back(mantissa + exponent);
      }
    }
  }
  std::mt19937_64 random(42);
  for (int k = 0; k < 3000; ++k) {
    const int exponent = static_cast<int>(random() % 760) - 400;
    words.push_back((k % 2 == 0 ? "-" : "") + std::to_string(random() % 10) + "." + std::to_string(random()) + "e" +
                    std::to_string(exponent));
  }
  int refused = 0;
  for (const std::string& word : words) {
    std::optional<double> by_json, by_market;
    const std::string why_json =
        RefusalOf([&] { by_json = ParseLcpRecord(R"({"A":[[1]],"b":[)" + word + "]}", "line").problem.b()[0]; });
    const std::string why_market = RefusalOf([&] {
      by_market = ParseMarket("%%MatrixMarket matrix array real general\n1 1\n" + word + "\n").ToVector("x")[0];
    });
    EXPECT_EQ(why_json.empty(), why_market.empty()) << word << ": " << why_json << why_market;
    refused += why_json.empty() ? 0 : 1;
    if (by_json && by_market) {
      EXPECT_TRUE(SameBits(&*by_json, &*by_market, 1)) << word;
    }
  }
  EXPECT_GT(refused, 100);
}

TEST_F(MatrixMarket, WhatIsWrongIsOneLineWithItsPlace) {
  for (const auto& refused : RefusalCases("matrix_market")) ExpectRefused([&] { ParseMarket(refused[0]); }, refused[1]);
}

TEST_F(MatrixMarket, FilesThatDoNotFitEachOtherAreNamed) {
  const auto expect = [&](const std::string& text) { ExpectRefused([&] { ReadMarketProblem(Path("p.mtx")); }, text); };
  const std::string array = "%%MatrixMarket matrix array real general\n";
  expect("p_b.mtx: cannot be opened");
  Write("p_b.mtx", array + "2 1\n-1\n-2\n");
  expect("p.mtx: cannot be opened; expected the matrix A");
  Write("p.mtx", array + "2 3\n1\n0\n0\n1\n0\n0\n");
  expect("p.mtx: expected 2 x 2 entries, found 2 x 3");
  Write("p.mtx", array + "2 2\n1\n0\n0\n1\n");
  EXPECT_EQ(ReadMarketProblem(Path("p.mtx")).problem.size(), 2);
  Write("p_bilateral.mtx", array + "1 1\n3\n");
  expect("expected row numbers from 1 to 2, found 3");
  Write("p_bilateral.mtx", array + "1 1\n2\n");
  EXPECT_EQ(ReadMarketProblem(Path("p.mtx")).problem.bilateral_rows(), std::vector<Index>{1});
  Write("p_x.mtx", array + "3 1\n1\n2\n3\n");
  expect("p_x.mtx: expected 2 x 1 entries, found 3 x 1");
  Write("p_x.mtx", array + "2 1\n1\n2\n");
  EXPECT_EQ((*ReadMarketProblem(Path("p.mtx")).x)[1], 2);
  Write("p_J.mtx", array + "2 3\n1\n0\n0\n1\n0\n0\n");
  expect("p_invM.mtx: cannot be opened; expected both factors");
  Write("p_invM.mtx", array + "2 1\n1\n1\n");
  expect("p_J.mtx: expected 2 x 2 entries, found 2 x 3");
  Write("p_invM.mtx", "%%MatrixMarket matrix coordinate real general\n2000000000 1 0\n");
  expect("p_invM.mtx: expected an array for a vector of 2000000000 entries");
}

}  // namespace
}  // namespace lcpbench
