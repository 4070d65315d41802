// What a campaign's folder survives: a full disk, files that were cut or changed, a second writer, workers that were
// killed.

#include <sys/wait.h>

#include <csignal>

#include "tests/benchmarks/command/command_fixture.h"

namespace lcpbench {
namespace {

class KeptCampaign : public CommandTest {
 protected:
  std::string Campaign(const std::string& folder, const std::string& more = "", const std::string& solvers = "dantzig",
                       const std::string& filter = "n8", const std::string& time_limit = "60") const {
    return "run --suite " LCPBENCH_SOURCE_DIR "/data/smoke.json --tiers 1e-6 --launches 1 --no-fills" +
           (" --filter " + filter) + " --time-limit " + time_limit + " --solvers " + solvers +
           " --external 'hanging=" LCPBENCH_TEST_WORKER " hang-aloud' --external 'slow=" LCPBENCH_TEST_WORKER
           " slow' -o " +
           Path(folder) + " " + more;
  }
  // The file's lines without what is measured.
  std::vector<Json> Planned(const std::string& file) const {
    std::vector<Json> lines = JsonLines(folder_ / file);
    for (Json& line : lines) {
      Json kept;
      for (const char* field : {"problem", "solver", "size_class", "tier", "kind", "pass", "count", "exceptions"}) {
        if (line.contains(field)) kept[field] = line[field];
      }
      line = kept;
    }
    return lines;
  }
  void ExpectSame(const std::string& folder, const std::string& whole) const {
    for (const char* file : {"/problems.jsonl", "/streams.jsonl"}) {
      EXPECT_EQ(Planned(folder + file), Planned(whole + file)) << folder << file;
    }
  }
  static bool HasEnded(pid_t child, int* status) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    return waitpid(child, status, WNOHANG) != 0;
  }
  // The one that runs another program; 0: it has none. What runs the same one only keeps watch (subprocess.cc).
  static pid_t ChildOf(pid_t parent) {
    const auto program = [](pid_t process) { return ReadFile("/proc/" + std::to_string(process) + "/cmdline"); };
    const std::string process = std::to_string(parent);
    std::ifstream children("/proc/" + process + "/task/" + process + "/children");
    for (pid_t child = 0; parent > 0 && children >> child;) {
      const std::string found = program(child);
      if (!found.empty() && found != program(parent)) return child;
    }
    return 0;
  }
  // Kills so many workers, one after the other, each once `is_time`: those of the campaign, or those of its worker that
  // have the solver.
  // @param new_ones  only of processes of the solver that began afterwards: one that has judged waits for its end
  void RunWithKills(const std::string& arguments, int kills, bool of_the_solver,
                    const std::function<bool(int killed)>& is_time, bool new_ones = false) const {
    const pid_t campaign = Start(arguments, "background");
    int status = 0;
    pid_t before = 0;
    std::vector<pid_t> killed;
    while (!HasEnded(campaign, &status)) {
      const int count = static_cast<int>(killed.size());
      if (count == kills) continue;
      const pid_t worker = of_the_solver ? ChildOf(ChildOf(campaign)) : ChildOf(campaign);
      if (!is_time(count)) {
        if (worker != 0) before = worker;
        continue;
      }
      if (worker == 0 || (of_the_solver && new_ones && worker == before) ||
          (!killed.empty() && killed.back() == worker))
        continue;
      kill(worker, SIGKILL);
      killed.push_back(worker);
    }
    ASSERT_EQ(status, 0) << ReadFile(folder_ / "background");
    ASSERT_EQ(static_cast<int>(killed.size()), kills);
  }
  static void ExpectRetried(const Json& line, const Json& at) {
    ASSERT_TRUE(line.contains("retried")) << line.dump();
    EXPECT_EQ(line["retried"].size(), 1U);
    EXPECT_EQ(line["retried"][0]["at"], at);
    ExpectPart(line["retried"][0]["detail"], "signal 9");
  }
};

TEST_F(KeptCampaign, ATornTailIsMadeAgain) {
  Succeed(Campaign("c"));
  fs::copy(folder_ / "c", folder_ / "whole");
  std::mt19937 random(5);
  for (const std::string file : {"problems.jsonl", "streams.jsonl"}) {
    for (int trial = 0; trial < 4; ++trial) {
      fs::resize_file(folder_ / "c" / file, random() % fs::file_size(folder_ / "whole" / file));
      Succeed(Campaign("c", "--resume"));
      ExpectSame("c", "whole");
    }
  }
  fs::remove(folder_ / "c/problems.jsonl");
  Succeed(Campaign("c", "--resume"));
  ExpectSame("c", "whole");
}

TEST_F(KeptCampaign, WhatIsNotOfThePlanIsRefusedByFileAndLine) {
  Succeed(Campaign("c"));
  const auto with = [](Json line, const char* field, const Json& value) {
    line[field] = value;
    return line.dump();
  };
  const Json problem = JsonLines(folder_ / "c/problems.jsonl").at(1);
  const Json line = JsonLines(folder_ / "c/streams.jsonl").at(1);
  const std::string noise = "\x01\xff\xfe{]";
  const std::vector<std::pair<std::string, std::string>> wrong[] = {
      {{noise, "not valid JSON"},
       {problem.dump() + problem.dump(), "not valid JSON"},
       {R"({"problem":"x",)" + problem.dump().substr(1), "/problem: this key is given twice"},
       {JsonLines(folder_ / "c/problems.jsonl").at(0).dump(), "problem"},
       {with(problem, "rows", 7777), "rows 7777"},
       {with(problem, "weight", 0.123), "weight"},
       {with(problem, "floor", "x"), "floor"},
       {with(problem, "size_class", "huge"), "size_class"}},
      {{noise, "not valid JSON"},
       {R"({"solver":"x",)" + line.dump().substr(1), "/solver: this key is given twice"},
       {JsonLines(folder_ / "c/streams.jsonl").at(0).dump(), "a second line of dantzig"},
       {with(line, "pass", -1), "field 'pass'"},
       {with(line, "pass", 1.5), "field 'pass'"},
       {with(line, "kind", "jugde"), "kind \"jugde\""},
       {with(line, "solver", "pgs"), "solver 'pgs'"},
       {with(line, "tier", 1e-5), "tier"},
       {with(line, "size_class", "huge"), "'huge'"},
       {with(line, "first", 4711), "a task"},
       {with(line, "pass", (1LL << 32) + line["pass"].get<int>()), "pass 42949672"},
       {with(line, "excluded", nullptr), "field 'excluded'"},
       {with(line, "exceptions", Json::array({{{"at", 1e30}}})), "field 'exceptions/0/at'"},
       {"{\"pass\":1," + line.dump().substr(1), "/pass: this key is given twice"}}};
  for (const std::string file : {"problems.jsonl", "streams.jsonl"}) {
    const std::string before = ReadFile(folder_ / "c" / file);
    ExpectSecondLineRefused("c/" + file, wrong[file == "streams.jsonl"], Campaign("c", "--resume"));
    Write("c/" + file, before + JsonLines(folder_ / "c" / file).back().dump() + "\n");
    ExpectMistake(Campaign("c", "--resume"), file + ":" + std::to_string(Lines(before).size() + 1) + ":");
    Write("c/" + file, before);
  }
  const std::string campaign = ReadFile(folder_ / "c/campaign.json");
  for (const std::string& text :
       {campaign.substr(0, campaign.size() / 2), noise, std::string("{}"), std::string("[]"),
        "{\"schema\":1," + campaign.substr(1), std::string("{\"schema\":\"lcpbench-campaign/2\"}"), std::string()}) {
    Write("c/campaign.json", text);
    ExpectMistake(Campaign("c", "--resume"), "campaign.json: ");
  }
}

TEST_F(KeptCampaign, ASecondWriterIsToldWhoIsAtWork) {
  const pid_t holder = Start(Campaign("c", "", "dantzig,hanging"), "background");
  int status = 0;
  while (!fs::exists(folder_ / "c/streams.jsonl")) ASSERT_FALSE(HasEnded(holder, &status));
  // The holder solves for a minute; the second is refused before it has written anything.
  ExpectMistake(Campaign("c", "--resume"),
                "campaign.lock: is locked by process " + std::to_string(holder) + " on host ");
  kill(holder, SIGKILL);
  waitpid(holder, &status, 0);
  // The lock has died with it: what is found now is the other plan.
  ExpectMistake(Campaign("c", "--resume"), "another plan");
}

TEST_F(KeptCampaign, AWorkerThatSomethingElseKillsIsGivenASecondTry) {
  for (const bool of_the_solver : {false, true}) {
    for (int kills = 1; kills <= 2; ++kills) {
      const std::string folder = "k" + std::to_string(kills) + (of_the_solver ? "s" : "");
      // Each in the midst of the solve.
      RunWithKills(Campaign(folder, "", "hanging", "rockers-n8-", "0.1"), kills, of_the_solver, [&](int killed) {
        const std::vector<std::string> told = Lines(ReadFile(folder_ / "background"));
        return std::count(told.begin(), told.end(), "hangs") > killed;
      });
      const Json line = JsonLines(folder_ / folder / "streams.jsonl").at(0);
      ASSERT_EQ(line["exceptions"].size(), 1U) << line.dump();
      // A solver in a process of its own is told by the end of that process.
      const char* twice = of_the_solver ? "numerical_failure" : "crashed";
      EXPECT_EQ(line["exceptions"][0]["claim"], kills == 2 ? twice : "time_limit") << line.dump();
      ExpectRetried(line, 0);
      if (kills == 2) Succeed("analyse " + Path(folder));
    }
  }
}

TEST_F(KeptCampaign, AWorkerThatSomethingElseKillsInATimedPassIsGivenASecondTry) {
  for (const bool of_the_solver : {false, true}) {
    const std::string folder = of_the_solver ? "s" : "w";
    RunWithKills(
        Campaign(folder, "", "slow"), 1, of_the_solver,
        [&](int) { return !ReadFile(folder_ / folder / "streams.jsonl").empty(); }, /*new_ones=*/true);
    const Json line = JsonLines(folder_ / folder / "streams.jsonl").at(1);
    ExpectHas(line, {{"kind", "fresh"}, {"outcome", "completed"}, {"failed", Json::array()}});
    ExpectRetried(line, nullptr);
    Succeed("analyse " + Path(folder));
  }
}

}  // namespace
}  // namespace lcpbench
