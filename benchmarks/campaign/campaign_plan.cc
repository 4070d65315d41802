#include "benchmarks/campaign/campaign_plan.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <map>
#include <regex>
#include <string_view>
#include <tuple>
#include <utility>
#include <variant>

#include "benchmarks/collection/plan.h"
#include "benchmarks/collection/turns.h"
#include "model/scenes/random.h"
#include "model/scenes/scene.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

// FNV-1a, of 64 bits.
std::uint64_t Hash(const std::string& text) {
  std::uint64_t hash = 14695981039346656037U;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211U;
  return hash;
}

// The finalizer of splitmix64: ids that differ in a digit get orders that have nothing in common.
std::uint64_t Mixed(std::uint64_t value) {
  value = (value ^ (value >> 30U)) * 0xbf58476d1ce4e5b9U;
  value = (value ^ (value >> 27U)) * 0x94d049bb133111ebU;
  return value ^ (value >> 31U);
}

std::string ShortTier(double tier) {
  char text[16];
  std::snprintf(text, sizeof text, "%.0e", tier);
  return text;
}

std::vector<double> LoosestFirst(const CampaignPlan& plan) {
  std::vector<double> tiers = plan.tiers;
  std::sort(tiers.begin(), tiers.end(), std::greater<>());
  return tiers;
}

// The task at every tier that its solver tells apart.
void AddByTier(Task task, const CampaignPlan& plan, std::vector<Task>* tasks) {
  task.judged = LoosestFirst(plan);
  task.tier = task.judged.back();
  if (!FindSolver(task.solver).uses_tolerance) {
    tasks->push_back(std::move(task));
    return;
  }
  for (const double tier : LoosestFirst(plan)) {
    task.tier = tier;
    task.judged = {tier};
    tasks->push_back(task);
  }
}

// Engines' recordings are without friction.
bool IsPlain(const SequenceEntry& entry) {
  const auto* start = std::get_if<Recipe>(&entry.source);
  return start == nullptr ||
         std::ranges::none_of(FrictionScenes(), [&](const SceneFamily& family) { return family.key == start->scene; });
}

// What a problem's size class is made of: scenes of ours (placed or in motion), engines' recordings and literature;
// and, apart from these, what is in no mean.
using Side = std::tuple<Index, bool, std::string_view>;
bool IsInMeans(const PlannedProblem& problem, const std::vector<Manifest>& manifests) {
  return IsInMeans(manifests[problem.manifest].name, *problem.entry);
}
Side SideOf(const PlannedProblem& problem, const std::vector<Manifest>& manifests) {
  const std::string_view origin = problem.entry->origin;
  return {problem.size_class->least, IsInMeans(problem, manifests), origin == "motion" ? "placed" : origin};
}

// Takes turns by sides, within these by origins, families and bases; fill-ups come after all others of their class.
void OrderByTurns(const std::vector<Manifest>& manifests, std::vector<PlannedProblem>* problems) {
  const auto side = [&](const PlannedProblem& problem) {
    return std::pair(problem.entry->fill, SideOf(problem, manifests));
  };
  for (const auto member : {&ManifestEntry::base, &ManifestEntry::family, &ManifestEntry::origin}) {
    TakeTurns(problems, [&](const PlannedProblem& problem) {
      return std::pair(side(problem), std::string_view(problem.entry->*member));
    });
  }
  TakeTurns(problems, side);
  const auto list = [](const PlannedProblem& problem) {
    return std::pair(problem.size_class->least, problem.entry->fill);
  };
  std::stable_sort(problems->begin(), problems->end(),
                   [&](const PlannedProblem& a, const PlannedProblem& b) { return list(a) < list(b); });
}

void KeepMostOfSides(const CampaignPlan& plan, const std::vector<Manifest>& manifests,
                     std::vector<PlannedProblem>* problems) {
  std::map<Side, int> kept;
  std::erase_if(*problems, [&](const PlannedProblem& problem) {
    const auto most = plan.most_of_side.find(std::string(problem.size_class->key));
    return most != plan.most_of_side.end() && ++kept[SideOf(problem, manifests)] > most->second;
  });
}

