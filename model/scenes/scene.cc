#include "model/scenes/scene.h"

#include <array>
#include <string>

#include "model/scenes/families.h"
#include "solvers/lcp/input_error.h"

namespace lcpbench {
namespace {

constexpr std::array kScenes{
    SceneFamily{
        "discs-in-v", "Equal discs stacked in a V of two walls",
        "Redundant contacts and force paths as long as the stack is high: A is rank deficient and f not unique, "
        "which tells methods that cope with singular A from those that need pivots of full rank.",
        &GenerateDiscsInV, &StartDiscsInV, MotionLevel::kVelocity, 1e-3},
    SceneFamily{"disc-pile", "Pile of discs of many sizes and masses in a box",
                "Isostatic, masses spread by up to a factor 100: A is nonsingular but ill-conditioned, which tells "
                "methods whose speed depends on conditioning from direct ones.",
                &GenerateDiscPile, &StartDiscPile, MotionLevel::kVelocity, 1e-3},
    SceneFamily{
        "disc-track", "Chain of spinning discs sliding inside a concave track",
        "Convex arcs in a concave one with centripetal terms; A is nonsingular and narrowly banded, which tells "
        "methods that use sparsity from those that fill a dense matrix.",
        &GenerateDiscTrack, &StartDiscTrack, MotionLevel::kAcceleration, 1e-2},
    SceneFamily{
        "boxes-and-discs", "Brick wall in running bond with discs in joints and on steps",
        "Flat contacts by pairs of vertices: more rows than degrees of freedom, many ties, and rotation coupled "
        "to translation - the everyday, highly redundant load of a physics engine.",
        &GenerateBoxesAndDiscs, &StartBoxesAndDiscs, MotionLevel::kVelocity, 1e-3},
    SceneFamily{"rockers", "Row of rocking bodies carrying discs, boxes and poles",
                "Every contact kind on turning edges, nonzero velocity-product terms on most rows, full rank: "
                "moderate sizes that most methods should solve, with b that depends on curvature.",
                &GenerateRockers, &StartRockers, MotionLevel::kVelocity, 1e-3},
    SceneFamily{"gear-train", "Train of gears on pins driven by a motor",
                "Two bilateral rows for every tooth contact, on flanks at random: tells methods that eliminate joints "
                "from those that carry them along, with gamma from turning arcs in every row.",
                &GenerateGearTrain, &StartGearTrain, MotionLevel::kVelocity, 1e-3},
    SceneFamily{"cam-follower", "Row of coupled cams with spring-loaded followers in guides",
                "Pins, coupling rods and path joints around few contacts of arcs, flanks and ellipses; the rods couple "
                "the whole row, which tells methods that use a band from those that fill a dense matrix.",
                &GenerateCamFollower, &StartCamFollower, MotionLevel::kVelocity, 1e-3},
    SceneFamily{"newtons-cradle", "Row of touching pendulums on rods, ropes and arms",
                "Squeezed balls form blocks as long as the row, and ropes go slack: tells methods that pass pushes on "
                "one neighbour a sweep from those that solve at once.",
                &GenerateNewtonsCradle, &StartNewtonsCradle, MotionLevel::kAcceleration, 1e-2, 1},
    SceneFamily{"chain-of-links", "Chain of pinned links lying over a turning drum",
                "Two pin rows for every contact, and a tension that sums up along the chain: stiff along, loose "
                "across, which tells direct methods from those that pass forces on link by link.",
                &GenerateChainOfLinks, &StartChainOfLinks, MotionLevel::kVelocity, 1e-3},
    SceneFamily{"spinning-drum", "Balls and ovals between the baffles of a turning drum",
                "A kinematic body whose motion and acceleration enter b, and independent sectors of balls and general "
                "curves: tells methods that use blocks from those whose cost grows with the whole.",
                &GenerateSpinningDrum, &StartSpinningDrum, MotionLevel::kVelocity, 1e-3},
    SceneFamily{"oval-train", "Train on a closed oval track, coupled by ropes and buffers",
                "Two path joints a car on an ellipse or superellipse, couplings that only pull or only push: the "
                "active set is a matter of the loads along the whole train.",
                &GenerateOvalTrain, &StartOvalTrain, MotionLevel::kVelocity, 1e-3},
    SceneFamily{"ovals-in-bowl", "Pile of ellipses in a round bowl",
                "General curves whose contact points must be searched, normals that miss the centres of mass, b that "
                "depends on curvature; nonsingular, with every force depending on the whole pile above.",
                &GenerateOvalsInBowl, &StartOvalsInBowl, MotionLevel::kVelocity, 1e-3},
    SceneFamily{"roller-bearing", "Rollers between concentric races",
                "Convex arcs in concave ones, highly redundant, with rings that touch hundreds of rollers: dense "
                "blocks in A, which tell methods that form A from those that work with J.",
                &GenerateRollerBearing, &StartRollerBearing, MotionLevel::kVelocity, 1e-3},
    SceneFamily{"rounded-wall", "Wall of bricks with rounded corners",
                "Flat contacts through corner arcs, up to six rows a brick against three degrees of freedom: the most "
                "redundant wall, with A far from full rank.",
                &GenerateRoundedWall, &StartRoundedWall, MotionLevel::kVelocity, 1e-3},
    SceneFamily{"tall-stacks", "Stacks with mass ratios up to a million",
                "Heavy bodies on light ones: forces and the eigenvalues of A spread over as many orders of magnitude, "
                "which tells direct methods from those that sweep locally, and relative from absolute tolerances.",
                &GenerateTallStacks, &StartTallStacks, MotionLevel::kVelocity, 1e-3},
    SceneFamily{"billiards-break", "Rack of discs pressed, or broken, by a cue ball",
                "Equal masses and nothing fixed: the redundancy of a lattice alone. Its sequence is a series of "
                "simultaneous impacts.",
                &GenerateBilliardsBreak, &StartBilliardsBreak, MotionLevel::kAcceleration, 2e-3, 0.95},
};

const SceneFamily& FindSceneFor(std::string_view key, int rows) {
  const SceneFamily& scene = FindScene(key);
  if (rows < 1) throw InputError("scene '" + std::string(key) + "': expected rows >= 1, found " + std::to_string(rows));
  return scene;
}

}  // namespace

std::span<const SceneFamily> AllScenes() { return kScenes; }

const SceneFamily& FindScene(std::string_view key) {
  std::string known;
  for (const SceneFamily& scene : kScenes) {
    if (scene.key == key) return scene;
    known += (known.empty() ? "" : ", ") + std::string(scene.key);
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
