// rockers: a row of rocking bodies with round bottoms and straight tops, on a floor, carrying discs, boxes and poles.

#include <algorithm>
#include <cmath>

#include "model/scenes/scene_builder.h"

namespace lcpbench {
namespace {

constexpr double kDensity = 60;
constexpr Range kRadius{0.36, 0.44};
/// The top is the chord between the arc's directions kTopAngle and pi - kTopAngle [rad, in the body].
constexpr double kTopAngle = 0.65;
constexpr double kMaxTilt = 0.15;  ///< [rad]
constexpr double kMaxSpin = 5;     ///< [rad/s]
constexpr double kMaxSlip = 1;     ///< of riders along a top [m/s]
constexpr double kNotchRadius = 0.025;
/// Share of these velocities that the row starts moving with, small enough for contacts to last.
constexpr double kCalm = 0.2;

/// Mass, centre of mass (above the arc's centre) and inertia about the arc's centre, per density, of the unit disc
/// without the cap above the chord: the cap is the sector of half-angle a less its triangle.
struct UnitRocker {
  double area;
  double centroid;
  double inertia;
};

UnitRocker MakeUnitRocker() {
  const Rotation top = SinCos(kTopAngle);
  const double a = kPi / 2 - kTopAngle;
  const double sin_a = top.cos;
  const double cos_a = top.sin;
  const double tan_a = sin_a / cos_a;
  const double cap_area = a - sin_a * cos_a;
  const double cap_moment = 2 * sin_a * sin_a * sin_a / 3;
  const double triangle_inertia = cos_a * cos_a * cos_a * cos_a * tan_a * (0.5 + tan_a * tan_a / 6);
  const double area = kPi - cap_area;
  return {area, -cap_moment / area, kPi / 2 - (a / 2 - triangle_inertia)};
}

/// A rocker on the floor, with what its neighbours and riders need to know.
struct Rocker {
  int body = -1;
  double radius = 0;
  Vec2 center;       ///< of the arc, world
  Vec2 top_middle;   ///< world
  Vec2 top_tangent;  ///< world, to the right
  Vec2 top_normal;   ///< world, outward
};

class RockerRow final : public SceneBuilder {
 public:
  using SceneBuilder::SceneBuilder;

  void Build() override {
    drift_ = random_.Uniform(-2, 2);
    floor_ = AddFixed("floor");
    AddRocker(NewRadius(), 0);
    while (left_ > 0) {
      AddRider();
      if (left_ >= 3 && random_.Uniform() < 0.25) {
        const int spacer = AddSpacer();
        if (left_ >= 2) AddRockerAtCornerOf(spacer);
      } else if (left_ >= 2) {
        AddTouchingRocker();
        if (left_ >= 2 && random_.Uniform() < 0.4) AddNotchDisc();
      }
      if (left_ == 1) AddRoller();
    }
    Get(floor_).outline = {WholeEdge({end_ + 1, 0}, {-1, 0})};
  }

  void Load() override { Apply({.weight = 0.3 * kGravity, .gust = 2 * kGravity}); }

  void Launch(World* world) override {
    // Gap rates are linear in the velocities: they stay 0.
    for (Body& body : world->bodies) {
      body.v = kCalm * body.v;
      body.omega = kCalm * body.omega;
    }
  }

 private:
  double NewRadius() { return random_.Uniform(kRadius); }
  double NewSpin() { return random_.Uniform(-kMaxSpin, kMaxSpin); }

