// `lcpbench run` on manifests: whatever interrupts or divides a campaign, its results are the same but for times.

#include <sched.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "benchmarks/campaign/campaign_plan.h"
#include "benchmarks/campaign/result_fields.h"
#include "benchmarks/campaign/worker_process.h"
#include "benchmarks/collection/build.h"
#include "benchmarks/collection/manifest.h"
#include "model/contact/assembly.h"
#include "model/scenes/scene.h"
#include "solvers/linear_algebra/loaded_blas.h"
#include "solvers/registry.h"
#include "tests/benchmarks/command/command_fixture.h"

namespace lcpbench {
namespace {

constexpr const char* kLong = "--launches 6 ";  // so many that signals come in the midst of them
// No limit ends anything, however slow the machine or a sanitizer is.
constexpr const char* kNoHurry = "--time-limit 60 ";
constexpr const char* kManifest = LCPBENCH_SOURCE_DIR "/data/smoke.json";

class CampaignCommand : public CommandTest {
 protected:
  // Own solvers: one by tolerance, one direct, one that fails at times.
  std::string Campaign(const std::string& folder, const std::string& more = "") const {
    return "run --suite " + manifest_ + " --solvers dantzig,pgs,lemke --filter 'n8|rounded-wall|tall|^steps' " +
           "--launches 2 " + kNoHurry + "-o " + Path(folder) + " " + more;
  }
  // From now on the campaign has two sequences, too.
  void AddSequences() {
    Manifest motions;
    motions.name = motions.version = "1";
    motions.sequences = {MeasureSequence(Recipe{"gear-train", 12, 1, {}}, 30),
                         MeasureSequence(Recipe{"discs-in-v", 12, 1, {}}, 8)};
    auto manifest = nlohmann::ordered_json::parse(ReadFile(kManifest));
    manifest["sequences"] = nlohmann::ordered_json::parse(FormatManifest(motions))["sequences"];
    manifest_ = Path("mixed.json");
    Write("mixed.json", manifest.dump());
    fs::copy(LCPBENCH_SOURCE_DIR "/data/references", folder_ / "references");
  }
  // Rows of a solver in the table of coverage.
  long AnalysedRows(const std::string& solver) {
    Succeed("analyse " + Path("c"));
    const std::vector<std::string> rows = Lines(ReadFile(folder_ / "c" / "analysis" / "coverage.csv"));
    return std::count_if(rows.begin(), rows.end(),
                         [&](const std::string& row) { return row.find("," + solver + ",") != std::string::npos; });
  }
  std::vector<Json> Cells() const { return CellsOf(folder_ / "c"); }
  std::vector<Json> Streams() const { return JsonLines(folder_ / "c" / "streams.jsonl"); }
  // What must not depend on when and where problems and sequences were run, sorted. What a deadline leaves time for
  // does.
  std::vector<std::string> WithoutTimes(const std::string& folder) const {
    std::vector<std::string> kept;
    for (const char* file : {"streams.jsonl", "steps.jsonl"}) {
      for (Json line : JsonLines(folder_ / folder / file)) {
        for (const char* field :
             {"first_s", "fresh_s", "problem_s", "prepare_s", "convert_s", "solve_s", "again_s", "group",
              "factor_share", "peak_bytes", "disturbance", "began_s", "environment", "latency_s", "preempted"}) {
          line.erase(field);
        }
        if (line.value("mode", "").starts_with("deadline")) {
          for (const char* field : {"claims", "verdicts", "late", "iterations", "rho", "backward_error", "w_error"}) {
            line.erase(field);
          }
        }
        kept.push_back(line.dump());
      }
    }
    std::sort(kept.begin(), kept.end());
    return kept;
  }

