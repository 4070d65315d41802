// What a campaign survives: one of its system calls, or of its allocations, fails, or it is killed there. Each of them
// in turn; afterwards --resume gives what an undisturbed campaign gives.

#include <cerrno>

#include "benchmarks/collection/build.h"
#include "benchmarks/collection/manifest.h"
#include "model/scenes/random.h"
#include "support/subprocess.h"
#include "tests/benchmarks/command/command_fixture.h"
#include "tests/fuzz/corpus.h"
#include "tests/fuzz/laws.h"
#include "tests/fuzz/scene_mutation.h"
#include "tests/support/cases.h"

namespace lcpbench {
namespace {

constexpr int kKilled = 0;  // instead of errno
constexpr int kSigkill = 128 + 9;
constexpr const char* kKernelsTried = "LCPBENCH_BLAS_KERNELS_TRIED";

// Without what is measured.
Json Repeatable(const Json& json) {
  static const std::set<std::string> measured = {"started",     "peak_bytes", "factor_share",
                                                 "disturbance", "preempted",  "retried"};
  Json kept = json;
  if (json.is_object()) {
    for (const auto& [key, value] : json.items()) {
      if (measured.count(key) > 0 || key.ends_with("_s")) {
        kept.erase(key);
      } else {
        kept[key] = Repeatable(value);
      }
    }
  } else if (json.is_array()) {
    std::transform(json.begin(), json.end(), kept.begin(), Repeatable);
  }
  return kept;
}

class FaultInjection : public CommandTest {
 protected:
  void SetUp() override {
    if (SanitizerReservesMemory()) GTEST_SKIP() << "a sanitizer stands between the program and the C library";
    CommandTest::SetUp();
    // As if each command had been started anew for other kernels of BLAS: doing so would leave the faults behind.
    setenv(kKernelsTried, "1", 1);
    fs::create_directory(folder_ / "p");
    for (const std::string scene : {"rockers --size 8", "gear-train --size 12"}) {
      Write("p/" + scene.substr(0, 4) + ".jsonl", Succeed("generate " + scene + " --seed 1").out);
    }
    Succeed("import " + Path("p") + " --name tiny --licence none --provenance none");
    Json manifest = ReadJson(folder_ / "p/manifest.json");
    Manifest motions;
    motions.sequences = {MeasureSequence(Recipe{"discs-in-v", 12, 1, {}}, 3)};
    manifest["sequences"] = Json::parse(FormatManifest(motions))["sequences"];
    Write("p/manifest.json", manifest.dump());
    Succeed(Campaign("whole"));
    whole_ = Results("whole");
  }
  void TearDown() override {
    unsetenv(kKernelsTried);
    CommandTest::TearDown();
  }

  // Runs one of our own solvers and one in a process of its own, on two problems and a sequence.
  std::string Campaign(const std::string& folder) const {
    return "run --resume --suite " + Path("p/manifest.json") +
           " --tiers 1e-6 --launches 1 --time-limit 60 --filter 'solve/|/cold$' "
           "--solvers dantzig,other --external 'other=" LCPBENCH_TEST_WORKER " dantzig' -o " +
           Path(folder);
  }

  std::map<std::string, std::vector<Json>> Results(const std::string& folder) const {
    std::map<std::string, std::vector<Json>> results;
    results["campaign.json"] = {Repeatable(ReadJson(folder_ / folder / "campaign.json"))};
    for (const char* file : {"problems.jsonl", "streams.jsonl", "steps.jsonl"}) {
      for (const Json& line : JsonLines(folder_ / folder / file)) results[file].push_back(Repeatable(line));
    }
    return results;
  }

  CommandOutcome RunWith(const std::string& kind, long k, int error, const std::string& folder) {
    const std::string fault = kind + " " + std::to_string(k) + " " + std::to_string(error) + " " + Path("count");
    const std::string faulty =
        "timeout -s KILL 100 env LD_PRELOAD=" LCPBENCH_FAILING_CALLS " LCPBENCH_FAULT='" + fault + "' ";
    const std::string program = std::exchange(program_, faulty + program_);
    CommandOutcome outcome = Run(Campaign(folder));
    program_ = program;
    return outcome;
  }

  // How many calls of this kind an undisturbed campaign makes.
  long Calls(const std::string& kind) {
    EXPECT_EQ(RunWith(kind, 0, EIO, "counted").status, 0);
    fs::remove_all(folder_ / "counted");
    return std::stol(ReadFile(folder_ / "count"));
  }

