#include "tests/solvers/io/read_lcp_file.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <vector>

#include "tests/solvers/lcp/same_problem.h"
#include "tests/solvers/test_problems.h"
#include "tests/support/refusal.h"

namespace lcpbench {
namespace {

LcpRecord Parse(const std::string& line) { return ParseLcpRecord(line, "file:7"); }

std::string Refusal(const std::string& line) {
  return RefusalOf([&] { Parse(line); });
}

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
  EXPECT_EQ(Refusal(R"({"A":[[1]],"b":[1,2]})"), "file:7: /A: expected 2 rows of 2 columns, found an array of 1");
  EXPECT_EQ(Refusal(R"({"A":[[1]]})"), "file:7: /b: missing field, expected an array");
  EXPECT_EQ(Refusal(R"({"b":[1]})"), "file:7: expected field 'A', or 'J' with 'invM'");
  EXPECT_EQ(Refusal(R"({"J":[[1,0,0]],"b":[1]})"), "file:7: /invM: missing field, expected an array");
  EXPECT_EQ(Refusal(R"({"A":[["x"]],"b":[1]})"), "file:7: /A/0/0: expected a finite number or \"p/q\", found \"x\"");
  EXPECT_EQ(Refusal(R"({"n":3,"A":[[1]],"b":[1]})"), "file:7: /n: expected the length of b, 1, found 3");
  EXPECT_EQ(Refusal(R"({"A":[[1]],"b":[1],"bilateral":[1]})"),
            "file:7: /bilateral/0: expected an integer in [0, 1), found 1");
}

TEST(JsonLines, WhatIsSaidOfJointsAndAnswersIsTakenOrRefused) {
  // Behind "A" and "b" of two rows.
  const std::pair<const char*, const char*> kRefused[] = {
      {R"("joint":"x")", "/joint: expected an array of 2, found \"x\""},
      {R"("joint":true)", "/joint: expected an array of 2, found true"},
      {R"("joint":[true])", "/joint: expected an array of 2, found an array of 1"},
      {R"("joint":["x",true])", "/joint/0: expected true or false, found \"x\""},
      {R"("joint":[1,0])", "/joint/0: expected true or false, found 1"},
      {R"("bilateral":"x")", "/bilateral: expected an array, found \"x\""},
      {R"("contacts":"x")", "/contacts: expected an array of 2, found \"x\""},
      {R"("contacts":[{"joint":"x"},{}])", "/contacts/0/joint: expected true or false, found \"x\""},
      {R"("bilateral":[0],"joint":[false,true])", "/joint: contradicts 'bilateral', expected the same bilateral rows"},
      {R"("bilateral":[],"joint":[false,true])", "/joint: contradicts 'bilateral'"},
      {R"("bilateral":[0],"contacts":[{"joint":false},{}])", "/contacts: contradicts 'bilateral'"},
      {R"("joint":[true,true],"contacts":[{"joint":true},{}])", "/contacts: contradicts 'joint'"},
      {R"("b":[1,2])", "/b: this key is given twice"},
      {R"("joint":[true,false],"joint":[false,false])", "/joint: this key is given twice"},
      {R"("more":[{},{"x":1,"x":1}])", "/more/1/x: this key is given twice"},
      {R"("status":1)", "/status: expected a string, found 1"},
      {R"("status":["solved"])", "/status: expected a string, found an array of 1"},
      {R"("status":"solved","w":1)", "/w: expected an array of 2, found 1"},
      {R"("status":"solved","w":[0,"x"])", "/w/1: expected a finite number"},
      {R"("w":"x")", "/w: expected an array of 2, found \"x\""},
      {R"("f_minnorm":[0])", "/f_minnorm: expected an array of 2, found an array of 1"},
      {R"("f_unique":1)", "/f_unique: expected true or false, found 1"},
      {R"("rank_A":"2")", "/rank_A: expected an integer in [0, 3), found \"2\""},
      {R"("rank_A":1.5)", "/rank_A: expected an integer in [0, 3), found 1.5"},
      {R"("rank_A":3)", "/rank_A: expected an integer in [0, 3), found 3"},
      {R"("category":7)", "/category: expected a string, found 7"},
  };
  const std::string problem = R"({"A":[[2,1],[1,2]],"b":[1,2],)";
  for (const auto& [fields, refusal] : kRefused) {
    ExpectRefused([&, line = problem + fields + "}"] { Parse(line); }, refusal, "file:7: ");
  }
  // What agrees, what is not known, and keys of others.
  for (const char* fields :
       {R"("bilateral":[1],"joint":[false,true],"contacts":[{},{"joint":true}])", R"("bilateral":[1],"joint":null)",
        R"("joint":[false,true],"contacts":[{"s1":0},{}])", R"("bilateral":null,"joint":[false,true])",
        R"("joint":[false,true],"status":null,"w":null,"f_minnorm":null,"f_unique":null,"rank_A":null,"category":null)",
        R"("bilateral":[1],"status":"failed","w":[null,null])", R"("bilateral":[1],"mine":{"b":1,"joint":"x"})"}) {
    const LcpProblem taken = Parse(problem + fields + "}").problem;
    EXPECT_EQ(taken.bilateral_rows(), std::vector<Index>{1}) << fields;
  }
}

TEST(JsonLines, MalformedLinesAreRefusedInOneLine) {
  const std::vector<std::string> lines = {
      "",
      "{",
      "[1,2]",
      "null",
      R"({"A":[[1]],"b":[NaN]})",
      R"({"A":[[1]],"b":[1e999]})",
      R"({"A":[[1]],"b":["1/0"]})",
      R"({"A":[[1]],"b":["1/-2"]})",
      R"({"A":[[1]],"b":[""]})",
      R"({"A":[[1]],"b":[null]})",
      R"({"A":[[1]],"b":{"x":1}})",
      R"({"A":5,"b":[1]})",
      R"({"A":[[1,2]],"b":[1]})",
      R"({"A":[1,2],"b":[1]})",
      R"({"A":{"shape":[1,1],"row":[0],"col":[0]},"b":[1]})",
      R"({"A":{"shape":[1,1],"row":[0],"col":[1],"val":[1]},"b":[1]})",
      R"({"A":{"shape":[1,1],"row":[-1],"col":[0],"val":[1]},"b":[1]})",
      R"({"A":{"shape":[1,1],"row":[0,0],"col":[0],"val":[1]},"b":[1]})",
      R"({"A":{"shape":[1000000000000,1000000000000],"row":[],"col":[],"val":[]},"b":[1]})",
      R"({"J":[[1,0,0]],"invM":[1,-1,1],"b":[1]})",
      R"({"J":[[1,0]],"invM":[1,1,1],"b":[1]})",
      R"({"A":[[1]],"b":[1],"bilateral":[0,0]})",
      R"({"A":[[1]],"b":[1],"bilateral":[0.5]})",
      R"({"id":{},"A":[[1]],"b":[1]})",
      R"({"A":[[1]],"b":[1],"status":"solved","w":[1,2]})",
  };
  for (const std::string& line : lines) ExpectRefused([&] { Parse(line); }, "", "file:7: ");
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

}  // namespace
}  // namespace lcpbench