  std::string manifest_ = kManifest;
};

TEST_F(CampaignCommand, EveryProblemIsJudgedAndTimedFresh) {
  Succeed(Campaign("c"));
  const auto cells = Cells();
  const auto problems = JsonLines(folder_ / "c" / "problems.jsonl");
  ASSERT_EQ(problems.size(), 18U);  // 16 families with 8 rows, two of them with 40 as well
  // Every tier of every solver, though direct methods run once.
  EXPECT_EQ(cells.size(), problems.size() * 3 * 3);
  for (const auto& cell : cells) {
    ExpectHas(cell, {{"false_success", false}, {"at_floor", false}});
    EXPECT_TRUE(cell["rho"].is_number()) << cell.dump();
    EXPECT_GT(cell["first_s"], 0);
    for (const double time : cell["fresh_s"]) EXPECT_GT(time, 0);
    if (cell["passes"] != true) continue;
    EXPECT_LE(cell["rho"].get<double>(), cell["tier"].get<double>());
    // What warms a pass is not timed in it: of two passes a problem misses one at most.
    EXPECT_GE(cell["fresh_s"].size(), 1U) << cell.dump();
  }
  double weight = 0;
  for (const auto& problem : problems) {
    EXPECT_GT(problem["oracle_s"].get<double>(), 0) << problem.dump();
    EXPECT_GT(problem["floor"].get<double>(), 0);
    EXPECT_LT(problem["floor"].get<double>(), 1e-10) << problem.dump();
    weight += problem["weight"].get<double>();
  }
  EXPECT_GT(weight, 0.99 * 16);  // at least a base per family
  for (const auto& line : Streams()) {
    EXPECT_TRUE(line["kind"] != "parts" || line["solve_s"].size() == line["count"]);
    EXPECT_TRUE(line["kind"] != "again" || line["failed"].empty()) << line.dump();
  }
  const auto expect_fields = [fields = ResultSchemaJson()](const Json& line, const std::vector<std::string>& records) {
    std::set<std::string> expected;
    for (const std::string& record : records) {
      for (const auto& [name, field] : fields.at(record).items()) expected.insert(name);
    }
    expected.erase("group");
    for (const auto& of_some : RareColumnFields()) expected.erase(of_some.name);
    std::set<std::string> found;
    for (const auto& [name, value] : line.items()) found.insert(name);
    EXPECT_EQ(found, expected) << line.dump();
  };
  for (const auto& problem : problems) expect_fields(problem, {"problem"});
  for (const auto& line : Streams()) expect_fields(line, {"line", line["kind"].get<std::string>()});
  const auto campaign = ReadJson(folder_ / "c" / "campaign.json");
  EXPECT_EQ(campaign["schema"], "lcpbench-campaign/2");
  EXPECT_EQ(campaign["manifests"][0]["name"], "smoke");
  for (const char* field : {"cpu", "instruction_sets", "kernel", "hypervisor", "git_commit"}) {
    EXPECT_FALSE(campaign["environment"][field].get<std::string>().empty()) << field;
  }
  // A direct method has a line at every tier, and at these alone.
  EXPECT_EQ(AnalysedRows("dantzig"), 3);
}

TEST_F(CampaignCommand, ComparisonFindsAWrongAnswer) {
  Succeed(Campaign("c", "--tiers 1e-6"));
  EXPECT_EQ(AnalysedRows("dantzig"), 1);
  // A campaign and itself: whatever the machine does meanwhile.
  const CommandOutcome same = Succeed("compare " + Path("c") + " " + Path("c"));
  ExpectPart(same.out, "They agree");
  ExpectMistake(Campaign("c", "--tiers 1e-6"), "--resume");
  fs::copy(folder_ / "c", folder_ / "wrong");
  std::vector<Json> lines = Streams();
  std::find_if(lines.begin(), lines.end(),
               [](const Json& line) { return line["kind"] == "judge" && line["exceptions"].empty(); })
      ->at("exceptions")
      .push_back(Json::parse(
          R"({"at":0,"claim":"solved","passes":false,"at_floor":false,"false_success":true,"false_infeasible":false,)"
          R"("proved_infeasible":false,"reason":"rho","detail":""})"));
  std::string text;
  for (const Json& line : lines) text += line.dump() + "\n";
  Write("wrong/streams.jsonl", text);
  const CommandOutcome wrong = Run("compare " + Path("c") + " " + Path("wrong") + " -o " + Path("summary.md"));
  EXPECT_EQ(wrong.status, 1) << wrong.error;
  ExpectPart(ReadFile(folder_ / "summary.md"), "1 new false success");
  EXPECT_EQ(Run("compare " + Path("c") + " " + Path("nowhere")).status, 2);
}

TEST_F(CampaignCommand, ShardsMergeToTheWholeInAnyOrder) {
  AddSequences();
  Succeed(Campaign("whole"));
  for (const std::string shard : {"1", "2-3", "2", "3"}) {
    Succeed(Campaign("s" + shard, "--shard " + shard + "/3"));
    EXPECT_LT(WithoutTimes("s" + shard).size(), WithoutTimes("whole").size());
  }
  const CommandOutcome all = Succeed("merge " + Path("s2") + " " + Path("s1") + " " + Path("s3") + " -o " + Path("m"));
  EXPECT_EQ(all.error, "");
  Succeed("merge " + Path("s3") + " " + Path("s2") + " " + Path("s1") + " -o " + Path("n"));
  for (const char* file : {"streams.jsonl", "steps.jsonl"}) {
    EXPECT_EQ(ReadFile(folder_ / "m" / file), ReadFile(folder_ / "n" / file));
  }
  Succeed("merge " + Path("s2-3") + " " + Path("s1") + " -o " + Path("l"));
  for (const char* merged : {"m", "l"}) EXPECT_EQ(WithoutTimes(merged), WithoutTimes("whole")) << merged;
  // A shard that is missing is told.
  const CommandOutcome two = Succeed("merge " + Path("s2") + " " + Path("s3") + " -o " + Path("two"));
  ExpectPart(two.error, "a shard is missing");
  // The same shard twice, and a shard of another campaign.
  ExpectMistake("merge " + Path("s1") + " " + Path("s1") + " -o " + Path("t"), "already");
  Succeed(Campaign("other", "--tiers 1e-6"));
  ExpectMistake("merge " + Path("s1") + " " + Path("other") + " -o " + Path("u"), "another plan");
}

// SIGKILL to the campaign alone, and what Ctrl-C at a terminal and job schedulers do: the worker gets the signal too,
// and its solve must not look crashed.
TEST_F(CampaignCommand, KilledOrInterruptedAnywhereItGoesOnToTheSameResults) {
  AddSequences();
  Succeed(Campaign("whole", kLong));
  const std::string arguments = Campaign("ended", std::string(kLong) + "--resume");
  std::mt19937 random(3);
  for (const std::string file : {"streams.jsonl", "steps.jsonl"}) {
    const std::uintmax_t all = fs::file_size(folder_ / "whole" / file);
    int ended = 0;
    for (int trial = 0; trial < 3; ++trial) {
      const int signal = std::array{SIGKILL, SIGTERM, SIGINT}.at(static_cast<std::size_t>(trial % 3));
      if (RunUntil("ended/" + file, random() % (all / 6), signal, signal != SIGKILL, arguments) == 0) break;
      ++ended;
      // What a crash of the machine could leave.
      if (trial % 3 == 1) std::ofstream(folder_ / "ended" / file, std::ios::app) << "{\"solver\":\"torn";
    }
    EXPECT_GE(ended, 1) << file;
  }
  Succeed(arguments);
  EXPECT_EQ(WithoutTimes("ended"), WithoutTimes("whole"));
}

TEST_F(CampaignCommand, VariantsAreSolversOfTheirOwn) {
  const std::string arguments = std::string("run --suite ") + kManifest + " --filter n8 --tiers 1e-6 --launches 1 " +
                                "--solvers pgs,over,again -o " + Path("c") +
                                " --variant over=pgs,relaxation=1.3 --variant again=pgs";
  Succeed(arguments);
  std::map<std::string, std::map<std::string, Json>> cells;
  for (const auto& cell : Cells()) cells[cell["problem"]][cell["solver"]] = cell;
  ASSERT_EQ(cells.size(), 16U);
  bool differs = false;
  for (const auto& [problem, by_solver] : cells) {
    ASSERT_EQ(by_solver.size(), 3U) << problem;
    // One solver under two names: the same answer to the last bit.
    EXPECT_EQ(by_solver.at("again")["rho"], by_solver.at("pgs")["rho"]) << problem;
    EXPECT_EQ(by_solver.at("again")["iterations"], by_solver.at("pgs")["iterations"]) << problem;
    differs = differs || by_solver.at("over")["iterations"] != by_solver.at("pgs")["iterations"];
  }
  EXPECT_TRUE(differs);
  const auto campaign = ReadJson(folder_ / "c" / "campaign.json");
  for (const auto& solver : campaign["solvers"]) {
    EXPECT_EQ(solver["base"], solver["key"] == "pgs" ? "" : "pgs");
    const Json settings = solver["key"] == "over" ? Json{{"relaxation", "1.3"}} : Json::object();
    EXPECT_EQ(solver["settings"], settings);
  }
  for (const auto& [variant, text] : {std::pair("pgs=dantzig", "taken"), std::pair("x=pgs,nonsense=1", "nonsense"),
                                      std::pair("x=nobody", "unknown solver"), std::pair("x", "KEY=SOLVER")}) {
    ExpectMistake(arguments + " --variant " + variant, text);
  }
}

TEST_F(CampaignCommand, EveryJudgementSaysWhatItsSolveTook) {
  Succeed(std::string("run --suite ") + kManifest + " --solvers dantzig,pgs,ipm --filter n40 --tiers 1e-6 " +
          "--launches 1 -o " + Path("c"));
  for (const auto& cell : Cells()) {
    if (cell["passes"] != true) continue;
    const std::string solver = cell["solver"];
    EXPECT_LT(cell["factor_share"].get<double>(), 1);
    // Sweeps factorize nothing, interior points every step.
    EXPECT_TRUE(solver == "dantzig" || (cell["factor_share"] != 0) == (solver == "ipm")) << solver;
  }
  for (const auto& line : Streams()) {
    if (line["kind"] != "fresh") continue;
    const auto& disturbance = line["disturbance"];
    for (const char* field : {"probe_s", "cpu_share"}) EXPECT_GT(disturbance[field], 0) << field;
    // What is undisturbed was not run again for nothing, and what is disturbed was run as often as allowed.
    EXPECT_LE(disturbance["reruns"].get<int>(), NoiseRule{}.most_reruns);
    EXPECT_TRUE(disturbance["disturbed"] == false || disturbance["reruns"] == NoiseRule{}.most_reruns);
  }
}

// A solver that is far from the best of its class is judged on all problems, and timed in fewer launches.
TEST_F(CampaignCommand, ASlowSolverHasFewerLaunches) {
  Succeed(std::string("run --suite quick --filter n25-s1/ --tiers 1e-6 --solvers dantzig,ipopt-qp ") + "-o " +
          Path("c"));
  const auto campaign = ReadJson(folder_ / "c" / "campaign.json");
  std::map<std::string, int> launches;
  for (const auto& line : Streams()) {
    if (line["kind"] == "judge") {
      EXPECT_EQ(line["attempted"], line["count"]);
    }
    if (line["kind"] != "fresh") continue;
    EXPECT_EQ(line["fresh_s"].size(), line["count"]);
    ++launches[line["solver"]];
  }
  EXPECT_EQ(launches.at("dantzig"), campaign["passes"]);
  EXPECT_EQ(launches.at("ipopt-qp"), campaign["launches"]["others"]);
}

// OpenBLAS runs its oldest kernels on processors newer than itself, which the command mends; a choice of the user
// stays.
TEST_F(CampaignCommand, TakesTheWidestKernelsOfOpenBlasUnlessTold) {
  const std::string run = "run --suite quick --filter n25-s1/ --tiers 1e-6 --launches 1 --solvers dantzig -o ";
  const auto blas_of = [&](const std::string& folder) {
    Succeed(run + Path(folder));
    return ReadJson(folder_ / folder / "campaign.json").at("environment").at("libraries").at("BLAS").get<std::string>();
  };
  unsetenv("OPENBLAS_CORETYPE");
  const bool is_narrow = HasNarrowBlasKernels();  // as this process loaded it
  const std::string own = BlasVersion();
  const std::string chosen = blas_of("own");
  EXPECT_NE(chosen.find(is_narrow ? RunnableBlasKernels().front() : own), std::string::npos) << chosen;
  if (own.find("OpenBLAS") == std::string::npos) return;
  setenv("OPENBLAS_CORETYPE", "Prescott", 1);
  const std::string told = blas_of("told");
  unsetenv("OPENBLAS_CORETYPE");
  EXPECT_NE(told.find("Prescott"), std::string::npos) << told;
}

TEST_F(CampaignCommand, GoogleBenchmarksFiltersWork) {
  const std::string filter = "--benchmark_filter='rockers-n(8|40)-' --solvers dantzig";
  const std::string campaign = std::string("run --suite ") + kManifest + " " + filter + " -o " + Path("c");
  const CommandOutcome list = Succeed(campaign + " --benchmark_list_tests");
  EXPECT_NE(list.out.find("solve/rockers-n8-s11/dantzig/1e-09\n"), std::string::npos) << list.out;
  EXPECT_FALSE(fs::exists(folder_ / "c"));
  Succeed(campaign + " --benchmark_repetitions=4");
  // Four launches, judged at three tiers by one run.
  size_t times = 0;
  for (const auto& cell : Cells()) times += cell["fresh_s"].size();
  EXPECT_EQ(times, 2U * 4 * 3);
  EXPECT_EQ(Run(Campaign("d", "--benchmark_color=true")).status, 2);
}

TEST(NoiseRule, CountsWhatTheMachineDid) {
  const double fastest = 1e-5;
  const auto found = [&](double probe_s, double cpu_share) {
    return DisturbanceOf(NoiseRule{}, {probe_s, cpu_share, 0}, fastest);
  };
  EXPECT_EQ(found(fastest, 1), 0);
  EXPECT_EQ(found(1.09e-5, 0.96), 0);
  // A clock that is 20 % slower; a thread that waited for 10 %; both are worse than one.
  EXPECT_GT(found(1.2e-5, 1), 0);
  EXPECT_GT(found(fastest, 0.9), 0);
  EXPECT_GT(found(1.2e-5, 0.9), std::max(found(1.2e-5, 1), found(fastest, 0.9)));
}

// A program that spins on the same processor takes half of it, and the pass says so; less where the program is gone.
TEST(DisturbanceWatch, APassTellsOfAProgramOnItsProcessor) {
  cpu_set_t before;
  ASSERT_EQ(sched_getaffinity(0, sizeof before, &before), 0);
  cpu_set_t one;
  CPU_ZERO(&one);
  for (std::size_t cpu = 0; cpu < CPU_SETSIZE && CPU_COUNT(&one) == 0; ++cpu) {
    if (CPU_ISSET(cpu, &before)) CPU_SET(cpu, &one);
  }
  ASSERT_EQ(sched_setaffinity(0, sizeof one, &one), 0);
  const auto problem = ProblemArrays::Of(AssembleContactLcp(GenerateScene("disc-pile", 60, 1)).problem);
  [[maybe_unused]] volatile double now = 0;
  PassRequest request;
  request.time_limit_s = 10;
  request.order.assign(4000, 0);  // one problem is enough to be disturbed at
  const auto pass = [&] { return RunPass([] { return MakeSolver("dantzig"); }, {&problem, 1}, request).disturbance; };
  const pid_t spinning = fork();
  if (spinning == 0) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    for (;;) now = SteadyNow();
  }
  const auto disturbed = pass();
  kill(spinning, SIGKILL);
  waitpid(spinning, nullptr, 0);
  const auto calm = pass();
  sched_setaffinity(0, sizeof before, &before);
  ASSERT_TRUE(disturbed.has_value() && calm.has_value());
  EXPECT_LT(disturbed->cpu_share, calm->cpu_share);
  EXPECT_LT(disturbed->cpu_share, NoiseRule{}.least_cpu_share);
  EXPECT_GT(disturbed->switches, 0);
  EXPECT_GT(DisturbanceOf(NoiseRule{}, *disturbed, disturbed->probe_s), 0);
}

// ----- one worker

JudgeRequest Request(const std::string& problem, const std::string& solver) {
  JudgeRequest request;
  request.problem = {LCPBENCH_SOURCE_DIR "/data/standard.json", problem};
  request.solver = solver;
  request.tier = 1e-6;
  request.judged = {1e-6};
  request.time_limit_s = 30;
  return request;
}

WorkerOptions Options() {
  WorkerOptions options;
  options.program = LCPBENCH_COMMAND;
  return options;
}

TEST(WorkerProcess, SolvesJudgesAndTimes) {
  WorkerProcess worker(Options());
  for (const char* solver : {"auto", "dantzig", "ipm"}) {
    const JudgeReply reply = worker.Run(Request("rockers-n100-s1", solver));
    ASSERT_EQ(reply.records.size(), 1U) << reply.detail;
    ExpectHas(reply.records[0], {{"claim", "solved"}, {"passes", true}});
    for (const char* field : {"peak_bytes", "first_s"}) EXPECT_GT(reply.records[0][field], 0) << field;
    TimedRequest pass{.stream = {}, .solver = solver, .launch = 1, .pass = {}, .judged = {1e-3, 1e-6}};
    for (const char* problem : {"rockers-n10-s1", "rockers-n25-s1", "rockers-n100-s1"}) {
      pass.stream.push_back(Request(problem, solver).problem);
    }
    pass.pass.tolerance = 1e-6;
    pass.pass.time_limit_s = 10;
    pass.pass.warm_up = {1};
    pass.pass.order = {2, 0};
    for (const auto& [kind, field, fields] : {std::tuple(PassKind::kFresh, "fresh_s", 1U),
                                              {PassKind::kParts, "solve_s", 4U},
                                              {PassKind::kAgain, "again_s", 1U}}) {
      pass.pass.kind = kind;
      const TimedReply timed = worker.Run(pass);
      EXPECT_EQ(timed.outcome, "completed") << timed.detail;
      ASSERT_EQ(timed.times.size(), fields);
      for (const auto& [name, seconds] : timed.times) {
        ASSERT_EQ(seconds.size(), 3U) << name;
        EXPECT_FALSE(seconds[1].has_value()) << name;
        for (const std::size_t place : {0U, 2U}) EXPECT_GE(*seconds[place], 0) << name;
      }
      EXPECT_GT(*timed.times.at(field)[0], 0);
      EXPECT_EQ(timed.failed, std::vector<std::vector<std::uint32_t>>(2));
    }
  }
}

// How it ended: the claim at the only tier, or what became of the process.
std::string EndOf(const JudgeReply& reply) {
  return reply.records.empty() ? reply.outcome : reply.records[0]["claim"].get<std::string>();
}

TEST(WorkerProcess, KillsWhatTakesTooLongAndGoesOn) {
  WorkerOptions options = Options();
  options.make_s = 1e-4;
  WorkerProcess worker(options);
  EXPECT_EQ(EndOf(worker.Run(Request("rockers-n100-s1", "auto"))), "killed");
  // Less time than the first factorization takes: the solver notices, or is killed.
  options = Options();
  options.grace_s = options.grace_share = 0;
  WorkerProcess impatient(options);
  JudgeRequest request = Request("chain-of-links-n10000-s1", "ipm");
  request.time_limit_s = 1e-3;
  const std::string late = EndOf(impatient.Run(request));
  EXPECT_TRUE(late == "killed" || late == "time_limit") << late;
  EXPECT_EQ(EndOf(impatient.Run(Request("rockers-n10-s1", "dantzig"))), "solved");
}

TEST(WorkerProcess, MemoryBeyondTheLimitIsAnOutcome) {
  if (SanitizerReservesMemory()) GTEST_SKIP() << "the sanitizer reserves more than any limit";
  WorkerOptions options = Options();
  options.memory_bytes = std::uint64_t{600} << 20U;
  WorkerProcess worker(options);
  const JudgeReply reply = worker.Run(Request("tall-stacks-n10000-s1", "dantzig"));
  const std::string end = EndOf(reply);
  EXPECT_TRUE(end == "out_of_memory" || end == "numerical_failure" || end == "unsupported") << end << reply.detail;
  EXPECT_EQ(EndOf(worker.Run(Request("rockers-n10-s1", "dantzig"))), "solved");
}

TEST(WorkerProcess, RefusesWhatItDoesNotKnow) {
  WorkerProcess worker(Options());
  EXPECT_THROW(worker.Run(Request("no-such-problem", "auto")), InputError);
  EXPECT_THROW(worker.Run(Request("rockers-n10-s1", "no-such-solver")), InputError);
  EXPECT_EQ(EndOf(worker.Run(Request("rockers-n10-s1", "auto"))), "solved");
}

// ----- fields

TEST_F(CampaignCommand, CommittedFilesSayWhatTheTablesSay) {
  const fs::path source = LCPBENCH_SOURCE_DIR;
  for (const auto& [file, list] : {std::pair{"benchmarks/FIELDS.md", "fields"},
                                   {"docs/formats/campaign_lines.schema.json", "fields --schema"},
                                   {"report/lcpbench_report/peers.json", "peers"}}) {
    EXPECT_EQ(ReadFile(source / file), Succeed(std::string("list ") + list).out) << "run lcpbench list " << list;
  }
}

TEST(ResultFields, EveryFieldIsDescribedAndHasItsValue) {
  const auto described = [](const char* record) {
    std::set<std::string> names;
    for (const auto& [name, field] : ResultSchemaJson().at(record).items()) names.insert(name);
    return names;
  };
  const auto taken = [](const auto& fields) {
    std::set<std::string> names;
    for (const auto& field : fields) names.insert(field.name);
    return names;
  };
  EXPECT_EQ(taken(ProblemFields()), described("problem"));
  EXPECT_EQ(taken(LineFields()), described("line"));
  EXPECT_EQ(taken(PassFields()), described("pass"));
  std::set<std::string> exception = taken(ExceptionFields());
  exception.insert("at");
  EXPECT_EQ(exception, described("exception"));
  for (const auto fields : {ColumnFields(), RareColumnFields()}) {
    for (const auto& field : fields) EXPECT_TRUE(described("judge").contains(field.name)) << field.name;
  }
  for (const TimeField& field : TimeFields()) {
    const char* kind = std::array{"fresh", "parts", "again"}.at(static_cast<std::size_t>(field.kind));
    EXPECT_TRUE(described(kind).contains(field.name)) << field.name;
  }
}

TEST(ResultFields, BelowTheFloorIsWhatTheJudgeFindsAtTheAnswerAndNotWhatASolverSays) {
  Eigen::Matrix2d A;
  A << 1, 1, 1, 1 + 0x1p-30;
  const Eigen::Vector2d b(0, -1);
  const LcpProblem problem = LcpProblem::FromDense("joints", A, b, RowBounds::WithBilateralRows(2, {0, 1}));
  const auto describe = [&](const Eigen::Vector2d& f, LcpStatus claim, double tier, const LcpReference& known) {
    LcpResult result;
    result.status = claim;
    result.f = f;
    result.detail = "1e-09 is below the rounding floor 1 of this problem";
    return DescribeAnswer({result, Verify(problem, result, tier, &known)})["below_floor"].get<bool>();
  };
  const Eigen::Vector2d exact(-0x1p30, 0x1p30);           // its floor is some 3e-7
  const Eigen::Vector2d rounded = exact * (1 + 0x1p-25);  // rho 3e-8
  const Eigen::Vector2d wrong = exact + 1e-4 * b;         // rho 1e-4
  const LcpStatus failed = LcpStatus::kNumericalFailure;
  EXPECT_TRUE(describe(rounded, failed, 1e-9, {}));
  EXPECT_TRUE(describe(rounded, LcpStatus::kIterationLimit, 1e-9, {}));
  EXPECT_FALSE(describe(exact, failed, 1e-9, {})) << "passes";
  EXPECT_FALSE(describe(rounded, failed, 1e-6, {})) << "passes";
  EXPECT_FALSE(describe(wrong, failed, 1e-9, {})) << "rounding is not what it misses the tier by";
  EXPECT_FALSE(describe(wrong, failed, 1e-6, {})) << "the tier is above the floor";
  EXPECT_FALSE(describe(Eigen::Vector2d::Zero(), failed, 1e-9, {})) << "no forces, no rounding";
  EXPECT_FALSE(describe(rounded, LcpStatus::kSolved, 1e-9, {})) << "a false success";
  LcpReference known;
  known.floor = 1e-12;
  EXPECT_FALSE(describe(rounded, failed, 1e-9, known)) << "the problem has an answer that needs no such forces";
}

}  // namespace
}  // namespace lcpbench