void SetWeights(const std::vector<Manifest>& manifests, std::vector<PlannedProblem>* problems) {
  // A variant that is in no mean takes nothing from those that are.
  const auto base = [&manifests](const PlannedProblem& problem) {
    return std::tuple(problem.size_class, IsInMeans(problem, manifests), std::string_view(problem.entry->base));
  };
  std::map<std::tuple<const SizeClass*, bool, std::string_view>, double> sharing;
  for (const PlannedProblem& problem : *problems) sharing[base(problem)] += 1;
  using Kind = std::pair<const SizeClass*, bool>;
  const auto kind = [&](const PlannedProblem& problem) {
    return Kind(problem.size_class, IsInMeans(problem, manifests));
  };
  std::map<Kind, std::map<Side, double>> weights;
  for (PlannedProblem& problem : *problems) {
    problem.weight = 1 / sharing[base(problem)];
    weights[kind(problem)][SideOf(problem, manifests)] += problem.weight;
  }
  for (PlannedProblem& problem : *problems) {
    const std::map<Side, double>& by_side = weights[kind(problem)];
    double sum = 0;
    for (const auto& [side, weight] : by_side) sum += weight;
    problem.weight *= sum / (static_cast<double>(by_side.size()) * by_side.at(SideOf(problem, manifests)));
  }
}

}  // namespace

double DisturbanceOf(const NoiseRule& rule, const Disturbance& found, double fast_probe_s) {
  const double slower = found.probe_s / fast_probe_s - 1;
  const double waiting = 1 - found.cpu_share;
  if (slower <= rule.slower_clock && found.cpu_share >= rule.least_cpu_share) return 0;
  return std::max(slower, 0.0) + waiting;
}

std::string CellName(const std::string& problem, const std::string& solver, double tier) {
  return "solve/" + problem + "/" + solver + "/" + ShortTier(tier);
}

std::string PassName(const Task& pass) {
  return "steps/" + pass.about + "/" + pass.solver + "/" + ShortTier(pass.tier) + "/" + pass.mode;
}

std::string OutOfTimeRule(double tier) { return "out of time at the looser tier " + ShortTier(tier); }
std::string OutOfTimeRule(const SolveLimits& limits) {
  return "out of time on " + std::to_string(limits.most_late) + " problems of the class or more, half of those tried";
}

void RequireValid(const CampaignPlan& plan) {
  const auto require = [](bool holds, const std::string& expected) {
    if (!holds) throw InputError("campaign: expected " + expected);
  };
  for (const std::string& solver : plan.solvers) FindSolver(solver);
  require(!plan.manifests.empty(), "at least one manifest");
  require(!plan.solvers.empty(), "at least one solver");
  require(!plan.tiers.empty(), "at least one tier");
  for (const double tier : plan.tiers) require(tier > 0 && tier < 1, "tiers in (0, 1)");
  require(plan.noise.slower_clock > 0 && plan.noise.least_cpu_share < 1 && plan.noise.most_reruns >= 0,
          "a rule for noise that some cells pass");
  require(plan.rounds >= 1 && plan.launches.others >= 1 && plan.launches.near >= plan.launches.others &&
              plan.launches.repeats >= 0 && plan.limits.most_late >= 1,
          "launches >= 1");
  require(plan.most_rows >= 0, "rows >= 0");
  require(
      plan.launches.within >= 1 && plan.launches.right > 0 && plan.launches.right <= 1 && plan.launches.settle_s >= 0,
      "launches within a factor >= 1, a share right in (0, 1], a time to settle >= 0 s");
  for (const auto& [key, most] : plan.most_of_side) {
    const bool is_class =
        std::any_of(kSizeClasses.begin(), kSizeClasses.end(), [&](const auto& of) { return of.key == key; });
    require(is_class && most >= 1, "a size class and problems of a side >= 1");
  }
  const SolveLimits& limits = plan.limits;
  require(limits.time_per_row_s >= 0 && limits.least_s > 0 && limits.most_s >= limits.least_s && limits.class_s > 0,
          "time limits > 0 s, in order");
  for (const double deadline : plan.deadlines_s) require(deadline > 0, "deadlines > 0 s");
  require(plan.pass_budget_s > 0, "a pass's budget > 0 s");
  try {
    const std::regex filter(plan.filter);
  } catch (const std::regex_error&) {
    throw InputError("campaign: expected a regular expression, found '" + plan.filter + "'");
  }
}

bool IsInMeans(const std::string& manifest, const ManifestEntry& entry) {
  return manifest != kNonsymmetricTier && manifest != kLiteratureTier && entry.properties.is_plain();
}

std::string NotTaken(const SolverEntry& solver, const ProblemProperties& problem) {
  if (problem.is_plain() && !solver.takes_plain) return "plain rows";
  if (problem.friction > 0 && !solver.takes_friction) return "friction rows";
  return problem.bounded > 0 && !solver.takes_bounded ? "bounded rows" : "";
}

