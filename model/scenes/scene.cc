#include "model/scenes/scene.h"

#include <array>
#include <string>

#include "solvers/lcp/memory_budget.h"
#include "support/input_error.h"

namespace lcpbench {

// Each is defined at the end of its own file.
extern const SceneFamily kDiscsInV, kDiscPile, kDiscTrack, kBoxesAndDiscs, kRockers, kGearTrain, kCamFollower,
    kNewtonsCradle, kChainOfLinks, kSpinningDrum, kOvalTrain, kOvalsInBowl, kRollerBearing, kRoundedWall, kTallStacks,
    kBilliardsBreak;
extern const SceneFamily kSlopeStacks, kRollingDiscs, kLadders, kWheelStep, kOvalsRocking, kWedgeJam, kThreeDiscs,
    kPyramids, kCardHouse, kVoussoirArch, kDrum, kCapstan, kPulledChain, kGearsFriction, kCamLock;

namespace {

const SceneFamily& FindSceneFor(std::string_view key, int rows) {
  const SceneFamily& scene = FindScene(key);
  if (rows < 1) throw InputError("scene '" + std::string(key) + "': expected rows >= 1, found " + std::to_string(rows));
  constexpr double kBytesPerRow = 1000;  // of bodies, contacts and rows, measured
  RequireMemory(kBytesPerRow * rows, "scene '" + std::string(key) + "' of " + std::to_string(rows) + " rows");
  return scene;
}

}  // namespace

std::span<const SceneFamily> AllScenes() {
  static const std::array families{kDiscsInV,      kDiscPile,     kDiscTrack,   kBoxesAndDiscs,
                                   kRockers,       kGearTrain,    kCamFollower, kNewtonsCradle,
                                   kChainOfLinks,  kSpinningDrum, kOvalTrain,   kOvalsInBowl,
                                   kRollerBearing, kRoundedWall,  kTallStacks,  kBilliardsBreak};
  return families;
}

std::span<const SceneFamily> FrictionScenes() {
  static const std::array families{kSlopeStacks, kRollingDiscs, kLadders,     kWheelStep,     kOvalsRocking,
                                   kWedgeJam,    kThreeDiscs,   kPyramids,    kCardHouse,     kVoussoirArch,
                                   kDrum,        kCapstan,      kPulledChain, kGearsFriction, kCamLock};
  return families;
}

const SceneFamily& FindScene(std::string_view key) {
  std::string known;
  for (const std::span<const SceneFamily> families : {AllScenes(), FrictionScenes()}) {
    for (const SceneFamily& scene : families) {
      if (scene.key == key) return scene;
      known += (known.empty() ? "" : ", ") + std::string(scene.key);
    }
  }
  throw InputError("unknown scene '" + std::string(key) + "', expected one of " + known);
}

ContactSystem GenerateScene(std::string_view key, int rows, std::uint64_t seed) {
  return FindSceneFor(key, rows).generate(rows, seed);
}

World StartScene(std::string_view key, int rows, std::uint64_t seed) {
  return FindSceneFor(key, rows).start(rows, seed);
}

}  // namespace lcpbench
