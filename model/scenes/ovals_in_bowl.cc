// ovals-in-bowl: ellipses of many shapes and sizes, at all angles, piled up in a round bowl.

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "model/scenes/oval_front.h"
#include "model/scenes/scene_builder.h"

namespace lcpbench {
namespace {

constexpr Range kAxis{0.07, 0.15};    ///< larger semi-axis [m]
constexpr Range kAspect{0.45, 0.95};  ///< smaller over larger semi-axis
/// Mean area of an oval, and the share of the half-full bowl's area that ovals take, about.
constexpr double kMeanArea = 0.028;
constexpr double kPacking = 0.75;
constexpr double kWeight = 0.2 * kGravity;  ///< times the root of the number of layers [m/s^2]
constexpr double kCentripetal = 0.5;        ///< centripetal acceleration at the bowl over the in-plane gravity
constexpr double kMaxSpin = 3;              ///< of ovals on the surface [rad/s]

struct NewOval {
  PlacedOval oval;
  double theta = 0;
};

NewOval RandomOval(double scale, Random* random) {
  NewOval made;
  made.oval.a = scale * random->Uniform(kAxis);
  made.oval.b = made.oval.a * random->Uniform(kAspect);
  made.theta = random->Uniform(-kPi, kPi);
  made.oval.u = Direction(made.theta);
  return made;
}

class OvalScene final : public SceneBuilder {
 public:
  using SceneBuilder::SceneBuilder;

  void Build() override {
    AddFixed("bowl");
    swing_ = random_.Sign() * std::sqrt(kCentripetal * weight_ / radius_);
    const NewOval first = RandomOval(1, &random_);
    front_.AddFirst(first.oval, Normalized({random_.Uniform(-0.2, 0.2), -1}));
    Adopt(first.theta, {kLeftBowl, kLeftBowl});
    for (int i = 1; i < count_; ++i) {
      for (int attempt = 0;; ++attempt) {
        if (attempt == kMaxTries) throw std::logic_error("ovals-in-bowl: no place for oval " + std::to_string(i));
        const NewOval oval = RandomOval(1, &random_);
        const auto supports = front_.Add(oval.oval);
        if (!supports) continue;
        Adopt(oval.theta, *supports);
        break;
      }
    }
    for (int attempt = 0; rows_ % 2 == 0; ++attempt) {
      if (attempt == kMaxTries) throw std::logic_error("ovals-in-bowl: no place on the crest");
      const NewOval oval = RandomOval(0.6, &random_);
      const auto support = front_.AddOnCrest(oval.oval);
      if (!support) continue;
      Adopt(oval.theta, {*support, *support});
      break;
    }
    SetVelocities();
    DrawBowl();
  }

  void Load() override { Apply({.weight = weight_, .gust = kGravity}); }

 private:
  static constexpr int kMaxTries = 1000;

  static bool IsBowl(int support) { return support < 0; }

  /// Adds the front's last oval as a body with contacts to its one or two supports.
  void Adopt(double theta, const OvalSupports& supports) {
    const int k = static_cast<int>(front_.ovals().size()) - 1;
    const PlacedOval& oval = front_.ovals()[static_cast<std::size_t>(k)];
    const double density = 40 * random_.Uniform(1, 4);
    Add("oval", MakeOval(oval.c, theta, oval.a, oval.b, density));
    supports_.push_back(supports);
    bears_.push_back(false);
    Rest(k, supports.left);
    if (supports.right != supports.left) Rest(k, supports.right);
  }

  void Rest(int k, int support) {
    const PlacedOval& oval = front_.ovals()[static_cast<std::size_t>(k)];
    const OvalGap gap = front_.GapTo(oval, support);
    Constraint& contact =
        IsBowl(support) ? Touch(k + 1, 0, ArcEdge{{}, radius_, Side::kConcave}) : Touch(k + 1, support + 1);
    contact.s1 = Parameter(oval, -gap.n);
    if (IsBowl(support)) return;
    contact.s2 = Parameter(front_.ovals()[static_cast<std::size_t>(support)], gap.n);
    bears_[static_cast<std::size_t>(support)] = true;
  }

  /// The ellipse's parameter s at the outward normal n.
  static double Parameter(const PlacedOval& oval, Vec2 n) {
    return AngleOf({oval.a * Dot(n, oval.u), oval.b * Cross(oval.u, n)});
  }

  void SetVelocities() {
    for (std::size_t k = 0; k < supports_.size(); ++k) {
      Body& body = system_.bodies[k + 1];
      body.v = swing_ * Perp(body.x);
      body.omega = swing_;
      if (bears_[k]) continue;
      // One more motion keeps both gaps, n.dv + (R x n) dw = 0: spin with the displacement that it forces.
      const PlacedOval& oval = front_.ovals()[k];
      const double spin = random_.Uniform(-kMaxSpin, kMaxSpin);
      const OvalGap gap1 = front_.GapTo(oval, supports_[k].left);
      const OvalGap gap2 = front_.GapTo(oval, supports_[k].right);
      const double rate1 = -spin * Cross(-SupportOf(oval, gap1.n).arm, gap1.n);
      const double rate2 = -spin * Cross(-SupportOf(oval, gap2.n).arm, gap2.n);
      const bool single = supports_[k].left == supports_[k].right;
      const double cross = Cross(gap1.n, gap2.n);
      const Vec2 slip =
          single ? rate1 * gap1.n
                 : (1 / cross) * Vec2{rate1 * gap2.n.y - rate2 * gap1.n.y, rate2 * gap1.n.x - rate1 * gap2.n.x};
      body.v = body.v + slip;
      body.omega += spin;
    }
  }

  /// The circle's lower part, up to above all that touches it.
  void DrawBowl() {
    double top = -radius_;
    for (const PlacedOval& oval : front_.ovals()) top = std::max(top, oval.c.y + 2 * oval.a);
    const double rim = std::clamp(top / radius_, -0.9, 0.9);
    const double angle = AngleOf({std::sqrt(1 - rim * rim), rim});
    system_.bodies[0].outline = {OutlineEdge{ArcEdge{{}, radius_, Side::kConcave}, angle + 2 * kPi, kPi - angle}};
  }

  const int count_ = (rows_ + 1) / 2;
  const double radius_ = 4 * kAxis.high + std::sqrt(2 * kMeanArea * count_ / (kPi * kPacking));
  const double weight_ = kWeight / std::sqrt(std::sqrt(1.0 + count_));
  OvalFront front_{radius_, kAxis.high};
  double swing_ = 0;  ///< angular velocity of the pile about the bowl's middle [rad/s]
  std::vector<OvalSupports> supports_;
  std::vector<bool> bears_;  ///< whether anything rests on it
};

}  // namespace

extern const SceneFamily kOvalsInBowl{
    "ovals-in-bowl", "Pile of ellipses in a round bowl",
    "General curves whose contact points must be searched, normals that miss the centres of mass, b that "
    "depends on curvature; nonsingular, with every force depending on the whole pile above.",
    &Make<OvalScene>};

}  // namespace lcpbench
