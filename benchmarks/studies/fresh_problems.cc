#include "benchmarks/studies/fresh_problems.h"

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>
#include <tuple>

#include "benchmarks/collection/plan.h"
#include "benchmarks/collection/problem_formats.h"
#include "benchmarks/collection/recipes/recipe.h"
#include "model/scenes/scene.h"
#include "solvers/friction/relaxation.h"
#include "solvers/registry.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

// ManifestEntry::origin, and what it is called here.
constexpr std::array<std::pair<std::string_view, std::string_view>, 6> kOrigins{{{"placed", "placed"},
                                                                                 {"motion", "motions"},
                                                                                 {"recorded", "engines"},
                                                                                 {"literature", "literature"},
                                                                                 {"given", "given"},
                                                                                 {"relaxed", "relaxed"}}};

std::size_t OriginOf(const ManifestEntry& entry) {
  const auto* found =
      std::find_if(kOrigins.begin(), kOrigins.end(), [&](const auto& origin) { return origin.first == entry.origin; });
  return static_cast<std::size_t>(found - kOrigins.begin());
}

}  // namespace

FreshProblems::FreshProblems(const FreshSources& sources, const CampaignPlan& plan) {
  for (const std::string& path : sources.manifests) {
    manifests_.push_back(sets_.emplace_back(std::make_unique<ProblemSet>(path))->manifest);
  }
  manifests_.emplace_back();
  if (sources.relaxed) relaxing_ = MakeSolver("relaxation");
  for (const std::string& path : sources.files) {
    ReadEachProblem(path, {},
                    [this](const LcpRecord& record, const std::string& /*where*/, const std::string& /*line*/) {
                      Keep(record.problem, "given", record.problem.id());
                    });
  }
  AddScenes(sources, plan);
  for (const PlannedProblem& one : PlanProblems(plan, manifests_)) {
    if (manifests_[one.manifest].name == kNonsymmetricTier) continue;  // nobody need solve these
    const std::size_t origin = OriginOf(*one.entry);
    FreshStream& stream = streams_[{one.size_class->least, origin}];
    stream.name = std::string(one.size_class->key) + "/" + std::string(kOrigins.at(origin).second);
    if (sources.most_problems == 0 || stream.planned.size() < sources.most_problems) stream.planned.push_back(one);
  }
  if (streams_.empty()) throw InputError("expected problems of at most --most-rows rows, found none");
  for (auto& [key, stream] : streams_) {
    // The order of manifests and files, which are then read once. A pass has an order of its own.
    std::sort(stream.planned.begin(), stream.planned.end(), [](const PlannedProblem& a, const PlannedProblem& b) {
      return std::tuple(a.manifest, a.entry->fill, a.entry) < std::tuple(b.manifest, b.entry->fill, b.entry);
    });
  }
}

void FreshProblems::Keep(const LcpProblem& problem, const char* origin, const std::string& base) {
  ManifestEntry& entry = manifests_.back().problems.emplace_back();
  entry.id = problem.id();
  entry.base = base;
  entry.origin = origin;
  entry.properties.rows = problem.size();
  made_.push_back(problem);
  const bool is_relaxed = relaxing_ != nullptr && !problem.is_plain() && relaxing_->WhyRefused(problem).empty();
  if (is_relaxed) Keep(RelaxationOf(problem), "relaxed", base);
}

void FreshProblems::AddScenes(const FreshSources& sources, const CampaignPlan& plan) {
  const auto is_left_out = [&](std::string_view family) { return plan.without_sealed && plan.sealed.Has(family); };
  std::vector<std::string_view> families;
  for (const std::string& name : sources.scenes) {
    if (name == "all" || name == "friction") {
      for (const SceneFamily& family : name == "all" ? AllScenes() : FrictionScenes()) {
        if (!is_left_out(family.key)) families.push_back(family.key);
      }
    } else if (is_left_out(name)) {
      throw InputError("scene family '" + name + "' is for measuring only (data/sealed.json): --sealed takes it");
    } else {
      families.push_back(FindScene(name).key);
    }
  }
  for (const std::string_view scene : families) {
    for (const int rows : sources.sizes) {
      for (const std::uint64_t seed : sources.seeds) {
        const Recipe recipe{std::string(scene), rows, seed, {}};
        Keep(MakeInstance(recipe).problem, "placed", BaseOf(recipe));
      }
    }
  }
}

std::vector<FreshStream*> FreshProblems::streams() {
  std::vector<FreshStream*> streams;
  for (auto& [key, stream] : streams_) streams.push_back(&stream);
  return streams;
}

void FreshProblems::Load(FreshStream* stream) {
  constexpr Index kMostRowsKept = 1000;
  if (!stream->problems.empty()) return;
  for (auto& [key, other] : streams_) {
    if (key.first <= kMostRowsKept) continue;
    other.problems = {};
    other.references = {};
    other.arrays = {};
  }
  for (const PlannedProblem& one : stream->planned) {
    std::optional<KnownAnswer> known;
    if (one.manifest == sets_.size()) {
      stream->problems.push_back(made_[static_cast<std::size_t>(one.entry - manifests_.back().problems.data())]);
    } else {
      ProblemSet& set = *sets_[one.manifest];
      known = set.references.Find(stream->problems.emplace_back(set.source.Get(*one.entry)));
    }
    stream->references.push_back(known ? std::move(known->reference) : LcpReference());
  }
  for (const LcpProblem& problem : stream->problems) stream->arrays.push_back(ProblemArrays::Of(problem));
}

}  // namespace lcpbench
