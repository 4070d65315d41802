#include "tests/solvers/io/read_lcp_file.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <vector>

#include "tests/fuzz/corpus.h"
#include "tests/fuzz/laws.h"
#include "tests/solvers/lcp/same_problem.h"
#include "tests/solvers/test_problems.h"
#include "tests/support/refusal.h"

namespace lcpbench {
namespace {

LcpRecord Parse(const std::string& line) { return ParseLcpRecord(line, "file:7"); }

TEST(JsonLines, EveryMatrixNotationMeansTheSame) {
  const LcpProblem rows = Parse(R"({"id":"a","A":[[1,2],[3,4]],"b":[5,6]})").problem;
  const LcpProblem flat = Parse(R"({"id":"a","n":2,"A":[1,2,3,4],"b":[5,6]})").problem;
  const LcpProblem sparse =
      Parse(R"({"A":{"shape":[2,2],"row":[1,0,0,1],"col":[1,0,1,0],"val":[4,1,2,3]},"b":[5,6]})").problem;
  EXPECT_EQ(rows.DenseA(), flat.DenseA());
  EXPECT_EQ(rows.DenseA(), sparse.DenseA());
  EXPECT_EQ(rows.DenseA()(0, 1), 2);
  EXPECT_EQ(rows.id(), "a");
  EXPECT_EQ(sparse.id(), "file:7");
}

TEST(JsonLines, FactorsWinOverA) {
  const LcpRecord record = Parse(R"({"A":[[99]],"J":[[1,0,2]],"invM":[1,1,"1/2"],"b":[-1],"bilateral":[0]})");
  EXPECT_TRUE(record.problem.has_factors());
  EXPECT_EQ(record.problem.DenseA()(0, 0), 3);
  EXPECT_TRUE(record.problem.is_bilateral(0));
}

TEST(JsonLines, RationalsRoundOnce) {
  const LcpProblem problem =
      Parse(
          R"({"A":[[1,0,0],[0,1,0],[0,0,1]],"b":["1/3","-010/7","100000000000000000000000/300000000000000000000001"]})")
          .problem;
  EXPECT_EQ(problem.b()[0], 1.0 / 3.0);
  EXPECT_EQ(problem.b()[1], -10.0 / 7.0);
  EXPECT_EQ(problem.b()[2], 1.0 / 3.0);  // the nearest double, although neither part is one
}

TEST(JsonLines, RecordedJointsAreBilateral) {
  EXPECT_TRUE(Parse(R"({"n":1,"A":[2],"b":[1],"contacts":[{"joint":true}]})").problem.is_bilateral(0));
  EXPECT_FALSE(Parse(R"({"n":1,"A":[2],"b":[1],"joint":[false]})").problem.is_bilateral(0));
}

TEST(JsonLines, RefusalsNameFileFieldExpectedAndFound) {
  for (const auto& refused : RefusalCases("json_lines")) {
    ExpectRefused([&] { Parse(refused[0]); }, refused[1], "file:7: ");
  }
  ExpectRefused([] { Parse(""); }, "", "file:7: ");
}

// What agrees, what is not known, and keys of others.
TEST(JsonLines, WhatIsSaidOfJointsAndAnswersIsTaken) {
  const std::string problem = R"({"A":[[2,1],[1,2]],"b":[1,2],)";
  for (const char* fields :
       {R"("bilateral":[1],"joint":[false,true],"contacts":[{},{"joint":true}])", R"("bilateral":[1],"joint":null)",
        R"("joint":[false,true],"contacts":[{"s1":0},{}])", R"("bilateral":null,"joint":[false,true])",
        R"("joint":[false,true],"status":null,"w":null,"f_minnorm":null,"f_unique":null,"rank_A":null,"category":null)",
        R"("bilateral":[1],"status":"failed","w":[null,null])", R"("bilateral":[1],"mine":{"b":1,"joint":"x"})"}) {
    const LcpProblem taken = Parse(problem + fields + "}").problem;
    EXPECT_EQ(taken.bilateral_rows(), std::vector<Index>{1}) << fields;
  }
}

TEST(JsonLines, ProblemsComeBackBitForBit) {
  std::vector<LcpProblem> problems = {LcpProblem::FromDense("no rows", {}, {}), EndsOfTheRange(),
                                      EndsOfTheRange({0, 1})};
  for (const TestProblem& test : GeneratedProblems()) {
    problems.push_back(test.problem);
    problems.push_back(InForm(test.problem, MatrixForm::kDense));
  }
  for (const LcpProblem& given : problems) {
    const LcpProblem back = Parse(FormatLcpRecord(given)).problem;
    EXPECT_EQ(back.id(), given.id());
    EXPECT_EQ(DifferenceOfProblems(back, given), "") << given.id();
  }
}

TEST(JsonLines, SolveRecordsStayValidJsonWhateverTheSolverLeft) {
  const LcpProblem problem = Parse(R"({"id":"x","A":[[1]],"b":[-1]})").problem;
  LcpResult result;
  result.status = LcpStatus::kSolved;
  result.f = Eigen::VectorXd::Constant(1, std::numeric_limits<double>::quiet_NaN());
  result.detail = "bytes \xff \" \n";
  const std::string line = FormatSolveRecord({problem, {}, ""}, "k", result, Verify(problem, result, 1e-9), {});
  const nlohmann::json record = nlohmann::json::parse(line);
  EXPECT_EQ(record["status"], "solved");
  EXPECT_TRUE(record["f"][0].is_null());
  EXPECT_TRUE(record["verdict"]["false_success"].get<bool>());
  EXPECT_EQ(line.find('\n'), std::string::npos);
}

TEST(JsonLines, ExactOracleRecordsAreReadWhole) {
  for (const LcpRecord& record : ReadLcpFile(LCPBENCH_SOURCE_DIR "/tests/data/oracle/lcp.jsonl")) {
    EXPECT_TRUE(record.problem.has_factors());
    EXPECT_NE(record.reference.status, LcpReference::Status::kUnknown);
    EXPECT_EQ(record.reference.w.has_value(), record.reference.status == LcpReference::Status::kSolved);
  }
}

TEST(ProblemLaws, HoldForTheCorporaAndTheirChanges) {
  ExpectLawHolds(BrokenJsonLineLaw, "json_lines_corpus", 20000, ChangesOfText());
  ExpectLawHolds(BrokenMatrixMarketLaw, "matrix_market_corpus", 20000, ChangesOfText());
}

}  // namespace
}  // namespace lcpbench
