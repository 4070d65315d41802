// billiards-break: a triangular rack of equal discs, seen from above, pressed by a cue ball at its apex.

#include <algorithm>
#include <cmath>
#include <vector>

#include "model/scenes/scene_builder.h"

namespace lcpbench {
namespace {

constexpr double kRadius = 0.028575;  ///< of a pool ball [m]
constexpr double kMass = 0.17;        ///< [kg]
constexpr double kPush = 3;           ///< the cue ball's push over its weight, for each layer of the rack
/// Pull towards the middle of the rack, over the weight, of a disc at its edge: a dished cloth.
constexpr double kDish = 0.3;
constexpr double kBreakSpeed = 8;  ///< [m/s]

class Rack final : public SceneBuilder {
 public:
  using SceneBuilder::SceneBuilder;

  void Build() override {
    const int table = AddFixed("table");
    // The apex at the origin; disc i of layer k (both from 0) is the (i+1)-th of k + 1, on lines parallel to y.
    const double root3 = std::sqrt(3.0);
    std::vector<int> front{AddBall("ball", {})};
    aim_ = Normalized({1, random_.Uniform(-0.3, 0.3)});
    cues_.push_back(AddBall("cue ball", -2 * kRadius * aim_));
    Touch(cues_[0], front[0]);
    for (int layer = 1; left_ > 0; ++layer) {
      std::vector<int> current;
      for (int i = 0; i <= layer; ++i) {
        const int touched = (i > 0 ? 2 : 0) + (i < layer ? 1 : 0);
        if (touched > left_) break;
        const int ball = AddBall("ball", {layer * root3 * kRadius, (2 * i - layer) * kRadius});
        const auto k = static_cast<std::size_t>(i);
        if (i > 0) Touch(ball, current.back());
        if (i > 0) Touch(ball, front[k - 1]);
        if (i < layer) Touch(ball, front[k]);
        current.push_back(ball);
        layers_ = layer;
      }
      if (static_cast<int>(current.size()) <= layer) break;
      front.swap(current);
    }
    while (left_ > 0) {
      const int last = cues_.back();
      cues_.push_back(AddBall("ball", Get(last).x - 2 * kRadius * aim_));
      Touch(last, cues_.back());
    }

    depth_ = layers_ * root3 * kRadius;
    const double half_width = std::max(0.6, 1.5 * layers_ * kRadius);
    head_ = 0.5 + depth_;
    const Vec2 low{-head_ - 1, -half_width};
    const Vec2 high{depth_ + 1, half_width};
    // The cloth is on the right of the direction of travel.
    Get(table).outline = Polyline({low, {low.x, high.y}, high, {high.x, low.y}, low});
  }

  void Load() override {
    Apply({.weight = 0, .gust = kGravity});
    const Vec2 middle{2 * depth_ / 3, 0};
    const double reach = std::max(depth_, kRadius);
    for (Body& body : system_.bodies) {
      if (!body.fixed) body.force = body.force - (kDish * kMass * kGravity / reach) * (body.x - middle);
    }
    Body& cue = Get(cues_.back());
    cue.force = cue.force + (kPush * kMass * kGravity * (1 + layers_)) * aim_;
  }

  void Launch(World* world) override {
    world->loads.gravity = {};
    for (const int cue : cues_) {
      Body& body = world->bodies[static_cast<std::size_t>(cue)];
      // Straight at the apex, which the direction of the push hits off centre.
      body.x = body.x - Vec2{head_, 0};
      body.v = {kBreakSpeed, 0};
    }
  }

 private:
  int AddBall(const char* kind, Vec2 x) {
    Body ball = MakeDisc(x, kRadius, kMass / (kPi * kRadius * kRadius));
    // A ball's inertia, not a plate's.
    ball.inertia = 0.4 * kMass * kRadius * kRadius;
    return Add(kind, ball);
  }

  int layers_ = 0;
  std::vector<int> cues_;  ///< the cue ball and the discs in line behind it
  Vec2 aim_;               ///< the unit direction of the cue ball's push
  double depth_ = 0;       ///< of the rack [m]
  double head_ = 0;        ///< distance that the cue ball starts from in the break [m]
};

}  // namespace

extern const SceneFamily kBilliardsBreak{
    "billiards-break",
    "Rack of discs pressed, or broken, by a cue ball",
    "Equal masses and nothing fixed: the redundancy of a lattice alone. Its sequence is a series of "
    "simultaneous impacts.",
    &Make<Rack>,
    MotionLevel::kAcceleration,
    2e-3,
    0.95};

}  // namespace lcpbench