std::vector<PlannedProblem> PlanProblems(const CampaignPlan& plan, const std::vector<Manifest>& manifests) {
  const std::regex filter(plan.filter);
  std::vector<PlannedProblem> problems;
  for (std::size_t m = 0; m < manifests.size(); ++m) {
    const auto add = [&](const std::vector<ManifestEntry>& entries) {
      for (const ManifestEntry& entry : entries) {
        const Index rows = entry.properties.rows;
        if (plan.without_sealed && plan.sealed.Has(entry.family)) continue;
        if (plan.most_rows > 0 && rows > plan.most_rows) continue;
        if (!plan.filter.empty() && !std::regex_search("solve/" + entry.id + "/", filter)) continue;
        problems.push_back({m, &entry, &SizeClassOf(rows), 1});
      }
    };
    add(manifests[m].problems);
    if (plan.fills) add(manifests[m].fill);
  }
  const std::string salt = std::to_string(plan.seed) + "|";
  std::sort(problems.begin(), problems.end(), [&salt](const PlannedProblem& a, const PlannedProblem& b) {
    const auto key = [&salt](const PlannedProblem& problem) {
      return std::tuple(problem.size_class->least, problem.entry->fill, Mixed(Hash(salt + problem.entry->id)),
                        std::string_view(problem.entry->id));
    };
    return key(a) < key(b);
  });
  OrderByTurns(manifests, &problems);
  KeepMostOfSides(plan, manifests, &problems);
  SetWeights(manifests, &problems);
  return problems;
}

std::vector<Task> PlanTasks(const CampaignPlan& plan, const std::vector<PlannedProblem>& problems) {
  constexpr Index kMostRowsTogether = 10'000;
  std::vector<Task> tasks;
  std::size_t first_of_class = 0;
  for (std::size_t begin = 0; begin < problems.size();) {
    const SizeClass* size_class = problems[begin].size_class;
    if (problems[first_of_class].size_class != size_class) first_of_class = begin;
    std::size_t end = begin + 1;
    while (size_class->most <= kMostRowsTogether && end < problems.size() && problems[end].size_class == size_class) {
      ++end;
    }
    Index least_rows = problems[begin].entry->properties.rows;
    bool is_plain = true;
    for (std::size_t k = begin; k < end; ++k) {
      least_rows = std::min(least_rows, problems[k].entry->properties.rows);
      is_plain = is_plain && problems[k].entry->properties.is_plain();
    }
    for (const std::string& key : plan.solvers) {
      const SolverEntry& solver = FindSolver(key);
      if (!solver.available || (is_plain && !solver.takes_plain)) continue;
      Task task;
      task.solver = key;
      task.runs = KeyForRows(solver, size_class->most);
      task.about = size_class->key;
      task.excluded = SizeRefusal(solver, least_rows);
      task.begin = begin;
      task.end = end;
      task.first = begin - first_of_class;
      AddByTier(std::move(task), plan, &tasks);
    }
    begin = end;
  }
  return tasks;
}

std::vector<Task> PlanPasses(const CampaignPlan& plan, const std::vector<Manifest>& manifests) {
  constexpr double kMillisecond = 1e-3;
  std::vector<Task> passes;
  for (std::size_t m = 0; m < manifests.size(); ++m) {
    for (const SequenceEntry& entry : manifests[m].sequences) {
      for (const std::string& key : plan.solvers) {
        const SolverEntry& solver = FindSolver(key);
        if (!solver.available || (!solver.takes_plain && IsPlain(entry))) continue;
        Task task;
        task.solver = solver.key;
        task.runs = KeyForRows(solver, SizeOf(entry));
        task.about = entry.id;
        task.excluded = SizeRefusal(solver, entry.most_rows);
        task.sequence = &entry;
        task.manifest = m;
        for (const char* mode : {"cold", "warm"}) {
          task.mode = mode;
          AddByTier(task, plan, &passes);
          task.warm = true;
        }
        task.judged = LoosestFirst(plan);
        task.tier = task.judged.back();
        for (const double deadline : plan.deadlines_s) {
          char text[32];
          std::snprintf(text, sizeof text, "deadline-%gms", deadline / kMillisecond);
          task.mode = text;
          task.deadline_s = deadline;
          passes.push_back(task);
        }
      }
    }
  }
  const std::regex filter(plan.filter);
  std::erase_if(passes,
                [&](const Task& pass) { return !plan.filter.empty() && !std::regex_search(PassName(pass), filter); });
  return passes;
}

