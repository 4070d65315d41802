// chain-of-links: links joined by pins, lying over a turning drum.
//
// Two pin rows for every contact: the chain is stiff along itself and loose across, its tension is a long sum over the
// links, and each contact force is what the tension's turn at that link leaves of it. Methods that treat joints one by
// one pass tension on by one link a sweep; direct ones see a band. Links have different lengths, so that their contact
// (straight edge on arc) lies off their middles; chain and drum turn about the drum's centre together, and gamma holds
// the centripetal terms. J has full rank (Jacobi-scaled condition number of A 1.2e4 at 200 rows, 1.7e5 at 1000).
//
// Rows with w > 0 at the solution, of the unilateral rows, seeds 1 to 5: 50-75 % at 10 rows, 29-41 % at 100, 32-39 % at
// 1000, 30-33 % at 3000.
//
// k links make 3 k - 2 rows; what is missing is closed by a rope from the chain's end to a peg that turns with the
// drum, and by a ball on the first link, one row each. (Ropes at both ends would nearly be a self-stress, with forces
// beyond all loads.)
//
// In motion: the drum goes on turning at its speed, gravity pulls the chain's ends down, and a chain that no rope holds
// slides off into the round casing.

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "model/geometry/trig.h"
#include "model/scenes/mechanism_parts.h"
#include "model/scenes/parts.h"
#include "model/scenes/scene.h"
#include "model/scenes/start.h"
#include "model/shape/mass_properties.h"
#include "model/shape/shapes.h"

namespace lcpbench {
namespace {

constexpr double kDensity = 50;
constexpr double kLinkRadius = 0.05;
/// From a joint to the next link's contact point, along the link [m].
constexpr double kMinArm = 0.12;
constexpr double kMaxArm = 0.25;
/// The part of the drum that a long chain covers [rad].
constexpr double kSpan = 3.4;
constexpr double kMinDrum = 0.6;
constexpr double kRope = 0.2;        ///< length of the rope at the chain's end [m]
constexpr double kPegRadius = 0.04;  ///< that it is tied to [m]
constexpr double kBallRadius = 0.08;
/// Between the drum and its casing [m]: wider than any link is long.
constexpr double kCasing = 0.8;
/// Largest centripetal acceleration over gravity.
constexpr double kCentripetal = 0.3;

/// The direction turned clockwise by the angle of a right triangle with these legs; hypotenuse^2 = near^2 + far^2.
Vec2 TurnedClockwise(Vec2 direction, double near, double far) {
  const double hypotenuse = std::sqrt(near * near + far * far);
  const Vec2 turned = Rotate({near / hypotenuse, -far / hypotenuse}, direction);
  return (1 / Norm(turned)) * turned;
}

class Chain {
 public:
  Chain(ContactSystem* system, int rows, Random* random) : system_(system) {
    constexpr int kRowsPerLink = 3;
    const int links = (rows + 2) / kRowsPerLink;
    const int missing = (rows + 2) % kRowsPerLink;
    std::vector<double> arms;  // arms[i] from joint i to the contacts on both its sides
    double length = 0;
    for (int joint = 0; joint <= links; ++joint) {
      arms.push_back(random->Uniform(kMinArm, kMaxArm));
      length += 2 * arms.back();
    }
    const double drum = std::max(kMinDrum, length / kSpan - kLinkRadius);
    rim_ = {{}, drum, Side::kConvex};
    const double centripetal = kCentripetal * kGravity * random->Uniform(0.3, 1);
    speed_ = random->Sign() * std::sqrt(centripetal / drum);
    Body body = MakeFixed("drum");
    body.omega = speed_;
    body.outline = {FullCircle({}, drum, Side::kConvex)};
    drum_ = AddBody(system, "drum", body);
    if (missing > 0) {
      Body peg = MakeFixed("peg");
      peg.omega = speed_;
      peg_ = AddBody(system, "peg", peg);
    }

    Body casing = MakeFixed("casing");
    casing.outline = {FullCircle({}, drum + kCasing, Side::kConcave)};
    AddBody(system, "casing", casing);

    const double covered = std::min(kSpan, length / drum);
    const double lean = random->Uniform(-0.2, 0.2);
    const Rotation start = SinCos(kPi / 2 + covered / 2 + lean);
    Vec2 joint{start.cos, start.sin};
    for (int link = 0; link < links; ++link) {
      const double behind = arms[static_cast<std::size_t>(link)];
      const double ahead = arms[static_cast<std::size_t>(link) + 1];
      const double height = drum + kLinkRadius;
      const Vec2 foot = TurnedClockwise(joint, height, behind);
      AddLink(foot, behind, ahead);
      if (link == 0 && missing == 2) AddBall(foot);
      joint = TurnedClockwise(foot, height, ahead);
      if (link == links - 1 && missing > 0) AddRope(joint, ahead);
    }
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
    Body body = MakeBody(Capsule(2 * half, kLinkRadius), kDensity);
    body.name.clear();
    body.theta = AngleOf(along);
    body.x = (rim_.radius + kLinkRadius) * foot + ((ahead - behind) / 2) * along;
    TurnAboutOrigin(&body, speed_);
    const Link previous = last_;
    last_ = {AddBody(system_, "link", body), half};
    if (previous.body >= 0) AddPin(system_, last_.body, {-half, 0}, previous.body, {previous.half, 0});
    AddContact(system_, last_.body, StraightEdge{{-half, -kLinkRadius}, {half, -kLinkRadius}}, drum_, rim_);
  }

