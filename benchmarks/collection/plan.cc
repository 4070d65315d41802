#include "benchmarks/collection/plan.h"

#include <boost/algorithm/string/join.hpp>
#include <initializer_list>
#include <utility>

#include "benchmarks/collection/recipes/hard_cases.h"
#include "model/scenes/scene.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

using Scenes = std::vector<std::string_view>;

Scenes EveryScene() {
  Scenes keys;
  for (const SceneFamily& scene : AllScenes()) keys.push_back(scene.key);
  return keys;
}

// One list of changes, which is empty.
const std::vector<std::vector<Change>> kUnchanged(1);

// Every scene at every size with every seed and every list of changes.
void Add(const Scenes& scenes, std::initializer_list<int> sizes, const std::vector<std::vector<Change>>& changes,
         Tier* tier, const std::vector<std::uint64_t>& seeds = {1}, std::string_view grid = {},
         std::string_view purpose = {}) {
  for (const std::string_view scene : scenes) {
    for (const int rows : sizes) {
      for (const std::uint64_t seed : seeds) {
        for (const std::vector<Change>& change : changes) {
          tier->problems.push_back({{std::string(scene), rows, seed, change}, std::string(grid), std::string(purpose)});
        }
      }
    }
  }
}

// Problems that differ in one number only.
void AddGrid(const char* property, const char* change, const Scenes& scenes, std::initializer_list<int> sizes,
             std::initializer_list<double> amounts, Tier* tier) {
  std::vector<std::vector<Change>> changes;
  for (const double amount : amounts) changes.push_back({{change, amount}});
  Add(scenes, sizes, changes, tier, {1}, property);
}

// Problems that are meant to break something.
void AddHard(const Scenes& scenes, std::initializer_list<int> sizes, const std::vector<std::vector<Change>>& changes,
             std::string_view purpose, Tier* tier, std::uint64_t seed = 1) {
  Add(scenes, sizes, changes, tier, {seed}, {}, purpose);
}

void AddMotion(std::string_view scene, int rows, std::uint64_t seed, int steps, Tier* tier) {
  tier->motions.push_back({{std::string(scene), rows, seed, {}}, steps});
}

// Steps of motions of every family.
void AddMotions(std::initializer_list<int> sizes, std::uint64_t last_seed, int steps, Tier* tier) {
  for (const int rows : sizes) {
    for (const std::string_view scene : EveryScene()) {
      for (std::uint64_t seed = 1; seed <= last_seed; ++seed) AddMotion(scene, rows, seed, steps, tier);
    }
  }
}

Tier Smoke() {
  Tier tier{"smoke", "Every scene family at two small sizes: all solvers in seconds.", true, true};
  Add(EveryScene(), {8, 40}, kUnchanged, &tier, {11});
  return tier;
}

Tier Engine() {
  Tier tier{"engine", "One to three rows, as a physics engine's islands mostly are.", false, true};
  Add(EveryScene(), {1, 2, 3}, kUnchanged, &tier, {1, 2, 3});
  // A single row has f = 0 or w = 0, and an engine meets both: no answer is a reason to refuse a problem.
  tier.fill = {{SizeClassOf(1), {1}}, {SizeClassOf(2), {2, 3}}};
  return tier;
}

