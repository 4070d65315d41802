// What is for measuring only: that it is what its seed draws, and who leaves it out.
#include "benchmarks/collection/sealed.h"

#include "benchmarks/campaign/campaign_plan.h"
#include "benchmarks/campaign/named_campaigns.h"
#include "benchmarks/collection/content_hash.h"
#include "benchmarks/measure/data_file.h"
#include "benchmarks/studies/fresh_problems.h"
#include "model/scenes/scene.h"
#include "tests/support/refusal.h"

namespace lcpbench {
namespace {

void ExpectDrawn(const std::string& kind, const std::set<std::string>& among, std::size_t count) {
  const nlohmann::json file = nlohmann::json::parse(ReadFile(DataFile("sealed")));
  std::vector<std::pair<std::string, std::string>> drawn;
  for (const std::string& name : among) drawn.emplace_back(TextHash(file.at("seed").dump() + " " + name), name);
  std::ranges::sort(drawn);
  std::set<std::string> expected;
  for (std::size_t k = 0; k < count; ++k) expected.insert(drawn.at(k).second);
  EXPECT_EQ(file.at(kind).get<std::set<std::string>>(), expected);
}

TEST(SealedSet, IsWhatItsSeedDraws) {
  std::set<std::string> plain, friction, engines;
  for (const SceneFamily& family : AllScenes()) plain.emplace(family.key);
  for (const SceneFamily& family : FrictionScenes()) friction.emplace(family.key);
  for (const ManifestEntry& entry : ReadManifest(DataFile("recorded")).problems) {
    engines.insert(entry.family.substr(0, entry.family.find(' ')));
  }
  ExpectDrawn("families", plain, 2);
  ExpectDrawn("friction_families", friction, 2);
  ExpectDrawn("engines", engines, 1);
}

TEST(SealedSet, AnEngineIsTheFirstWordOfItsRecordings) {
  const SealedSet set = SealedSet::Read(DataFile("sealed"));
  EXPECT_EQ(set.names().size(), 5U);
  EXPECT_TRUE(set.Has("bullet ragdolls") && set.Has("gear-train"));
  EXPECT_FALSE(set.Has("bullets") || set.Has("box2d bullet") || set.Has("gear-train-2") || set.Has(""));
  EXPECT_FALSE(SealedSet().Has(""));
}

TEST(SealedSet, APlanLeavesItOutOrHasAllOfIt) {
  CampaignPlan plan;
  plan.sealed = SealedSet::Read(DataFile("sealed"));
  std::vector<Manifest> manifests;
  for (const char* name : {"engine", "standard", "recorded", "friction", "friction-recorded"})
    manifests.push_back(ReadManifest(DataFile(name)));
  const auto count = [&] {
    std::map<bool, int> counts;
    for (const PlannedProblem& one : PlanProblems(plan, manifests)) ++counts[plan.sealed.Has(one.entry->family)];
    return counts;
  };
  const auto all = count();
  EXPECT_GT(all.at(true), 300);
  plan.without_sealed = true;
  const auto open = count();
  EXPECT_FALSE(open.contains(true));
  EXPECT_EQ(open.at(false), all.at(false));
}

TEST(SealedSet, FreshProblemsLeaveItOutUnlessTold) {
  CampaignPlan plan;
  plan.sealed = SealedSet::Read(DataFile("sealed"));
  plan.without_sealed = true;
  FreshSources sources;
  sources.scenes = {"all", "friction"};
  sources.sizes = {12};
  sources.seeds = {1};
  const auto families = [&] {
    std::size_t found = 0;
    FreshProblems problems(sources, plan);
    for (const FreshStream* stream : problems.streams()) found += stream->planned.size();
    return found;
  };
  EXPECT_EQ(families(), AllScenes().size() + FrictionScenes().size() - 4);
  sources.scenes = {"gear-train"};
  ExpectRefused([&] { families(); }, "scene family 'gear-train' is for measuring only (data/sealed.json): --sealed");
  plan.without_sealed = false;
  EXPECT_EQ(families(), 1U);
  sources.scenes = {"all", "friction"};
  EXPECT_EQ(families(), AllScenes().size() + FrictionScenes().size());
}

}  // namespace
}  // namespace lcpbench
