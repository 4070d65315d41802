// disc-track: a chain of touching discs that slides along the inside of a circular track.

#include <cmath>
#include <vector>

#include "model/scenes/scene_builder.h"

namespace lcpbench {
namespace {

constexpr Range kRadius{0.06, 0.14};
constexpr double kDensity = 40;
constexpr double kSpan = 4.2;         ///< the part of the track that the chain covers [rad]
constexpr double kCentripetal = 0.5;  ///< centripetal acceleration over gravity
/// In-plane gravity in motion over gravity: a plane so flat that a disc which passes the bottom with that acceleration
/// stays on the track over the top, where v^2 = (kCentripetal - 4 kPlane) g R must be at least kPlane g R.
constexpr double kPlane = kCentripetal / 5;
constexpr double kMaxSpin = 8;  ///< largest spin [rad/s]

/// A disc with a cylindrical insert of radius r / 3 and random density at distance r / 2 from its centre.
Body MakeEccentricDisc(Vec2 center, double r, Vec2 center_velocity, Random* random) {
  const double insert = r / 3;
  const double plain_mass = kPi * r * r * kDensity;
  const double insert_mass = kPi * insert * insert * kDensity * random->Uniform(1, 12);
  const double mass = plain_mass + insert_mass;
  const Vec2 direction = random->UnitVector();
  const double offset = r / 2 * insert_mass / mass;
  const double insert_offset = r / 2 - offset;

  Body body;
  body.mass = mass;
  body.inertia =
      plain_mass * (r * r / 2 + offset * offset) + insert_mass * (insert * insert / 2 + insert_offset * insert_offset);
  body.x = center + offset * direction;
  body.omega = random->Uniform(-kMaxSpin, kMaxSpin);
  body.v = center_velocity + (body.omega * offset) * Perp(direction);
  body.outline = {FullCircle(-offset * direction, r, Side::kConvex)};
  return body;
}

class Track final : public SceneBuilder {
 public:
  using SceneBuilder::SceneBuilder;

  void Build() override {
    const int chain = (rows_ + 1) / 2;
    const bool straggler = rows_ % 2 == 0;

    std::vector<double> radii;
    double length = 0;
    for (int i = 0; i < chain; ++i) {
      radii.push_back(random_.Uniform(kRadius));
      length += 2 * radii.back();
    }
    const double track = length / kSpan + 3 * kRadius.high;
    const double turning = random_.Sign() * std::sqrt(kCentripetal * kGravity / track);
    const int track_body = AddFixed("track", {FullCircle({}, track, Side::kConcave)});

    Vec2 direction = RandomDirection();
    const auto add = [&](double r) {
      const Vec2 center = (track - r) * direction;
      const int body = Add("disc", MakeEccentricDisc(center, r, turning * Perp(center), &random_));
      Touch(body, track_body);
      return body;
    };

    for (int i = 0; i < chain; ++i) {
      const double r = radii[static_cast<std::size_t>(i)];
      if (i > 0) direction = NextAlongArc(direction, radii[static_cast<std::size_t>(i) - 1], r, track);
      const int body = add(r);
      if (i > 0) Touch(body, body - 1);
    }
    if (straggler) {
      // Leaves the place of one disc free behind the chain.
      direction = NextAlongArc(direction, radii.back(), kRadius.low, track);
      direction = NextAlongArc(direction, kRadius.low, kRadius.low, track);
      add(kRadius.low);
    }
  }

  void Load() override { Apply({.weight = kGravity, .gust = 2 * kGravity}); }

  void Launch(World* world) override { world->loads.gravity = {0, -kPlane * kGravity}; }
};

}  // namespace

extern const SceneFamily kDiscTrack{
    "disc-track",
    "Chain of spinning discs sliding inside a concave track",
    "Convex arcs in a concave one with centripetal terms; A is nonsingular and narrowly banded, which tells "
    "methods that use sparsity from those that fill a dense matrix.",
    &Make<Track>,
    MotionLevel::kAcceleration,
    1e-2};

}  // namespace lcpbench
