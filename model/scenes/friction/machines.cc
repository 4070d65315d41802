#include "model/scenes/friction/machines.h"

#include <algorithm>
#include <cmath>

#include "model/scenes/friction/friction_scene.h"
#include "model/shape/shapes.h"

namespace lcpbench {
namespace {

constexpr double kDensity = 10;
constexpr double kCamRadius = 0.5;
constexpr double kTipRadius = 0.1;
constexpr double kLever = 1;  ///< from the pin to the centre of the tip

/// The lever arms about the pin of the normal and the tangential force at the tip.
struct Arms {
  double normal, tangential;
};
Arms ArmsOf(double lean) {
  const auto [cos, sin] = SinCos(lean);
  return {kLever * sin, kTipRadius + kLever * cos};
}

}  // namespace

double CapstanRatio(int beads, double delta, double mu) {
  const auto [cos, sin] = SinCos(delta);
  double ratio = 1;
  for (int i = 0; i < beads; ++i) ratio *= (cos + mu * sin) / (cos - mu * sin);
  return ratio;
}

ContactSystem Capstans(int chains, int beads, double delta, double pull, double mu) {
  constexpr double kBead = 0.02;
  FrictionScene scene;
  for (int chain = 0; chain < chains; ++chain) {
    const Vec2 center{3.0 * chain, 0};
    const int drum = scene.AddFixed("drum " + std::to_string(chain), {FullCircle(center, 1, Side::kConvex)});
    const auto place = [&](int i) { return Direction(kPi / 2 + (beads - 1 - 2 * i) * delta); };
    int previous = -1;
    for (int i = 0; i < beads; ++i) {
      const int bead = scene.Add("bead", MakeDisc(center + (1 + kBead) * place(i), kBead, kDensity));
      scene.Touch(bead, drum);
      const Vertex before{-kBead * place(i - 1)};
      if (i > 0) scene.Join(ConstraintType::kRod, bead, -kBead * place(i), previous, before);
      previous = bead;
    }
    const int first = previous - beads + 1;
    scene.Push(first, center + place(0), Normalized(place(-1) - place(0)));
    scene.Push(previous, center + place(beads - 1), pull * Normalized(place(beads) - place(beads - 1)));
  }
  return scene.Finish(mu, 0, 0);
}

ContactSystem PulledChains(int chains, int boxes, double share, double mu) {
  FrictionScene scene;
  for (int chain = 0; chain < chains; ++chain) {
    const double y = 2.0 * chain;
    const int floor = scene.AddFixed("floor " + std::to_string(chain), {WholeEdge({1.5 * boxes, y}, {-2, y})});
    double weight = 0;
    int first = -1;
    for (int i = 0; i < boxes; ++i) {
      const double density = kDensity * (1 + i % 3);
      const int box = scene.Add("box", MakeBox({1.5 * i, y + 0.5}, 1, 1, density));
      weight += kGravity * scene.Get(box).mass;
      scene.Stand(box, floor, StraightEdge{{1, y}, {0, y}});
      if (i > 0) scene.Join(ConstraintType::kPin, box, {-0.75, 0}, box - 1, Vertex{{0.75, 0}});
      if (i == 0) first = box;
    }
    scene.Push(first, scene.Get(first).x, {-share * mu * weight, 0});
  }
  return scene.Finish(mu);
}

ContactSystem FrictionDrives(int drives, double share, double mu) {
  constexpr double kWheel = 0.3;
  FrictionScene scene;
  for (int drive = 0; drive < drives; ++drive) {
    const double y = 1.5 * drive;
    const int frame = scene.AddFixed("frame " + std::to_string(drive));
    const int plank = scene.Add("plank", MakeBox({0, y + kWheel + 0.1}, 3, 0.2, kDensity));
    scene.Join(ConstraintType::kRod, plank, {1.5, -0.1}, frame, Vertex{{3, y + kWheel}});
    for (const double x : {-1.0, 1.0}) {
      const int wheel = scene.Add("wheel", MakeDisc({x, y}, kWheel, kDensity));
      scene.Join(ConstraintType::kPin, wheel, {}, frame, Vertex{{x, y}});
      scene.Touch(plank, scene.Piece(plank, 0), wheel, scene.Piece(wheel));
      scene.Get(wheel).torque = share * mu * kGravity * scene.Get(plank).mass / 2 * kWheel;
    }
  }
  return scene.Finish(mu);
}

double CamLockFriction(double lean) { return ArmsOf(lean).normal / ArmsOf(lean).tangential; }

double CamHolds(double lean, double mu) {
  const Arms arms = ArmsOf(lean);
  return kCamRadius * mu / (arms.normal - mu * arms.tangential);
}

ContactSystem LockedCams(int cams, double lean, double torque, double mu) {
  FrictionScene scene;
  for (int i = 0; i < cams; ++i) {
    const double x = 3.0 * i;
    const int frame = scene.AddFixed("frame " + std::to_string(i));
    const int cam = scene.Add("cam", MakeDisc({x, 0}, kCamRadius, kDensity));
    // The tip on top of the cam; the lever leans to the right of the normal, up to its pin.
    const Vec2 tip{x, kCamRadius + kTipRadius};
    const auto [cos, sin] = SinCos(lean);
    const Vec2 up{sin, cos};
    Body body = MakePlate(Capsule(kLever, kTipRadius), kDensity);
    body.x = tip + (kLever / 2) * up;
    body.theta = kPi / 2 - lean;
    const int lever = scene.Add("lever", body);
    scene.Join(ConstraintType::kPin, cam, {}, frame, Vertex{{x, 0}});
    scene.Join(ConstraintType::kPin, lever, {kLever / 2, 0}, frame, Vertex{tip + kLever * up});
    scene.Touch(lever, scene.Piece(lever, 3), cam, scene.Piece(cam));
    // Counter-clockwise the tip swings to the right and down; the cam draws it there by turning clockwise.
    scene.Get(lever).torque = 1;
    scene.Get(cam).torque = -torque;
  }
  return scene.Finish(mu, 0, 0);
}

namespace {

constexpr int kRows = 2;  ///< of a contact

// A chain of k beads has 2 k rows of contacts and k - 1 of rods.
ContactSystem DrawCapstans(int rows, Random* random) {
  constexpr int kMostBeads = 12;
  const int beads = std::clamp((rows + 1) / 3, 1, kMostBeads);
  const double delta = random->Uniform(0.02, 0.1);
  const double mu = random->Uniform(0.1, 1);
  const double pull = random->Uniform(0.6, 1.2) * CapstanRatio(beads, delta, mu);
  return Capstans(std::max(1, rows / (3 * beads - 1)), beads, delta, pull, mu);
}

// k boxes have 2 contacts each and k - 1 pins.
ContactSystem DrawPulledChains(int rows, Random* random) {
  constexpr int kMostBoxes = 20;
  const int boxes = std::clamp((rows + 2) / (3 * kRows), 1, kMostBoxes);
  const double share = random->Uniform(0.5, 1.5);
  const double mu = random->Uniform(0.1, 0.9);
  return PulledChains(std::max(1, rows / (kRows * (3 * boxes - 1))), boxes, share, mu);
}

ContactSystem DrawFrictionDrives(int rows, Random* random) {
  constexpr int kDriveRows = 2 * kRows + 2 * 2 + 1;
  const double share = random->Uniform(0.5, 1.5);
  const double mu = random->Uniform(0.1, 0.9);
  return FrictionDrives(std::max(1, rows / kDriveRows), share, mu);
}

ContactSystem DrawLockedCams(int rows, Random* random) {
  constexpr int kCamRows = kRows + 2 * 2;
  const double lean = random->Uniform(0.1, 0.8);
  const double mu = random->Uniform(0.3, 1.5) * CamLockFriction(lean);
  const double torque = random->Uniform(0.2, 5);
  return LockedCams(std::max(1, rows / kCamRows), lean, torque, mu);
}

}  // namespace

extern const SceneFamily kCapstan{"capstan",
                                  "Chains of beads around a drum",
                                  "Tension grows geometrically from bead to bead: joints and friction in one chain.",
                                  &Make<DrawnScene<&DrawCapstans>>,
                                  MotionLevel::kVelocity,
                                  kFrictionStep};
extern const SceneFamily kPulledChain{"pulled-chain",
                                      "Boxes pinned to each other, pulled over a floor",
                                      "Bilateral rows beside friction: all slide or none.",
                                      &Make<DrawnScene<&DrawPulledChains>>,
                                      MotionLevel::kVelocity,
                                      kFrictionStep};
extern const SceneFamily kGearsFriction{"gears-friction",
                                        "Planks on driven, pinned wheels",
                                        "Friction that transmits torques between bodies on joints.",
                                        &Make<DrawnScene<&DrawFrictionDrives>>,
                                        MotionLevel::kVelocity,
                                        kFrictionStep};
extern const SceneFamily kCamLock{
    "cam-lock",
    "Pinned levers that lock turning cams",
    "Normal and tangential rows depend on each other so strongly that friction locks whatever the load.",
    &Make<DrawnScene<&DrawLockedCams>>,
    MotionLevel::kVelocity,
    kFrictionStep};

}  // namespace lcpbench
