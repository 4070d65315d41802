// spinning-drum: balls and ovals between the baffles of a turning drum.

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "model/scenes/scene_builder.h"
#include "model/shape/shapes.h"

namespace lcpbench {
namespace {

constexpr double kDensity = 60;
constexpr Range kRadius{0.095, 0.105};
/// A ball in the notch of two others, over the smaller of them: leaves its neighbours in other notches clear.
constexpr double kNotchShare = 0.75;
constexpr int kMinWallBalls = 4;
constexpr int kMaxWallBalls = 8;
constexpr int kLayers = 3;
constexpr Range kHalfLength{0.14, 0.18};  ///< of ovals [m]
constexpr Range kHalfWidth{0.08, 0.11};
constexpr int kMinOvals = 3;
constexpr int kMaxOvals = 6;
constexpr double kOvalShare = 0.35;
constexpr double kMinDrum = 1.5;
constexpr double kFilledShare = 0.9;  ///< of the drum's wall, at most
constexpr double kBaffleHeight = 0.4;
constexpr double kBaffleWidth = 0.06;
constexpr double kClearance = 0.05;      ///< between a baffle and the bodies before it, and ovals after it
constexpr double kShell = 0.12;          ///< the drum's thickness
constexpr Range kCentripetal{0.7, 1.4};  ///< centripetal acceleration over gravity
constexpr double kSpinUp = 0.5;          ///< largest tangential acceleration over gravity

/// What lies between two baffles.
struct Sector {
  bool ovals = false;
  int bodies = 0;
  std::vector<double> radii;  ///< of the balls on the wall
  double a = 0;               ///< semi-axes of the ovals
  double b = 0;

  double Length() const {
    double length = kBaffleWidth + 2 * kClearance + (ovals ? 2 * a * bodies : 0);
    for (const double r : radii) length += 2 * r;
    return length;
  }
};

std::vector<Sector> PlanSectors(int rows, Random* random) {
  std::vector<Sector> sectors;
  while (rows > 0) {
    Sector sector;
    sector.ovals = random->Uniform() < kOvalShare || rows == 1;
    if (sector.ovals) {
      sector.bodies = std::min(random->Integer(kMinOvals, kMaxOvals), (rows + 1) / 2);
      sector.a = random->Uniform(kHalfLength);
      sector.b = random->Uniform(kHalfWidth);
      rows -= 2 * sector.bodies - 1;
    } else {
      const int wall = random->Integer(kMinWallBalls, kMaxWallBalls);
      int full = 0;
      for (int layer = 0; layer < kLayers; ++layer) full += wall - layer;
      sector.bodies = std::min(full, rows / 2);
      for (int k = 0; k < std::min(wall, sector.bodies); ++k) {
        sector.radii.push_back(random->Uniform(kRadius));
      }
      rows -= 2 * sector.bodies;
    }
    sectors.push_back(sector);
  }
  return sectors;
}

class Drum final : public SceneBuilder {
 public:
  using SceneBuilder::SceneBuilder;

  void Build() override {
    const std::vector<Sector> sectors = PlanSectors(rows_, &random_);
    double length = 0;
    for (const Sector& sector : sectors) length += sector.Length();
    // Centres lie inside the wall, where the same lengths take larger angles.
    radius_ = std::max(kMinDrum, length / (2 * kPi * kFilledShare) + 2 * kRadius.high);
    wall_ = {{}, radius_, Side::kConcave};
    Body drum = MakeFixed("drum");
    const double centripetal = kGravity * random_.Uniform(kCentripetal);
    drum.omega = random_.Sign() * std::sqrt(centripetal / radius_);
    drum.alpha = kSpinUp * kGravity / radius_ * random_.Uniform(-1, 1);
    drum_ = Add("drum", drum);

    Vec2 ray = RandomDirection();
    for (const Sector& sector : sectors) {
      baffles_.push_back(ray);
      ray = sector.ovals ? AddOvals(sector, ray) : AddBalls(sector, ray);
    }
    Draw();
    for (Body& body : system_.bodies) {
      if (body.fixed) continue;
      body.omega = drum.omega;
      body.v = drum.omega * Perp(body.x);
    }
  }

  void Load() override {
    Apply({.weight = kGravity, .gust = kGravity});
    LoadEnds(&system_, {.squeeze = 50, .burst = 100});
  }

  void Launch(World* world) override {
    // Constant speed: a drum that speeds up would leave every scale behind.
    for (Body& body : world->bodies) body.alpha = 0;
  }

 private:
  static Vec2 SideOf(Vec2 ray) { return (kBaffleWidth / 2) * Perp(ray); }
  /// The counter-clockwise face of a baffle, in the direction of travel around the drum's inside.
  StraightEdge Face(Vec2 ray) const {
    const double foot = std::sqrt(radius_ * radius_ - kBaffleWidth * kBaffleWidth / 4);
    return {foot * ray + SideOf(ray), (radius_ - kBaffleHeight) * ray + SideOf(ray)};
  }

