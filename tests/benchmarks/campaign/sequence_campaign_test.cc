// Campaigns on sequences: what a warm start is given, what a pass records, and what a campaign refuses.

#include "benchmarks/campaign/campaign_plan.h"
#include "benchmarks/campaign/sequence_file.h"
#include "benchmarks/campaign/sequence_runner.h"
#include "benchmarks/campaign/worker_process.h"
#include "benchmarks/collection/build.h"
#include "benchmarks/collection/manifest.h"
#include "benchmarks/collection/recipes/motion_steps.h"
#include "benchmarks/collection/recording.h"
#include "model/motion/contact_finder.h"
#include "solvers/io/gzip_file.h"
#include "solvers/lcp/verify.h"
#include "solvers/registry.h"
#include "tests/benchmarks/command/command_fixture.h"

namespace lcpbench {
namespace {

// Rows enter and leave in the first steps.
const SequenceEntry& GearTrain() {
  static const SequenceEntry entry = MeasureSequence(Recipe{"gear-train", 12, 1, {}}, 30);
  return entry;
}

// Rows only stay.
const SequenceEntry& DiscsInV() {
  static const SequenceEntry entry = MeasureSequence(Recipe{"discs-in-v", 12, 1, {}}, 8);
  return entry;
}

std::string ManifestText(std::vector<SequenceEntry> sequences) {
  Manifest manifest;
  manifest.name = "motions";
  manifest.version = "1";
  manifest.sequences = std::move(sequences);
  return FormatManifest(manifest);
}

class SequenceFile : public CommandTest {
 protected:
  std::vector<SequenceStep> WrittenAndRead(const SequenceEntry& entry) const {
    const std::string path = SequencePath(folder_.string(), entry.id);
    WriteSequenceFile(entry, ".", path);
    return ReadSequenceFile(path, entry.sha256);
  }
};

TEST_F(SequenceFile, HoldsTheProblemsAndWhichRowsAreTheSame) {
  const std::vector<SequenceStep> steps = WrittenAndRead(GearTrain());
  ASSERT_EQ(static_cast<std::int64_t>(steps.size()), GearTrain().problems);
  std::size_t k = 0;
  std::ptrdiff_t entered = 0;
  std::ptrdiff_t left = 0;
  RowMatching matching;
  ForEachSequenceProblem(std::get<Recipe>(GearTrain().source), GearTrain().steps,
                         [&](const LcpProblem& problem, const MotionProblem& met) {
                           const SequenceStep& step = steps[k];
                           ASSERT_EQ(step.problem.size(), problem.size());
                           EXPECT_TRUE((step.problem.b().array() == problem.b().array()).all());
                           const std::vector<std::optional<int>> expected = matching.Follow(met.system, met.rows);
                           ASSERT_EQ(step.previous.size(), expected.size());
                           for (std::size_t i = 0; i < expected.size(); ++i)
                             EXPECT_EQ(step.previous[i], expected[i].value_or(-1));
                           if (k > 0) {
                             const auto stay = std::count_if(step.previous.begin(), step.previous.end(),
                                                             [](int row) { return row >= 0; });
                             entered += problem.size() - stay;
                             left += steps[k - 1].problem.size() - stay;
                           }
                           ASSERT_TRUE(step.reference.w.has_value());
                           EXPECT_LE(ComputeMetrics(step.problem, met.result.f, &step.reference).w_error, 1e-12);
                           EXPECT_LE(*step.reference.floor, 1e-9);
                           ++k;
                         });
  EXPECT_EQ(entered, GearTrain().entered);
  EXPECT_EQ(left, GearTrain().left);
  EXPECT_GT(entered, 0);
  EXPECT_GT(left, 0);
}

TEST_F(SequenceFile, AnotherHashOrDamageIsRefused) {
  const std::string path = SequencePath(folder_.string(), DiscsInV().id);
  SequenceEntry other = DiscsInV();
  other.sha256 = GearTrain().sha256;
  EXPECT_THROW(WriteSequenceFile(other, ".", path), InputError);
  EXPECT_FALSE(fs::exists(path));
  WriteSequenceFile(DiscsInV(), ".", path);
  EXPECT_THROW(ReadSequenceFile(path, other.sha256), InputError);
  fs::resize_file(path, fs::file_size(path) / 2);
  EXPECT_THROW(ReadSequenceFile(path, DiscsInV().sha256), InputError);
}

// The exact answer to redundant rows may be a self-stress of 10^16: its floor must excuse nobody.
TEST_F(SequenceFile, AHugeExactAnswerLendsNeitherItsFloorNorItsW) {
  const SequenceEntry entry = MeasureSequence(Recipe{"roller-bearing", 40, 1, {}}, 2);
  const std::vector<SequenceStep> steps = WrittenAndRead(entry);
  std::size_t k = 0;
  double largest = 0;
  ForEachSequenceProblem(
      std::get<Recipe>(entry.source), entry.steps, [&](const LcpProblem& problem, const MotionProblem& met) {
        const double exact = RoundingFloor(problem, met.result.f);
        largest = std::max(largest, exact);
        EXPECT_LE(*steps[k].reference.floor, 1e-9) << k;
        EXPECT_EQ(steps[k].reference.w.has_value(), exact <= 1e-12 && met.result.detail.empty()) << k;
        ++k;
      });
  EXPECT_GT(largest, 1);
}

TEST(CarryOver, FollowsRowsAndStartsNewOnesAtZero) {
  const Eigen::VectorXd carried = CarryOver(Eigen::Vector3d(1, 2, 3), {2, -1, 0, -1});
  EXPECT_EQ(carried, Eigen::Vector4d(3, 0, 1, 0));
  EXPECT_EQ(CarryOver(Eigen::VectorXd(), {-1}), Eigen::VectorXd::Zero(1));
}

class RecordedSequence : public SequenceFile {
 protected:
  static SequenceEntry Entry(int steps = 100) {
    return MeasureSequence(RecordedSteps{"recordings/ode-heightfield-sequence.jsonl.gz", 200}, steps, kData);
  }
  static constexpr const char* kData = LCPBENCH_SOURCE_DIR "/data";
};

TEST_F(RecordedSequence, FollowsRowsByTheEnginesNames) {
  const SequenceEntry entry = Entry();
  const std::string path = SequencePath(folder_.string(), entry.id);
  WriteSequenceFile(entry, kData, path);
  const std::vector<SequenceStep> steps = ReadSequenceFile(path, entry.sha256);
  ASSERT_EQ(steps.size(), 100U);
  RecordingReader reader(std::string(kData) + "/recordings/ode-heightfield-sequence.jsonl.gz");
  std::vector<std::string> before;
  std::int64_t entered = 0;
  std::int64_t left = 0;
  for (std::size_t k = 0; k < steps.size(); ++k) {
    RecordedStep step;
    ASSERT_TRUE(reader.Next(&step));
    const RecordedProblem made = VelocityProblem(reader.header(), step);
    ASSERT_EQ(made.problem.b(), steps[k].problem.b());
    std::set<int> taken;
    for (std::size_t i = 0; i < made.identity.size(); ++i) {
      const int previous = steps[k].previous[i];
      if (previous >= 0) {
        EXPECT_EQ(before.at(static_cast<std::size_t>(previous)), made.identity[i]);
        EXPECT_TRUE(taken.insert(previous).second) << "two rows are the same row of the step before";
      } else if (k > 0) {
        ++entered;
        EXPECT_EQ(std::count(before.begin(), before.end(), made.identity[i]), 0) << made.identity[i];
      }
    }
    if (k > 0) left += static_cast<std::int64_t>(before.size() - taken.size());
    before = made.identity;
  }
  EXPECT_EQ(entered, entry.entered);
  EXPECT_EQ(left, entry.left);
  EXPECT_GT(entered, 0);
}

TEST_F(RecordedSequence, LacksNoStepAndHasNoneTooLarge) {
  ExpectRefused([] { Entry(101); }, "step 300: the recording does not have it");
  EXPECT_THROW(MeasureSequence(RecordedSteps{"recordings/ode-heightfield-sequence.jsonl.gz", 199}, 2, kData),
               InputError);
  EXPECT_THROW(MeasureSequence(RecordedSteps{"recordings/box2d-tiles.jsonl.gz", 30}, 1, kData), InputError);
}

class SequencePass : public CommandTest {
 protected:
  void SetUp() override {
    CommandTest::SetUp();
    request_.file = SequencePath(folder_.string(), GearTrain().id);
    request_.sha256 = GearTrain().sha256;
    request_.solver = "dantzig";
    request_.tier = 1e-6;
    request_.judged = {1e-3, 1e-6};
    request_.limits.least_s = request_.limits.most_s = 10;
    request_.budget_s = 100;
    WriteSequenceFile(GearTrain(), ".", request_.file);
  }

