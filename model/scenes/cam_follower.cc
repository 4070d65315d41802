// cam-follower: a row of cams, coupled by rods to turn together, each lifting a spring-loaded follower in a guide.

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "model/scenes/scene_builder.h"
#include "model/shape/shapes.h"

namespace lcpbench {
namespace {

constexpr double kCamDensity = 60;
constexpr double kFollowerDensity = 30;
constexpr double kSpacing = 1;       ///< of cam axles [m]
constexpr double kCrank = 0.07;      ///< the crank arm of the coupling rods, common to all cams in the world [m]
constexpr Range kSpeed{3, 6};        ///< of the cams [rad/s]
constexpr double kMaxOffset = 0.03;  ///< largest distance of a follower's axis from the cam's axle [m]
constexpr double kFollowerHeight = 0.6;
constexpr double kWallBottom = 0.45;  ///< the guide's wall begins above every cam and ends above every follower [m]
constexpr double kWallTop = 1.3;
constexpr double kWallWidth = 0.08;
constexpr double kPlay = 0.01;  ///< of a loose follower between its walls [m]
constexpr double kSpringAnchor = 1.5;
constexpr Range kPreload{0.5, 2};    ///< force of a follower's spring as it stands, over its weight
constexpr double kSpringRest = 1.2;  ///< [m]: longer than any spring of the scene, so that all are compressed

/// A highest contact: what a follower comes to rest on.
struct Top {
  double height = 0;  ///< of the follower's reference point [m]
  Feature feature;    ///< of the cam
};

/// The height at which a circle of that radius (0: a point) on the vertical line at world x touches the cam from above.
std::optional<Top> TopForCircle(const Body& cam, double x, double radius) {
  const Rotation turn = SinCos(cam.theta);
  std::optional<Top> top;
  const auto keep = [&](double height, const Feature& feature) {
    if (!top || height > top->height) top = Top{height, feature};
  };
  for (const OutlineEdge& piece : cam.outline) {
    if (const auto* arc = std::get_if<ArcEdge>(&piece.edge)) {
      const Vec2 center = WorldPoint(cam, arc->center);
      const double reach = arc->radius + radius;
      const double aside = x - center.x;
      if (std::abs(aside) >= reach) continue;
      const double rise = std::sqrt((reach - aside) * (reach + aside));
      // The arcs of a hull are told from the rest of their circles by the normal: forward of the flanks' normal or not.
      const Vec2 normal = RotateBack(turn, (1 / reach) * Vec2{aside, rise});
      const double limit = SinCos(piece.s_begin).cos;
      const bool is_nose = piece.s_begin < 0;
      if (is_nose == (normal.x > limit)) keep(center.y + rise, *arc);
    } else if (const auto* flank = std::get_if<StraightEdge>(&piece.edge)) {
      const Vec2 a = WorldPoint(cam, flank->a);
      const Vec2 along = WorldPoint(cam, flank->b) - a;
      const double length = Norm(along);
      const Vec2 outward = (-1 / length) * Perp(along);
      if (outward.y <= 0) continue;
      const double height = a.y + (radius - outward.x * (x - a.x)) / outward.y;
      const double foot = Dot(Vec2{x, height} - a, along) / (length * length);
      if (foot >= 0 && foot <= 1) keep(height, *flank);
    }
  }
  return top;
}

/// The height of the cam's highest point: where a horizontal face touches it.
Top TopForFace(const Body& cam) {
  Top top{-std::numeric_limits<double>::infinity(), {}};
  const Rotation turn = SinCos(cam.theta);
  for (const OutlineEdge& piece : cam.outline) {
    double height = top.height;
    if (const auto* arc = std::get_if<ArcEdge>(&piece.edge)) {
      height = WorldPoint(cam, arc->center).y + arc->radius;
    } else if (const auto* oval = std::get_if<EllipseEdge>(&piece.edge)) {
      const double along = oval->a * turn.sin;
      const double across = oval->b * turn.cos;
      height = WorldPoint(cam, oval->center).y + std::sqrt(along * along + across * across);
    }
    if (height > top.height) top = {height, ToFeature(piece.edge)};
  }
  return top;
}

class CamRow final : public SceneBuilder {
 public:
  using SceneBuilder::SceneBuilder;

