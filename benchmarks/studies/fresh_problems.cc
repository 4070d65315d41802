#include "benchmarks/studies/fresh_problems.h"

#include <algorithm>
#include <numeric>
#include <optional>
#include <set>
#include <utility>

#include "benchmarks/collection/problem_formats.h"
#include "benchmarks/collection/recipes/motion_steps.h"
#include "model/scenes/scene.h"
#include "solvers/io/gzip_file.h"
#include "solvers/io/json_lines.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

// The entry of a problem that no manifest has.
ManifestEntry Entry(const std::string& id, const char* origin, Index rows) {
  ManifestEntry entry;
  entry.id = id;
  entry.base = id;
  entry.origin = origin;
  entry.properties.rows = rows;
  return entry;
}

// Whether f = 0 is an answer: nothing touches.
bool IsIdle(const LcpProblem& problem) {
  for (Index row = 0; row < problem.size(); ++row) {
    if (problem.b()[row] < 0) return false;
  }
  return std::all_of(problem.bilateral_rows().begin(), problem.bilateral_rows().end(),
                     [&](auto row) { return problem.b()[row] == 0; });
}

template <typename Visit>
void ForEachStart(const std::vector<std::string>& families, const FreshSources& sources, const Visit& visit) {
  for (const std::string& scene : FamiliesOf(families)) {
    for (const int rows : sources.sizes) {
      for (const std::uint64_t seed : sources.seeds) visit(Recipe{scene, rows, seed, {}});
    }
  }
}

}  // namespace

std::vector<std::string> FamiliesOf(const std::vector<std::string>& named) {
  std::vector<std::string> families;
  for (const std::string& name : named) {
    if (name == "all") {
      for (const SceneFamily& family : AllScenes()) families.emplace_back(family.key);
    } else {
      families.emplace_back(FindScene(name).key);
    }
  }
  return families;
}

FreshProblems::FreshProblems(const FreshSources& sources, const CampaignPlan& plan) {
  for (const std::string& path : sources.manifests) Add(ReadManifest(path), FolderOf(path));
  for (const std::string& path : sources.files) AddFile(path);
  if (!sources.scenes.empty()) AddScenes(sources);
  if (!sources.motions.empty()) AddMotions(sources, plan.most_rows);
  planned_ = PlanProblems(plan, manifests_);
  if (sources.most_problems > 0) {
    KeepPerClass(sources.most_problems);
    planned_ = PlanProblems(plan, manifests_);  // with the weights of what is kept
  }
  // Nobody need solve those of kNonsymmetricTier.
  std::erase_if(planned_, [&](const PlannedProblem& one) { return !IsInMeans(manifests_[one.manifest].name); });
}

void FreshProblems::Add(Manifest manifest, const std::string& folder) {
  made_by_.push_back(std::make_unique<ProblemSource>(folder));
  references_.push_back(std::make_unique<References>(manifest, folder));
  manifests_.push_back(std::move(manifest));
}

void FreshProblems::AddFile(const std::string& path) {
  Manifest manifest;
  manifest.name = path;
  const auto add = [&](const LcpProblem& problem, std::size_t line) {
    ManifestEntry& entry = manifest.problems.emplace_back(Entry(problem.id(), "given", problem.size()));
    entry.source = FileSource{path, line};
  };
  if (!FormatOfFile(path).is_lines()) {
    add(ReadProblemFile(path, {}), 1);
  } else {
    LineReader lines(path);
    for (std::string line; lines.Next(&line);) {
      if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
      add(ParseLcpRecord(line, path + ":" + std::to_string(lines.number())).problem, lines.number());
    }
  }
  Add(std::move(manifest), "");
}

void FreshProblems::AddScenes(const FreshSources& sources) {
  Manifest manifest;
  manifest.name = "scenes";
  ForEachStart(sources.scenes, sources, [&](const Recipe& recipe) {
    ManifestEntry& entry = manifest.problems.emplace_back(Entry(RecipeId(recipe), "placed", recipe.rows));
    entry.base = BaseOf(recipe);
    entry.source = recipe;
  });
  Add(std::move(manifest), "");
}

void FreshProblems::AddMotions(const FreshSources& sources, Index most_rows) {
  Manifest manifest;
  manifest.name = "motions";
  ForEachStart(sources.motions, sources, [&](const Recipe& start) {
    TakeSteps(start, sources.steps, [&](const MotionStep& step) {
      const LcpProblem& problem = step.instance.problem;
      if (problem.size() < 1 || (most_rows > 0 && problem.size() > most_rows) || IsIdle(problem)) return false;
      Recipe recipe = start;
      recipe.motion_step = step.number;
      ManifestEntry& entry = manifest.problems.emplace_back(Entry(problem.id(), "motion", problem.size()));
      entry.base = BaseOf(recipe);
      entry.source = recipe;
      steps_.emplace(problem.id(), problem);
      return true;
    });
  });
  Add(std::move(manifest), "");
}

void FreshProblems::KeepPerClass(int most) {
  std::map<const SizeClass*, int> taken;
  std::set<const ManifestEntry*> kept;
  for (const PlannedProblem& one : planned_) {
    if (taken[one.size_class]++ < most) kept.insert(one.entry);
  }
  for (Manifest& manifest : manifests_) {
    for (auto* entries : {&manifest.problems, &manifest.fill}) {
      std::vector<ManifestEntry> rest;
      for (ManifestEntry& entry : *entries) {
        if (kept.count(&entry) > 0) rest.push_back(std::move(entry));
      }
      *entries = std::move(rest);
    }
  }
}

std::vector<FreshProblems::Problem> FreshProblems::Make(std::size_t begin, std::size_t end) {
  // In the order of manifests and files, which reads these once.
  std::vector<std::size_t> order(end - begin);
  std::iota(order.begin(), order.end(), begin);
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::pair(planned_[a].manifest, planned_[a].entry) < std::pair(planned_[b].manifest, planned_[b].entry);
  });
  std::vector<std::optional<Problem>> made(end - begin);
  for (const std::size_t k : order) {
    const PlannedProblem& one = planned_[k];
    const auto step = steps_.find(one.entry->id);
    LcpProblem problem = step != steps_.end() ? step->second : made_by_[one.manifest]->Get(*one.entry);
    std::optional<KnownAnswer> known = references_[one.manifest]->Find(problem);
    made[k - begin] = Problem{std::move(problem), known ? std::move(known->reference) : LcpReference()};
  }
  std::vector<Problem> problems;
  problems.reserve(made.size());
  for (std::optional<Problem>& one : made) problems.push_back(*std::move(one));
  return problems;
}

}  // namespace lcpbench
