// lcpbench sequence, lcpbench motion and lcpbench scene as their users meet them.

#include <csignal>
#include <nlohmann/json.hpp>

#include "benchmarks/motions/scene_source.h"
#include "model/contact/assembly.h"
#include "solvers/lcp/verify.h"
#include "solvers/registry.h"
#include "tests/benchmarks/command/command_fixture.h"
#include "tests/solvers/io/read_lcp_file.h"
#include "tests/solvers/solvers_under_test.h"

namespace lcpbench {
namespace {

class SequenceCommand : public CommandTest {};

TEST_F(SequenceCommand, WritesOneVerifiedProblemPerTimeStepWithItsChanges) {
  const CommandOutcome outcome = Succeed("sequence disc-pile --size 30 --steps 120 --seed 3");
  const std::vector<Json> records = Records(outcome.out);
  ASSERT_EQ(records.size(), 120u);
  std::size_t rows = 0;
  std::size_t changes = 0;
  for (std::size_t k = 0; k < records.size(); ++k) {
    const Json& motion = records[k].at("motion");
    ExpectHas(motion, {{"step", k}, {"solver", "auto"}, {"kind", "time_step"}});
    EXPECT_NEAR(motion.at("time").get<double>(), 1e-3 * static_cast<double>(k), 1e-12);
    EXPECT_TRUE(motion.at("verdict").at("passes").get<bool>());
    // Every row came from somewhere.
    EXPECT_EQ(records[k].at("n").get<std::size_t>(), rows - motion.at("left").size() + motion.at("entered").size());
    rows = records[k].at("n").get<std::size_t>();
    if (k > 0) changes += motion.at("entered").size() + motion.at("left").size() + motion.at("activated").size();
  }
  EXPECT_GT(changes, 0u);
  for (const char* part : {"120 problems", "worst penetration"}) ExpectPart(outcome.error, part);
}

// Every line has an id of its own, that tells the step; with --forces the answer that drove the motion.
TEST_F(SequenceCommand, TellsForcesAndSteps) {
  const std::string file = std::string(LCPBENCH_SOURCE_DIR) + "/data/scenes/newtons_cradle.json";
  for (const char* level : {"velocity", "acceleration"}) {
    std::set<std::string> ids;
    const CommandOutcome outcome = Succeed("sequence " + file + " --forces --steps 40 --level " + level);
    const std::vector<Json> records = Records(outcome.out);
    for (const Json& record : records) {
      const Json& motion = record.at("motion");
      const auto id = record.at("id").get<std::string>();
      EXPECT_NE(id.find("-step" + std::to_string(motion.at("step").get<int>())), std::string::npos) << id;
      ids.insert(id);
      const LcpProblem problem = ParseLcpRecord(record.dump(), "line").problem;
      const auto f = motion.at("f").get<std::vector<double>>();
      const auto w = motion.at("w").get<std::vector<double>>();
      LcpResult answer;
      answer.status = LcpStatus::kSolved;
      answer.f = Eigen::Map<const Eigen::VectorXd>(f.data(), static_cast<Index>(f.size()));
      const Verdict verdict = Verify(problem, answer, 1e-9);
      EXPECT_TRUE(verdict.passes) << id;
      EXPECT_EQ(verdict.metrics.w, Eigen::Map<const Eigen::VectorXd>(w.data(), static_cast<Index>(w.size())));
    }
    EXPECT_EQ(ids.size(), records.size());
  }
  EXPECT_FALSE(Answers("sequence disc-pile --size 12 --steps 2").front().at("motion").contains("f"));
}

// The LCP of a scene file is the one that its picture shows, and the first of its motion at the acceleration level.
TEST_F(SequenceCommand, AProblemIsGeneratedOfASceneFile) {
  const std::string file = std::string(LCPBENCH_SOURCE_DIR) + "/data/scenes/newtons_cradle.json";
  const LcpProblem problem = ParseLcpRecord(Succeed("generate " + file).out, "line").problem;
  EXPECT_EQ(FormatLcpRecord(problem) + "\n",
            FormatLcpRecord(AssembleContactLcp(LoadInstant(file, 1, 1)).problem) + "\n");
  const LcpRecord first =
      ParseLcpRecord(Lines(Succeed("sequence " + file + " --level acceleration --steps 1").out)[0], "l");
  EXPECT_EQ(problem.size(), first.problem.size());
}

TEST_F(SequenceCommand, IsReadBackBitForBitAndSolvedByTheSolveCommand) {
  const std::string file = Path("x.jsonl");
  Succeed("sequence boxes-and-discs --size 25 --steps 20 --with-matrix -o " + file);
  const std::vector<LcpRecord> records = ReadLcpFile(file);
  ASSERT_EQ(records.size(), 20u);
  const std::vector<Json> written = Records(ReadFile(file));
  for (std::size_t k = 0; k < records.size(); ++k) {
    EXPECT_EQ(Json::parse(FormatLcpRecord(records[k].problem, true)).at("A"), written[k].at("A"));
    EXPECT_TRUE(records[k].problem.has_factors());
  }
  const CommandOutcome solved = Succeed("solve --solver ipm " + file);
  const std::vector<Json> answers = Records(solved.out);
  ASSERT_EQ(answers.size(), 20u);
  for (const Json& answer : answers) EXPECT_TRUE(answer.at("verdict").at("passes").get<bool>());
}

// Methods of auto that do not take these problems end the motion with their reason, the first problem still written.
TEST_F(SequenceCommand, IsTheSameFileTwiceUnderEverySolver) {
  std::set<std::string> refusing;
  for (const SolverEntry& solver : OwnSolversAndAPeerOfEachLibrary()) {
    const std::string arguments =
        "sequence disc-pile --size 12 --steps 15 --tolerance 1e-6 --solver " + std::string(solver.key);
    const CommandOutcome first = Run(arguments);
    EXPECT_EQ(first.out, Run(arguments).out) << solver.key;
    if (first.error.find("the solver does not take problem 'disc-pile-12-s1'") != std::string::npos) {
      refusing.insert(std::string(solver.key));
      EXPECT_EQ(first.status, 1) << first.error;
      EXPECT_EQ(Lines(first.out).size(), 1u);
    } else {
      EXPECT_EQ(first.status, 0) << first.error;
      EXPECT_EQ(Lines(first.out).size(), 15u);
    }
  }
  EXPECT_EQ(refusing, (std::set<std::string>{"band-pivoting", "fixed-size-bpp"}));
}

// A Scott-Russell linkage with one arm too many falls through its dead point: every step under every direct solver.
TEST_F(SequenceCommand, ARedundantLinkagePassesItsDeadPoint) {
  const std::string file = LCPBENCH_SOURCE_DIR "/tests/data/reports/scott-russell.json";
  const std::string steps = Path("steps.jsonl");
  const CommandOutcome moved = Succeed("sequence " + file + " --steps 1454 -o " + steps);
  for (const char* part : {"1454 problems", "0 not verified"}) ExpectPart(moved.error, part);
  for (const char* solver : {"dantzig", "lemke", "auto", "bpp", "ipm"}) {
    int failed = 0;
    for (const Json& answer : Records(Run("solve --tolerance 1e-9 " + steps + " --solver " + solver).out)) {
      if (!answer.at("verdict").at("passes").get<bool>()) ++failed;
    }
    EXPECT_EQ(failed, 0) << solver;
  }
}

TEST_F(SequenceCommand, TakesSolverSettingsAndATimeLimit) {
  const std::string arguments = "sequence disc-pile --size 20 --steps 10 --solver pgs --tolerance 1e-6 ";
  const CommandOutcome plain = Succeed(arguments);
  const CommandOutcome relaxed = Succeed(arguments + "--set relaxation=1.3");
  EXPECT_NE(relaxed.out, plain.out);
  const CommandOutcome hurried = Succeed(arguments + "--time-limit 1e-12");
  EXPECT_EQ(Records(hurried.out).front().at("motion").at("claim"), "time_limit");
}

TEST_F(SequenceCommand, KeepsWhatIsWrittenOnInterruption) {
  const std::string file = Path("x.jsonl");
  // Interrupted as soon as something is there, however slow the machine.
  const int status =
      RunUntil("x.jsonl", 1, SIGINT, false, "sequence disc-pile --size 20 --steps 100000000 -o " + file, /*once=*/true);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 128 + SIGINT);
  const std::string text = ReadFile(file);
  EXPECT_EQ(text.back(), '\n');
  EXPECT_GE(ReadLcpFile(file).size(), 1u);
  EXPECT_NE(ReadFile(Path("stderr")).find("worst penetration"), std::string::npos);
}

TEST_F(SequenceCommand, MotionComparesEverySolverWithTheReference) {
  std::string solvers;
  std::map<std::string, std::size_t> motions;  // of each solver and scene
  std::set<std::string> own;
  for (const SolverEntry& solver : OwnSolversAndAPeerOfEachLibrary()) {
    // These do not take some of the problems, which ends a motion early.
    if (solver.key == "fixed-size-bpp" || solver.key == "band-pivoting") continue;
    solvers += " " + solver.key;
    motions[solver.key] = solver.uses_tolerance ? 2 : 1;
    if (solver.origin == SolverOrigin::kOwn) own.insert(solver.key);
  }
  const CommandOutcome outcome = Succeed(
      "motion --scenes disc-pile,boxes-and-discs,disc-track@velocity --size 10 --steps 30 --tolerances 1e-3,1e-9 "
      "--budget 60 --solvers" +
      solvers + " -o " + Path("m"));
  const std::vector<std::string> rows = Lines(ReadFile(Path("m") + "/motion.csv"));
  std::map<std::string, std::size_t> rows_of;
  for (std::size_t i = 1; i < rows.size(); ++i) ++rows_of[Split(rows[i], ',')[4]];
  for (const auto& [solver, count] : motions) {
    // A peer's answers may be wrong and end a motion early: then the output says so.
    const bool is_told = !own.contains(solver) && outcome.out.find("\n" + solver + " at ") != std::string::npos;
    EXPECT_TRUE(rows_of[solver] == 3 * count * 31 || is_told) << solver << ": " << rows_of[solver];
  }
  for (const char* scene : {"disc-pile, velocity level", "boxes-and-discs, velocity level", "disc-track, velocity"}) {
    ExpectPart(outcome.out, scene);
  }
  const nlohmann::json about = nlohmann::json::parse(ReadFile(Path("m") + "/motion.json"));
  EXPECT_EQ(about["scenes"].size(), 3u);
  EXPECT_EQ(about["steps"], 30);
  EXPECT_TRUE(about["environment"].contains("git_commit"));
  // dantzig at 1e-9 is the reference itself but for what it is told.
  std::size_t exact = 0;
  for (const std::string& row : rows) {
    const std::vector<std::string> cells = Split(row, ',');
    if (cells[4] != "dantzig") continue;
    EXPECT_LE(std::stod(cells[9]), 1e-9) << row;
    EXPECT_LE(std::stod(cells[12]), 1e-9) << row;
    ++exact;
  }
  EXPECT_EQ(exact, 3u * 31u);
}

// ----- lcpbench scene

class SceneCommand : public CommandTest {};

TEST_F(SceneCommand, WritesTheSamePictureToStandardOutputAndToAFile) {
  const CommandOutcome outcome = Succeed("scene rockers --size 12 --seed 3");
  EXPECT_EQ(outcome.out.find("<svg "), 0U);
  EXPECT_NE(outcome.out.find("rockers-12-s3"), std::string::npos);
  Succeed("scene rockers --size 12 --seed 3 -o " + Path("x.svg"));
  EXPECT_EQ(ReadFile(folder_ / "x.svg"), outcome.out);
  EXPECT_NE(Run("scene rockers --size 12 --seed 4").out, outcome.out);
}

TEST_F(SceneCommand, ReadsSceneFilesAndFindsTheirContacts) {
  Write("two.json", R"({"lcpbench_scene": 1, "gravity": [0, -9.81], "bodies": [
      {"name": "floor", "fixed": true, "shape": {"box": {"width": 4, "height": 1}}, "position": [0, -0.5]},
      {"name": "ball", "density": 1, "shape": {"disc": {"radius": 1}}, "position": [0, 1]}]})");
  const CommandOutcome outcome = Succeed("scene " + Path("two.json") + " --solver pgs");
  // The ball's weight last.
  for (const char* part : {"active, f &gt; 0 (1)", "pgs", ">30.8 N<"}) ExpectPart(outcome.out, part);
}