  void Build() override {
    const double sense = random_.Sign();
    speed_ = sense * random_.Uniform(kSpeed);
    crank_ = kCrank * Direction(random_.Uniform(kPi / 4, 3 * kPi / 4));
    frame_ = AddFixed("frame");

    constexpr int kDriven = 6;
    constexpr int kDriving = 3;
    for (int ball = 0; ball < rows_ % kDriving; ++ball) AddBall(AddDrivingCam(false));
    int left = rows_ / kDriving;
    const int driving = left == 0 ? 0 : (left % 2 == 1 ? 1 : 2);
    for (int k = 0; k < driving; ++k) AddFollower(AddDrivingCam(true));
    for (left -= driving; left > 0; left -= kDriven / kDriving) AddFollower(AddDrivenCam());

    std::vector<OutlineEdge>& outline = Get(frame_).outline;
    outline.push_back(WholeEdge({axle_.x + kFloorBeyond, kFloor}, {-kFloorBeyond, kFloor}));
    for (const double x : walls_) {
      const std::vector<OutlineEdge> wall = Sides({x, kWallBottom}, {x + kWallWidth, kWallTop});
      outline.insert(outline.end(), wall.begin(), wall.end());
    }
  }

  void Load() override {
    Apply({.weight = kGravity, .gust = 3 * kGravity});
    for (const Spring& spring : springs_) ApplySpring(spring, system_.bodies);
    LoadEnds(&system_);
  }

  void Launch(World* world) override { world->loads.springs = springs_; }

 private:
  static constexpr double kFloor = -1;
  static constexpr double kFloorBeyond = 5;  // balls fall off and roll away
  static constexpr double kBallRadius = 0.07;

  /// A cam, its axle at the drawing's origin: a hull of two circles or an eccentric ellipse.
  Outline DrawShape(bool oval_allowed) {
    if (oval_allowed && random_.Uniform() < 0.3) {
      const double a = random_.Uniform(0.16, 0.2);
      const double b = random_.Uniform(0.1, 0.14);
      const double eccentricity = random_.Uniform(0.02, 0.06);
      return Transformed(Ellipse(a, b), 0, {eccentricity, 0});
    }
    const double base = random_.Uniform(0.12, 0.16);
    const double nose = random_.Uniform(0.04, 0.07);
    const double distance = random_.Uniform(0.15, 0.2);
    return Cam(base, nose, distance);
  }

  Vec2 NextAxle() {
    axle_.x = kSpacing * cams_++;
    return axle_;
  }

  int AddDrivingCam(bool oval_allowed) {
    Body cam = MakeFixed("motor " + std::to_string(cams_), AllPieces(DrawShape(oval_allowed)));
    cam.theta = random_.Uniform(0, 2 * kPi);
    cam.x = NextAxle();
    cam.omega = speed_;
    last_cam_ = Add("motor", cam);
    return last_cam_;
  }

  int AddDrivenCam() {
    Body cam = MakePlate(DrawShape(true), kCamDensity);
    const Vec2 axle_point = -cam.x;
    cam.theta = random_.Uniform(0, 2 * kPi);
    const Vec2 axle = NextAxle();
    const Vec2 arm = -Rotate(SinCos(cam.theta), axle_point);
    cam.x = axle + arm;
    cam.omega = speed_;
    cam.v = speed_ * Perp(arm);
    const int before = last_cam_;
    last_cam_ = Add("cam", cam);
    Join(ConstraintType::kPin, last_cam_, axle_point, frame_, Vertex{axle});
    const Vec2 crank_before = axle - Vec2{kSpacing, 0} + crank_;
    Join(ConstraintType::kRod, last_cam_, BodyPoint(Get(last_cam_), axle + crank_), before,
         Vertex{BodyPoint(Get(before), crank_before)});
    return last_cam_;
  }

  void AddBall(int cam) {
    const double x = axle_.x + random_.Uniform(-kMaxOffset, kMaxOffset);
    const Top top = *TopForCircle(Get(cam), x, kBallRadius);
    const int ball = Add("ball", MakeDisc({x, top.height}, kBallRadius, kFollowerDensity));
    Touch(ball, cam, top.feature);
    Get(ball).v.y = StillVelocity(system_, 1);
  }