  /// A rocker whose arc is centred at height `radius` above floor point x: one row.
  void AddRocker(double radius, double x) {
    previous_ = last_;
    Rocker& rocker = last_;
    rocker.radius = radius;
    rocker.center = {x, radius};
    end_ = x + radius;

    // The plain body with a round ballast of radius / 6 at a random place: moves the centre of mass off the axis.
    const double mass = unit_.area * radius * radius * kDensity;
    const double ballast_radius = radius / 6;
    const double ballast = kPi * ballast_radius * ballast_radius * kDensity * random_.Uniform(0, 20);
    const Vec2 ballast_at = (0.6 * radius) * Vec2{random_.Uniform(-1, 1), random_.Uniform(-1, 0)};
    const Vec2 centroid{0, unit_.centroid * radius};
    Body body;
    body.mass = mass + ballast;
    const Vec2 offset = (1 / body.mass) * (mass * centroid + ballast * ballast_at);
    const double inertia_center = unit_.inertia * radius * radius * radius * radius * kDensity +
                                  ballast * (ballast_radius * ballast_radius / 2 + Dot(ballast_at, ballast_at));
    body.inertia = inertia_center - body.mass * Dot(offset, offset);
    body.theta = random_.Uniform(-kMaxTilt, kMaxTilt);
    body.omega = NewSpin();
    const Rotation tilt = SinCos(body.theta);
    const Vec2 arm = Rotate(tilt, offset);
    body.x = rocker.center + arm;
    body.v = Vec2{drift_, 0} + body.omega * Perp(arm);

    const Rotation top = SinCos(kTopAngle);
    rocker.top_tangent = {tilt.cos, tilt.sin};
    rocker.top_normal = Perp(rocker.top_tangent);
    rocker.top_middle = rocker.center + radius * top.sin * rocker.top_normal;
    body.outline = {{ArcEdge{-offset, radius, Side::kConvex}, kPi - kTopAngle, 2 * kPi + kTopAngle},
                    WholeEdge(-offset + radius * Vec2{top.cos, top.sin}, -offset + radius * Vec2{-top.cos, top.sin})};
    rocker.body = Add("rocker", body);
    Touch(rocker.body, floor_, Floor());
  }

  /// Arc to arc with the last one: two rows with the floor's. Circles of radii r1, r2 on one line that touch have their
  /// centres 2 sqrt(r1 r2) apart along it.
  void AddTouchingRocker() {
    const double radius = NewRadius();
    AddRocker(radius, last_.center.x + 2 * std::sqrt(last_.radius * radius));
    Touch(last_.body, previous_.body);
  }

  /// Horizontal distance from a circle's centre to its point at height `height` above the floor it stands on.
  static double HalfChord(double radius, double height) { return std::sqrt(height * (2 * radius - height)); }

  /// A box on the floor whose upper left corner touches the last rocker's arc: three rows.
  int AddSpacer() {
    const double height = random_.Uniform(0.5, 0.9) * kRadius.low;
    const double width = random_.Uniform(0.6, 1) * kRadius.low;
    const double x = last_.center.x + HalfChord(last_.radius, height) + width / 2;
    Body body = MakeBox({x, height / 2}, width, height, kDensity);
    body.v = {drift_, 0};
    const int box = Add("spacer", body);
    Stand(box, floor_, Floor());
    Touch(box, Corner(box, 3), last_.body, Piece(last_.body));
    end_ = x + width / 2;
    return box;
  }

  /// A rocker that leans on that box's upper right corner: two rows.
  void AddRockerAtCornerOf(int box) {
    const double radius = NewRadius();
    const Vertex corner = Corner(box, 2);
    const Vec2 at = Get(box).x + corner.p;
    AddRocker(radius, at.x + HalfChord(radius, at.y));
    Touch(last_.body, box, corner);
  }

  /// A small disc in the notch above the contact of the last two rockers: two rows.
  void AddNotchDisc() {
    const Vec2 center =
        MeetingOf(previous_.center, previous_.radius + kNotchRadius, last_.center, last_.radius + kNotchRadius).Left();
    Body body = MakeDisc(center, kNotchRadius, 4 * kDensity);
    body.v = {drift_, 0};
    body.omega = NewSpin();
    const int disc = Add("disc", body);
    Touch(disc, previous_.body);
    Touch(disc, last_.body);
  }

