// The commands `collection` and `import`, as a user calls them.

#include "tests/benchmarks/command/command_fixture.h"

namespace lcpbench {
namespace {

class CollectionCommand : public CommandTest {};

TEST_F(CollectionCommand, ChecksHashesAndSaysWhichProblemIsAnother) {
  std::string text = ReadFile(LCPBENCH_SOURCE_DIR "/data/smoke.json");
  Write("smoke.json", text);
  const CommandOutcome good = Succeed("collection check " + Path("smoke.json"));
  EXPECT_NE(good.out.find("32 of 32"), std::string::npos) << good.out;
  char& digit = text.at(text.find("\"sha256\":\"") + 10);
  digit = digit == 'a' ? 'b' : 'a';
  Write("other.json", text);
  const CommandOutcome bad = Run("collection check " + Path("other.json"));
  EXPECT_EQ(bad.status, 1);
  EXPECT_NE(bad.out.find("31 of 32"), std::string::npos) << bad.out;
}

TEST_F(CollectionCommand, BuildsATierAsItIsCommitted) {
  Succeed("collection build engine -o " + folder_.string());
  EXPECT_EQ(ReadFile(folder_ / "engine.json"), ReadFile(LCPBENCH_SOURCE_DIR "/data/engine.json"));
}

TEST_F(CollectionCommand, WritesProblemsThatAreImportedWithTheSameHashes) {
  const std::string manifest = LCPBENCH_SOURCE_DIR "/data/smoke.json";
  fs::create_directories(folder_ / "set" / "deeper");
  Succeed("collection write " + manifest + " rockers-n8-s11 rockers-n40-s11 -o " + Path("set/two.jsonl"));
  Succeed("collection write " + manifest + " gear-train-n8-s11 -o " + Path("gears.jsonl"));
  for (const char* file : {"gears.mtx", "fclib.hdf5"}) {
    Succeed("convert " + Path("gears.jsonl") + " -o " + Path("set/deeper/") + file);
  }
  Succeed("import " + Path("set") + " --provenance 'a test' --licence CC0-1.0");
  const CommandOutcome check = Succeed("collection check " + Path("set/manifest.json"));
  EXPECT_NE(check.out.find("4 of 4"), std::string::npos) << check.out;

  std::map<std::string, Json> ours;
  const auto committed = Json::parse(ReadFile(manifest));
  for (const auto& problem : committed["problems"]) ours[problem["id"]] = problem;
  ours["gears"] = ours["gear-train-n8-s11"];  // of a Matrix Market file the id is its name; FCLib's files keep it
  const auto imported = Json::parse(ReadFile(folder_ / "set" / "manifest.json"));
  EXPECT_EQ(imported["name"], "set");
  EXPECT_EQ(imported["problems"].size(), 4U);
  for (const auto& theirs : imported["problems"]) {
    ExpectHas(theirs, {{"provenance", "a test"}, {"licence", "CC0-1.0"}});
    EXPECT_EQ(theirs["reference"]["kind"], "certified");
    for (const char* field : {"sha256", "rows", "rank", "condition", "fraction_active", "nonzeros_A", "bodies"}) {
      EXPECT_EQ(theirs[field], ours.at(theirs["id"])[field]) << field;
    }
  }
}

TEST_F(CollectionCommand, ImportLeavesOutWhatCannotBeReadAndSaysSo) {
  fs::create_directories(folder_ / "set");
  Write("set/a.jsonl",
        "{\"id\":\"good\",\"A\":[[2,1],[1,2]],\"b\":[-1,1]}\n{\"id\":\"bad\",\"A\":[[1]],\"b\":[1,2]}\n");
  Write("set/b.mtx", "%%MatrixMarket matrix coordinate real general\n1 1 1\n1 1 nan\n");
  const CommandOutcome outcome = Run("import " + Path("set") + " --provenance p --licence CC0-1.0");
  EXPECT_EQ(outcome.status, 2);
  EXPECT_NE(outcome.error.find("a.jsonl:2"), std::string::npos) << outcome.error;
  EXPECT_NE(outcome.error.find("b_b.mtx"), std::string::npos) << outcome.error;
  const auto imported = Json::parse(ReadFile(folder_ / "set" / "manifest.json"));
  ASSERT_EQ(imported["problems"].size(), 1U);
  EXPECT_EQ(imported["problems"][0]["id"], "good");
  EXPECT_EQ(imported["problems"][0]["file"]["line"], 1);
}

TEST_F(CollectionCommand, ProblemsWithoutRowsGoThroughEveryCommand) {
  fs::create_directories(folder_ / "set");
  const std::string reported = LCPBENCH_SOURCE_DIR "/tests/data/reports/no-rows.jsonl";
  std::string lines = ReadFile(reported) + "\n";
  for (const char* form :
       {R"({"id":"sparse","n":0,"A":{"shape":[0,0],"row":[],"col":[],"val":[]},"b":[],"bilateral":[],"joint":[]})",
        R"({"id":"factors","J":[],"invM":[1,1,1],"b":[]})", R"({"id":"nothing","J":[],"invM":[],"b":[],"contacts":[]})",
        R"({"id":"no-bodies","J":[[],[]],"invM":[],"b":[1,2]})"}) {
    lines += std::string(form) + "\n";
  }
  Write("set/lines.jsonl", lines);
  for (const char* format : {"mtx", "hdf5", "dat", "qps", "npz"}) {
    Succeed("convert " + reported + " -o " + Path(std::string("set/") + format + "." + format));
  }
  fs::remove(folder_ / "set/hdf5.hdf5");  // which keeps the id, of the first line
  for (const char* file : {"set/lines.jsonl", "set/mtx.mtx", "set/dat.dat"}) {
    for (const char* arguments : {"solve --solver auto", "solve --solver pgs --floor", "certify"}) {
      const bool is_certify = arguments == std::string("certify");
      if (is_certify && file != std::string("set/lines.jsonl")) continue;
      for (const Json& answer : Answers(arguments + (" " + Path(file)))) {
        EXPECT_EQ(answer["status"], "solved") << answer;
        const bool has_rows = answer["id"] == "no-bodies";
        EXPECT_EQ(answer["f"], has_rows ? Json({0.0, 0.0}) : Json::array()) << answer;
        EXPECT_EQ(is_certify ? answer["certified"] : answer["verdict"]["passes"], true) << answer;
      }
    }
  }
  Succeed("import " + Path("set") + " --provenance 'a test' --licence CC0-1.0");
  const std::string manifest = Path("set/manifest.json");
  const CommandOutcome check = Succeed("collection check " + manifest);
  EXPECT_NE(check.out.find("9 of 9"), std::string::npos) << check.out;
  EXPECT_EQ(Lines(Succeed("collection write " + manifest).out).size(), 9U);
  Succeed("run --suite " + manifest + " --solvers auto,dantzig --launches 1 -o " + Path("campaign"));
  for (const Json& cell : CellsOf(folder_ / "campaign")) EXPECT_EQ(cell["passes"], true) << cell;
  Succeed("analyse " + Path("campaign"));
}

// What docs/recording.md tells a user to do.
TEST_F(CollectionCommand, ARecorderOfAUsersOwnEngineGivesProblemsThatAreSolved) {
  const std::string example = LCPBENCH_SOURCE_DIR "/examples/record_discs.py";
  ASSERT_EQ(std::system(("/usr/bin/python3 " + example + " 12 200 > " + Path("discs.jsonl")).c_str()), 0);
  for (const char* level : {"velocity", "acceleration"}) {
    Succeed("recording --level " + std::string(level) + " " + Path("discs.jsonl") + " -o " + Path("problems.jsonl"));
    const std::size_t problems = Lines(ReadFile(folder_ / "problems.jsonl")).size();
    EXPECT_GT(problems, 10U) << level;
    const std::vector<Json> answers = Answers("solve --solver auto --tolerance 1e-9 " + Path("problems.jsonl"));
    EXPECT_EQ(answers.size(), problems);
    for (const Json& answer : answers) EXPECT_EQ(answer["status"], "solved") << answer;
  }

  // A mistake in the header is one mistake, however many steps follow.
  std::string text = ReadFile(folder_ / "discs.jsonl");
  const std::string dimension = "\"dimension\": 2";
  Write("wrong.jsonl", text.replace(text.find(dimension), dimension.size(), "\"dimension\": 4"));
  ExpectMistake("recording " + Path("wrong.jsonl"), "wrong.jsonl:1: /dimension: expected 2 or 3, found 4");
}

}  // namespace
}  // namespace lcpbench