// The picture and the motion have one notion of depth.
TEST_F(SceneCommand, BodiesThatOverlapDeeperThanTheirMotionTakesAreRefusedByName) {
  const std::string file = std::string(LCPBENCH_SOURCE_DIR) + "/tests/data/reports/overlap-at-start.json";
  const CommandOutcome taken = Succeed("sequence " + file + " --level velocity --steps 10");
  EXPECT_NE(taken.error.find("worst penetration 1.3e-05 m"), std::string::npos) << taken.error;
  Succeed("scene " + file + " --level velocity");

  Write("same.json", R"({"lcpbench_scene": 1, "bodies": [
      {"name": "this", "density": 1, "shape": {"disc": {"radius": 1}}},
      {"name": "that", "density": 1, "shape": {"disc": {"radius": 1}}}]})");
  for (const char* level : {"acceleration", "velocity"}) {
    const std::string options = Path("same.json") + " --level " + level;
    ExpectMistake("sequence " + options, "bodies 'this' (edge 0) and 'that' (edge 0) overlap by");
    ExpectMistake("scene " + options, "bodies 'this' (edge 0) and 'that' (edge 0) overlap by");
  }
}

TEST_F(SceneCommand, WritesASceneFileOfWhatMovesFromThenOn) {
  Succeed("scene rockers --size 12 --seed 3 --time 0.05 -o " + Path("x.json"));
  const std::string all = Run("sequence rockers --size 12 --seed 3 --steps 53").out;
  const std::string rest = Run("sequence " + Path("x.json") + " --steps 3").out;
  // The problem of step 50 is the file's first; names and what is told of the motion differ.
  const auto problem = [](const std::string& text, std::size_t line) {
    Json record = Records(text).at(line);
    record.erase("id");
    record.erase("motion");
    return record.dump();
  };
  EXPECT_GT(problem(rest, 0).size(), 100U);
  EXPECT_EQ(problem(rest, 0), problem(all, 50));
  Succeed("scene " + Path("x.json") + " -o " + Path("x.svg"));
}