  /// Something on the last rocker's top, or nothing: none to two rows.
  void AddRider() {
    const double choice = random_.Uniform();
    if (choice < 0.3) {
      AddDiscRider();
    } else if (choice < 0.55) {
      AddPoleRider();
    } else if (choice < 0.8 && left_ >= 2) {
      AddBoxRider();
    }
  }

  Vec2 TopPoint(double share) {
    return last_.top_middle + (share * last_.radius * random_.Uniform(-1, 1)) * last_.top_tangent;
  }
  /// Velocity of what slides over the last rocker's top at world point p.
  Vec2 SlidingVelocity(Vec2 p) {
    return VelocityAt(Get(last_.body), p) + random_.Uniform(-kMaxSlip, kMaxSlip) * last_.top_tangent;
  }

  void AddDiscRider() {
    const double radius = random_.Uniform(0.15, 0.3) * last_.radius;
    const Vec2 p = TopPoint(0.35);
    Body body = MakeDisc(p + radius * last_.top_normal, radius, kDensity);
    body.omega = NewSpin();
    // The foot of the centre on a turning line: the rim's own spin has no component along the normal there.
    body.v = SlidingVelocity(p);
    Touch(Add("disc", body), last_.body, Piece(last_.body, 1));
  }

  /// A slender box that stands on one corner.
  void AddPoleRider() {
    const double width = 0.14 * last_.radius;
    const double height = random_.Uniform(0.5, 0.8) * last_.radius;
    const double side = random_.Sign();  // one draw per statement: the order within an expression is not defined
    const double lean = side * random_.Uniform(0.1, 0.3);
    const Vec2 p = TopPoint(0.25);
    // Turned to the left it stands on its left corner.
    const Vec2 corner{lean > 0 ? -width / 2 : width / 2, -height / 2};
    Body body = MakeBox({}, width, height, 2 * kDensity);
    body.theta = Get(last_.body).theta + lean;
    body.omega = NewSpin();
    const Vec2 arm = Rotate(SinCos(body.theta), corner);
    body.x = p - arm;
    body.v = SlidingVelocity(p) - body.omega * Perp(arm);
    Touch(Add("pole", body), Vertex{corner}, last_.body, Piece(last_.body, 1));
  }

  /// A box that lies flat on the top and so turns with it: two rows.
  void AddBoxRider() {
    const double width = random_.Uniform(0.4, 0.7) * last_.radius;
    const double height = random_.Uniform(0.2, 0.4) * last_.radius;
    Body body = MakeBox(TopPoint(0.25) + (height / 2) * last_.top_normal, width, height, kDensity);
    body.theta = Get(last_.body).theta;
    body.omega = Get(last_.body).omega;
    body.v = SlidingVelocity(body.x);
    Stand(Add("box", body), last_.body, Piece(last_.body, 1));
  }

  /// A disc on the floor, clear of everything: one row.
  void AddRoller() {
    const double radius = kRadius.low / 2;
    end_ += 2 * kRadius.high;
    Body body = MakeDisc({end_, radius}, radius, kDensity);
    body.v = {drift_, 0};
    body.omega = NewSpin();
    Touch(Add("disc", body), floor_, Floor());
    end_ += radius;
  }

  double drift_ = 0;  ///< common speed of all arc centres [m/s]
  const UnitRocker unit_ = MakeUnitRocker();
  int floor_ = 0;
  double end_ = 0;  ///< right end of the row so far
  Rocker last_;
  Rocker previous_;
};

}  // namespace

extern const SceneFamily kRockers{
    "rockers", "Row of rocking bodies carrying discs, boxes and poles",
    "Every contact kind on turning edges, nonzero velocity-product terms on most rows, full rank: "
    "moderate sizes that most methods should solve, with b that depends on curvature.",
    &Make<RockerRow>};

}  // namespace lcpbench
