// Settings that are tuned: the declared space is the registry's, and what was chosen runs beside the defaults.

#include "model/contact/assembly.h"
#include "model/scenes/scene.h"
#include "solvers/auto/auto_limits.h"
#include "support/number_text.h"
#include "tests/benchmarks/command/command_fixture.h"
#include "tests/solvers/solve_with.h"

namespace lcpbench {
namespace {

constexpr const char* kTunedManifest = LCPBENCH_SOURCE_DIR "/data/smoke.json";

// By value: what a loop runs over must outlive it.
Json DeclaredSolvers() { return ReadJson(LCPBENCH_SOURCE_DIR "/data/tuning.json").at("solvers"); }

TEST(TuningSpace, DeclaresEverySolverOnce) {
  std::set<std::string> declared;
  for (const auto& solver : DeclaredSolvers()) {
    EXPECT_TRUE(declared.insert(solver["solver"].get<std::string>()).second) << solver["solver"];
  }
  for (const SolverEntry& entry : AllSolvers()) {
    // Other tests may have registered some.
    if (entry.origin == SolverOrigin::kExternal || !entry.base.empty()) continue;
    EXPECT_EQ(declared.erase(entry.key), 1U) << entry.key;
  }
  EXPECT_TRUE(declared.empty()) << *declared.begin() << " is no solver";
}

TEST(TuningSpace, EveryDeclaredValueIsTaken) {
  for (const auto& solver : DeclaredSolvers()) {
    const std::string key = solver["solver"];
    if (!FindSolver(key).available) continue;
    for (const auto& [name, values] : solver["settings"].items()) {
      for (const std::string value : values) EXPECT_NO_THROW(MakeSolver(key, {{name, value}})) << key << name << value;
    }
  }
}

TEST(TriedLimits, AreAllLimitsOfAutoInValuesThatItTakes) {
  const auto trials = ReadJson(LCPBENCH_SOURCE_DIR "/data/limits.json").at("trials");
  ASSERT_EQ(trials.size(), kAutoLimits.size());
  for (std::size_t k = 0; k < kAutoLimits.size(); ++k) {
    const std::string name = trials[k]["limit"];
    EXPECT_EQ(name, kAutoLimits[k].name);
    for (const std::string value : trials[k]["values"]) {
      EXPECT_NO_THROW(MakeSolver("auto", {{name, value}})) << name << value;
      EXPECT_NE(ParseNumber(value), kAutoLimits[k].Of(kDefaultLimits)) << name;
    }
  }
}

// Else the default would be tried twice, and another one never.
TEST(TuningSpace, FirstValuesAreTheDefaults) {
  for (const char* scene : {"boxes-and-discs", "disc-track"}) {
    const LcpProblem problem = AssembleContactLcp(GenerateScene(scene, 60, 3)).problem;
    for (const auto& solver : DeclaredSolvers()) {
      const std::string key = solver["solver"];
      Settings first;
      for (const auto& [name, values] : solver["settings"].items()) first[name] = values[0];
      if (!FindSolver(key).available || first.empty()) continue;
      SCOPED_TRACE(std::string(scene) + ", " + key);
      const LcpResult expected = SolveBy(key, problem, 1e-6);
      const LcpResult found = SolveBy(key, problem, 1e-6, first);
      EXPECT_EQ(found.status, expected.status);
      EXPECT_EQ(found.iterations, expected.iterations);
      EXPECT_TRUE(found.f == expected.f);
    }
  }
}

class TunedSettings : public CommandTest {
 protected:
  std::string Campaign(const std::string& folder, const std::string& more) const {
    return std::string("run --suite ") + kTunedManifest + " --filter 'rockers-n8-' --tiers 1e-6 --launches 1 -o " +
           Path(folder) + " " + more;
  }
  std::map<std::string, Json> SolversOf(const std::string& folder) const {
    const auto campaign = ReadJson(folder_ / folder / "campaign.json");
    std::map<std::string, Json> solvers;
    for (const auto& solver : campaign["solvers"]) solvers[solver["key"]] = solver;
    return solvers;
  }
};

TEST_F(TunedSettings, RunBesideTheDefaults) {
  Write("tuned.json", R"({"schema": "lcpbench-tuned/2", "budget": 5, "solvers": [
    {"solver": "pgs", "rows": 9, "chosen": {"relaxation": "1.3", "sweep": "forward"}},
    {"solver": "dantzig", "rows": 9, "chosen": {}}, {"solver": "lemke", "rows": 9, "chosen": {"block_start": "yes"}}]})");
  Succeed(Campaign("c", "--solvers dantzig,pgs,bpp --tuned " + Path("tuned.json")));
  // None for a solver whose default stays, and for one that the campaign has not.
  const auto solvers = SolversOf("c");
  ASSERT_EQ(solvers.size(), 4U);
  ExpectHas(solvers.at("pgs-tuned"), {{"setting", "variant"}, {"base", "pgs"}});
  EXPECT_EQ(solvers.at("pgs-tuned")["settings"], (Json{{"9 rows", "relaxation=1.3,sweep=forward"}}));
  const Json tuning = ReadJson(folder_ / "c" / "campaign.json")["tuning"];
  ExpectHas(tuning, {{"file", "tuned.json"}, {"budget", 5}});
  EXPECT_EQ(tuning["sha256"].get<std::string>().size(), 64U);
  // The worker process knows it too, and it sweeps otherwise.
  std::map<std::string, int> iterations;
  for (const auto& cell : CellsOf(folder_ / "c")) {
    EXPECT_EQ(cell["passes"], true) << cell.dump();
    iterations[cell["solver"]] = cell["iterations"];
  }
  ASSERT_EQ(iterations.size(), 4U);
  EXPECT_NE(iterations["pgs-tuned"], iterations["pgs"]);

