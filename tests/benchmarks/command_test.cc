// The lcpbench command as its users meet it: exit status, standard output, standard error.

#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "model/scenes/scene.h"
#include "solvers/io/json_lines.h"
#include "solvers/peers/protocol/external_solver.h"
#include "solvers/registry.h"
#include "tests/benchmarks/command_fixture.h"
#include "tests/solvers/test_problems.h"
#include "tests/solvers_under_test.h"

namespace lcpbench {
namespace {

namespace fs = std::filesystem;

using Outcome = CommandOutcome;

std::vector<std::string> Lines(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

class Command : public CommandTest {
 protected:
  void ExpectMisuse(const std::string& arguments, const std::string& mentions, const std::string& input = "") {
    const Outcome outcome = Run(arguments, input);
    EXPECT_EQ(outcome.status, 2) << arguments;
    EXPECT_EQ(Lines(outcome.error).size(), 1u) << arguments << "\n" << outcome.error;
    EXPECT_NE(outcome.error.find(mentions), std::string::npos) << arguments << "\n" << outcome.error;
  }
};

constexpr char kProblem[] = R"({"id":"p","A":[[2,1],[1,2]],"b":[-5,-4]})";

TEST_F(Command, HelpIsEverywhere) {
  for (const char* sub : {"", "list", "list solvers", "generate", "solve", "certify", "convert", "assemble", "run",
                          "report", "analyse", "compare"}) {
    const Outcome outcome = Run(std::string(sub) + " --help");
    EXPECT_EQ(outcome.status, 0) << sub;
    EXPECT_NE(outcome.out.find("sage: "), std::string::npos) << sub;
    EXPECT_EQ(outcome.error, "") << sub;
  }
}

TEST_F(Command, ServeGivesTheBitsOfTheSolverInThisProcess) {
  const LcpProblem problem = ParseLcpRecord(kProblem, "test").problem;
  for (const char* key : {"auto", "dantzig"}) {
    ExternalSolver served({{LCPBENCH_COMMAND, "serve", key}});
    EXPECT_EQ(served.Greet().name, key);
    LcpResult there;
    LcpResult here;
    served.Solve(problem, {}, &there);
    MakeSolver(key)->Solve(problem, {}, &here);
    EXPECT_EQ(there.status, LcpStatus::kSolved);
    EXPECT_EQ(there.f, here.f);
    EXPECT_GT(there.own_fresh_s, 0);
    const std::vector<ProblemArrays> stream{ProblemArrays::Of(problem), ProblemArrays::Of(problem)};
    PassRequest request;
    request.time_limit_s = request.budget_s = 1;
    request.warm_up = {0};
    request.order = {1};
    served.LoadStream(stream);
    EXPECT_EQ(served.RunPass(request, 10).at(0).f, here.f);
  }
  ExpectMisuse("serve nobody", "unknown solver 'nobody'");
  ExpectMisuse("serve auto no-such-option=1", "no-such-option");
}

TEST_F(Command, ListsStartWithTheKey) {
  const std::vector<std::string> solvers = Lines(Run("list solvers").out);
  ASSERT_EQ(solvers.size(), AllSolvers().size());
  for (size_t i = 0; i < solvers.size(); ++i) {
    const SolverEntry& entry = AllSolvers()[i];
    EXPECT_TRUE(solvers[i].starts_with(entry.key));
    EXPECT_NE(solvers[i].find(entry.licence), std::string::npos) << solvers[i];
    EXPECT_EQ(solvers[i].ends_with("(not in this build)"), !entry.available) << solvers[i];
    // A version: a digit, a point, a digit.
    if (entry.available) {
      EXPECT_TRUE(std::regex_search(solvers[i], std::regex("\\[.* [0-9]+\\.[0-9].*\\]"))) << solvers[i];
    }
  }
  const std::vector<std::string> scenes = Lines(Run("list scenes").out);
  ASSERT_EQ(scenes.size(), AllScenes().size());
  for (size_t i = 0; i < scenes.size(); ++i) EXPECT_TRUE(scenes[i].starts_with(AllScenes()[i].key));
  EXPECT_TRUE(Run("list metrics").out.starts_with("rho "));
}

TEST_F(Command, MisuseIsOneLineAndStatusTwo) {
  ExpectMisuse("", "subcommand");
  ExpectMisuse("frobnicate", "frobnicate");
  ExpectMisuse("solve", "--solver");
  ExpectMisuse("solve --solver simplex -", "unknown solver 'simplex'", kProblem);
  ExpectMisuse("solve --solver dantzig no-such-file.jsonl", "no-such-file.jsonl");
  ExpectMisuse("solve --solver dantzig /", "is a folder");
  ExpectMisuse("solve --solver dantzig --tolerance 0 -", "--tolerance", kProblem);
  ExpectMisuse("solve --solver dantzig --tolerance x -", "--tolerance", kProblem);
  ExpectMisuse("solve --solver dantzig --time-limit -1 -", "--time-limit", kProblem);
  ExpectMisuse("solve --solver pgs --set relaxation=5 -", "relaxation", kProblem);
  ExpectMisuse("solve --solver pgs --set nonsense -", "NAME=VALUE", kProblem);
  ExpectMisuse("solve --solver pgs --set nonsense=1 -", "nonsense", kProblem);
  // Every one counts where there are several.
  ExpectMisuse("solve --solver pgs --set relaxation=1.2 --set nonsense=1 -", "nonsense", kProblem);
  ExpectMisuse("solve --solver pgs --set nonsense=1 --set relaxation=1.2 -", "nonsense", kProblem);
  ExpectMisuse("solve --solver dantzig -", "empty", "");
  ExpectMisuse("assemble -", "empty", "\n\n");
  ExpectMisuse("assemble -", "<stdin>:1", "{");
  ExpectMisuse("generate no-such-scene", "no-such-scene");
  ExpectMisuse("generate disc-pile --size 0", "0");
  ExpectMisuse("generate disc-pile --size -5", "-5");
  ExpectMisuse("run --suite huge", "huge");
  ExpectMisuse("run --suite default", "expected one of quick, core");
  ExpectMisuse("run --suite quick --solvers simplex -o " + Path("r"), "simplex");
  ExpectMisuse("run --filter ')|(' -o " + Path("r"), "--filter: expected a regular expression");
  for (const char* option : {"--nonsense", "--scenes disc-pile", "--sizes 10", "--seeds 1", "--benchmark_color=true"}) {
    const std::string text = option;
    ExpectMisuse("run " + text + " -o " + Path("r"), text.substr(0, text.find(' ')));
  }
  EXPECT_FALSE(fs::exists(folder_ / "r"));
}

TEST_F(Command, SolveJudgesEveryLineAndKeepsGoingAfterABadOne) {
  Write("problems.jsonl", std::string(kProblem) + "\n{\"A\":[[1]]}\n" + R"({"id":"q","A":[[1]],"b":[3]})" + "\n");
  const Outcome outcome = Run("solve --solver dantzig " + Path("problems.jsonl"));
  EXPECT_EQ(outcome.status, 2);
  EXPECT_EQ(Lines(outcome.error).size(), 1u);
  EXPECT_NE(outcome.error.find("problems.jsonl:2"), std::string::npos);
  const std::vector<std::string> lines = Lines(outcome.out);
  ASSERT_EQ(lines.size(), 2u);
  const nlohmann::json first = nlohmann::json::parse(lines[0]);
  for (const char* field : {"id", "solver", "status", "f", "w", "iterations", "time_s", "metrics", "verdict"}) {
    EXPECT_TRUE(first.contains(field)) << field;
  }
  EXPECT_EQ(first["status"], "solved");
  EXPECT_NEAR(first["f"][0].get<double>(), 2, 1e-9);
  EXPECT_TRUE(first["verdict"]["passes"].get<bool>());
  EXPECT_EQ(nlohmann::json::parse(lines[1])["id"], "q");
}

TEST_F(Command, SolveJudgesByTheToleranceAloneUnlessAskedForTheFloor) {
  Write("heavy.jsonl", FormatLcpRecord(MakeStackedColumn(200, 1e6).problem) + "\n");
  const Outcome strict = Run("solve --solver dantzig --tolerance 1e-9 " + Path("heavy.jsonl"));
  const Outcome relative = Run("solve --solver dantzig --tolerance 1e-9 --floor " + Path("heavy.jsonl"));
  ASSERT_EQ(strict.status, 0) << strict.error;
  ASSERT_EQ(relative.status, 0) << relative.error;
  const nlohmann::json by_tolerance = nlohmann::json::parse(strict.out);
  const nlohmann::json by_floor = nlohmann::json::parse(relative.out);
  // The floor of the answer is told either way.
  EXPECT_GT(by_tolerance["metrics"]["answer_floor"].get<double>(), 1e-9);
  EXPECT_TRUE(by_tolerance["metrics"]["floor"].is_null());
  const double floor = by_floor["metrics"]["floor"].get<double>();
  EXPECT_NEAR(floor, by_floor["metrics"]["answer_floor"].get<double>(), 1e-3 * floor);
  EXPECT_EQ(by_tolerance["f"], by_floor["f"]);
  EXPECT_FALSE(by_tolerance["verdict"]["at_floor"].get<bool>());
  EXPECT_FALSE(by_tolerance["verdict"]["passes"].get<bool>());
  EXPECT_TRUE(by_floor["verdict"]["passes"].get<bool>());
  EXPECT_TRUE(by_floor["verdict"]["at_floor"].get<bool>());
}

TEST_F(Command, EverySolverSolvesWhatGenerateWrites) {
  for (const SceneFamily& scene : AllScenes()) {
    const Outcome generated = Run("generate " + std::string(scene.key) + " --size 12 --seed 3");
    ASSERT_EQ(generated.status, 0) << generated.error;
    EXPECT_EQ(generated.out, Run("generate " + std::string(scene.key) + " --size 12 --seed 3").out);
    EXPECT_NE(generated.out, Run("generate " + std::string(scene.key) + " --size 12 --seed 4").out);
    for (const SolverEntry& entry : OwnSolversAndAPeerOfEachLibrary()) {
      const Outcome solved = Run("solve --solver " + std::string(entry.key) + " --tolerance 1e-3 -", generated.out);
      ASSERT_EQ(solved.status, 0) << solved.error;
      const nlohmann::json record = nlohmann::json::parse(solved.out);
      EXPECT_EQ(record["f"].size(), 12u);
      EXPECT_FALSE(entry.origin == SolverOrigin::kOwn && record["verdict"]["false_success"].get<bool>());
    }
  }
}

TEST_F(Command, ReportNamesWhatItCannotTake) {
  ExpectMisuse("report", "FOLDER");
  ExpectMisuse("report " + Path("nothing-here"), "nothing-here");
  ExpectMisuse("report " + folder_.string(), "expected the files of a campaign");
  Write("campaign.json", "{}");
  ExpectMisuse("report " + folder_.string(), "schema");
  ExpectMisuse("report " + folder_.string() + " --motion " + Path("stdin"), "motion.csv");
  ExpectMisuse("report " + folder_.string() + " --motion " + folder_.string(), "motion.csv");
  ExpectMisuse("report " + folder_.string() + " --nonsense", "--nonsense");
}

TEST_F(Command, CertifyAnswersInFractions) {
  const Outcome outcome = Run("certify -", R"({"id":"p","A":[[2,1],[1,"7/3"]],"b":[-5,"-1/3"]})"
                                           "\n"
                                           R"({"id":"q","A":[[1,-1],[-1,1]],"b":[-1,0]})"
                                           "\n");
  EXPECT_EQ(outcome.status, 0) << outcome.error;
  const std::vector<std::string> lines = Lines(outcome.out);
  ASSERT_EQ(lines.size(), 2u);
  const nlohmann::json solved = nlohmann::json::parse(lines[0]);
  EXPECT_EQ(solved["status"], "solved");
  EXPECT_EQ(solved["certified"], true);
  EXPECT_EQ(solved["w_exact"], nlohmann::json({"0", "13/6"}));
  EXPECT_EQ(solved["f_exact"], nlohmann::json({"5/2", "0"}));
  EXPECT_EQ(solved["f_unique"], true);
  EXPECT_EQ(solved["rank_A"], 2);
  const nlohmann::json infeasible = nlohmann::json::parse(lines[1]);
  EXPECT_EQ(infeasible["status"], "infeasible");
  EXPECT_EQ(infeasible["certified"], true);
  EXPECT_EQ(infeasible["ray_exact"], nlohmann::json({"1", "1"}));
  const nlohmann::json rounded = nlohmann::json::parse(Run("certify --rounded -", std::string(kProblem) + "\n").out);
  EXPECT_FALSE(rounded.contains("w_exact"));
  EXPECT_EQ(rounded["w"], nlohmann::json({0.0, 0.0}));
}

TEST_F(Command, CertifyBoundsWhatIsTooLargeToBeExact) {
  const std::string problems =
      Run("generate disc-pile --size 40 --seed 1").out + Run("generate roller-bearing --size 60 --seed 1").out;
  const std::vector<std::string> exact = Lines(Run("certify --exact-up-to 60 -", problems).out);
  const std::vector<std::string> bounded = Lines(Run("certify --exact-up-to 39 -", problems).out);
  ASSERT_EQ(exact.size(), 2u);
  ASSERT_EQ(bounded.size(), 2u);
  const nlohmann::json answer = nlohmann::json::parse(exact[0]);
  const nlohmann::json pile = nlohmann::json::parse(bounded[0]);
  EXPECT_EQ(answer["status"], "solved");
  EXPECT_EQ(pile["status"], "bounded");
  EXPECT_EQ(pile["certified"], true);
  EXPECT_LT(pile["w_bound"], 1e-40);
  EXPECT_EQ(pile["energy_shift"], 0);
  for (const char* field : {"id", "n", "w", "f", "f_unique"}) EXPECT_EQ(pile[field], answer[field]) << field;
  EXPECT_EQ(pile["f_exact"].size(), 40u);
  // One rounding away from a solution.
  EXPECT_EQ(nlohmann::json::parse(exact[1])["status"], "infeasible");
  const nlohmann::json bearing = nlohmann::json::parse(bounded[1]);
  EXPECT_EQ(bearing["certified"], false);
  EXPECT_EQ(bearing["proof"], "nearby problem");
  EXPECT_GT(bearing["energy_shift"], 0);
  const std::string rounded = Lines(Run("certify --exact-up-to 0 --rounded -", problems).out).at(0);
  EXPECT_FALSE(nlohmann::json::parse(rounded).contains("f_exact"));
}

TEST_F(Command, CertifyNamesWhatItCannotTake) {
  ExpectMisuse("certify --exact-up-to -1 -", "--exact-up-to", std::string(kProblem) + "\n");
  ExpectMisuse("certify --exact-up-to 1 -", "fractions",
               R"({"id":"p","A":[[2,1],[1,"7/3"]],"b":[-5,"-1/3"]})"
               "\n");
  ExpectMisuse("certify -", "symmetric",
               R"({"id":"p","A":[[1,2],[3,1]],"b":[1,1]})"
               "\n");
  ExpectMisuse("certify /nowhere.jsonl", "/nowhere.jsonl");
  ExpectMisuse("certify --time-limit 0 -", "--time-limit", std::string(kProblem) + "\n");
  const Outcome outcome = Run("certify -", R"({"id":"p","A":[[1,2],[2,1]],"b":[-1,-1]})"
                                           "\n");
  EXPECT_EQ(outcome.status, 0);
  EXPECT_EQ(nlohmann::json::parse(outcome.out)["certified"], false);
}

TEST_F(Command, ConvertGoesToMatrixMarketAndBackBitForBit) {
  const fs::path folder = fs::path(testing::TempDir()) / "lcpbench-convert";
  fs::remove_all(folder);
  fs::create_directories(folder / "many");
  const std::string problem = Run("generate chain-of-links --size 30 --seed 2").out;
  const std::string path = (folder / "chain.mtx").string();
  EXPECT_EQ(Run("convert - -o " + path, problem).status, 0);
  const nlohmann::json given = nlohmann::json::parse(problem);
  nlohmann::json back = nlohmann::json::parse(Run("convert " + path).out);
  EXPECT_EQ(back["id"], "chain");
  for (const char* field : {"n", "J", "invM", "b", "bilateral"}) EXPECT_EQ(back[field], given[field]) << field;
  const std::string other = Run("generate rockers --size 10 --seed 1").out;
  EXPECT_EQ(Run("convert - -o " + (folder / "many").string(), problem + other).status, 0);
  const std::string name = nlohmann::json::parse(other)["id"].get<std::string>();
  EXPECT_TRUE(fs::exists(folder / "many" / (name + "_b.mtx")));
  ExpectMisuse("convert - -o " + path, "chain.mtx: expected one problem", problem + other);
  ExpectMisuse("convert " + (folder / "none.mtx").string(), "none_b.mtx: cannot be opened");
  ExpectMisuse("convert - -o /nowhere/x.jsonl", "/nowhere/x.jsonl", problem);
  fs::remove_all(folder);
}

TEST_F(Command, ConvertGoesThroughEveryFormatBitForBit) {
  // Bilateral rows stand between the others; of factors Siconos' text keeps the rounded matrix.
  const std::string problem = Run("generate gear-train --size 12 --seed 3").out;
  const nlohmann::json given = nlohmann::json::parse(problem);
  ASSERT_FALSE(given["bilateral"].empty());
  ASSERT_EQ(Run("convert - -o " + Path("a.hdf5"), problem).status, 0);
  ASSERT_EQ(Run("convert " + Path("a.hdf5") + " -o " + Path("b.mtx")).status, 0);
  ASSERT_EQ(Run("convert " + Path("b.mtx") + " -o " + Path("c.h5")).status, 0);
  nlohmann::json back = nlohmann::json::parse(Run("convert " + Path("c.h5")).out);
  for (const char* field : {"n", "J", "invM", "b", "bilateral"}) EXPECT_EQ(back[field], given[field]) << field;
  ASSERT_EQ(Run("convert " + Path("c.h5") + " -o " + Path("d.dat")).status, 0);
  ASSERT_EQ(Run("convert " + Path("d.dat") + " -o " + Path("e.hdf5")).status, 0);
  ASSERT_EQ(Run("convert " + Path("e.hdf5") + " -o " + Path("f.dat")).status, 0);
  EXPECT_EQ(ReadFile(Path("f.dat")), ReadFile(Path("d.dat")));
  back = nlohmann::json::parse(Run("convert " + Path("e.hdf5")).out);
  EXPECT_FALSE(back.contains("J"));
  for (const char* field : {"n", "b", "bilateral"}) EXPECT_EQ(back[field], given[field]) << field;
}

TEST_F(Command, ConvertFillsAFolderWithFilesOfAFormat) {
  const std::string problems =
      std::string(kProblem) + "\n" + R"({"id":"q/r","A":[[1]],"b":[-1],"bilateral":[0]})" + "\n";
  for (const char* format : {"jsonl", "mtx", "hdf5", "dat"}) {
    SCOPED_TRACE(format);
    const fs::path folder = folder_ / format;
    fs::create_directories(folder);
    ASSERT_EQ(Run("convert - --to " + std::string(format) + " -o " + folder.string(), problems).status, 0);
    const std::string first = (folder / ("p." + std::string(format))).string();
    const std::string second = (folder / ("q_r." + std::string(format))).string();
    const std::vector<std::string> back = Lines(Run("convert " + first + " " + second).out);
    ASSERT_EQ(back.size(), 2u);
    EXPECT_EQ(nlohmann::json::parse(back[0])["b"], nlohmann::json::parse("[-5.0,-4.0]"));
    EXPECT_EQ(nlohmann::json::parse(back[1])["bilateral"], nlohmann::json::parse("[0]"));
  }
  ExpectMisuse("convert - --to xml -o " + folder_.string(), "expected a format of jsonl, mtx, hdf5, dat, found 'xml'",
               problems);
  ExpectMisuse("convert - --to dat -o " + Path("x.mtx"), "expected a folder or a file of this format", problems);
}

TEST_F(Command, ConvertTellsWhatIsWrongWithAFileInOneLine) {
  ExpectMisuse("convert " + Path("absent.hdf5"), "absent.hdf5: cannot be opened");
  ExpectMisuse("convert " + Path("absent.dat"), "absent.dat: cannot be opened");
  Write("text.h5", "no HDF5");
  ExpectMisuse("convert " + Path("text.h5"), "text.h5: expected an HDF5 file");
  Write("short.dat", "2\n0\n2\n2\n2 2\n1 2\n3");
  ExpectMisuse("convert " + Path("short.dat"), "short.dat:7: expected number 4 of the 4 of a matrix");
  Write("empty.mtx", "");
  Write("empty_b.mtx", "");
  ExpectMisuse("convert " + Path("empty.mtx"), "empty_b.mtx:1: expected");
  ExpectMisuse("convert - -o /nowhere/x.hdf5", "/nowhere/x.hdf5: cannot be written", std::string(kProblem) + "\n");
  ExpectMisuse("convert - -o /nowhere/x.dat", "/nowhere/x.dat: cannot be written", std::string(kProblem) + "\n");
  const std::string unsymmetric = R"({"id":"u","A":[[1,2],[3,1]],"b":[1,1],"bilateral":[1]})";
  ExpectMisuse("convert - -o " + Path("u.h5"), "problem 'u': expected the same entries between contacts and bilateral",
               unsymmetric + "\n");
}

}  // namespace
}  // namespace lcpbench
