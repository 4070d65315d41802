// oval-train: a train on a closed oval track, its cars kept on it by two path joints each.
//
// Path joints (a point of a body on an ellipse or superellipse of another) are the bilateral rows, and couplings the
// unilateral ones: at random, ropes that only pull and round buffers that only push. Braking and pulling parts of the
// train thus alternate, and the active set is a matter of all loads along it. A's Schur complement in the path joints
// is tridiagonal. The track's curvature enters gamma with the square of the speed, and near the flat sides of a
// superellipse it vanishes. J has full rank (Jacobi-scaled condition number of A 2e3 at 200 rows, 5e4 at 1000).
//
// Rows with w > 0 at the solution, of the unilateral rows, seeds 1 to 5: 67 % at 10 rows, 42-67 % at 100, 45-52 % at
// 1000, 49-52 % at 3000.
//
// k cars make 3 k - 1 rows; what is missing is closed by a trolley with a single path joint (one row), coupled to the
// last car (two rows).
//
// In motion: the track stands upright in gravity, and the first car drives the train with a constant thrust.

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "model/geometry/feature.h"
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
constexpr double kMinWheelbase = 0.3;  ///< between the path joints of a car [m]
constexpr double kMaxWheelbase = 0.5;
constexpr double kMinBuffer = 0.16;  ///< between the path joints of two cars, buffers touching [m]
constexpr double kMaxBuffer = 0.2;
constexpr double kMinRope = 0.26;  ///< the same at a rope: its length [m]
constexpr double kMaxRope = 0.32;
constexpr double kMinEnd = 0.08;  ///< radius of a car's end without buffer [m]
constexpr double kMaxEnd = 0.1;
constexpr double kTrolleyRadius = 0.08;
constexpr double kMinAspect = 0.5;  ///< of the track's semi-axes
constexpr double kMaxAspect = 0.8;
constexpr double kOccupied = 0.8;  ///< share of the track under the train, at most
constexpr double kMinTrack = 1.2;  ///< greater semi-axis [m]
/// Centripetal acceleration over gravity on a circle of the greater semi-axis.
constexpr double kCentripetal = 0.5;
/// The thrust of the first car in motion, over its weight.
constexpr double kThrust = 0.5;

/// A closed curve about the origin that points are placed on by their distances.
class Track {
 public:
  explicit Track(OutlineCurve curve, double size) : curve_(curve), size_(size) {}

  const OutlineCurve& curve() const { return curve_; }
  Vec2 Point(double s) const { return CurvePoint(curve_, s); }
  /// Unit, in the sense of increasing s.
  Vec2 Tangent(double s) const {
    const Vec2 direction = CurveDirection(curve_, s);
    return (1 / Norm(direction)) * direction;
  }

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

OutlineCurve Oval(double a, double b, bool superellipse) {
  if (superellipse) return SuperellipseEdge{{}, a, b, 4, 0, Side::kConvex};
  return EllipseEdge{{}, a, b, 0, Side::kConvex};
}

struct Coupling {
  bool rope = false;
  double distance = 0;  ///< between the joints
  double radius1 = 0;   ///< of the end of the car before it, and of the one after it
  double radius2 = 0;
};

class Train {
 public:
  Train(ContactSystem* system, int rows, Random* random) : system_(system), random_(random), track_(EllipseEdge{}, 1) {
    constexpr int kRowsPerCar = 3;
    const int cars = (rows + 1) / kRowsPerCar;
    const int missing = (rows + 1) % kRowsPerCar;
    double length = 2 * kMaxRope;
    std::vector<double> wheelbases;
    for (int i = 0; i < cars; ++i) {
      wheelbases.push_back(random->Uniform(kMinWheelbase, kMaxWheelbase));
      couplings_.push_back(DrawCoupling());
      length += wheelbases.back() + couplings_.back().distance;
    }
    if (missing == 1 && cars > 0) couplings_.back() = FreeEnd();
    LayTrack(length);

    s_ = random->Uniform(0, 2 * kPi);
    // The speed of the first joint; the others follow from the distances between them.
    speed_ = random->Sign() * std::sqrt(kCentripetal * kGravity * size_);
    Coupling before;
    before.radius2 = kMinEnd;
    for (int i = 0; i < cars; ++i) {
      Coupling& after = couplings_[static_cast<std::size_t>(i)];
      if (i == cars - 1 && missing == 0) after = FreeEnd();
      AddCar(i, wheelbases[static_cast<std::size_t>(i)], before, &after);
      before = after;
    }
    if (missing > 0) AddTrolley(before, missing == 2 && cars > 0);
  }

  int first_car() const { return first_car_; }