Tier Standard() {
  Tier tier{"standard", "What solvers are compared on: all families at 4 to 10^4 rows, and grids of one property each.",
            true, true};
  Add(EveryScene(), {4, 6, 10, 16, 25, 40, 64, 100, 160, 250, 400, 640, 1000}, kUnchanged, &tier, {1, 2});
  Add(EveryScene(), {2000}, kUnchanged, &tier);
  Add({"discs-in-v", "disc-pile", "disc-track", "boxes-and-discs", "chain-of-links", "ovals-in-bowl", "roller-bearing",
       "tall-stacks"},
      {4000, 10'000}, kUnchanged, &tier);
  AddGrid("mass ratio", "mass-ratio", {"disc-pile", "rounded-wall", "chain-of-links"}, {100, 400},
          {1e1, 1e2, 1e3, 1e4, 1e5, 1e6}, &tier);
  AddGrid("redundancy", "duplicate-rows", {"ovals-in-bowl", "disc-pile", "disc-track"}, {100, 400}, {0.1, 0.25, 0.5, 1},
          &tier);
  AddGrid("condition", "crowd-contacts", {"ovals-in-bowl", "rockers", "spinning-drum"}, {100, 400},
          {1, 1e-1, 1e-2, 1e-3, 1e-4}, &tier);
  AddGrid("active fraction", "slack", {"disc-pile", "ovals-in-bowl", "disc-track"}, {100, 400},
          {-0.5, -0.25, 0.25, 0.5, 1, 1.5}, &tier);
  AddGrid("curvature contrast", "curvature-contrast",
          {"disc-track", "rockers", "ovals-in-bowl", "gear-train", "cam-follower"}, {100, 400}, {3, 10, 30, 100, 1000},
          &tier);
  AddMotions({45, 64}, 3, 2, &tier);
  AddMotions({100}, 2, 2, &tier);
  AddMotions({160, 250, 400}, 2, 1, &tier);
  AddMotions({640}, 1, 1, &tier);
  for (const std::string_view scene : {"disc-pile", "disc-track", "boxes-and-discs", "cam-follower", "chain-of-links",
                                       "ovals-in-bowl", "roller-bearing", "tall-stacks"}) {
    AddMotion(scene, 1000, 1, 1, &tier);
  }
  for (const std::string_view scene : {"disc-pile", "chain-of-links", "ovals-in-bowl", "tall-stacks"}) {
    AddMotion(scene, 1900, 1, 1, &tier);
  }
  tier.fill = {{SizeClassOf(4), {4, 6}},         {SizeClassOf(10), {10}},        {SizeClassOf(16), {16, 25}},
               {SizeClassOf(40), {40, 64, 100}}, {SizeClassOf(160), {160, 250}}, {SizeClassOf(400), {400, 640, 1000}}};
  return tier;
}

Tier Large() {
  Tier tier{"large", "10^4 to 10^6 rows, generated when they are wanted."};
  Add(EveryScene(), {20'000, 100'000}, kUnchanged, &tier);
  Add({"disc-pile", "disc-track", "ovals-in-bowl", "rounded-wall"}, {300'000, 1'000'000}, kUnchanged, &tier);
  return tier;
}

Tier Pathological() {
  Tier tier{"pathological", "Problems that are meant to break something, each of which says what.", false, true};
  for (const HardCase& hard : AllHardCases()) AddHard({hard.key}, {8, 40, 200}, kUnchanged, hard.purpose, &tier);
  AddHard({"discs-in-v", "roller-bearing", "rounded-wall", "billiards-break"}, {60, 240}, kUnchanged,
          "Rank-deficient A: forces are not unique, and pivots vanish but for rounding.", &tier, 21);
  AddHard({"roller-bearing"}, {60}, kUnchanged,
          "Infeasible by one rounding of its data: solvers in doubles cannot know, and a proof of either kind is wrong "
          "for the neighbour.",
          &tier);
  AddHard({"disc-pile", "tall-stacks", "rounded-wall", "chain-of-links"}, {40, 200}, {{{"mass-ratio", 1e8}}},
          "Mass ratios to 10^8: sweeps stall, and absolute tolerances lose the light bodies.", &tier);
  for (const double clearance : {1e-3, 1e-6, 1e-9}) {
    AddHard({"disc-track"}, {40}, {{{"conformal", clearance}}},
            "Nearly conformal arcs: the relative curvature all but vanishes, and gamma is huge on some rows.", &tier);
    AddHard(
        {"roller-bearing"}, {40}, {{{"conformal", clearance}}},
        "Nearly conformal arcs in redundant rows, which depend on each other but for rounding: the exact forces are "
        "beyond what doubles can balance.",
        &tier);
  }
  AddHard({"disc-pile", "rockers", "gear-train"}, {60}, {{{"scale-rows", 20}}, {{"scale-rows", 60}}},
          "Rows in units that differ by up to 2^120: whatever is not relative to the diagonal sees some rows only.",
          &tier);
  AddHard({"disc-pile", "ovals-in-bowl", "gear-train"}, {30, 150}, {{{"duplicate-rows", 1}}},
          "Every contact twice: A_FF is singular for every active set but some.", &tier);
  AddHard({"disc-pile", "ovals-in-bowl"}, {30, 150}, {{{"oppose-rows", 0.2}}},
          "Contacts with their opposites: bilateral in disguise, forces without bound along a line.", &tier);
  AddHard({"ovals-in-bowl"}, {60}, {{{"crowd-contacts", 1e-5}}, {{"crowd-contacts", 1e-7}}},
          "Contacts that all but coincide: singular to rounding, and yet unique forces.", &tier);
  return tier;
}

Tier Sequences() {
  Tier tier{"sequences", "Consecutive problems of scenes in motion: what warm starts are for."};
  constexpr int kSteps = 200;
  const auto add = [&tier](std::string_view scene, int rows) {
    tier.sequences.push_back({{std::string(scene), rows, 1, {}}, kSteps});
  };
  for (const SceneFamily& scene : AllScenes()) {
    add(scene.key, 12);
    add(scene.key, 40);
  }
  // As large as exact arithmetic drives in minutes.
  for (const std::string_view scene : {"disc-pile", "ovals-in-bowl", "rockers", "cam-follower", "chain-of-links"}) {
    add(scene, 120);
  }
  return tier;
}

Tier Literature() {
  Tier tier{"literature", "What others published: problems by formulas of 10 to 10^6 rows, and literal ones.", true,
            true};
  tier.version = "3.0.0";
  tier.has_literals = true;
  const auto grid = [&tier](std::string_view key, const char* parameter, std::initializer_list<double> amounts) {
    Add({key}, {100, 1024, 10'000, 99'856, 1'000'000}, kUnchanged, &tier);
    std::vector<std::vector<Change>> changes;
    for (const double amount : amounts) changes.push_back({{parameter, amount}});
    Add({key}, {100, 1024, 10'000}, changes, &tier);
  };
  grid("obstacle", "load", {-20, -5, 0});
  grid("torsion", "angle", {10, 20});
  grid("journal-bearing", "eccentricity", {0.3, 0.5, 0.9});
  grid("block-tridiagonal", "shift", {0});
  Add({"biggsb1"}, {100, 1000, 10'000, 1'000'000}, kUnchanged, &tier);
  Add({"chen-harker"}, {100, 1000, 10'000, 100'000}, kUnchanged, &tier);
  Add({"fathi"}, {8, 16, 32, 64, 128, 256}, kUnchanged, &tier);
  Add({"hilbert"}, {5, 8, 12, 16, 20}, kUnchanged, &tier);
  Add({"harker-pang"}, {10, 30, 100, 200, 400, 1000}, kUnchanged, &tier);
  Add({"harker-pang"}, {10, 30, 100, 200}, kUnchanged, &tier, {2});
  return tier;
}

Tier Nonsymmetric() {
  Tier tier{kNonsymmetricTier,
            "Nonsymmetric and indefinite A: \"unsupported\" is a right answer, and a wrong \"solved\" a false success.",
            false, true};
  tier.version = "3.0.0";
  tier.has_literals = true;
  Add({"murty"}, {8, 32, 128, 512}, kUnchanged, &tier);
  Add({"murty-lemke"}, {8, 16, 32, 50}, kUnchanged, &tier);
  Add({"csizmadia"}, {10, 30, 50}, kUnchanged, &tier);
  Add({"block-tridiagonal-skew"}, {100, 1024, 10'000}, {{}, {{"shift", 0}}}, &tier);
  Add({"harker-pang-skew"}, {8, 10, 30, 100}, kUnchanged, &tier, {1, 2});
  Add({"clique"}, {6, 20, 100}, kUnchanged, &tier);
  Add({"knapsack"}, {8, 12, 40}, kUnchanged, &tier);
  Add({"knapsack"}, {8, 12}, {{{"solvable", 0}}}, &tier);
  return tier;
}

Tier Recorded() {
  Tier tier{
      "recorded",
      "What physics engines met in scenes of their own: whole scenes of 4 to 5000 rows, and islands of 1 or more.",
      true, true};
  tier.version = "3.1.0";
  tier.recordings = RecordedShare{};
  return tier;
}

// ----- with friction

constexpr const char* kFrictionVersion = "4.0.0";

Tier OfFriction(Tier tier) {
  tier.has_friction = true;
  tier.version = kFrictionVersion;
  return tier;
}
const std::initializer_list<double> kFrictions = {0.1, 0.3, 0.6, 1};

// Families without friction get it on every contact, which doubles their rows; the others have their own, drawn about
// their thresholds.
void AddFrictionGrid(const Scenes& scenes, std::initializer_list<int> contacts, std::initializer_list<double> frictions,
                     Tier* tier) {
  AddGrid("coefficient of friction", "friction", scenes, contacts, frictions, tier);
}

Tier FrictionEngine() {
  Tier tier =
      OfFriction({"friction-engine", "One to three contacts with friction, as a physics engine's islands mostly are.",
                  true, true});
  // The least sizes of two families have joints and no contact.
  Scenes scenes = EveryScene();
  std::erase(scenes, "oval-train");
  AddFrictionGrid(scenes, {3}, kFrictions, &tier);
  std::erase(scenes, "newtons-cradle");
  AddFrictionGrid(scenes, {1, 2}, kFrictions, &tier);
  const std::vector<std::uint64_t> seeds = {1, 2, 3, 4, 5, 6};
  Add({"rolling-discs", "ovals-rocking", "drum"}, {2, 4, 6}, kUnchanged, &tier, seeds);
  Add({"slope-stacks", "ladders", "wheel-step", "wedge-jam", "pulled-chain"}, {4}, kUnchanged, &tier, seeds);
  Add({"card-house"}, {6}, kUnchanged, &tier, seeds);
  Add({"capstan"}, {2, 5, 8}, kUnchanged, &tier, seeds);
  Add({"gears-friction"}, {9}, kUnchanged, &tier, seeds);
  Add({"cam-lock"}, {6, 12, 18}, kUnchanged, &tier, seeds);
  return tier;
}

Tier WithFriction() {
  Tier tier = OfFriction(
      {"friction",
       "What solvers of Coulomb's law are compared on: all families, with and without thresholds of their own, at "
       "4 to 10^4 rows.",
       true, true});
  AddFrictionGrid(EveryScene(), {4, 10, 25, 64}, kFrictions, &tier);
  AddFrictionGrid(EveryScene(), {160}, {0.3}, &tier);
  for (const SceneFamily& scene : FrictionScenes()) {
    if (scene.key == "three-discs") {
      Add({scene.key}, {10}, kUnchanged, &tier, {1, 2, 3, 4, 5, 6});
    } else {
      Add({scene.key}, {24, 40, 100}, kUnchanged, &tier, {1, 2, 3});
      Add({scene.key}, {300}, kUnchanged, &tier);
    }
  }
  AddFrictionGrid({"disc-pile", "boxes-and-discs", "chain-of-links", "tall-stacks"}, {400}, {0.3}, &tier);
  AddFrictionGrid({"boxes-and-discs", "chain-of-links", "disc-track", "rockers", "roller-bearing", "rounded-wall",
                   "tall-stacks", "cam-follower"},
                  {700}, {0.1, 0.6}, &tier);
  AddFrictionGrid({"disc-pile", "ovals-in-bowl"}, {1500}, {0.3}, &tier);
  Add({"slope-stacks", "pyramids", "card-house", "drum"}, {1000}, kUnchanged, &tier);
  Add({"slope-stacks", "pyramids", "voussoir-arch", "wedge-jam"}, {3000, 10'000}, kUnchanged, &tier);
  return tier;
}

Tier FrictionRecorded() {
  Tier tier = OfFriction(
      {"friction-recorded",
       "What physics engines met in scenes of their own, with their coefficients of friction: whole scenes, and "
       "islands of 2 rows or more. In space friction has two tangents.",
       true, true});
  tier.recordings = RecordedShare{RecordedLevel::kFriction, 3, 120};
  return tier;
}

Tier FrictionLiterature() {
  Tier tier = OfFriction({"friction-literature", "Problems with friction that others published.", false, true});
  tier.has_literals = true;
  return tier;
}

Tier FrictionPathological() {
  Tier tier =
      OfFriction({"friction-pathological",
                  "Problems with friction that are meant to break something, each of which says what.", false, true});
  tier.has_literals = true;
  const auto add = [&tier](const Scenes& scenes, std::initializer_list<int> contacts, double mu,
                           const std::vector<Change>& changes, std::string_view purpose) {
    std::vector<Change> with_friction = {{"friction", mu}};
    with_friction.insert(with_friction.end(), changes.begin(), changes.end());
    AddHard(scenes, contacts, {with_friction}, purpose, &tier);
  };
  add({"disc-pile", "tall-stacks", "chain-of-links"}, {20, 100}, 0.6, {{"mass-ratio", 1e8}},
      "Mass ratios to 10^8: sweeps stall, and absolute tolerances lose the light bodies.");
  for (const double clearance : {1e-3, 1e-6, 1e-9}) {
    add({"disc-track", "roller-bearing"}, {20}, 0.3, {{"conformal", clearance}},
        "Nearly conformal arcs: contacts in one place whose rows all but agree.");
  }
  add({"disc-pile", "rockers", "gear-train"}, {30}, 0.6, {{"scale-rows", 60}},
      "Rows in units that differ by up to 2^120, and coefficients of friction by as much.");
  add({"disc-pile", "ovals-in-bowl", "gear-train"}, {15, 75}, 0.6, {{"duplicate-rows", 1}},
      "Every normal row twice, one of them with friction: how the two share the load decides how much it holds.");
  add({"disc-pile", "ovals-in-bowl"}, {15, 75}, 0.6, {{"oppose-rows", 0.2}},
      "Contacts with their opposites: normal forces without bound, and with them friction.");
  add({"ovals-in-bowl"}, {30}, 0.6, {{"crowd-contacts", 1e-6}},
      "Contacts that all but coincide: singular to rounding, and yet unique forces.");
  for (const double mu : {10.0, 1e3, 1e6}) {
    add({"disc-pile", "rounded-wall", "cam-follower", "spinning-drum"}, {30}, mu, {},
        "Large coefficients of friction: the least normal force holds, and sliding contacts jam.");
  }
  add({"disc-pile", "rounded-wall", "ovals-in-bowl"}, {30}, 1e-6, {},
      "Nearly no friction: what slides and what does not is decided by forces of a millionth.");
  return tier;
}

Tier Painleve() {
  Tier tier = OfFriction(
      {"painleve", "Accelerations of contacts that slide, stick or roll: problems with no, one or several solutions.",
       false, true});
  tier.has_literals = true;
  return tier;
}

Tier FrictionSequences() {
  Tier tier{"friction-sequences",
            "Consecutive time steps of scenes in motion with friction: what warm starts are for."};
  tier.version = kFrictionVersion;
  constexpr int kSteps = 100;
  // A family may have one size only, and needs two seeds then; with others the drum's balls do not stay in it.
  for (const auto& [rows, seed] : {std::pair(40, 2), std::pair(120, 1)}) {
    for (const SceneFamily& scene : FrictionScenes()) {
      tier.sequences.push_back({{std::string(scene.key), rows, static_cast<std::uint64_t>(seed), {}}, kSteps});
    }
  }
  return tier;
}

using Plan = std::pair<const char*, Tier (*)()>;
constexpr Plan kPlans[] = {
    {"smoke", &Smoke},
    {"engine", &Engine},
    {"standard", &Standard},
    {"large", &Large},
    {"sequences", &Sequences},
    {"pathological", &Pathological},
    {kLiteratureTier, &Literature},
    {"recorded", &Recorded},
    {kNonsymmetricTier, &Nonsymmetric},
    {"friction-engine", &FrictionEngine},
    {"friction", &WithFriction},
    {"friction-recorded", &FrictionRecorded},
    {"friction-literature", &FrictionLiterature},
    {"friction-pathological", &FrictionPathological},
    {"painleve", &Painleve},
    {"friction-sequences", &FrictionSequences},
};

}  // namespace

const std::vector<std::string>& AllTiers() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const auto& [name, plan] : kPlans) all.emplace_back(name);
    return all;
  }();
  return names;
}

Tier PlanTier(std::string_view name) {
  for (const auto& [key, plan] : kPlans) {
    if (key == name) return plan();
  }
  throw InputError("unknown tier '" + std::string(name) + "', expected one of " +
                   boost::algorithm::join(AllTiers(), ", "));
}

}  // namespace lcpbench