  // @return whether the failure was told: the campaign may get on without some calls
  bool ExpectSurvives(const std::string& kind, long k, int error) {
    SCOPED_TRACE(kind + " " + std::to_string(k) + ", errno " + std::to_string(error));
    const std::string folder = "c";
    fs::remove_all(folder_ / folder);
    const CommandOutcome outcome = RunWith(kind, k, error, folder);
    // Passes that were disturbed are run again, so that the number of calls is not always the same.
    if (outcome.status != 0 && error == kKilled) {
      EXPECT_EQ(outcome.status, kSigkill) << outcome.error;
    } else if (outcome.error.starts_with("libgomp: Out of memory")) {
      EXPECT_EQ(outcome.status, 1);  // this library ends the process itself
    } else if (outcome.status != 0) {
      EXPECT_TRUE(outcome.status == 2 || outcome.status == 3) << outcome.status << outcome.error;
      // The others tell of progress.
      const std::vector<std::string> lines = Lines(outcome.error);
      EXPECT_EQ(lines.empty() ? "" : lines.back().substr(0, 10), "lcpbench: ") << outcome.error;
      for (const char* wrong : {"internal error", "terminate called", "unknown"}) {
        EXPECT_EQ(outcome.error.find(wrong), std::string::npos) << outcome.error;
      }
    }
    // Else nothing was begun.
    if (fs::exists(folder_ / folder / "campaign.json")) {
      Succeed(Campaign(folder));
      for (const auto& [file, lines] : Results(folder)) EXPECT_TRUE(lines == whole_.at(file)) << file;
      for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder_ / folder)) {
        EXPECT_FALSE(entry.path().filename().string().starts_with(".lcpbench-")) << entry.path();
      }
    }
    return outcome.status != 0;
  }

  // Every call of a kind in turn, or each `stride`-th, with one of the errors after the other. @return how many were
  // told
  int ExpectSurvivesEvery(const std::string& kind, const std::vector<int>& errors, long stride = 1) {
    int told = 0;
    const long calls = Calls(kind);
    for (long k = 1; k <= calls; k += stride) {
      told += ExpectSurvives(kind, k, errors[static_cast<std::size_t>(k) % errors.size()]) ? 1 : 0;
    }
    return told;
  }

  std::map<std::string, std::vector<Json>> whole_;
};

TEST_F(FaultInjection, AFullDiskOrAnErrorOfItAtAnyWrite) { EXPECT_GT(ExpectSurvivesEvery("write", {ENOSPC, EIO}), 10); }
TEST_F(FaultInjection, ALineOfProgressThatIsLost) {
  for (const long k : {1, 2, 3}) EXPECT_FALSE(ExpectSurvives("tell", k, EIO));
}
TEST_F(FaultInjection, AKillInTheMidstOfAnyWrite) { EXPECT_GT(ExpectSurvivesEvery("write", {kKilled}), 10); }
// A pass that was disturbed is sent up to three times.
TEST_F(FaultInjection, AWorkerThatCannotBeAsked) { EXPECT_GE(ExpectSurvivesEvery("send", {EPIPE, EIO}, 3), 0); }
TEST_F(FaultInjection, AKillInTheMidstOfAQuestion) { EXPECT_GT(ExpectSurvivesEvery("send", {kKilled}, 3), 3); }
TEST_F(FaultInjection, AFailedSynchronisation) { EXPECT_GT(ExpectSurvivesEvery("fsync", {EIO}), 3); }
TEST_F(FaultInjection, AKillAtASynchronisation) { EXPECT_GT(ExpectSurvivesEvery("fsync", {kKilled}), 3); }
TEST_F(FaultInjection, AFileThatCannotTakeItsPlace) { EXPECT_EQ(ExpectSurvivesEvery("rename", {EIO}), 2); }
TEST_F(FaultInjection, AKillBeforeAFileTakesItsPlace) { EXPECT_EQ(ExpectSurvivesEvery("rename", {kKilled}), 2); }
TEST_F(FaultInjection, NoProcessToBeHad) { EXPECT_GE(ExpectSurvivesEvery("fork", {EAGAIN}), 3); }
TEST_F(FaultInjection, AFileThatCannotBeRead) { EXPECT_GT(ExpectSurvivesEvery("read", {EIO}), 3); }

TEST_F(FaultInjection, NoMemoryAtSomeAllocations) {
  const long calls = Calls("malloc");
  std::mt19937 random(23);
  const int trials = Cases("LCPBENCH_ALLOCATION_FAULTS", 30);  // 100 in `make test-long`
  int told = 0;
  for (int trial = 0; trial < trials; ++trial) {
    // The first ones too, where the command has only begun.
    const long k = trial < 5 ? trial + 1 : 1 + static_cast<long>(random() % static_cast<unsigned long>(calls));
    told += ExpectSurvives("malloc", k, ENOMEM) ? 1 : 0;
  }
  EXPECT_GT(told, trials / 2);
}

TEST(JournalLaw, HoldsForTheCorpusAndItsChanges) {
  ExpectLawHolds(
      BrokenJournalLaw, "journal_corpus", 2000,
      [of_trees = Random(1), of_text = ChangesOfText()](const std::string& text, const auto& corpus) mutable {
        std::vector<std::string> changes = of_text(text, corpus);
        changes.push_back(MutatedLine(text, &of_trees));
        return changes;
      });
}

}  // namespace
}  // namespace lcpbench