 private:
  Body& Get(int body) { return system_->bodies[static_cast<std::size_t>(body)]; }

  Coupling DrawCoupling() {
    Coupling coupling;
    coupling.rope = random_->Uniform() < 0.5;
    coupling.distance = coupling.rope ? random_->Uniform(kMinRope, kMaxRope) : random_->Uniform(kMinBuffer, kMaxBuffer);
    coupling.radius1 = coupling.rope ? random_->Uniform(kMinEnd, kMaxEnd) : coupling.distance / 2;
    coupling.radius2 = coupling.rope ? random_->Uniform(kMinEnd, kMaxEnd) : coupling.distance - coupling.radius1;
    return coupling;
  }
  static Coupling FreeEnd() { return {true, 2 * kMaxRope, kMinEnd, kMinEnd}; }

  void LayTrack(double length) {
    const double aspect = random_->Uniform(kMinAspect, kMaxAspect);
    const bool superellipse = random_->Uniform() < 0.5;
    const double perimeter = Track(Oval(1, aspect, superellipse), 1).Perimeter();
    size_ = std::max(kMinTrack, length / (kOccupied * perimeter));
    track_ = Track(Oval(size_, aspect * size_, superellipse), size_);
    Body body = MakeFixed("track");
    body.outline = {{track_.curve(), 0, 2 * kPi}};
    track_body_ = AddBody(system_, "track", body);
  }

  Feature TrackFeature() const {
    return std::visit([](const auto& edge) -> Feature { return edge; }, track_.curve());
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
    Body body = MakeBody(hull, kDensity);
    body.name.clear();
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
    const int car = AddBody(system_, "car", body);
    if (index == 0) first_car_ = car;
    AddPathJoint(system_, car, rear_joint, track_body_, TrackFeature(), s1);
    AddPathJoint(system_, car, front_joint, track_body_, TrackFeature(), s_);
    if (index > 0) Couple(car, rear_joint, before);
    last_car_ = car;
    last_joint_ = front_joint;
    Advance(after->distance);
  }

  void Couple(int body, Vec2 joint, const Coupling& coupling) {
    if (coupling.rope) {
      AddRope(system_, body, joint, last_car_, last_joint_);
    } else {
      AddContact(system_, body, ArcEdge{joint, coupling.radius2, Side::kConvex}, last_car_,
                 ArcEdge{last_joint_, coupling.radius1, Side::kConvex});
    }
  }

  void AddTrolley(const Coupling& before, bool coupled) {
    const double radius = coupled ? before.radius2 : kTrolleyRadius;
    Body body = MakeDisc(track_.Point(s_), radius, kDensity);
    body.v = speed_ * track_.Tangent(s_);
    const int trolley = AddBody(system_, "trolley", body);
    AddPathJoint(system_, trolley, {}, track_body_, TrackFeature(), s_);
    if (coupled) Couple(trolley, {}, before);
  }

  ContactSystem* system_;
  Random* random_;
  Track track_;
  double size_ = 0;
  std::vector<Coupling> couplings_;
  int track_body_ = -1;
  int first_car_ = -1;
  int last_car_ = -1;
  Vec2 last_joint_;
  double s_ = 0;
  double speed_ = 0;
};

ContactSystem Generate(int rows, std::uint64_t seed) {
  Random random(seed);
  ContactSystem system = EmptyScene("oval-train", rows, seed);
  const Train train(&system, rows, &random);
  ApplyLoads(&system, {.weight = kGravity, .gust = 2 * kGravity}, &random);
  LoadEnds(&system);
  return system;
}

World Start(int rows, std::uint64_t seed) {
  Random random(seed);
  ContactSystem system = EmptyScene("oval-train", rows, seed);
  const Train train(&system, rows, &random);
  Loads loads;
  loads.gravity = {0, -kGravity};
  if (train.first_car() >= 0) {
    const Body& car = system.bodies[static_cast<std::size_t>(train.first_car())];
    // The car's x axis points along the track the way the parameter grows.
    const double sense = Dot(car.v, Rotate(SinCos(car.theta), {1, 0})) > 0 ? 1 : -1;
    loads.thrusters = {{{train.first_car(), {}}, {sense * kThrust * car.mass * kGravity, 0}}};
  }
  return SetInMotion(std::move(system), std::move(loads));
}

}  // namespace

extern const SceneFamily kOvalTrain{
    "oval-train",
    "Train on a closed oval track, coupled by ropes and buffers",
    "Two path joints a car on an ellipse or superellipse, couplings that only pull or only push: the "
    "active set is a matter of the loads along the whole train.",
    &Generate,
    &Start,
    MotionLevel::kVelocity,
    1e-3};

}  // namespace lcpbench