  void AddFollower(int cam) {
    const bool oval = std::holds_alternative<EllipseEdge>(Get(cam).outline[0].edge);
    const double x = axle_.x + random_.Uniform(-kMaxOffset, kMaxOffset);
    const double half_width = random_.Uniform(0.06, 0.09);
    const double kind = random_.Uniform();
    const bool flat = oval || kind < 0.35;
    const bool roller = !flat && kind < 0.7;
    const Top top = flat ? TopForFace(Get(cam)) : *TopForCircle(Get(cam), x, roller ? half_width : 0);
    const Vec2 at{x, top.height};
    const int body = AddFollowerBody(flat     ? Tappet(half_width)
                                     : roller ? Roller(half_width)
                                              : KnifeEdge(half_width),
                                     at);
    Touch(body, flat || roller ? Piece(body) : Vertex{BodyPoint(Get(body), at)}, cam, top.feature);
    Get(body).v.y = StillVelocity(system_, 1);
    AddGuide(body, x, half_width);
    AddSpring(body, x);
  }

  /// Outlines begin with the underside; their frames have their origins at the follower's lowest point or, of a
  /// roller, at the roller's centre.
  int AddFollowerBody(OutlineLoop outline, Vec2 at) {
    Body body = MakePlate({"", {std::move(outline)}}, kFollowerDensity);
    body.x = body.x + at;
    return Add("follower", body);
  }

  /// A flat plate below a stem.
  static OutlineLoop Tappet(double half) {
    constexpr double kPlate = 0.05;
    constexpr double kTop = kFollowerHeight;
    constexpr double w = 0.25;  // a face wide enough for the highest point of every cam in every position
    return Polyline({{-w, 0},
                     {w, 0},
                     {w, kPlate},
                     {half, kPlate},
                     {half, kTop},
                     {-half, kTop},
                     {-half, kPlate},
                     {-w, kPlate},
                     {-w, 0}});
  }
  static OutlineLoop Roller(double half) {
    OutlineLoop loop = Polyline({{half, 0}, {half, kFollowerHeight}, {-half, kFollowerHeight}, {-half, 0}});
    loop.insert(loop.begin(), OutlineEdge{ArcEdge{{}, half, Side::kConvex}, -kPi, 0});
    return loop;
  }
  static OutlineLoop KnifeEdge(double half) {
    const double low = 1.5 * half;
    return Polyline({{0, 0}, {half, low}, {half, kFollowerHeight}, {-half, kFollowerHeight}, {-half, low}, {0, 0}});
  }

  void AddGuide(int body, double x, double half_width) {
    if (random_.Uniform() < 0.5) {
      const StraightEdge axis{{x, 0}, {x, 1}};
      // The axis passes the centre of mass at a distance of rounding.
      const double aside = x - Get(body).x.x;
      for (const double height : {-0.1, 0.2}) Join(ConstraintType::kPathJoint, body, {aside, height}, frame_, axis);
      return;
    }
    // The follower's left side lies on the wall's right face from the wall's bottom up to the follower's top.
    const Body& follower = Get(body);
    const double face = x - half_width;
    walls_.push_back(face - kWallWidth);
    walls_.push_back(x + half_width + kPlay);
    const StraightEdge wall{{face, kWallBottom}, {face, kWallTop}};
    double top = 0;
    for (const OutlineEdge& piece : follower.outline) {
      if (const auto* line = std::get_if<StraightEdge>(&piece.edge)) top = std::max(top, line->a.y);
    }
    const Vec2 corner{face - follower.x.x, top};
    const Vec2 below{corner.x, kWallBottom - follower.x.y};
    Touch(body, Vertex{corner}, frame_, wall);
    Touch(body, StraightEdge{corner, below}, frame_, Vertex{{face, kWallBottom}});
  }

  /// Compressed between the frame and the follower's centre of mass.
  void AddSpring(int body, double x) {
    const Body& follower = Get(body);
    Spring spring;
    spring.end1 = {frame_, {x, kSpringAnchor}};
    spring.end2 = {body, {x - follower.x.x, 0}};
    spring.rest_length = kSpringRest;
    const double compression = kSpringRest - (kSpringAnchor - follower.x.y);
    spring.stiffness = random_.Uniform(kPreload) * follower.mass * kGravity / compression;
    springs_.push_back(spring);
  }

  double speed_ = 0;
  Vec2 crank_;
  Vec2 axle_;
  int frame_ = -1;
  int cams_ = 0;
  int last_cam_ = -1;
  std::vector<double> walls_;  // their left faces
  std::vector<Spring> springs_;
};

}  // namespace

extern const SceneFamily kCamFollower{
    "cam-follower", "Row of coupled cams with spring-loaded followers in guides",
    "Pins, coupling rods and path joints around few contacts of arcs, flanks and ellipses; the rods couple "
    "the whole row, which tells methods that use a band from those that fill a dense matrix.",
    &Make<CamRow>};

}  // namespace lcpbench
