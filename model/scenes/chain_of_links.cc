// chain-of-links: links joined by pins, lying over a turning drum.

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "model/scenes/scene_builder.h"
#include "model/shape/shapes.h"

namespace lcpbench {
namespace {

constexpr double kDensity = 50;
constexpr double kLinkRadius = 0.05;
constexpr Range kArm{0.12, 0.25};  ///< from a joint to the next link's contact point, along the link [m]
constexpr double kSpan = 3.4;      ///< the part of the drum that a long chain covers [rad]
constexpr double kMinDrum = 0.6;
constexpr double kRope = 0.2;        ///< length of the rope at the chain's end [m]
constexpr double kPegRadius = 0.04;  ///< that it is tied to [m]
constexpr double kBallRadius = 0.08;
constexpr double kCasing = 0.8;       ///< between the drum and its casing [m]: wider than any link is long
constexpr double kCentripetal = 0.3;  ///< largest centripetal acceleration over gravity

/// The direction turned clockwise by the angle of a right triangle with these legs; hypotenuse^2 = near^2 + far^2.
Vec2 TurnedClockwise(Vec2 direction, double near, double far) {
  const double hypotenuse = std::sqrt(near * near + far * far);
  return Turned(direction, {near / hypotenuse, -far / hypotenuse});
}

class Chain final : public SceneBuilder {
 public:
  using SceneBuilder::SceneBuilder;

  void Build() override {
    constexpr int kRowsPerLink = 3;
    const int links = (rows_ + 2) / kRowsPerLink;
    const int missing = (rows_ + 2) % kRowsPerLink;
    std::vector<double> arms;  // arms[i] from joint i to the contacts on both its sides
    double length = 0;
    for (int joint = 0; joint <= links; ++joint) {
      arms.push_back(random_.Uniform(kArm));
      length += 2 * arms.back();
    }
    const double drum = std::max(kMinDrum, length / kSpan - kLinkRadius);
    const double centripetal = kCentripetal * kGravity * random_.Uniform(0.3, 1);
    speed_ = random_.Sign() * std::sqrt(centripetal / drum);
    drum_ = AddFixed("drum", {FullCircle({}, drum, Side::kConvex)});
    Get(drum_).omega = speed_;
    if (missing > 0) {
      peg_ = AddFixed("peg");
      Get(peg_).omega = speed_;
    }
    AddFixed("casing", {FullCircle({}, drum + kCasing, Side::kConcave)});

    const double covered = std::min(kSpan, length / drum);
    const double lean = random_.Uniform(-0.2, 0.2);
    const double height = drum + kLinkRadius;
    Vec2 joint = Direction(kPi / 2 + covered / 2 + lean);
    for (int link = 0; link < links; ++link) {
      const double behind = arms[static_cast<std::size_t>(link)];
      const double ahead = arms[static_cast<std::size_t>(link) + 1];
      const Vec2 foot = TurnedClockwise(joint, height, behind);
      AddLink(foot, behind, ahead);
      if (link == 0 && missing == 2) AddBall(foot);
      joint = TurnedClockwise(foot, height, ahead);
      if (link == links - 1 && missing > 0) AddRope(joint, ahead);
    }
  }

  void Load() override {
    Apply({.weight = kGravity, .gust = 2 * kGravity});
    // A push across a taut chain is borne by many times its tension: no squeeze.
    LoadEnds(&system_, {.squeeze = 0});
  }

 private:
  struct Link {
    int body = -1;
    double half = 0;  ///< from its middle to its joints
  };

  /// A link that touches the drum at `foot` (unit), its joints `behind` and `ahead` of there along the tangent.
  void AddLink(Vec2 foot, double behind, double ahead) {
    const Vec2 along = -Perp(foot);
    const double half = (behind + ahead) / 2;
    Body body = MakePlate(Capsule(2 * half, kLinkRadius), kDensity);
    body.theta = AngleOf(along);
    body.x = (Radius(drum_) + kLinkRadius) * foot + ((ahead - behind) / 2) * along;
    TurnWithDrum(&body);
    const Link previous = last_;
    last_ = {Add("link", body), half};
    if (previous.body >= 0) {
      Join(ConstraintType::kPin, last_.body, {-half, 0}, previous.body, Vertex{{previous.half, 0}});
    }
    Touch(last_.body, StraightEdge{{-half, -kLinkRadius}, {half, -kLinkRadius}}, drum_, Piece(drum_));
  }

  /// A ball on the outer side of the last link, above its contact point.
  void AddBall(Vec2 foot) {
    Body body = MakeDisc((Radius(drum_) + 2 * kLinkRadius + kBallRadius) * foot, kBallRadius, kDensity);
    TurnWithDrum(&body);
    Touch(Add("ball", body), last_.body, StraightEdge{{last_.half, kLinkRadius}, {-last_.half, kLinkRadius}});
  }

  /// From the chain's end at the joint, in direction `joint` (unit), to a peg on the drum ahead of it. `arm` is the
  /// end's distance from the contact point. The peg is a body of its own, because bodies that a joint connects do not
  /// touch each other.
  void AddRope(Vec2 joint, double arm) {
    const double height = Radius(drum_) + kLinkRadius;
    const double distance = std::sqrt(height * height + arm * arm);
    const Vec2 end = distance * Rotate(OfSine(-kRope / distance), joint);
    Get(peg_).outline = {FullCircle(end, kPegRadius, Side::kConvex)};
    Join(ConstraintType::kRope, last_.body, {last_.half, 0}, peg_, Vertex{end});
  }

  void TurnWithDrum(Body* body) const {
    body->omega = speed_;
    body->v = speed_ * Perp(body->x);
  }

  double speed_ = 0;
  int drum_ = -1;
  int peg_ = -1;
  Link last_;
};

}  // namespace

extern const SceneFamily kChainOfLinks{
    "chain-of-links", "Chain of pinned links lying over a turning drum",
    "Two pin rows for every contact, and a tension that sums up along the chain: stiff along, loose "
    "across, which tells direct methods from those that pass forces on link by link.",
    &Make<Chain>};

}  // namespace lcpbench