// What moves does not: each of these went on for ever.
TEST_F(SceneCommand, WhatCannotAdvanceEndsWithTheReason) {
  const auto ball = [&](const std::string& name, const std::string& motion, const std::string& state) {
    Write(name, R"({"lcpbench_scene": 1, "motion": {)" + motion + R"(}, "bodies": [
        {"name": "floor", "fixed": true, "shape": {"box": {"width": 100000, "height": 1}}, "position": [0, -0.5]},
        {"name": "ball", "density": 1, "shape": {"disc": {"radius": 1}}, )" +
                    state + "}]}");
    return Path(name);
  };
  const std::string fast =
      ball("fast.json", R"("level": "acceleration")", R"("position": [0, 3], "velocity": [1e29, 0])");
  const std::string far = ball("far.json", R"("level": "velocity")", R"("position": [0, 1e29], "velocity": [0, 1])");
  const std::string tiny = ball("tiny.json", R"("level": "velocity", "step": 1e-30)", R"("position": [0, 3])");
  for (const auto& [file, why] :
       {std::pair(fast, "more than 10000 events or steps within"), std::pair(far, "below the spacing of doubles"),
        std::pair(tiny, "do not advance the time")}) {
    ExpectMistake("scene " + file + " --time 0.05 -o " + Path("x.svg"), why);
  }
  const CommandOutcome outcome = Run("sequence " + fast + " --steps 1");
  EXPECT_EQ(outcome.status, 1);
  EXPECT_NE(outcome.error.find("stopped: more than 10000 events or steps"), std::string::npos) << outcome.error;
  // It does advance, but would take a thousand years.
  const std::string slow = ball("slow.json", R"("level": "velocity", "step": 1e-12)", R"("position": [0, 3])");
  ExpectMistake("scene " + slow + " --time 1000 --budget 0.2 -o " + Path("x.svg"), "not finished within 0.2 s");
  Succeed("scene " + far + " -o " + Path("x.svg"));
}

TEST_F(SceneCommand, WritesAnAnimationPage) {
  const CommandOutcome outcome =
      Succeed("scene disc-pile --size 6 --level velocity --duration 0.1 --fps 30 --animate " + Path("x.html"));
  const std::string page = ReadFile(folder_ / "x.html");
  EXPECT_EQ(page.find("<!DOCTYPE html>"), 0U);
  EXPECT_NE(page.find("\"frameCount\":4"), std::string::npos);
}

}  // namespace
}  // namespace lcpbench