  SequenceReply Run() {
    return SequenceRunner().Run(request_, [](double, const std::string&) {});
  }

  SequenceRequest request_;
  std::size_t steps_ = static_cast<std::size_t>(GearTrain().problems);
};

// The solver adds 1 to what it starts from, so that the force on a row is its age in steps.
TEST_F(SequencePass, AWarmStepStartsFromTheAnswerByTheIdentityOfRows) {
  const std::string key = "add-one";
  if (std::none_of(AllSolvers().begin(), AllSolvers().end(), [&](const auto& entry) { return entry.key == key; })) {
    RegisterExternalSolver(key, {LCPBENCH_TEST_WORKER, key});
  }
  request_.solver = key;
  const std::vector<SequenceStep> steps = ReadSequenceFile(request_.file, request_.sha256);
  for (const bool warm : {true, false}) {
    request_.warm = warm;
    const SequenceReply reply = Run();
    ASSERT_EQ(reply.results.at("rho").size(), steps.size());
    Eigen::VectorXd age;
    std::set<double> ages;
    for (std::size_t k = 0; k < steps.size(); ++k) {
      const std::vector<int> none(steps[k].previous.size(), -1);
      age = CarryOver(age, warm ? steps[k].previous : none).array() + 1;
      ages.insert(age.begin(), age.end());
      const double expected = ComputeMetrics(steps[k].problem, age).rho;
      EXPECT_NEAR(reply.results.at("rho")[k].get<double>(), expected, 1e-3 * expected) << k;
    }
    EXPECT_EQ(ages.size() > 5, warm);
    // It says that it solved what it did not.
    EXPECT_EQ(reply.results.at("verdicts")[1].at("false_successes"), steps.size());
  }
}

TEST_F(SequencePass, EveryStepIsTimedAndJudged) {
  for (const char* solver : {"dantzig", "auto", "ipm"}) {
    for (const bool warm : {false, true}) {
      request_.solver = solver;
      request_.warm = warm;
      const SequenceReply reply = Run();
      EXPECT_EQ(reply.outcome, "completed") << reply.detail;
      EXPECT_EQ(reply.results.at("reached"), steps_);
      ASSERT_EQ(reply.results.at("latency_s").size(), steps_);
      for (const auto& time : reply.results.at("latency_s")) EXPECT_GT(time.get<double>(), 0);
      for (const auto& verdict : reply.results.at("verdicts")) {
        EXPECT_EQ(verdict.at("passed"), steps_) << solver << warm << verdict.dump();
        EXPECT_EQ(verdict.at("failed_steps").size(), 0U);
      }
      for (const auto& error : reply.results.at("w_error")) EXPECT_LE(error.get<double>(), 1e-4);
    }
  }
}

// Every look at this clock takes a millisecond.
double SlowClock() {
  static double now = 0;
  return now += 1e-3;
}

TEST_F(SequencePass, WhatComesLateIsNoAnswer) {
  request_.warm = true;
  for (const double deadline : {0.5e-3, 10.0}) {
    request_.deadline_s = deadline;
    const SequenceReply reply = SequenceRunner(&SlowClock).Run(request_, [](double, const std::string&) {});
    const bool late = deadline < 1;
    EXPECT_EQ(reply.results.at("late").size(), late ? steps_ : 0);
    EXPECT_EQ(reply.results.at("rho")[0].is_null(), late);
    for (const auto& verdict : reply.results.at("verdicts")) {
      EXPECT_EQ(verdict.at("failed"), late ? steps_ : 0);
      EXPECT_EQ(verdict.at("failed_steps").size(), verdict.at("failed"));
    }
  }
}

TEST_F(SequencePass, ABudgetEndsThePass) {
  request_.budget_s = 1e-9;
  const SequenceReply reply = Run();
  EXPECT_EQ(reply.outcome, "budget");
  EXPECT_EQ(reply.results.at("reached"), 1);
  const auto& verdict = reply.results.at("verdicts")[0];
  EXPECT_EQ(verdict.at("passed"), 1);
  EXPECT_EQ(verdict.at("failed"), GearTrain().problems - 1);
}

TEST_F(SequencePass, WorkersServeSequencesAndProblemsAndAreKilledWhereTheyHang) {
  WorkerOptions options;
  options.program = LCPBENCH_COMMAND;
  WorkerProcess worker(options);
  EXPECT_EQ(worker.Run(request_).outcome, "completed");
  SequenceRequest unknown = request_;
  unknown.solver = "no-such-solver";
  EXPECT_THROW(worker.Run(unknown), InputError);
  EXPECT_EQ(worker.Run(request_).results.at("reached"), GearTrain().problems);
  options.make_s = 1e-4;
  WorkerProcess impatient(options);
  const SequenceReply killed = impatient.Run(request_);
  EXPECT_EQ(killed.outcome, "killed");
  EXPECT_FALSE(killed.detail.empty());
  EXPECT_TRUE(killed.results.is_null());
  // What is written of it then: no step counts as reached.
  const Json nothing = StepRecord({1e-6}).Results(3);
  EXPECT_EQ(nothing.at("verdicts")[0].at("failed_steps"), Json({0, 1, 2}));
  EXPECT_TRUE(nothing.at("preempted").empty());
}

class SequenceCampaign : public CommandTest {
 protected:
  void SetUp() override {
    CommandTest::SetUp();
    Write("motions.json", ManifestText({GearTrain(), DiscsInV()}));
  }
  std::string Campaign(const std::string& folder, const std::string& more = "") const {
    return "run --suite " + Path("motions.json") + " --solvers dantzig,pgs --tiers 1e-3,1e-6 --launches 2 -o " +
           Path(folder) + " " + more;
  }
  std::vector<Json> Passes(const std::string& folder) const { return JsonLines(folder_ / folder / "steps.jsonl"); }
};

TEST_F(SequenceCampaign, EveryPassHasALineInEveryRound) {
  Succeed(Campaign("c"));
  std::map<std::string, int> lines;
  for (const Json& pass : Passes("c")) {
    EXPECT_EQ(pass["outcome"], "completed") << pass["detail"];
    ++lines[pass["sequence"].get<std::string>() + " " + pass["solver"].get<std::string>() + " " +
            pass["mode"].get<std::string>()];
  }
  EXPECT_EQ(lines.size(), 2U * 2 * 5);
  for (const auto& [name, count] : lines) {
    const bool both_tiers = name.find("pgs") != std::string::npos && name.find("deadline") == std::string::npos;
    EXPECT_EQ(count, both_tiers ? 4 : 2) << name;
  }
  EXPECT_TRUE(JsonLines(folder_ / "c" / "streams.jsonl").empty());
  const Json campaign = ReadJson(folder_ / "c" / "campaign.json");
  EXPECT_EQ(campaign["deadlines_s"].size(), 3U);
  EXPECT_EQ(campaign["sequences"][0]["steps"], GearTrain().problems);
  EXPECT_EQ(campaign["sequences"][1]["rows"], 12);

  Succeed("analyse " + Path("c"));
  // Two solvers; one size and all together; tiers: two cold, two warm, and of three deadlines the strictest alone; and
  // the header.
  EXPECT_EQ(Lines(ReadFile(folder_ / "c" / "analysis" / "latency_by_solver.csv")).size(), 2 * 2 * (2 + 2 + 3) + 1U);
  EXPECT_TRUE(fs::exists(folder_ / "c" / "analysis" / "deadline.csv"));
  EXPECT_FALSE(fs::exists(folder_ / "c" / "analysis" / "cells.csv"));
}

// Short ones of several families, the least work first.
const std::vector<SequenceEntry>& ShortMotions() {
  static const std::vector<SequenceEntry> entries = [] {
    std::vector<SequenceEntry> made;
    for (const char* family : {"discs-in-v", "disc-track", "gear-train", "disc-pile"}) {
      for (const int rows : {6, 12}) made.push_back(MeasureSequence(Recipe{family, rows, 3, {}}, 4));
    }
    std::sort(made.begin(), made.end(), [](const SequenceEntry& a, const SequenceEntry& b) {
      return a.problems * a.most_rows * a.most_rows < b.problems * b.most_rows * b.most_rows;
    });
    return made;
  }();
  return entries;
}

TEST_F(SequenceCampaign, OnlyWhatIsSolvedIsMadeAndEachBeforeItsFirstSolve) {
  const auto made = [&](const std::string& folder) {
    std::set<std::string> names;
    for (const auto& file : fs::directory_iterator(folder_ / folder / "sequences")) {
      names.insert(file.path().filename().string());
    }
    return names;
  };
  // The one with the most work cannot be made: all others are solved before that is noticed.
  std::vector<SequenceEntry> entries = ShortMotions();
  entries.back().sha256 = entries.front().sha256;
  Write("motions.json", ManifestText(entries));
  const CommandOutcome other = Run(Campaign("c"));  // with a progress bar before
  EXPECT_EQ(other.status, 2);
  const std::string told = entries.back().id + ": expected the sequence with SHA-256";
  EXPECT_NE(other.error.find(told), std::string::npos) << other.error;
  std::set<std::string> solved;
  std::set<std::string> files;
  for (const Json& pass : Passes("c")) solved.insert(pass["sequence"]);
  for (const SequenceEntry& entry : entries) files.insert(entry.id + ".jsonl.gz");
  EXPECT_EQ(solved.size(), entries.size() - 1);
  EXPECT_EQ(solved.count(entries.back().id), 0U);
  files.erase(entries.back().id + ".jsonl.gz");
  EXPECT_EQ(made("c"), files);

  for (const SequenceEntry& entry : ShortMotions()) {
    if (entry.id == entries.back().id) continue;
    Succeed(Campaign(entry.id, "--filter '" + entry.id + "/dantzig/.*/cold'"));
    EXPECT_EQ(made(entry.id), std::set<std::string>{entry.id + ".jsonl.gz"});
  }
}

TEST_F(SequenceCampaign, KeptSequencesAreUsedAgainAndDamagedOnesMadeAnew) {
  Write("motions.json", ManifestText(ShortMotions()));
  const std::string campaign = Campaign("c", "--filter '/dantzig/.*/cold'");
  Succeed(campaign);
  const auto path_of = [&](const SequenceEntry& entry) { return SequencePath(Path("c"), entry.id); };
  std::map<std::string, std::string> kept;
  for (const SequenceEntry& entry : ShortMotions()) kept[entry.id] = ReadFile(path_of(entry));

  // What is right stays as it is: here with another compression.
  const SequenceEntry& right = ShortMotions().front();
  std::string text;
  ReadEachLine(path_of(right), [&](const std::string& line, const std::string&) { text += line + "\n"; });
  Write("c/sequences/" + right.id + ".jsonl.gz", text);
  const std::string& first = kept.begin()->second;
  const auto damage = [&](std::size_t k, const std::string& file) -> std::string {
    switch (k % 4) {
      case 0:
        return file.substr(0, file.size() / 2);
      case 1:
        return file == first ? kept.rbegin()->second : first;  // another sequence
      case 2:
        return "";
      default:
        std::string flipped = file;
        flipped[file.size() / 2] = static_cast<char>(flipped[file.size() / 2] ^ 0x10);
        return flipped;
    }
  };
  for (std::size_t k = 1; k < ShortMotions().size(); ++k) {
    const std::string& id = ShortMotions()[k].id;
    Write("c/sequences/" + id + ".jsonl.gz", damage(k, kept.at(id)));
  }
  Write("c/steps.jsonl", "");
  const CommandOutcome again = Succeed(campaign + " --resume");
  EXPECT_EQ(ReadFile(path_of(right)), text);
  for (std::size_t k = 1; k < ShortMotions().size(); ++k) {
    const SequenceEntry& entry = ShortMotions()[k];
    EXPECT_TRUE(ReadFile(path_of(entry)) == kept.at(entry.id)) << k;
    EXPECT_NE(again.error.find("note: made anew: " + path_of(entry)), std::string::npos) << again.error;
  }
  EXPECT_EQ(again.error.find(path_of(right)), std::string::npos) << again.error;
  EXPECT_EQ(Passes("c").size(), ShortMotions().size() * 2);  // of two rounds

  // What is done needs no sequence.
  fs::remove_all(folder_ / "c/sequences");
  Succeed(campaign + " --resume");
  EXPECT_FALSE(fs::exists(folder_ / "c/sequences"));
}

// As the lines of streams.jsonl (kept_campaign_test.cc).
TEST_F(SequenceCampaign, ATornTailOfStepsIsMadeAgainAndWhatIsNotOfThePlanIsRefused) {
  const std::string filter = "--filter 'discs-in-v.*/(cold|warm)$'";
  const auto plan = [&] {
    std::vector<std::tuple<Json, Json, Json, Json, Json>> keys;
    for (const Json& pass : Passes("c")) {
      keys.emplace_back(pass["solver"], pass["tier"], pass["mode"], pass["round"], pass["outcome"]);
    }
    return keys;
  };
  Succeed(Campaign("c", filter));
  const auto whole = plan();
  const std::string before = ReadFile(folder_ / "c/steps.jsonl");
  for (const std::size_t bytes : {before.size() - 1, before.size() / 2, std::size_t{7}}) {
    fs::resize_file(folder_ / "c/steps.jsonl", bytes);
    Succeed(Campaign("c", filter + " --resume"));
    EXPECT_EQ(plan(), whole);
  }
  const Json line = Passes("c").at(1);
  const auto with = [&line](const char* field, const Json& value) {
    Json changed = line;
    changed[field] = value;
    return changed.dump();
  };
  ExpectSecondLineRefused("c/steps.jsonl",
                          {{"\x01\xff\xfe{]", "not valid JSON"},
                           {line.dump().substr(0, 30), "not valid JSON"},
                           {R"({"solver":"x",)" + line.dump().substr(1), "/solver: this key is given twice"},
                           {Passes("c").at(0).dump(), "a second line of"},
                           {with("round", -1), "field 'round'"},
                           {with("round", 2), "round 2"},
                           {with("round", "x"), "field 'round'"},
                           {with("solver", "lemke"), "solver 'lemke'"},
                           {with("sequence", "another"), "'another'"},
                           {with("tier", 1e-9), "tier"},
                           {with("mode", "lukewarm"), "a task"}},
                          Campaign("c", filter + " --resume"));
}

}  // namespace
}  // namespace lcpbench
