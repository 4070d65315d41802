// oval-train: a train on a closed oval track, its cars kept on it by two path joints each.

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "model/geometry/feature.h"
#include "model/scenes/scene_builder.h"
#include "model/shape/shapes.h"

namespace lcpbench {
namespace {

constexpr double kDensity = 60;
constexpr Range kWheelbase{0.3, 0.5};  ///< between the path joints of a car [m]
constexpr Range kBuffer{0.16, 0.2};    ///< between the path joints of two cars, buffers touching [m]
constexpr Range kRope{0.26, 0.32};     ///< the same at a rope: its length [m]
constexpr Range kEnd{0.08, 0.1};       ///< radius of a car's end without buffer [m]
constexpr double kTrolleyRadius = 0.08;
constexpr Range kAspect{0.5, 0.8};    ///< of the track's semi-axes
constexpr double kOccupied = 0.8;     ///< share of the track under the train, at most
constexpr double kMinTrack = 1.2;     ///< greater semi-axis [m]
constexpr double kCentripetal = 0.5;  ///< centripetal acceleration over gravity on a circle of the greater semi-axis
constexpr double kThrust = 0.5;       ///< the thrust of the first car in motion, over its weight

/// A closed curve about the origin that points are placed on by their distances.
class Track {
 public:
  explicit Track(OutlineCurve curve, double size) : curve_(curve), size_(size) {}

  const OutlineCurve& curve() const { return curve_; }
  Vec2 Point(double s) const { return CurvePoint(curve_, s); }
  /// Unit, in the sense of increasing s.
  Vec2 Tangent(double s) const { return Normalized(CurveDirection(curve_, s)); }

  double Perimeter() const {
    constexpr int kSamples = 2048;
    double length = 0;
    Vec2 last = Point(0);
    for (int k = 1; k <= kSamples; ++k) {
      const Vec2 p = Point(2 * kPi * k / kSamples);
      length += Norm(p - last);
      last = p;
    }
    return length;
  }

  /// The parameter of the next point ahead of s at that distance, short against the track: by the Illinois variant of
  /// the regula falsi, in plain arithmetic, to the last digits of the coordinates.
  double Ahead(double s, double distance) const {
    constexpr int kMaxSteps = 100;
    constexpr double kRounding = 4e-16;
    const Vec2 from = Point(s);
    const auto excess = [&](double t) { return Norm(Point(t) - from) - distance; };
    double low = s;
    double low_value = -distance;
    double high = s;
    double high_value = low_value;
    while (high_value < 0) {
      low = high;
      low_value = high_value;
      high += distance / size_;
      high_value = excess(high);
    }
    for (int step = 0; step < kMaxSteps; ++step) {
      const double t = low + (high - low) * (low_value / (low_value - high_value));
      const double value = excess(t);
      if (std::abs(value) <= kRounding * size_ || !(t > low && t < high)) return t;
      if (value < 0) {
        low = t;
        low_value = value;
        high_value /= 2;
      } else {
        high = t;
        high_value = value;
        low_value /= 2;
      }
    }
    return high;
  }

 private:
  OutlineCurve curve_;
  double size_;  // greater semi-axis
};

OutlineCurve OvalOf(double a, double b, bool superellipse) {
  if (superellipse) return SuperellipseEdge{{}, a, b, 4, 0, Side::kConvex};
  return EllipseEdge{{}, a, b, 0, Side::kConvex};
}

struct Coupling {
  bool rope = false;
  double distance = 0;  ///< between the joints
  double radius1 = 0;   ///< of the end of the car before it, and of the one after it
  double radius2 = 0;
};

class Train final : public SceneBuilder {
 public:
  using SceneBuilder::SceneBuilder;

  void Build() override {
    constexpr int kRowsPerCar = 3;
    const int cars = (rows_ + 1) / kRowsPerCar;
    const int missing = (rows_ + 1) % kRowsPerCar;
    double length = 2 * kRope.high;
    std::vector<double> wheelbases;
    for (int i = 0; i < cars; ++i) {
      wheelbases.push_back(random_.Uniform(kWheelbase));
      couplings_.push_back(DrawCoupling());
      length += wheelbases.back() + couplings_.back().distance;
    }
    if (missing == 1 && cars > 0) couplings_.back() = FreeEnd();
    LayTrack(length);

    s_ = random_.Uniform(0, 2 * kPi);
    // The speed of the first joint; the others follow from the distances between them.
    speed_ = random_.Sign() * std::sqrt(kCentripetal * kGravity * size_);
    Coupling before;
    before.radius2 = kEnd.low;
    for (int i = 0; i < cars; ++i) {
      Coupling& after = couplings_[static_cast<std::size_t>(i)];
      if (i == cars - 1 && missing == 0) after = FreeEnd();
      AddCar(i, wheelbases[static_cast<std::size_t>(i)], before, &after);
      before = after;
    }
    if (missing > 0) AddTrolley(before, missing == 2 && cars > 0);
  }

  void Load() override {
    Apply({.weight = kGravity, .gust = 2 * kGravity});
    LoadEnds(&system_);
  }