  /// A ball on the outer side of the last link, above its contact point.
  void AddBall(Vec2 foot) {
    Body body = MakeDisc((rim_.radius + 2 * kLinkRadius + kBallRadius) * foot, kBallRadius, kDensity);
    TurnAboutOrigin(&body, speed_);
    const int ball = AddBody(system_, "ball", body);
    const StraightEdge top{{last_.half, kLinkRadius}, {-last_.half, kLinkRadius}};
    AddContact(system_, ball, Circle(kBallRadius), last_.body, top);
  }

  /// From the chain's end at the joint, in direction `joint` (unit), to a peg on the drum ahead of it. `arm` is the
  /// end's distance from the contact point. The peg is a body of its own, because bodies that a joint connects do not
  /// touch each other.
  void AddRope(Vec2 joint, double arm) {
    const double height = rim_.radius + kLinkRadius;
    const double distance = std::sqrt(height * height + arm * arm);
    const double sine = kRope / distance;
    const Vec2 end = distance * Rotate({std::sqrt((1 - sine) * (1 + sine)), -sine}, joint);
    system_->bodies[static_cast<std::size_t>(peg_)].outline = {FullCircle(end, kPegRadius, Side::kConvex)};
    lcpbench::AddRope(system_, last_.body, {last_.half, 0}, peg_, end);
  }

  ContactSystem* system_;
  ArcEdge rim_;
  double speed_ = 0;
  int drum_ = -1;
  int peg_ = -1;
  Link last_;
};

ContactSystem Generate(int rows, std::uint64_t seed) {
  Random random(seed);
  ContactSystem system = EmptyScene("chain-of-links", rows, seed);
  const Chain chain(&system, rows, &random);
  ApplyLoads(&system, {.weight = kGravity, .gust = 2 * kGravity}, &random);
  // A push across a taut chain is borne by many times its tension: no squeeze.
  LoadEnds(&system, {.squeeze = 0});
  return system;
}

World Start(int rows, std::uint64_t seed) {
  Random random(seed);
  ContactSystem system = EmptyScene("chain-of-links", rows, seed);
  const Chain chain(&system, rows, &random);
  return WorldUnderGravity(std::move(system), {0, -kGravity});
}

}  // namespace

extern const SceneFamily kChainOfLinks{
    "chain-of-links",
    "Chain of pinned links lying over a turning drum",
    "Two pin rows for every contact, and a tension that sums up along the chain: stiff along, loose "
    "across, which tells direct methods from those that pass forces on link by link.",
    &Generate,
    &Start,
    MotionLevel::kVelocity,
    1e-3};

}  // namespace lcpbench
