#include "model/scenes/friction/slopes.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "model/scenes/friction/friction_scene.h"
#include "model/shape/outline.h"

namespace lcpbench {
namespace {

constexpr double kDensity = 10;
constexpr double kDiscRadius = 0.5;

}  // namespace

ContactSystem SlopeStacks(int stacks, int boxes, double slope, double mu, double width, double height) {
  // So that corners lie on faces, not on corners.
  constexpr double kNarrower = 0.002;
  FrictionScene scene;
  const int floor = scene.AddFloor(-width, 2 * width * stacks);
  for (int stack = 0; stack < stacks; ++stack) {
    int below = floor;
    for (int i = 0; i < boxes; ++i) {
      const Vec2 x{2 * width * stack, (i + 0.5) * height};
      const int box = scene.Add("box", MakeBox(x, width * (1 - kNarrower * i), height, kDensity));
      scene.Stand(box, below, below == floor ? Feature(FrictionScene::Floor()) : scene.Piece(below, 2));
      below = box;
    }
  }
  return scene.Finish(mu, slope);
}

ContactSystem DiscsOnSlope(int discs, double slope, double mu, double hole) {
  FrictionScene scene;
  const int floor = scene.AddFloor(-1, 100 + 2 * discs);
  for (int i = 0; i < discs; ++i) {
    const Vec2 x{1.5 * i, kDiscRadius};
    const int disc = scene.Add(
        "disc", hole > 0 ? MakeRing(x, kDiscRadius, hole * kDiscRadius, kDensity) : MakeDisc(x, kDiscRadius, kDensity));
    scene.Touch(disc, floor, FrictionScene::Floor());
  }
  return scene.Finish(mu, slope);
}

ContactSystem DiscOnArc(Side side, double rho, double r, double angle, double v, double mu) {
  FrictionScene scene;
  const double sign = side == Side::kConvex ? 1 : -1;
  const int ground = scene.AddFixed("ground", {FullCircle({}, rho, side)});
  // From the arc's centre to the disc's, and down along the arc.
  const Vec2 up{SinCos(angle).sin, sign * SinCos(angle).cos};
  const Vec2 along = -sign * Perp(up);
  Body body = MakeDisc((rho + sign * r) * up, r, kDensity);
  body.v = v * along;
  // The material point at -sign r up from the centre is at rest: v along = sign r omega Perp(up).
  body.omega = -v / r;
  scene.Touch(scene.Add("disc", body), ground);
  return scene.Finish(mu);
}

ContactSystem Ladders(int ladders, double angle, double mu) {
  constexpr double kLength = 2;
  constexpr double kHalfWidth = 0.03;
  FrictionScene scene;
  const int floor = scene.AddFloor(-1, 1 + 1.5 * kLength * ladders);
  const Vec2 along = -Direction(-angle);  // from the foot up to the wall on the left
  for (int i = 0; i < ladders; ++i) {
    const double wall_x = 1.5 * kLength * i;
    const Vec2 foot{wall_x + kLength * SinCos(angle).cos, 0};
    const double height = 1.2 * kLength;
    const int wall = scene.AddFixed("wall " + std::to_string(i), {WholeEdge({wall_x, 0}, {wall_x, height})});
    // A slender rhombus: its ends are points.
    const Vec2 aside = kHalfWidth * Perp(along);
    const Vec2 middle = (kLength / 2) * along;
    const Body lath = MakePlate({"", {Polyline({-middle, -aside, middle, aside, -middle})}}, kDensity);
    const int ladder = scene.Add("ladder", lath);
    scene.Get(ladder).x = foot + middle;
    scene.Touch(ladder, scene.Corner(ladder, 0), floor, FrictionScene::Floor());
    scene.Touch(ladder, scene.Corner(ladder, 2), wall, StraightEdge{{wall_x, 0}, {wall_x, 1}});
  }
  return scene.Finish(mu);
}

ContactSystem WheelsAtStep(int wheels, double r, double k, double F, double mu) {
  FrictionScene scene;
  const double apart = 4 * r;
  const int floor = scene.AddFloor(-apart, apart * wheels);
  for (int i = 0; i < wheels; ++i) {
    const double x = apart * i;
    const int wheel = scene.Add("wheel", MakeDisc({x, r}, r, kDensity));
    const Vec2 edge{x + std::sqrt(2 * r * k - k * k), k};
    const int step = scene.AddFixed("step " + std::to_string(i), Polyline({edge + Vec2{r / 2, 0}, edge, {edge.x, 0}}));
    scene.Touch(wheel, floor, FrictionScene::Floor());
    scene.Touch(wheel, step, Vertex{edge});
    scene.Push(wheel, scene.Get(wheel).x, {F, 0});
  }
  return scene.Finish(mu);
}

ContactSystem RollingOvals(int ovals, double a, double b, double angle, double omega, double mu) {
  FrictionScene scene;
  const int floor = scene.AddFloor(-3 * a, 3 * a * (ovals + 1));
  const auto [cos, sin] = SinCos(angle);
  for (int i = 0; i < ovals; ++i) {
    const double height = std::sqrt(a * a * sin * sin + b * b * cos * cos);
    // The lowest point, from the centre.
    const Vec2 arm{(b * b - a * a) * sin * cos / height, -height};
    Body body = MakeOval({3 * a * i, height}, angle, a, b, kDensity);
    body.omega = omega;
    body.v = -omega * Perp(arm);
    const int oval = scene.Add("oval", body);
    scene.Touch(oval, floor, FrictionScene::Floor());
  }
  return scene.Finish(mu);
}

namespace {

constexpr int kRows = 2;  ///< of a contact

double Tangent(double angle) { return SinCos(angle).sin / SinCos(angle).cos; }

ContactSystem DrawSlopeStacks(int rows, Random* random) {
  constexpr int kMostBoxes = 10;
  const int boxes = std::clamp(rows / (2 * kRows), 1, kMostBoxes);
  const double slope = random->Uniform(0.05, 0.7);
  const double mu = random->Uniform(0.7, 3) * Tangent(slope);
  const double width = random->Uniform(0.7, 3) * boxes * Tangent(slope);
  return SlopeStacks(std::max(1, rows / (2 * kRows * boxes)), boxes, slope, mu, width, 1);
}

ContactSystem DrawRollingDiscs(int rows, Random* random) {
  const double slope = random->Uniform(0.05, 0.7);
  const double mu = random->Uniform(0.2, 1) * Tangent(slope);
  const double hole = random->Uniform(-0.9, 0.9);
  return DiscsOnSlope(std::max(1, rows / kRows), slope, mu, hole);
}

ContactSystem DrawLadders(int rows, Random* random) {
  const double angle = random->Uniform(0.4, 1.3);
  const double share = random->Uniform(0.7, 1.5);
  // (1 - mu^2) / (2 mu) = tan(angle), solved for mu.
  const double tangent = Tangent(angle);
  const double mu = share * (std::sqrt(tangent * tangent + 1) - tangent);
  return Ladders(std::max(1, rows / (2 * kRows)), angle, mu);
}

ContactSystem DrawWheelStep(int rows, Random* random) {
  const double step = random->Uniform(0.1, 0.7);
  const double mass = kDensity * kPi;
  const double least = mass * kGravity * std::sqrt(2 * step - step * step) / (1 - step);
  const double force = random->Uniform(0.5, 1.5) * least;
  const double mu = random->Uniform(0.1, 1);
  return WheelsAtStep(std::max(1, rows / (2 * kRows)), 1, step, force, mu);
}

ContactSystem DrawRollingOvals(int rows, Random* random) {
  const double a = random->Uniform(1.05, 2);
  const double angle = random->Uniform(-kPi, kPi);
  const double omega = random->Uniform(-3, 3);
  const double mu = random->Uniform(0.05, 1);
  return RollingOvals(std::max(1, rows / kRows), a, 1, angle, omega, mu);
}

}  // namespace

extern const SceneFamily kSlopeStacks{
    "slope-stacks",
    "Stacks of boxes on a slope",
    "Loads that pass through every storey by normal and tangential forces together: the worst case of sweeps.",
    &Make<DrawnScene<&DrawSlopeStacks>>,
    MotionLevel::kVelocity,
    kFrictionStep};
extern const SceneFamily kRollingDiscs{
    "rolling-discs",
    "Discs and rings on a slope, at the threshold between rolling and sliding",
    "Tells stick from slip where normal and tangential forces do not depend on each other.",
    &Make<DrawnScene<&DrawRollingDiscs>>,
    MotionLevel::kVelocity,
    kFrictionStep};
extern const SceneFamily kLadders{"ladders",
                                  "Ladders that lean against walls, near the angle at which they slide",
                                  "Both ends must hold: one of the forces bounds the friction that the other needs.",
                                  &Make<DrawnScene<&DrawLadders>>,
                                  MotionLevel::kVelocity,
                                  kFrictionStep};
extern const SceneFamily kWheelStep{"wheel-step",
                                    "Wheels that are pulled over a step",
                                    "One contact opens where another must stick for it.",
                                    &Make<DrawnScene<&DrawWheelStep>>,
                                    MotionLevel::kVelocity,
                                    kFrictionStep};
extern const SceneFamily kOvalsRocking{
    "ovals-rocking",
    "Ellipses that roll and rock on a floor",
    "Normal and tangential rows depend on each other by the arm of the contact, which moves along the edge.",
    &Make<DrawnScene<&DrawRollingOvals>>,
    MotionLevel::kVelocity,
    kFrictionStep};

}  // namespace lcpbench