  void Launch(World* world) override {
    if (first_car_ < 0) return;
    const Body& car = world->bodies[static_cast<std::size_t>(first_car_)];
    // The car's x axis points along the track the way the parameter grows.
    const double sense = Dot(car.v, Direction(car.theta)) > 0 ? 1 : -1;
    world->loads.thrusters = {{{first_car_, {}}, {sense * kThrust * car.mass * kGravity, 0}}};
  }

 private:
  Coupling DrawCoupling() {
    Coupling coupling;
    coupling.rope = random_.Uniform() < 0.5;
    coupling.distance = random_.Uniform(coupling.rope ? kRope : kBuffer);
    coupling.radius1 = coupling.rope ? random_.Uniform(kEnd) : coupling.distance / 2;
    coupling.radius2 = coupling.rope ? random_.Uniform(kEnd) : coupling.distance - coupling.radius1;
    return coupling;
  }
  static Coupling FreeEnd() { return {true, 2 * kRope.high, kEnd.low, kEnd.low}; }

  void LayTrack(double length) {
    const double aspect = random_.Uniform(kAspect);
    const bool superellipse = random_.Uniform() < 0.5;
    const double perimeter = Track(OvalOf(1, aspect, superellipse), 1).Perimeter();
    size_ = std::max(kMinTrack, length / (kOccupied * perimeter));
    track_ = Track(OvalOf(size_, aspect * size_, superellipse), size_);
    track_body_ = AddFixed("track", {{track_.curve(), 0, 2 * kPi}});
  }

  /// From the joint at s_ to the one that far ahead: the speed at which their distance lasts.
  void Advance(double distance) {
    const double ahead = track_.Ahead(s_, distance);
    const Vec2 between = track_.Point(ahead) - track_.Point(s_);
    speed_ *= Dot(track_.Tangent(s_), between) / Dot(track_.Tangent(ahead), between);
    s_ = ahead;
  }

  /// A hull of two circles about its joints.
  void AddCar(int index, double wheelbase, const Coupling& before, Coupling* after) {
    const double rear = before.radius2;
    const double front = after->radius1;
    const Outline hull =
        front <= rear ? Cam(rear, front, wheelbase) : Transformed(Cam(front, rear, wheelbase), kPi, {wheelbase, 0});
    Body body = MakePlate(hull, kDensity);
    const Vec2 rear_joint = -body.x;
    const Vec2 front_joint = Vec2{wheelbase, 0} - body.x;

    const double s1 = s_;
    const Vec2 p1 = track_.Point(s1);
    const Vec2 v1 = speed_ * track_.Tangent(s1);
    Advance(wheelbase);
    const Vec2 between = track_.Point(s_) - p1;
    const Vec2 v2 = speed_ * track_.Tangent(s_);
    body.theta = AngleOf(between);
    body.omega = Cross(between, v2 - v1) / Dot(between, between);
    const Vec2 arm = Rotate(SinCos(body.theta), -rear_joint);
    body.x = p1 + arm;
    body.v = v1 + body.omega * Perp(arm);
    const int car = Add("car", body);
    if (index == 0) first_car_ = car;
    KeepOnTrack(car, rear_joint, s1);
    KeepOnTrack(car, front_joint, s_);
    if (index > 0) Couple(car, rear_joint, before);
    last_car_ = car;
    last_joint_ = front_joint;
    Advance(after->distance);
  }

  void KeepOnTrack(int body, Vec2 joint, double s) {
    Join(ConstraintType::kPathJoint, body, joint, track_body_, Piece(track_body_)).s2 = s;
  }

  void Couple(int body, Vec2 joint, const Coupling& coupling) {
    if (coupling.rope) {
      Join(ConstraintType::kRope, body, joint, last_car_, Vertex{last_joint_});
    } else {
      Touch(body, ArcEdge{joint, coupling.radius2, Side::kConvex}, last_car_,
            ArcEdge{last_joint_, coupling.radius1, Side::kConvex});
    }
  }

  void AddTrolley(const Coupling& before, bool coupled) {
    const double radius = coupled ? before.radius2 : kTrolleyRadius;
    Body body = MakeDisc(track_.Point(s_), radius, kDensity);
    body.v = speed_ * track_.Tangent(s_);
    const int trolley = Add("trolley", body);
    KeepOnTrack(trolley, {}, s_);
    if (coupled) Couple(trolley, {}, before);
  }

  Track track_{EllipseEdge{}, 1};
  double size_ = 0;
  std::vector<Coupling> couplings_;
  int track_body_ = -1;
  int first_car_ = -1;
  int last_car_ = -1;
  Vec2 last_joint_;
  double s_ = 0;
  double speed_ = 0;
};

}  // namespace

extern const SceneFamily kOvalTrain{
    "oval-train", "Train on a closed oval track, coupled by ropes and buffers",
    "Two path joints a car on an ellipse or superellipse, couplings that only pull or only push: the "
    "active set is a matter of the loads along the whole train.",
    &Make<Train>};

}  // namespace lcpbench
