// spinning-drum: balls and ovals between the baffles of a turning drum.
//
// A kinematic body that does not merely stand: the drum turns and speeds up, so that its prescribed angular
// acceleration enters b through the baffles, and everything turns with it, so that every row carries velocity-product
// terms. Piles of balls (convex arcs in a concave one, against each other and against straight baffles) and chains of
// ovals (general curves in the arc and against each other) lie in sectors that know nothing of each other: A falls into
// blocks, which tells methods that find or use independent parts from those whose cost grows with the whole. Loads
// pull every way, and the same sector is full at the bottom and falling at the top. The common motion meets every
// constraint, so that the problem is solvable for every seed. J has full rank, and A is well conditioned (Jacobi-scaled
// 2e2 at 200 and at 1000 rows).
//
// Rows with w > 0 at the solution, seeds 1 to 5: 10-20 % at 10 rows, 21-35 % at 100, 14-22 % at 1000, 13-22 % at 3000.
//
// Balls bring two rows each; a chain of k ovals 2 k - 1.
//
// In motion: the drum turns at constant speed about as fast as holds the bodies to its wall, and those at the top fall.

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

constexpr double kDensity = 60;
constexpr double kMinRadius = 0.095;
constexpr double kMaxRadius = 0.105;
/// A ball in the notch of two others, over the smaller of them: leaves its neighbours in other notches clear.
constexpr double kNotchShare = 0.75;
constexpr int kMinWallBalls = 4;
constexpr int kMaxWallBalls = 8;
constexpr int kLayers = 3;
constexpr double kMinHalfLength = 0.14;  ///< semi-axes of ovals [m]
constexpr double kMaxHalfLength = 0.18;
constexpr double kMinHalfWidth = 0.08;
constexpr double kMaxHalfWidth = 0.11;
constexpr int kMinOvals = 3;
constexpr int kMaxOvals = 6;
constexpr double kOvalShare = 0.35;
constexpr double kMinDrum = 1.5;
constexpr double kFilledShare = 0.9;  ///< of the drum's wall, at most
constexpr double kBaffleHeight = 0.4;
constexpr double kBaffleWidth = 0.06;
constexpr double kClearance = 0.05;  ///< between a baffle and the bodies before it, and ovals after it
constexpr double kShell = 0.12;      ///< the drum's thickness
/// Centripetal acceleration over gravity.
constexpr double kMinCentripetal = 0.7;
constexpr double kMaxCentripetal = 1.4;
/// Largest tangential acceleration over gravity.
constexpr double kSpinUp = 0.5;

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
      const int wanted = kMinOvals + random->Integer(kMaxOvals - kMinOvals + 1);
      sector.bodies = std::min(wanted, (rows + 1) / 2);
      sector.a = random->Uniform(kMinHalfLength, kMaxHalfLength);
      sector.b = random->Uniform(kMinHalfWidth, kMaxHalfWidth);
      rows -= 2 * sector.bodies - 1;
    } else {
      const int wall = kMinWallBalls + random->Integer(kMaxWallBalls - kMinWallBalls + 1);
      int full = 0;
      for (int layer = 0; layer < kLayers; ++layer) full += wall - layer;
      sector.bodies = std::min(full, rows / 2);
      for (int k = 0; k < std::min(wall, sector.bodies); ++k) {
        sector.radii.push_back(random->Uniform(kMinRadius, kMaxRadius));
      }
      rows -= 2 * sector.bodies;
    }
    sectors.push_back(sector);
  }
  return sectors;
}

/// The unit direction turned counter-clockwise by the angle of that sine, below a right angle.
Vec2 Turned(Vec2 direction, double sine) {
  const Vec2 turned = Rotate({std::sqrt((1 - sine) * (1 + sine)), sine}, direction);
  return (1 / Norm(turned)) * turned;
}

class Drum {
 public:
  Drum(ContactSystem* system, int rows, Random* random) : system_(system) {
    const std::vector<Sector> sectors = PlanSectors(rows, random);
    double length = 0;
    for (const Sector& sector : sectors) length += sector.Length();
    // Centres lie inside the wall, where the same lengths take larger angles.
    radius_ = std::max(kMinDrum, length / (2 * kPi * kFilledShare) + 2 * kMaxRadius);
    wall_ = {{}, radius_, Side::kConcave};
    Body drum = MakeFixed("drum");
    const double centripetal = kGravity * random->Uniform(kMinCentripetal, kMaxCentripetal);
    drum.omega = random->Sign() * std::sqrt(centripetal / radius_);
    drum.alpha = kSpinUp * kGravity / radius_ * random->Uniform(-1, 1);
    drum_ = AddBody(system, "drum", drum);

    const Rotation start = SinCos(random->Uniform(0, 2 * kPi));
    Vec2 ray{start.cos, start.sin};
    for (const Sector& sector : sectors) {
      baffles_.push_back(ray);
      ray = sector.ovals ? AddOvals(sector, ray) : AddBalls(sector, ray);
    }
    Draw();
    for (Body& body : system->bodies) {
      if (!body.fixed) TurnAboutOrigin(&body, drum.omega);
    }
  }

