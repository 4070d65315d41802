// Which problems a campaign has, in what order, and what each of them counts.

#include "benchmarks/campaign/campaign_plan.h"

#include <unistd.h>

#include <filesystem>
#include <set>

#include "benchmarks/campaign/journal.h"
#include "benchmarks/collection/manifest.h"
#include "benchmarks/collection/plan.h"
#include "model/scenes/random.h"
#include "tests/support/test.h"

namespace lcpbench {
namespace {

constexpr const char* kOrigins[] = {"placed", "motion", "recorded", "literature"};

ManifestEntry Entry(const std::string& id, const std::string& base, const std::string& origin, Index rows, bool fill) {
  ManifestEntry entry;
  entry.id = id;
  entry.base = base;
  entry.family = origin + " family" + std::to_string(base.size() + static_cast<std::size_t>(base.back() % 2));
  entry.origin = origin;
  entry.fill = fill;
  entry.properties.rows = rows;
  return entry;
}

// Origins of very different numbers of problems, some of which share a base, also across size classes.
std::vector<Manifest> RandomManifests(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<Manifest> manifests(2);
  manifests[0].name = "standard";
  manifests[1].name = kNonsymmetricTier;
  int number = 0;
  for (const char* origin : kOrigins) {
    const int bases = 1 + static_cast<int>(random() % 20);
    for (int b = 0; b < bases; ++b) {
      const std::string base = std::string(origin) + std::to_string(b);
      const int variants = 1 + static_cast<int>(random() % 5);
      for (int v = 0; v < variants; ++v) {
        const Index rows = 1 + static_cast<Index>(random() % 60);
        manifests[0].problems.push_back(Entry("p" + std::to_string(number++), base, origin, rows, false));
      }
    }
  }
  const std::size_t problems = manifests[0].problems.size();
  for (int k = 0; k < 30; ++k) {
    const std::string id = "fill" + std::to_string(k);
    manifests[0].fill.push_back(Entry(id, id, "placed", 1 + static_cast<Index>(random() % 60), true));
    const std::string hard = "hard" + std::to_string(k);
    manifests[1].problems.push_back(Entry(hard, hard, "placed", 8, false));
    // A variant with friction of what is there without.
    ManifestEntry& variant = manifests[0].problems.emplace_back(manifests[0].problems[random() % problems]);
    variant.id = "friction" + std::to_string(k);
    variant.properties.friction = 1;
  }
  return manifests;
}

class CampaignProblems : public testing::TestWithParam<int> {
 protected:
  const std::vector<Manifest> manifests_ = RandomManifests(static_cast<std::uint64_t>(GetParam()));
};

bool IsApart(const PlannedProblem& problem) { return problem.manifest == 1 || !problem.entry->properties.is_plain(); }

std::string SideOf(const PlannedProblem& problem) {
  const std::string& origin = problem.entry->origin;
  return (IsApart(problem) ? "in no mean: " : "") + (origin == "motion" ? "placed" : origin);
}

// Sides as much as each other, within a side every base as much as another; what is in no mean apart.
void ExpectFairWeights(const std::vector<PlannedProblem>& problems) {
  std::map<std::pair<const SizeClass*, bool>, std::map<std::string, std::map<std::string, double>>> weight;
  for (const PlannedProblem& problem : problems) {
    weight[{problem.size_class, IsApart(problem)}][SideOf(problem)][problem.entry->base] += problem.weight;
  }
  for (const auto& [of, by_side] : weight) {
    std::size_t bases = 0;
    for (const auto& [side, by_base] : by_side) bases += by_base.size();
    for (const auto& [side, by_base] : by_side) {
      const double expected =
          static_cast<double>(bases) / static_cast<double>(by_side.size()) / static_cast<double>(by_base.size());
      for (const auto& [base, sum] : by_base) EXPECT_NEAR(sum, expected, 1e-12 * expected) << of.first->key << base;
    }
  }
}

TEST_P(CampaignProblems, OfASizeClassWeighTheSameBySideAndWithinItByBase) {
  ExpectFairWeights(PlanProblems({}, manifests_));
}

// Between two problems of one key there is one of every other key of their group that has not run out.
template <typename Group, typename Key>
void ExpectTurns(const std::vector<PlannedProblem>& problems, const Group& group_of, const Key& key_of) {
  std::map<std::string, std::map<std::string, int>> left;
  std::map<std::string, std::set<std::string>> round;
  for (const PlannedProblem& problem : problems) ++left[group_of(problem)][key_of(problem)];
  for (const PlannedProblem& problem : problems) {
    std::map<std::string, int>& of_group = left[group_of(problem)];
    std::set<std::string>& seen = round[group_of(problem)];
    if (seen.contains(key_of(problem))) {
      for (const auto& [key, count] : of_group) EXPECT_TRUE(count == 0 || seen.contains(key)) << key;
      seen.clear();
    }
    seen.insert(key_of(problem));
    --of_group[key_of(problem)];
  }
}

TEST_P(CampaignProblems, ComeByTurnsOfSidesOriginsFamiliesAndBases) {
  const auto list = [](const PlannedProblem& problem) {
    return std::string(problem.size_class->key) + (problem.entry->fill ? " fill" : "");
  };
  const auto side = [&](const PlannedProblem& problem) { return list(problem) + "|" + SideOf(problem); };
  const auto origin = [&](const PlannedProblem& problem) { return side(problem) + "|" + problem.entry->origin; };
  const auto family = [&](const PlannedProblem& problem) { return origin(problem) + "|" + problem.entry->family; };
  const auto base = [&](const PlannedProblem& problem) { return family(problem) + "|" + problem.entry->base; };
  const std::vector<PlannedProblem> problems = PlanProblems({}, manifests_);
  ExpectTurns(problems, list, side);
  ExpectTurns(problems, side, origin);
  ExpectTurns(problems, origin, family);
  ExpectTurns(problems, family, base);
}

TEST_P(CampaignProblems, OfClassesWithALimitAreTheFirstOfEverySide) {
  CampaignPlan plan;
  plan.most_of_side = {{"13-30", 4}, {"31-100", 9}};
  const std::vector<PlannedProblem> problems = PlanProblems(plan, manifests_);
  std::map<std::string, std::vector<std::string>> all, kept;
  const auto collect = [](const std::vector<PlannedProblem>& from, auto* into) {
    for (const PlannedProblem& problem : from) {
      (*into)[std::string(problem.size_class->key) + "|" + SideOf(problem)].push_back(problem.entry->id);
    }
  };
  collect(PlanProblems({}, manifests_), &all);
  collect(problems, &kept);
  for (auto& [side, ids] : all) {
    const auto most = plan.most_of_side.find(side.substr(0, side.find('|')));
    if (most != plan.most_of_side.end()) ids.resize(std::min(ids.size(), static_cast<std::size_t>(most->second)));
  }
  EXPECT_EQ(kept, all);
  ExpectFairWeights(problems);
}

// All of a class and tier follow each other; who has one launch for all tiers is with the usual one.
TEST(OrderOfRound, TakesAClassTierByTier) {
  CampaignPlan plan;
  const std::vector<std::string> solvers = {"a", "b", "c", "d"};
  std::vector<Task> tasks;
  for (const std::size_t begin : {0U, 7U}) {
    for (const std::string& solver : solvers) {
      Task task;
      task.begin = begin;
      task.end = begin + 3;
      task.about = std::to_string(begin);
      task.solver = solver;
      task.tier = plan.tiers.back();
      task.judged = plan.tiers;
      if (solver == "d") tasks.push_back(task);
      for (const double tier : solver == "d" ? std::vector<double>() : plan.tiers) {
        task.tier = tier;
        task.judged = {tier};
        tasks.push_back(task);
      }
    }
  }
  std::set<std::string> orders;
  for (int round = 1; round < 6; ++round) {
    std::vector<std::pair<std::size_t, double>> rounds;
    std::map<std::pair<std::size_t, double>, std::set<std::string>> met;
    std::string order;
    for (const std::size_t k : OrderOfRound(plan, tasks, round)) {
      const auto of = RoundOf(plan, tasks[k]);
      if (rounds.empty() || rounds.back() != of) rounds.push_back(of);
      met[of].insert(tasks[k].solver);
      order += tasks[k].solver;
    }
    EXPECT_EQ(rounds.size(), 6U);  // none begins twice
    for (const auto& [of, solvers_of_round] : met) {
      EXPECT_EQ(solvers_of_round.contains("d"), of.second == -1e-6);
      EXPECT_EQ(solvers_of_round.size(), of.second == -1e-6 ? 4U : 3U);
    }
    orders.insert(order);
  }
  EXPECT_GT(orders.size(), 1U);
}

class JournalOfLaunches : public testing::Test {
 protected:
  void SetUp() override { std::filesystem::create_directories(folder_); }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  const std::string folder_ = testing::TempDir() + "lcpbench-launches-" + std::to_string(getpid());
};

TEST_F(JournalOfLaunches, OneIsOffByItsLevelAgainstTheOthers) {
  Task task;
  task.solver = "dantzig";
  task.about = "2-3";
  task.end = 9;
  task.tier = 1e-6;
  task.judged = {1e-6};
  const Launches launches{.near = 6, .others = 2};
  Journal journal(folder_, {task}, {}, launches, 1, "here");
  Random random(1);
  const double slower[] = {1.02, 0.98, 1.0, 1.3, 0.8, 1.01};
  for (int launch = 1; launch <= launches.near; ++launch) {
    TimedRun run;
    std::vector<std::optional<double>>& times = run.reply.times["fresh_s"];
    for (std::size_t place = 0; place < task.end; ++place) {
      const double alone = place == 3 ? 5 : random.Uniform(0.99, 1.01);  // a single problem says nothing of the launch
      times.emplace_back(slower[launch - 1] * alone * 1e-6 * static_cast<double>(place + 1));
    }
    times[static_cast<std::size_t>(launch)].reset();  // it warmed the launch up
    journal.WriteTimed(task, PassKind::kFresh, launch, run);
  }
  const Journal::Judgement& found = *journal.Find(TaskKey(task, 1e-6));
  for (int launch = 1; launch <= launches.near; ++launch) {
    EXPECT_EQ(journal.IsOff(found, launch), std::abs(slower[launch - 1] - 1) > Journal::kOff) << launch;
  }
  EXPECT_FALSE(journal.IsOff(found, launches.near + 1));  // was not run
}

TEST(NotTaken, IsWhatASolverOfTheKeyRefuses) {
  const auto properties = [](Index friction, Index bounded) {
    ProblemProperties of;
    of.friction = friction;
    of.bounded = bounded;
    return of;
  };
  for (const SolverEntry& entry : AllSolvers()) {
    EXPECT_EQ(NotTaken(entry, properties(0, 0)), entry.takes_plain ? "" : "plain rows") << entry.key;
    EXPECT_EQ(NotTaken(entry, properties(3, 0)), entry.takes_friction ? "" : "friction rows") << entry.key;
    EXPECT_EQ(NotTaken(entry, properties(0, 2)), entry.takes_bounded ? "" : "bounded rows") << entry.key;
    EXPECT_EQ(NotTaken(entry, properties(1, 1)).empty(), entry.takes_friction && entry.takes_bounded) << entry.key;
  }
}

// A class with one problem that is not plain has a task of them, for that one.
TEST(PlanTasks, MethodsMadeForFrictionHaveNoneWhereAllIsPlain) {
  std::vector<Manifest> manifests(1);
  for (const Index rows : {5, 20, 21}) {
    manifests[0].problems.push_back(Entry("p" + std::to_string(rows), "base", "placed", rows, false));
  }
  manifests[0].problems.back().properties.friction = 1;
  for (const char* scene : {"disc-pile", "slope-stacks"}) {
    SequenceEntry& sequence = manifests[0].sequences.emplace_back();
    sequence.id = scene;
    sequence.source = Recipe{.scene = scene, .rows = 12, .changes = {}};
  }
  const CampaignPlan plan{.manifests = {"set"}, .solvers = {"pgs", "relaxation"}, .tiers = {1e-6}};
  std::map<std::string, std::set<std::string>> classes, sequences;  // by solver
  for (const Task& task : PlanTasks(plan, PlanProblems(plan, manifests))) classes[task.solver].insert(task.about);
  for (const Task& pass : PlanPasses(plan, manifests)) sequences[pass.solver].insert(pass.about);
  EXPECT_EQ(classes.at("pgs"), (std::set<std::string>{"4-6", "13-30"}));
  EXPECT_EQ(classes.at("relaxation"), (std::set<std::string>{"13-30"}));
  EXPECT_EQ(sequences.at("pgs"), (std::set<std::string>{"disc-pile", "slope-stacks"}));
  EXPECT_EQ(sequences.at("relaxation"), (std::set<std::string>{"slope-stacks"}));
}

INSTANTIATE_TEST_SUITE_P(Seeds, CampaignProblems, testing::Range(1, 21));

}  // namespace
}  // namespace lcpbench
