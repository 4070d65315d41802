// The lcpbench command as its users meet it: exit status, standard output, standard error.

#include <regex>

#include "model/scenes/scene.h"
#include "solvers/io/gzip_file.h"
#include "solvers/io/json_lines.h"
#include "solvers/peers/protocol/external_solver.h"
#include "solvers/registry.h"
#include "tests/benchmarks/command/command_fixture.h"
#include "tests/solvers/solvers_under_test.h"
#include "tests/solvers/test_problems.h"

namespace lcpbench {
namespace {

class Command : public CommandTest {};

constexpr char kProblem[] = R"({"id":"p","A":[[2,1],[1,2]],"b":[-5,-4]})";

TEST_F(Command, HelpIsEverywhere) {
  for (const char* sub : {"", "list", "list solvers", "generate", "solve", "certify", "convert", "assemble", "run",
                          "report", "analyse", "compare"}) {
    const CommandOutcome outcome = Succeed(std::string(sub) + " --help");
    EXPECT_NE(outcome.out.find("sage: "), std::string::npos) << sub;
    EXPECT_EQ(outcome.error, "") << sub;
  }
}

// A program that is missing or never greets ends every command that is to use it, before anything is done.
TEST_F(Command, AnExternalProgramThatDoesNotStartIsAMistake) {
  Write("p.jsonl", std::string(kProblem) + "\n");
  Write("no-program", "");
  const std::string folder = Path("campaign");
  const std::string uses[] = {"solve --solver s --time-limit 1 " + Path("p.jsonl"),
                              "run --solvers s -o " + folder + " --filter disc-pile",
                              "recommend --candidates s " + Path("p.jsonl")};
  for (const std::string& use : uses) {
    ExpectMistake(use + " --external s=no-such-program", "'no-such-program'");
    ExpectMistake(use + " --external 's=/no/such/program x'", "'/no/such/program'");
    ExpectMistake(use + " --external s=" + Path("no-program"), "no-program");
    for (const char* script : {"trap \"\" TERM; while :; do sleep 1; done", "sleep 1000 & wait"}) {
      Write("mute", std::string("#!/bin/sh\n") + script + "\n");
      fs::permissions(Path("mute"), fs::perms::owner_all);
      ExpectMistake(use + " --start-limit 0.2 --external s=" + Path("mute"), "start limit of 0.2 s");
    }
    EXPECT_FALSE(fs::exists(folder + "/campaign.json"));
  }
  ExpectMistake(
      "solve --solver s " + Path("p.jsonl") + " --external s='" LCPBENCH_COMMAND " serve auto' --set no-such-option=1",
      "no-such-option");
}

// A = I of so many rows, sparse: what takes n x n says so, and does not try.
TEST_F(Command, DenseSolversRefuseWhatTheyCannotHold) {
  constexpr int kRows = 400'000;
  Json places = Json::array();
  for (int i = 0; i < kRows; ++i) places.push_back(i);
  const Json A = {{"row", places}, {"col", places}, {"val", std::vector<double>(kRows, 1)}, {"shape", {kRows, kRows}}};
  Write("sparse.jsonl", Json{{"id", "p"}, {"A", A}, {"b", std::vector<double>(kRows, -1)}}.dump() + "\n");
  for (const char* key : {"bullet-dantzig", "bullet-lemke", "dart-dantzig", "ode-dantzig", "siconos-lexicolemke"}) {
    const auto is_key = [&](const SolverEntry& entry) { return entry.key == key && entry.available; };
    if (std::none_of(AllSolvers().begin(), AllSolvers().end(), is_key)) continue;
    const Json record =
        Records(Run(std::string("solve --time-limit 5 --solver ") + key + " " + Path("sparse.jsonl")).out).at(0);
    EXPECT_EQ(record["status"], "unsupported") << key << ": " << record["detail"];
    EXPECT_NE(record["detail"].get<std::string>().find(" GB"), std::string::npos) << key << ": " << record["detail"];
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
    request.time_limit_s = 1;
    request.warm_up = {0};
    request.order = {1};
    served.LoadStream(stream);
    EXPECT_EQ(served.RunPass(request, 10).entries.at(0).f, here.f);
  }
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
  const size_t plain = AllScenes().size();
  ASSERT_EQ(scenes.size(), plain + FrictionScenes().size());
  for (size_t i = 0; i < scenes.size(); ++i) {
    EXPECT_TRUE(scenes[i].starts_with(i < plain ? AllScenes()[i].key : FrictionScenes()[i - plain].key)) << scenes[i];
  }
  EXPECT_TRUE(Run("list metrics").out.starts_with("rho "));
}

TEST_F(Command, MistakesAreOneLineAndStatusTwo) {
  Write("wrong.json", "{}");
  Write("text.h5", "no HDF5");
  Write("short.dat", "2\n0\n2\n2\n2 2\n1 2\n3");
  for (const char* empty : {"empty.mtx", "empty_b.mtx"}) Write(empty, "");
  fs::create_directories(Path("empty"));
  fs::create_symlink("loop.jsonl", Path("loop.jsonl"));
  const std::regex folder("FOLDER"), source("SOURCE");
  for (const auto& mistake : RefusalCases("commands")) {
    // Words in capitals may be the name of an argument.
    const std::string in_source = std::regex_replace(mistake[0], source, LCPBENCH_SOURCE_DIR);
    const std::string arguments = std::regex_replace(in_source, folder, folder_.string());
    ExpectMistake(arguments, mistake[1], mistake[2].empty() ? kProblem : mistake[2]);
  }
  ExpectMistake("solve --solver dantzig -", "empty", "");
  EXPECT_FALSE(fs::exists(folder_ / "r"));
}

TEST_F(Command, BudgetsEndAMotionAndKeepWhatItMet) {
  const CommandOutcome sequence = Run("sequence tall-stacks --size 60 --steps 1000000 --budget 0.2");
  EXPECT_EQ(sequence.status, 1);
  ExpectPart(sequence.error, "stopped: not finished within 0.2 s");
  EXPECT_FALSE(Records(sequence.out).empty());
  ExpectMistake("scene tall-stacks --size 60 --time 1e6 --budget 0.2", "not finished within 0.2 s");
}

TEST_F(Command, ControlCharactersAreShownEscaped) {
  ExpectMistake("solve --solver \"$(printf 'a\\033\\nb')\" -", "unknown solver 'a\\x1b\\nb'", kProblem);
  ExpectMistake("solve --solver pgs \"$(printf 'a\\033\\nä')\"", "a\\x1b\\nä");
}

TEST_F(Command, OfManyBadLinesTenReasonsAreToldEachOnce) {
  std::string same, others;
  for (int k = 0; k < 25; ++k) {
    same += "{\"A\":[[1]]}\n";
    others += "{\"A\":[[1]],\"b\":[" + std::to_string(k) + ",1]," + "\"n\":" + std::to_string(k + 3) + "}\nno JSON\n";
  }
  for (const auto& [bad, told, left] : {std::tuple{same, 2U, " 24 "}, std::tuple{others, 11U, " 40 "}}) {
    const CommandOutcome outcome = Run("solve --solver dantzig -", bad + kProblem);
    EXPECT_EQ(outcome.status, 2);
    EXPECT_EQ(Lines(outcome.error).size(), told) << outcome.error;
    ExpectPart(outcome.error, std::string("<stdin>: and") + left + "more\n");
    EXPECT_EQ(Records(outcome.out).size(), 1U);
  }
}

TEST_F(Command, AWrongFileGetsOneComplaint) {
  const std::string market = ReadFile(std::string(LCPBENCH_SOURCE_DIR) + "/tests/data/reports/UP.MTX");
  const std::string binary("\x89HDF\r\n\x1a\n\0\0\n\n{}\n", 18);
  int number = 0;
  for (const std::string& text :
       {market, binary, std::string("{\n  \"id\": 1,\n  \"b\": [1]\n}\n"), std::string("1\n2\n3\n"),
        std::string("a,b\n1,2\n"), std::string("\n\n[1, 2]\n[3, 4]\n"), std::string("x\ty\n\n")}) {
    const std::string name = "wrong" + std::to_string(number++) + ".txt";
    Write(name, text);
    WriteGzipFile(Path(name + ".gz"), text);
    ExpectMistake("solve --solver auto " + Path(name + ".gz"), name + ".gz:");
    for (const char* arguments : {"solve --solver auto ", "convert ", "certify ", "recommend ", "recommend --features ",
                                  "assemble ", "replay ", "recording "}) {
      ExpectMistake(arguments + Path(name), name + ":");
    }
    ExpectMistake("convert -", "; expected JSON lines, an object on each", text);
  }
  // Lines that are objects of another kind: answers.
  const std::string answers = Succeed("solve --solver auto -", std::string(kProblem) + "\n" + kProblem).out;
  const CommandOutcome outcome = Run("solve --solver auto -", answers + answers);
  EXPECT_EQ(Lines(outcome.error).size(), 2U) << outcome.error;
}

TEST_F(Command, FormatsAreToldByEndingsWhateverTheirCaseAndTextMayBeCompressed) {
  const std::string problem = Run("generate gear-train --size 12 --seed 3").out;
  const Json given = Json::parse(problem);
  for (const std::string ending : {"mtx", "MTX", "Mtx", "mtx.gz", "MTX.GZ", "mTx.gZ", "dat", "Dat.Gz", "HDF5", "h5",
                                   "jsonl", "JSONL", "jsonl.gz", "JSONL.GZ", "json", "gz", "qps", "mps"}) {
    SCOPED_TRACE(ending);
    const std::string file = Path("p." + ending);
    Succeed("convert - -o " + file, problem);
    const bool is_gzip =
        ending.ends_with("gz") || ending.ends_with("GZ") || ending.ends_with("Gz") || ending.ends_with("gZ");
    EXPECT_EQ(ReadFile(file).starts_with("\x1f\x8b"), is_gzip);
    const Json back = Answer("convert " + file);
    for (const char* field : {"n", "b", "bilateral"}) EXPECT_EQ(back[field], given[field]) << field;
    EXPECT_EQ(Answer("solve --solver auto " + file)["verdict"]["passes"], true);
    EXPECT_EQ(Answer("certify " + file)["certified"], true);
    fs::remove(file);
  }
  for (const auto& [ending, format] : {std::pair{"hdf5.gz", "hdf5"}, {"H5.GZ", "hdf5"}, {"npz.gz", "npz"}}) {
    const std::string file = Path(std::string("p.") + ending);
    const std::string told = "files of " + std::string(format) + " are not compressed by gzip, expected a name like p.";
    ExpectMistake("convert - -o " + file, told, problem);
    for (const char* command : {"convert ", "solve --solver auto ", "recommend "}) ExpectMistake(command + file, told);
  }
  // Programs of npz have no rows of joints.
  Succeed("convert - -o " + Path("p.npz"), kProblem);
  ExpectHas(Answer("convert " + Path("p.npz")), {{"b", {-5, -4}}, {"A", Answer("convert -", kProblem)["A"]}});
  Succeed("convert - -o " + Path("q.QPS"), problem);
  Succeed("convert - -o " + Path("q.qps.gz"), problem);
  TextInput unpacked(Path("q.qps.gz"));
  EXPECT_EQ((std::string{std::istreambuf_iterator<char>(unpacked), {}}), ReadFile(Path("q.QPS")));
}

TEST_F(Command, ReportedFilesAreReadByTheirEndingsAndNumbers) {
  const std::string reports = std::string(LCPBENCH_SOURCE_DIR) + "/tests/data/reports/";
  const Json answer = Answer("solve --solver auto " + reports + "UP.MTX");
  EXPECT_EQ(answer["id"], "UP");
  for (const auto& [row, f] : {std::pair{0, 0.2}, {1, 0.6}}) EXPECT_NEAR(answer["f"][row], f, 1e-12);
  EXPECT_EQ(Answer("convert " + reports + "under.mtx")["A"]["val"], Json({0.0, 0.0, 0.0, 3.0}));
}

TEST_F(Command, SolveJudgesEveryLineAndKeepsGoingAfterABadOne) {
  Write("problems.jsonl", std::string(kProblem) + "\n{\"A\":[[1]]}\n" + R"({"id":"q","A":[[1]],"b":[3]})" + "\n");
  const CommandOutcome outcome = Run("solve --solver dantzig " + Path("problems.jsonl"));
  EXPECT_EQ(outcome.status, 2);
  EXPECT_EQ(Lines(outcome.error).size(), 1u);
  ExpectPart(outcome.error, "problems.jsonl:2");
  const std::vector<Json> lines = Records(outcome.out);
  ASSERT_EQ(lines.size(), 2u);
  const Json& first = lines[0];
  for (const char* field : {"id", "solver", "status", "f", "w", "iterations", "time_s", "metrics", "verdict"}) {
    EXPECT_TRUE(first.contains(field)) << field;
  }
  EXPECT_EQ(first["status"], "solved");
  EXPECT_NEAR(first["f"][0].get<double>(), 2, 1e-9);
  EXPECT_TRUE(first["verdict"]["passes"].get<bool>());
  EXPECT_EQ(lines[1]["id"], "q");
}

TEST_F(Command, SolveJudgesByTheToleranceAloneUnlessAskedForTheFloor) {
  Write("heavy.jsonl", FormatLcpRecord(MakeStackedColumn(200, 1e6).problem) + "\n");
  const std::string arguments = "solve --solver dantzig --tolerance 1e-9 " + Path("heavy.jsonl");
  const Json by_tolerance = Answer(arguments);
  const Json by_floor = Answer(arguments + " --floor");
  // The floor of the answer is told either way.
  EXPECT_GT(by_tolerance["metrics"]["answer_floor"].get<double>(), 1e-9);
  EXPECT_TRUE(by_tolerance["metrics"]["floor"].is_null());
  const double floor = by_floor["metrics"]["floor"].get<double>();
  EXPECT_NEAR(floor, by_floor["metrics"]["answer_floor"].get<double>(), 1e-3 * floor);
  EXPECT_EQ(by_tolerance["f"], by_floor["f"]);
  ExpectHas(by_tolerance["verdict"], {{"at_floor", false}, {"passes", false}});
  ExpectPart(by_tolerance["detail"], "1e-09 is below the rounding floor");
  ExpectHas(by_floor["verdict"], {{"passes", true}, {"at_floor", true}});
}

TEST_F(Command, EverySolverSolvesWhatGenerateWrites) {
  for (const SceneFamily& scene : AllScenes()) {
    const std::string generate = "generate " + std::string(scene.key) + " --size 12 --seed ";
    const std::string problem = Succeed(generate + "3").out;
    EXPECT_EQ(problem, Run(generate + "3").out);
    EXPECT_NE(problem, Run(generate + "4").out);
    if (scene.key != "disc-pile") continue;
    for (const SolverEntry& entry : OwnSolversAndAPeerOfEachLibrary()) {
      const Json record = Answer("solve --solver " + entry.key + " --tolerance 1e-3 -", problem);
      EXPECT_EQ(record["f"].size(), 12u);
      EXPECT_FALSE(entry.origin == SolverOrigin::kOwn && record["verdict"]["false_success"].get<bool>());
    }
  }
}

TEST_F(Command, CertifyAnswersInFractions) {
  const std::vector<Json> lines = Answers("certify -", R"({"id":"p","A":[[2,1],[1,"7/3"]],"b":[-5,"-1/3"]})"
                                                       "\n"
                                                       R"({"id":"q","A":[[1,-1],[-1,1]],"b":[-1,0]})");
  ASSERT_EQ(lines.size(), 2u);
  ExpectHas(lines[0], {{"status", "solved"}, {"certified", true}, {"f_unique", true}, {"rank_A", 2}});
  ExpectHas(lines[0], {{"w_exact", Json::array({"0", "13/6"})}, {"f_exact", Json::array({"5/2", "0"})}});
  ExpectHas(lines[1], {{"status", "infeasible"}, {"certified", true}, {"ray_exact", Json::array({"1", "1"})}});
  EXPECT_EQ(Answer("certify -", R"({"id":"p","A":[[1,2],[2,1]],"b":[-1,-1]})")["certified"], false);
  const std::string nearly = R"({"id":"p","A":[[2,1],[1.00000001,2]],"b":[-1,-1]})";
  ExpectMistake("certify -", "symmetric", nearly);
  EXPECT_EQ(Answer("certify --symmetrize 1e-6 -", nearly)["certified"], true);
  const Json rounded = Json::parse(Run("certify --rounded -", kProblem).out);
  EXPECT_FALSE(rounded.contains("w_exact"));
  EXPECT_EQ(rounded["w"], Json({0.0, 0.0}));
}

// A block that slides: f_n = 2, f_t = -1. By all modes, by those of solvers' answers, and by a proof in doubles.
TEST_F(Command, CertifyProvesModesOfFriction) {
  const std::string block =
      R"({"id":"p","A":[[1,0],[0,1]],"b":[-2,3],"friction":{"row":[1],"normal":[0],"mu":["1/2"]}})";
  const std::string same = R"({"id":"p","A":[[1,0],[0,1]],"b":[-2,3],"friction":{"row":[1],"normal":[0],"mu":[0.5]}})";
  const Json all = Answer("certify -", block);
  ExpectHas(all, {{"complete", true}, {"f_unique", true}});
  EXPECT_EQ(all["pieces"][0]["vertices"][0], Json({"2", "-1"}));
  const Json one = Answer("certify --modes-up-to 0 -", block);
  ExpectHas(one, {{"complete", false}, {"tried", 0}});
  const Json bounded = Answer("certify --exact-up-to 0 -", same);
  EXPECT_EQ(bounded["status"], "bounded");
  EXPECT_LT(bounded["f_bound"], 1e-12);
  for (const Json& answer : {all, one, bounded}) {
    ExpectHas(answer, {{"certified", true}, {"proof", "modes"}, {"modes", "C+"}});
    EXPECT_NEAR(answer["f"][1], -1, 1e-12);
  }
  // Two rows that carry the same load: doubles prove a problem nearby only.
  const Json nearby = Answer("certify --exact-up-to 0 -", R"({"id":"p","J":[[1],[1],[0]],"invM":[1],"b":[-2,-2,0],)"
                                                          R"("friction":{"row":[2],"normal":[0],"mu":[0.5]}})");
  ExpectHas(nearby, {{"certified", false}, {"proof", "nearby problem"}});
  EXPECT_LT(nearby["b_shift"], 1e-12);
}

// A plank on four legs: f is one of many, and the one of least norm shares equally.
TEST_F(Command, SolveTellsWhetherForcesAreUniqueAndFindsTheLeast) {
  const std::string plank =
      R"({"id":"plank","J":[[0,1,-1.5],[0,1,-0.5],[0,1,0.5],[0,1,1.5]],"invM":[0.1,0.1,0.25],"b":[-9.81,-9.81,-9.81,-9.81]})";
  const Json any = Answer("solve --solver auto -", plank);
  EXPECT_EQ(any["f_unique"], false);
  EXPECT_FALSE(any.contains("least_norm"));
  const Json least = Answer("solve --solver auto --least-norm -", plank);
  EXPECT_EQ(least["least_norm"]["nullity"], 2);
  EXPECT_GT(least["least_norm"]["rank_tolerance"], 0);
  EXPECT_TRUE(least["verdict"]["passes"].get<bool>());
  for (const Json& force : least["f"]) EXPECT_NEAR(force.get<double>(), 98.1 / 4, 1e-9);
  const Json single = Answer("solve --solver auto -", R"({"id":"s","J":[[0,1,0]],"invM":[1,1,1],"b":[-1]})");
  EXPECT_EQ(single["f_unique"], true);
}

TEST_F(Command, CertifyBoundsWhatIsTooLargeToBeExact) {
  const std::string problems =
      Run("generate disc-pile --size 40 --seed 1").out + Run("generate roller-bearing --size 60 --seed 1").out;
  const std::vector<Json> exact = Records(Run("certify --exact-up-to 60 -", problems).out);
  const std::vector<Json> bounded = Records(Run("certify --exact-up-to 39 -", problems).out);
  ASSERT_EQ(exact.size(), 2u);
  ASSERT_EQ(bounded.size(), 2u);
  const Json& answer = exact[0];
  const Json& pile = bounded[0];
  EXPECT_EQ(answer["status"], "solved");
  ExpectHas(pile, {{"status", "bounded"}, {"certified", true}, {"energy_shift", 0}});
  EXPECT_LT(pile["w_bound"], 1e-40);
  for (const char* field : {"id", "n", "w", "f", "f_unique"}) EXPECT_EQ(pile[field], answer[field]) << field;
  EXPECT_EQ(pile["f_exact"].size(), 40u);
  // One rounding away from a solution.
  EXPECT_EQ(exact[1]["status"], "infeasible");
  const Json& bearing = bounded[1];
  ExpectHas(bearing, {{"certified", false}, {"proof", "nearby problem"}});
  EXPECT_GT(bearing["energy_shift"], 0);
  EXPECT_FALSE(Records(Run("certify --exact-up-to 0 --rounded -", problems).out).at(0).contains("f_exact"));
}

TEST_F(Command, ConvertFillsAFolderWithFilesOfAFormat) {
  const std::string problems =
      std::string(kProblem) + "\n" + R"({"id":"q/r","A":[[1]],"b":[-1],"bilateral":[0]})" + "\n";
  for (const char* format : {"jsonl", "mtx", "hdf5", "dat"}) {
    SCOPED_TRACE(format);
    const fs::path folder = folder_ / format;
    fs::create_directories(folder);
    Succeed("convert - --to " + std::string(format) + " -o " + folder.string(), problems);
    const std::string first = (folder / ("p." + std::string(format))).string();
    const std::string second = (folder / ("q_r." + std::string(format))).string();
    const std::vector<Json> back = Records(Run("convert " + first + " " + second).out);
    ASSERT_EQ(back.size(), 2u);
    EXPECT_EQ(back[0]["b"], Json({-5.0, -4.0}));
    EXPECT_EQ(back[1]["bilateral"], Json({0}));
  }
}

TEST_F(Command, SymmetrizeMakesSymmetricWhatNearlyIsAndNotesTheAmount) {
  const std::string nearly = R"({"id":"p","A":[[4,1.0625],[1,4]],"b":[-1,2],"status":"infeasible"})";
  const std::string other = R"({"id":"q","A":[[1,2],[0,1]],"b":[1,1]})";
  const CommandOutcome outcome = Succeed("convert --symmetrize 0.1 -", nearly + "\n" + other + "\n");
  EXPECT_EQ(
      outcome.error,
      "symmetrized: 1, of an asymmetry of at most 0.015625; left as they are: 1, of an asymmetry of at least 2\n");
  const std::vector<Json> made = Records(outcome.out);
  EXPECT_EQ(made[0]["symmetrized"], 0.015625);
  EXPECT_EQ(made[0]["A"]["val"], Json({4.0, 1.03125, 1.03125, 4.0}));
  EXPECT_FALSE(made[1].contains("symmetrized"));
  EXPECT_EQ(made[1]["A"]["val"], Json({1.0, 2.0, 1.0}));
  // It stays with the problem, and comes to the answer.
  EXPECT_EQ(Answer("convert -", made[0].dump())["symmetrized"], 0.015625);
  ExpectHas(Answer("solve --solver dantzig -", made[0].dump()), {{"symmetrized", 0.015625}, {"status", "solved"}});
  Succeed("convert - -o " + Path("p.dat"), R"({"id":"p","A":[[4,1.0625],[1,4]],"b":[-1,2]})");
  EXPECT_EQ(Json::parse(Run("solve --solver dantzig " + Path("p.dat")).out)["status"], "unsupported");
  EXPECT_EQ(Answer("solve --solver dantzig --symmetrize 0.1 " + Path("p.dat"))["symmetrized"], 0.015625);
}

TEST_F(Command, ReadersHaveOptionsForFclibFiles) {
  const std::string seed =
      std::string(LCPBENCH_SOURCE_DIR) + "/python/tests/formats/corpus/hdf5/columns_first_unwritten";
  fs::copy_file(seed, Path("p.h5"));
  EXPECT_EQ(Json::parse(Run("convert " + Path("p.h5")).out)["A"]["val"], Json({4.0, 7.0, 5.0, 1.0, 3.0, 5.0, 2.0}));
  EXPECT_EQ(Run("convert --fclib-triplets columns-first --without-friction " + Path("p.h5")).status, 0);
  ExpectMistake("convert --fclib-triplets rows-first " + Path("p.h5"), "V/i: expected indices from 0 to 0, found 3");
  ExpectMistake("convert --fclib-triplets transposed " + Path("p.h5"), "--fclib-triplets");
}

TEST_F(Command, LostOutputIsToldInOneLineWithStatus3) {
  Write("p.jsonl", std::string(kProblem) + "\n" + kProblem + "\n");
  const std::string problem = Path("p.jsonl");
  for (const std::string& arguments :
       {std::string("--help"), std::string("list scenes"), std::string("list fields"),
        std::string("generate disc-pile --size 5"), "solve --solver auto " + problem, "certify " + problem,
        "convert " + problem, std::string("scene disc-pile --size 5")}) {
    for (const auto& [place, reason] :
         {std::pair{"> /dev/full", "No space left on device"}, std::pair{">&-", "Bad file descriptor"}}) {
      const int status = std::system((program_ + " " + arguments + " " + place + " 2> " + Path("error")).c_str());
      EXPECT_EQ(WEXITSTATUS(status), 3) << arguments << place;
      EXPECT_EQ(ReadFile(Path("error")), std::string("lcpbench: standard output: writing failed: ") + reason + "\n");
    }
  }
  // Nothing is lost where nothing is written there.
  EXPECT_EQ(std::system((program_ + " convert " + problem + " -o " + Path("q.jsonl") + " >&-").c_str()), 0);
  EXPECT_EQ(Lines(ReadFile(Path("q.jsonl"))).size(), 2U);
}

TEST_F(Command, AClosedPipeEndsQuietly) {
  for (const char* trap : {"", "trap '' PIPE; "}) {
    const std::string command = std::string(trap) + program_ + " list fields 2> " + Path("error") + " | true";
    EXPECT_EQ(std::system(command.c_str()), 0);
    EXPECT_EQ(ReadFile(Path("error")), "");
  }
}

TEST_F(Command, ConvertInPlaceAndOnAFullDiskKeepsTheInput) {
  std::string lines;
  for (int k = 0; k < 2000; ++k) lines += std::string(kProblem) + "\n";
  Write("x.jsonl", lines);
  const std::string x = Path("x.jsonl");
  Succeed("convert " + x + " -o " + x);
  EXPECT_EQ(Records(ReadFile(x)).size(), 2000U);
  Succeed("convert - -o " + Path("y.mtx"), kProblem);
  Succeed("convert - -o " + Path("y.h5"), kProblem);
  const auto before = [&] { return std::distance(fs::directory_iterator(folder_), {}); };
  const auto files = before();
  const std::string full = "ulimit -f 0; " + program_ + " convert ";
  for (const std::string& arguments : {x + " -o " + x, Path("y.mtx") + " -o " + Path("y.h5"),
                                       Path("y.h5") + " -o " + Path("y.dat"), Path("y.h5") + " -o " + Path("y.mtx")}) {
    // Standard error is a pipe: a file would not grow, either.
    const int status = std::system(("sh -c '" + full + arguments + "; exit $?' 2>&1 | cat > " + Path("error")).c_str());
    EXPECT_EQ(status, 0);
    const std::vector<std::string> told = Lines(ReadFile(Path("error")));
    ASSERT_EQ(told.size(), 1U) << arguments;
    EXPECT_TRUE(told[0].ends_with("writing failed: File too large")) << told[0];
  }
  EXPECT_EQ(Records(ReadFile(x)).size(), 2000U);
  Succeed("convert " + Path("y.h5"));
  Succeed("convert " + Path("y.mtx"));
  EXPECT_LE(before(), files + 1);  // the file of errors
  // Bad records alone make nothing, and good ones are not lost for a bad one.
  EXPECT_EQ(Run("convert - -o " + x, "no problem\n").status, 2);
  EXPECT_EQ(Records(ReadFile(x)).size(), 2000U);
  EXPECT_EQ(Run("convert - -o " + x, std::string(kProblem) + "\nno problem\n").status, 2);
  EXPECT_EQ(Records(ReadFile(x)).size(), 1U);
}

// One option for every format; who does not give it is told how large the asymmetry is.
TEST_F(Command, SymmetrizeIsForProgramsToo) {
  Write("p.qps",
        "NAME p\nROWS\n N c\nCOLUMNS\n x1 c -1\n x2 c -2\nRHS\nQMATRIX\n x1 x1 4\n x1 x2 1.0000000000000002\n"
        " x2 x1 1\n x2 x2 3\nENDATA\n");
  ExpectMistake("solve --solver auto " + Path("p.qps"), "symmetri");
  const Json f = Answers("solve --symmetrize 1e-9 --solver auto " + Path("p.qps")).at(0).at("f");
  EXPECT_NEAR(f.at(0).get<double>(), 1.0 / 11, 1e-12);
  EXPECT_NEAR(f.at(1).get<double>(), 7.0 / 11, 1e-12);
  ExpectMistake("solve --symmetrize 1e-17 --solver auto " + Path("p.qps"), "symmetri");
}

// PYTHONPATH and PYTHONHOME may be meant for another Python; an interpreter may print lines of its own.
TEST_F(Command, PythonProgramsDoNotTakeTheCallersPython) {
  Write("p.qps", "NAME p\nROWS\n N c\nCOLUMNS\n x1 c -1\nRHS\nQUADOBJ\n x1 x1 2\nENDATA\n");
  Write("numpy.py", "raise ImportError('built for another Python')\n");
  Write("sitecustomize.py", "print('modules loaded')\n");
  const std::string command = program_;
  for (const char* variable : {"PYTHONPATH", "PYTHONHOME"}) {
    program_ = variable + ("=" + folder_.string()) + " " + command;
    EXPECT_EQ(Answers("solve --solver auto " + Path("p.qps")).at(0).at("f").at(0), 0.5) << variable;
    ExpectMistake("report " + Path("none"), "none");
  }
  Write("python.sh", "#!/bin/sh\necho modules loaded\nexec /usr/bin/python3 \"$@\"\n");
  fs::permissions(Path("python.sh"), fs::perms::owner_all);
  program_ = "LCPBENCH_PYTHON=" + Path("python.sh") + " " + command;
  ExpectMistake("solve --solver auto " + Path("p.qps"), "answers is not understood");
}

}  // namespace
}  // namespace lcpbench