 private:
  Body& Get(int body) { return system_->bodies[static_cast<std::size_t>(body)]; }
  static Vec2 SideOf(Vec2 ray) { return (kBaffleWidth / 2) * Perp(ray); }
  /// The counter-clockwise face of a baffle, in the direction of travel around the drum's inside.
  StraightEdge Face(Vec2 ray) const {
    const double foot = std::sqrt(radius_ * radius_ - kBaffleWidth * kBaffleWidth / 4);
    return {foot * ray + SideOf(ray), (radius_ - kBaffleHeight) * ray + SideOf(ray)};
  }

  struct Ball {
    int body = -1;
    Vec2 center;
    double radius = 0;
  };

  Ball AddBall(Vec2 center, double radius) {
    return {AddBody(system_, "ball", MakeDisc(center, radius, kDensity)), center, radius};
  }

  void Touch(const Ball& ball, const Ball& other) {
    AddContact(system_, ball.body, Circle(ball.radius), other.body, Circle(other.radius));
  }

  /// A pile on the counter-clockwise side of the baffle at `ray`: a row along the wall and shorter rows in its notches.
  /// Returns the next baffle's direction.
  Vec2 AddBalls(const Sector& sector, Vec2 ray) {
    std::vector<Ball> layer;
    Vec2 direction = ray;
    for (const double r : sector.radii) {
      if (layer.empty()) {
        direction = Turned(ray, (kBaffleWidth / 2 + r) / (radius_ - r));
      } else {
        direction = NextAlongArc(direction, layer.back().radius, r, radius_);
      }
      const Ball ball = AddBall((radius_ - r) * direction, r);
      AddContact(system_, ball.body, Circle(r), drum_, wall_);
      if (layer.empty()) {
        AddContact(system_, ball.body, Circle(r), drum_, Face(ray));
      } else {
        Touch(ball, layer.back());
      }
      layer.push_back(ball);
    }
    const double last = sector.radii.back();
    const Vec2 next = Turned(direction, (last + kClearance + kBaffleWidth / 2) / (radius_ - last));

    int left = sector.bodies - static_cast<int>(layer.size());
    while (left > 0) {
      std::vector<Ball> above;
      for (std::size_t k = 0; k + 1 < layer.size() && left > 0; ++k, --left) {
        above.push_back(AddNotchBall(layer[k], layer[k + 1]));
        Touch(above.back(), layer[k]);
        Touch(above.back(), layer[k + 1]);
      }
      layer = above;
    }
    return next;
  }

  /// On the inner side of two balls, touching both.
  Ball AddNotchBall(const Ball& ball1, const Ball& ball2) {
    const double r = kNotchShare * std::min(ball1.radius, ball2.radius);
    const double reach1 = ball1.radius + r;
    const double reach2 = ball2.radius + r;
    const Vec2 between = ball2.center - ball1.center;
    const double distance = Norm(between);
    const Vec2 unit = (1 / distance) * between;
    const double along = (reach1 * reach1 - reach2 * reach2 + distance * distance) / (2 * distance);
    return AddBall(ball1.center + along * unit + std::sqrt(reach1 * reach1 - along * along) * Perp(unit), r);
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
    const Body shape = MakeBody(Ellipse(a, b), kDensity);
    Vec2 edge = Turned(ray, margin);
    for (int k = 0; k < sector.bodies; ++k) {
      const Vec2 direction = Turned(edge, half_sine);
      Body oval = shape;
      oval.name.clear();
      oval.x = c * direction;
      oval.theta = AngleOf(Perp(direction));
      const int body = AddBody(system_, "oval", oval);
      AddContact(system_, body, rim, drum_, wall_);
      system_->constraints.back().s1 = -kPi / 2;
      if (k > 0) {
        // Towards the oval before; mirrored for that one.
        const Vec2 normal{-Dot(Perp(edge), Perp(direction)), Dot(Perp(edge), direction)};
        const double s = AngleOf({a * normal.x, b * normal.y});
        AddContact(system_, body, rim, body - 1, rim);
        system_->constraints.back().s1 = s;
        system_->constraints.back().s2 = kPi - s;
      }
      edge = Turned(direction, half_sine);
    }
    return Turned(edge, margin);
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

  ContactSystem* system_;
  double radius_ = 0;
  ArcEdge wall_;
  int drum_ = -1;
  std::vector<Vec2> baffles_;
};

ContactSystem Generate(int rows, std::uint64_t seed) {
  Random random(seed);
  ContactSystem system = EmptyScene("spinning-drum", rows, seed);
  const Drum drum(&system, rows, &random);
  ApplyLoads(&system, {.weight = kGravity, .gust = kGravity}, &random);
  LoadEnds(&system, {.squeeze = 50, .burst = 100});
  return system;
}

World Start(int rows, std::uint64_t seed) {
  Random random(seed);
  ContactSystem system = EmptyScene("spinning-drum", rows, seed);
  const Drum drum(&system, rows, &random);
  // Constant speed: a drum that speeds up would leave every scale behind.
  for (Body& body : system.bodies) body.alpha = 0;
  return WorldUnderGravity(std::move(system), {0, -kGravity});
}

}  // namespace

extern const SceneFamily kSpinningDrum{
    "spinning-drum",
    "Balls and ovals between the baffles of a turning drum",
    "A kinematic body whose motion and acceleration enter b, and independent sectors of balls and general "
    "curves: tells methods that use blocks from those whose cost grows with the whole.",
    &Generate,
    &Start,
    MotionLevel::kVelocity,
    1e-3};

}  // namespace lcpbench