  /// A pile on the counter-clockwise side of the baffle at `ray`: a row along the wall and shorter rows in its notches.
  /// Returns the next baffle's direction.
  Vec2 AddBalls(const Sector& sector, Vec2 ray) {
    std::vector<int> layer;
    Vec2 direction = Turned(ray, OfSine((kBaffleWidth / 2 + sector.radii[0]) / (radius_ - sector.radii[0])));
    for (const double r : sector.radii) {
      if (!layer.empty()) direction = NextAlongArc(direction, Radius(layer.back()), r, radius_);
      const int ball = Add("ball", MakeDisc((radius_ - r) * direction, r, kDensity));
      Touch(ball, drum_, wall_);
      if (layer.empty()) {
        Touch(ball, drum_, Face(ray));
      } else {
        Touch(ball, layer.back());
      }
      layer.push_back(ball);
    }
    const double last = sector.radii.back();
    const Vec2 next = Turned(direction, OfSine((last + kClearance + kBaffleWidth / 2) / (radius_ - last)));

    int left = sector.bodies - static_cast<int>(layer.size());
    while (left > 0) {
      std::vector<int> above;
      for (std::size_t k = 0; k + 1 < layer.size() && left > 0; ++k, --left) {
        above.push_back(AddNotchBall(layer[k], layer[k + 1]));
      }
      layer = above;
    }
    return next;
  }

  /// On the inner side of two balls, touching both.
  int AddNotchBall(int ball1, int ball2) {
    const double r = kNotchShare * std::min(Radius(ball1), Radius(ball2));
    const Vec2 center = MeetingOf(Get(ball1).x, Radius(ball1) + r, Get(ball2).x, Radius(ball2) + r).Left();
    const int ball = Add("ball", MakeDisc(center, r, kDensity));
    for (const int below : {ball1, ball2}) Touch(ball, below);
    return ball;
  }

  /// Equal ovals that lie on the wall along their long sides, side by side. Two of them touch on the ray halfway
  /// between, at which both are tangent: with c the distance of their middles from the drum's, the ray's distance
  /// c sin(angle) equals the ellipse's support sqrt(a^2 cos^2(angle) + b^2 sin^2(angle)).
  Vec2 AddOvals(const Sector& sector, Vec2 ray) {
    const double a = sector.a;
    const double b = sector.b;
    const double c = radius_ - b;
    const double half_sine = a / std::sqrt(a * a + c * c - b * b);
    const double inner = radius_ - std::max(kBaffleHeight, 2 * b);
    const double margin = (kBaffleWidth / 2 + kClearance) / inner;
    const EllipseEdge rim{{}, a, b, 0, Side::kConvex};
    const Body shape = MakePlate(Ellipse(a, b), kDensity);
    Vec2 edge = Turned(ray, OfSine(margin));
    for (int k = 0; k < sector.bodies; ++k) {
      const Vec2 direction = Turned(edge, OfSine(half_sine));
      Body oval = shape;
      oval.x = c * direction;
      oval.theta = AngleOf(Perp(direction));
      const int body = Add("oval", oval);
      Touch(body, rim, drum_, wall_).s1 = -kPi / 2;
      if (k > 0) {
        // Towards the oval before; mirrored for that one.
        const Vec2 normal{-Dot(Perp(edge), Perp(direction)), Dot(Perp(edge), direction)};
        const double s = AngleOf({a * normal.x, b * normal.y});
        Constraint& contact = Touch(body, rim, body - 1, rim);
        contact.s1 = s;
        contact.s2 = kPi - s;
      }
      edge = Turned(direction, OfSine(half_sine));
    }
    return Turned(edge, OfSine(margin));
  }

  /// The drum's inside, clockwise, with a round edge on each baffle.
  void Draw() {
    std::vector<OutlineEdge> outline = {FullCircle({}, radius_ + kShell, Side::kConvex)};
    for (std::size_t i = baffles_.size(); i-- > 0;) {
      const Vec2 ray = baffles_[i];
      const Vec2 next = baffles_[(i + 1) % baffles_.size()];
      const StraightEdge face = Face(ray);
      const Vec2 begin = Face(next).a - 2 * SideOf(next);
      const double s_end = AngleOf(face.a);
      double s_begin = AngleOf(begin);
      if (s_begin < s_end) s_begin += 2 * kPi;
      outline.push_back({wall_, s_begin, s_end});
      outline.push_back(WholeEdge(face.a, face.b));
      const double side = AngleOf(Perp(ray));
      outline.push_back({ArcEdge{(radius_ - kBaffleHeight) * ray, kBaffleWidth / 2, Side::kConvex}, side, side + kPi});
      outline.push_back(WholeEdge(face.b - 2 * SideOf(ray), face.a - 2 * SideOf(ray)));
    }
    Get(drum_).outline = std::move(outline);
  }

  double radius_ = 0;
  ArcEdge wall_;
  int drum_ = -1;
  std::vector<Vec2> baffles_;
};

}  // namespace

extern const SceneFamily kSpinningDrum{
    "spinning-drum", "Balls and ovals between the baffles of a turning drum",
    "A kinematic body whose motion and acceleration enter b, and independent sectors of balls and general "
    "curves: tells methods that use blocks from those whose cost grows with the whole.",
    &Make<Drum>};

}  // namespace lcpbench
