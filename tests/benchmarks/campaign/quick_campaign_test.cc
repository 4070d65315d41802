// What `lcpbench run` does when it is asked for nothing else: a campaign of several manifests, with sequences.

#include <regex>

#include "benchmarks/campaign/named_campaigns.h"
#include "benchmarks/collection/manifest.h"
#include "solvers/registry.h"
#include "tests/benchmarks/command/command_fixture.h"

namespace lcpbench {
namespace {

// By id.
std::map<std::string, ManifestEntry> Problems(const std::string& set) {
  std::map<std::string, ManifestEntry> problems;
  for (const ManifestEntry& entry : ReadManifest(LCPBENCH_SOURCE_DIR "/data/" + set + ".json").problems) {
    problems.emplace(entry.id, entry);
  }
  return problems;
}

class QuickCampaign : public CommandTest {};

// A key of a list that is misspelt, or split by a line break, would be missing from the published numbers.
TEST(NamedCampaign, NamesSolversOfTheRegistryAndNoneTwice) {
  for (const CampaignPlan& plan : NamedCampaigns()) {
    std::set<std::string> keys;
    for (const std::string& key : plan.solvers) {
      EXPECT_TRUE(keys.insert(key).second) << plan.name << ": " << key;
      constexpr std::string_view kTuned = "-tuned";
      const std::string base = key.ends_with(kTuned) ? key.substr(0, key.size() - kTuned.size()) : key;
      EXPECT_NO_THROW(FindSolver(base)) << plan.name << ": " << key;
    }
    EXPECT_LE(keys.size() + 2, 50U) << plan.name;  // with the two builds for narrower instruction sets
  }
}

TEST_F(QuickCampaign, HasASpreadOfEverything) {
  const CommandOutcome listed = Succeed("run --benchmark_list_tests");
  EXPECT_EQ(listed.out, Run("run --suite quick --benchmark_list_tests").out);
  std::set<std::string> problems;
  std::set<std::string> sequences;
  std::map<std::string, std::set<std::string>> tiers;  // by solver
  std::set<std::string> stepped;                       // solvers
  for (const std::string& name : Lines(listed.out)) {
    const std::vector<std::string> parts = Split(name, '/');
    ASSERT_GE(parts.size(), 4U) << name;
    (parts[0] == "solve" ? problems : sequences).insert(parts[1]);
    tiers[parts[2]].insert(parts[3]);
    if (parts[0] == "steps") stepped.insert(parts[2]);
  }
  // What a newcomer's first report compares with (cmake/packages/packages.txt).
  for (const char* engine : {"ode-dantzig", "ode-dantzig-cfm", "bullet-dantzig", "bullet-dantzig-cfm"}) {
    EXPECT_EQ(stepped.count(engine), FindSolver(engine).available ? 1U : 0U) << engine;
  }
  for (const SolverEntry& entry : AllSolvers()) {
    // Other tests may have registered some.
    if (!entry.available || entry.origin == SolverOrigin::kExternal || !entry.base.empty()) continue;
    std::set<std::string> expected = {"1e-09"};
    if (entry.uses_tolerance) expected.insert("1e-06");
    EXPECT_EQ(tiers[entry.key], entry.takes_plain ? expected : std::set<std::string>()) << entry.key;
  }

  // Problems that count: of every family four sizes or more, and one seed of each.
  const auto standard = Problems("standard");
  std::map<std::string, std::set<Index>> sizes;
  std::size_t engine = 0;
  for (const std::string& id : problems) {
    engine += Problems("engine").count(id);
    const auto entry = standard.find(id);
    if (entry == standard.end()) continue;
    EXPECT_TRUE(sizes[entry->second.family].insert(entry->second.properties.rows).second) << id;
  }
  EXPECT_GE(engine, 16U);
  EXPECT_EQ(sizes.size(), 16U);
  Index largest = 0;
  for (const auto& [family, rows] : sizes) {
    EXPECT_GE(rows.size(), 4U) << family;
    EXPECT_GE(*rows.rbegin(), 16 * *rows.begin()) << family;
    largest = std::max(largest, *rows.rbegin());
  }
  EXPECT_EQ(largest, 400);

  // Whatever is meant to break something says what: of some of these sentences a problem each.
  std::set<std::string> purposes;
  std::size_t pathological = 0;
  for (const auto& [id, entry] : Problems("pathological")) {
    if (problems.count(id) == 0) continue;
    ++pathological;
    purposes.insert(entry.purpose);
  }
  EXPECT_GE(purposes.size(), 8U);
  EXPECT_LE(pathological, 16U);
  EXPECT_EQ(sequences.size(), 1U);
}

TEST_F(QuickCampaign, ProblemsAndSequencesOfSeveralManifestsGoIntoOneFolder) {
  const std::string command =
      "run --solvers dantzig,pgs --filter '/(disc-pile-n(2|10)-s1|idle-line-n40-s1|"
      "boxes-and-discs-n40-s1-motion/pgs/1e-06)/' --launches 1 -o " +
      Path("q");
  const CommandOutcome run = Succeed(command);
  // The first result, while the other launches run: a column per size class.
  const std::vector<std::string> told = Lines(run.out);
  ASSERT_EQ(told.size(), 5U) << run.out;
  EXPECT_NE(told[0].find("asked for 1e-06"), std::string::npos) << told[0];
  EXPECT_TRUE(std::regex_match(told[1], std::regex(" *rows +2-3 +7-12 +31-100"))) << told[1];
  const std::string time = " +[0-9.]+ (ns|µs|ms)( [0-9]+ %)?";
  EXPECT_TRUE(std::regex_match(told[2], std::regex(" *dantzig" + time + time + time))) << told[2];
  const Json campaign = ReadJson(folder_ / "q/campaign.json");
  EXPECT_EQ(campaign["name"], "quick");
  ASSERT_EQ(campaign["manifests"].size(), 4U);
  std::map<std::string, std::pair<std::string, bool>> set_and_counts;
  for (const Json& problem : JsonLines(folder_ / "q/problems.jsonl")) {
    set_and_counts[problem["problem"]] = {problem["set"].get<std::string>(), problem["counts"].get<bool>()};
  }
  const std::map<std::string, std::pair<std::string, bool>> expected = {{"disc-pile-n2-s1", {"engine", true}},
                                                                        {"disc-pile-n10-s1", {"standard", true}},
                                                                        {"idle-line-n40-s1", {"pathological", true}}};
  EXPECT_EQ(set_and_counts, expected);
  EXPECT_EQ(CellsOf(folder_ / "q").size(), 3U * 2 * 2);
  std::set<std::string> modes;
  for (const Json& pass : JsonLines(folder_ / "q/steps.jsonl")) {
    EXPECT_EQ(pass["outcome"], "completed") << pass["detail"];
    modes.insert(pass["mode"].get<std::string>());
  }
  EXPECT_EQ(modes, (std::set<std::string>{"cold", "warm"}));

  Succeed("analyse " + Path("q"));
  const std::string cells = ReadFile(folder_ / "q/analysis/cells.csv");
  for (const auto& [problem, set] : expected) EXPECT_NE(cells.find(problem), std::string::npos) << problem;
  // header + 2 modes, of one size and of all
  EXPECT_EQ(Lines(ReadFile(folder_ / "q/analysis/latency_by_solver.csv")).size(), 5U);
  // Only what counts is in the means.
  const std::string coverage = ReadFile(folder_ / "q/analysis/coverage.csv");
  EXPECT_NE(coverage.find("counted"), std::string::npos) << coverage;
  EXPECT_EQ(coverage.find("engine"), std::string::npos) << coverage;

  // All of it is one report.
  Succeed("report " + Path("q") + " -o " + Path("report/index.html"));
  const std::string page = ReadFile(folder_ / "report/index.html");
  for (const char* section : {"performance", "robustness", "sequences", "limitations"}) {
    EXPECT_NE(page.find("<section id=\"" + std::string(section) + "\">"), std::string::npos) << section;
  }
  for (const char* file : {"summary.md", "tables/coverage.tex", "tables/deadline.csv", "figures/time-by-size.svg"}) {
    EXPECT_TRUE(fs::exists(folder_ / "report" / file)) << file;
  }

  // It goes on where it is asked to.
  const std::string before = ReadFile(folder_ / "q/streams.jsonl");
  const CommandOutcome again = Succeed(command + " --resume");
  EXPECT_EQ(again.error.find("another environment"), std::string::npos) << again.error;
  EXPECT_EQ(ReadFile(folder_ / "q/streams.jsonl"), before);

  // Another build may go on with it, but not in silence.
  auto other = nlohmann::ordered_json::parse(ReadFile(folder_ / "q/campaign.json"));
  other["environment"]["git_commit"] = "0000";
  other["environment_hash"] = "0000";
  Write("q/campaign.json", other.dump());
  const CommandOutcome elsewhere = Succeed(command + " --resume");
  EXPECT_NE(elsewhere.error.find("note: begun in another environment (git_commit)"), std::string::npos)
      << elsewhere.error;
}

}  // namespace
}  // namespace lcpbench