std::vector<std::size_t> ShuffleGroups(const std::vector<std::size_t>& group_of_cell, std::uint64_t seed, int round) {
  std::vector<std::pair<std::size_t, std::size_t>> groups;  // first cell, count
  for (std::size_t k = 0; k < group_of_cell.size(); ++k) {
    if (k > 0 && group_of_cell[k] == group_of_cell[k - 1]) {
      ++groups.back().second;
    } else {
      groups.emplace_back(k, 1);
    }
  }
  constexpr std::uint64_t kRoundStep = 1'000'003;
  Random random(seed + kRoundStep * static_cast<std::uint64_t>(round));
  for (std::size_t k = groups.size(); k > 1; --k) {
    std::swap(groups[k - 1], groups[static_cast<std::size_t>(random.Integer(static_cast<int>(k)))]);
  }
  std::vector<std::size_t> order;
  order.reserve(group_of_cell.size());
  for (const auto& [first, count] : groups) {
    for (std::size_t k = first; k < first + count; ++k) order.push_back(k);
  }
  return order;
}

PassRequest PlanPass(const std::vector<std::size_t>& places, PassKind kind, std::uint64_t seed, int pass) {
  constexpr std::size_t kMostWarmUps = 16;
  constexpr std::size_t kOneIn = 8;
  PassRequest request;
  request.kind = kind;
  const std::size_t count = places.size();
  if (count == 0) return request;
  const std::size_t warm = count < 2 ? 0 : std::clamp<std::size_t>(count / kOneIn, 1, kMostWarmUps);
  std::vector<bool> warms(count, false);
  const std::vector<std::size_t> fixed = ShuffleGroups(places, seed, 0);
  for (std::size_t k = 0; k < warm; ++k) {
    const std::size_t chosen = fixed[(static_cast<std::size_t>(pass - 1) * warm + k) % count];
    warms[chosen] = true;
    request.warm_up.push_back(static_cast<std::uint32_t>(places[chosen]));
  }
  for (const std::size_t k : ShuffleGroups(places, seed, pass)) {
    if (!warms[k]) request.order.push_back(static_cast<std::uint32_t>(places[k]));
  }
  return request;
}

std::pair<std::size_t, double> RoundOf(const CampaignPlan& plan, const Task& task) {
  constexpr double kUsual = 1e-6;
  if (task.judged.size() <= 1) return {task.begin, -task.tier};
  const auto distance = [](double tier) { return std::abs(std::log(tier / kUsual)); };
  return {task.begin, -std::ranges::min(plan.tiers, {}, distance)};
}

std::vector<std::size_t> OrderOfRound(const CampaignPlan& plan, const std::vector<Task>& tasks, int round) {
  std::vector<std::size_t> groups(tasks.size(), 0);
  for (std::size_t k = 1; k < tasks.size(); ++k) {
    const bool same = tasks[k].about == tasks[k - 1].about && tasks[k].first == tasks[k - 1].first &&
                      tasks[k].solver == tasks[k - 1].solver;
    groups[k] = groups[k - 1] + (same ? 0 : 1);
  }
  std::vector<std::size_t> order = ShuffleGroups(groups, plan.seed, round);
  const auto place = [&](std::size_t k) {
    const SequenceEntry* entry = tasks[k].sequence;
    if (entry == nullptr) {
      const auto [begin, tier] = RoundOf(plan, tasks[k]);
      return std::tuple(begin, tier, std::string_view());
    }
    if (round > 0) return std::tuple(tasks[k].begin, 0.0, std::string_view());
    // An exact solve costs about the square of the rows.
    const auto rows = static_cast<double>(entry->most_rows);
    const double work_to_make = static_cast<double>(entry->problems) * rows * rows;
    return std::tuple(tasks[k].begin, work_to_make, std::string_view(entry->id));
  };
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return place(a) < place(b); });
  return order;
}

std::vector<Task> TasksOfShard(std::vector<Task> tasks, const Shard& shard) {
  std::map<std::pair<std::string, std::size_t>, int> places;
  std::erase_if(tasks, [&](const Task& task) {
    const int place = places.try_emplace({task.about, task.first}, static_cast<int>(places.size())).first->second;
    const int part = place % shard.parts + 1;
    return part < shard.first || part > shard.last;
  });
  return tasks;
}

}  // namespace lcpbench