  Succeed(Campaign("d", "--solvers dantzig,pgs"));
  EXPECT_EQ(SolversOf("d").size(), 2U);
  EXPECT_FALSE(ReadJson(folder_ / "d" / "campaign.json").contains("tuning"));
}

// The numbers of sweeps tell which ones ran.
TEST_F(TunedSettings, AreThoseOfTheNearestSize) {
  Write("tuned.json", R"({"schema": "lcpbench-tuned/2", "budget": 5, "solvers": [
    {"solver": "pgs", "rows": 10, "chosen": {"relaxation": "1.3", "sweep": "forward"}},
    {"solver": "pgs", "rows": 100, "chosen": {}},
    {"solver": "pgs", "rows": 1000, "chosen": {"relaxation": "1.2"}}]})");
  // Who names it needs no base for it.
  Succeed(std::string("run --suite ") + kTunedManifest + " --filter rockers --tiers 1e-6 --launches 1 -o " + Path("c") +
          " --solvers pgs-tuned,small,default --variant small=pgs,relaxation=1.3,sweep=forward --variant default=pgs " +
          "--tuned " + Path("tuned.json"));
  EXPECT_EQ(SolversOf("c").at("pgs-tuned")["settings"],
            (Json{{"10 rows", "relaxation=1.3,sweep=forward"}, {"100 rows", ""}, {"1000 rows", "relaxation=1.2"}}));
  std::map<std::string, std::map<std::string, int>> iterations;  // by problem and solver
  for (const auto& cell : CellsOf(folder_ / "c")) iterations[cell["problem"]][cell["solver"]] = cell["iterations"];
  ASSERT_EQ(iterations.size(), 2U);
  for (auto& [problem, of] : iterations) {
    const bool is_small = problem.find("-n8-") != std::string::npos;
    EXPECT_NE(of.at("small"), of.at("default")) << problem;
    EXPECT_EQ(of.at("pgs-tuned"), of.at(is_small ? "small" : "default")) << problem;
  }
}

TEST(SolversBySize, RunWhatIsMeantForTheNearestNumberOfRows) {
  RegisterSolverBySize("by-size", "pgs", {{10, "pgs"}, {100, "psor"}, {1000, "nncg"}});
  const SolverEntry& entry = FindSolver("by-size");
  for (const auto& [rows, key] :
       {std::pair(1, "pgs"), std::pair(10, "pgs"), std::pair(31, "pgs"), std::pair(32, "psor"), std::pair(316, "psor"),
        std::pair(317, "nncg"), std::pair(1'000'000, "nncg")}) {
    EXPECT_EQ(KeyForRows(entry, rows), key) << rows;
  }
  EXPECT_EQ(KeyForRows(FindSolver("psor"), 10), "psor");
  EXPECT_EQ(entry.base, "pgs");
}

TEST_F(TunedSettings, WhatIsNoTunedFileIsRefusedByOneLine) {
  for (const auto& refused : RefusalCases("tuned")) {
    Write("wrong.json", refused[0]);
    ExpectMistake(Campaign("c", "--solvers pgs --tuned " + Path("wrong.json")), refused[1]);
    EXPECT_FALSE(fs::exists(folder_ / "c"));
  }
  ExpectMistake(Campaign("c", "--solvers pgs --tuned " + Path("none.json")), "none.json");
}

TEST_F(TunedSettings, CampaignsSayWhichKeysRunTuned) {
  Succeed(Campaign("c", "--solvers pgs,dart-pgs,dart-pgs-default,bullet-dantzig,again --variant again=pgs"));
  const auto solvers = SolversOf("c");
  for (const auto& [key, setting] :
       {std::pair("pgs", "default"), std::pair("dart-pgs", "tuned"), std::pair("dart-pgs-default", "default"),
        std::pair("bullet-dantzig", "default"), std::pair("again", "variant")}) {
    EXPECT_EQ(solvers.at(key)["setting"], setting) << key;
  }
}

// The whole way, small: what tune writes, run takes.
TEST_F(TunedSettings, TuneWritesWhatRunTakes) {
  // A peer without settings, where there is one, is left out.
  const std::string peer = FindSolver("bullet-lemke").available ? ",bullet-lemke" : "";
  Succeed("tune --solvers lemke" + peer + " --budget 2 --sizes 12 --problem-seed 77 --launches 1 --folder " +
          Path("t") + " -o " + Path("tuned.json"));
  const auto tuned = ReadJson(folder_ / "tuned.json");
  EXPECT_EQ(tuned["budget"], 2);
  EXPECT_EQ(tuned["problems"]["count"], 42);  // three of each family that is not sealed
  EXPECT_EQ(tuned["solvers"][0]["rows"], 12);
  ASSERT_EQ(tuned["solvers"].size(), 1U);
  EXPECT_EQ(tuned["solvers"][0]["configurations"], 2);
  EXPECT_EQ(tuned["solvers"][0]["tried"][1]["settings"], (Json{{"block_start", "yes"}}));
  Succeed(Campaign("c", "--solvers lemke --tuned " + Path("tuned.json")));
  EXPECT_EQ(SolversOf("c").size(), tuned["solvers"][0]["chosen"].empty() ? 1U : 2U);
}

}  // namespace
}  // namespace lcpbench
