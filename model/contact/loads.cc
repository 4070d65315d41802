#include "model/contact/loads.h"

#include <cmath>
#include <cstddef>
#include <string>

#include "support/input_error.h"

namespace lcpbench {
namespace {

void Require(bool holds, const char* force, const std::string& condition) {
  if (!holds) throw InputError(std::string(force) + ": " + condition);
}

void RequireNonNegative(double value, const char* force, const char* quantity) {
  Require(std::isfinite(value) && value >= 0, force, std::string("the ") + quantity + " must be finite and >= 0");
}

// A point of a body in the world.
struct PlacedPoint {
  std::size_t body = 0;
  Vec2 arm;       // from the centre of mass
  Vec2 position;  // world
  Vec2 velocity;
};

PlacedPoint PlaceOf(const char* force, const Attachment& at, std::span<const Body> bodies) {
  Require(at.body >= 0 && static_cast<std::size_t>(at.body) < bodies.size(), force,
          "there is no body " + std::to_string(at.body) + " among " + std::to_string(bodies.size()));
  const auto index = static_cast<std::size_t>(at.body);
  const Body& body = bodies[index];
  PlacedPoint placed;
  placed.body = index;
  placed.arm = Rotate(SinCos(body.theta), at.point);
  placed.position = body.x + placed.arm;
  placed.velocity = body.v + body.omega * Perp(placed.arm);
  Require(IsFinite(placed.position) && IsFinite(placed.velocity), force,
          "the state of " + BodyText(bodies, index) + " or its attachment is not finite");
  return placed;
}

void AddForce(const PlacedPoint& at, Vec2 force, std::span<Body> bodies) {
  Body& body = bodies[at.body];
  body.force = body.force + force;
  body.torque += Cross(at.arm, force);
}

// Two points and the line between them.
struct LineOfForce {
  PlacedPoint end1;
  PlacedPoint end2;
  Vec2 between;  // from end 1 to end 2
  double length = 0;

  double rate() const { return Dot(end2.velocity - end1.velocity, between) / length; }
  // A tension pulls the ends together.
  void Pull(double tension_per_length, std::span<Body> bodies) const {
    const Vec2 force = tension_per_length * between;
    AddForce(end1, force, bodies);
    AddForce(end2, -force, bodies);
  }
};

// @param needs_direction  a length of 0 is an error
LineOfForce MakeLine(const char* force, const Attachment& end1, const Attachment& end2, bool needs_direction,
                     std::span<const Body> bodies) {
  LineOfForce line{PlaceOf(force, end1, bodies), PlaceOf(force, end2, bodies), {}, 0};
  line.between = line.end2.position - line.end1.position;
  line.length = Norm(line.between);
  Require(std::isfinite(line.length), force, "its length overflows");
  Require(line.length > 0 || !needs_direction, force,
          "between " + BodyText(bodies, line.end1.body) + " and " + BodyText(bodies, line.end2.body) +
              " has length 0: its direction is undefined");
  return line;
}

LineOfForce PlaceSpring(const Spring& spring, std::span<const Body> bodies) {
  RequireNonNegative(spring.stiffness, "spring", "stiffness");
  RequireNonNegative(spring.rest_length, "spring", "rest length");
  return MakeLine("spring", spring.end1, spring.end2, spring.rest_length > 0, bodies);
}

LineOfForce PlaceDamper(const Damper& damper, std::span<const Body> bodies) {
  RequireNonNegative(damper.coefficient, "damper", "coefficient");
  return MakeLine("damper", damper.end1, damper.end2, true, bodies);
}

// Calls visit(i, j, from centre i to centre j, its softened length) for all pairs i < j.
template <class Visit>
void ForEachPair(const MutualAttraction& attraction, std::span<const Body> bodies, const Visit& visit) {
  constexpr const char* kName = "mutual attraction";
  Require(std::isfinite(attraction.strength), kName, "the strength must be finite");
  RequireNonNegative(attraction.softening, kName, "softening length");
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    for (std::size_t j = i + 1; j < bodies.size(); ++j) {
      const Vec2 between = bodies[j].x - bodies[i].x;
      const double distance = std::sqrt(Dot(between, between) + attraction.softening * attraction.softening);
      Require(distance > 0 && std::isfinite(distance), kName,
              "the centres of " + BodyText(bodies, i) + " and " + BodyText(bodies, j) + " coincide or are not finite");
      visit(i, j, between, distance);
    }
  }
}

template <class Bodies, class Visit>
void ForEachMovable(Bodies bodies, const Visit& visit) {
  for (auto& body : bodies) {
    if (!body.fixed) visit(body);
  }
}

void ApplyGravity(Vec2 g, std::span<Body> bodies) {
  Require(IsFinite(g), "gravity", "the acceleration must be finite");
  ForEachMovable(bodies, [&](Body& b) { b.force = b.force + b.mass * g; });
}

void ApplyThruster(const Thruster& thruster, std::span<Body> bodies) {
  constexpr const char* kName = "thruster";
  Require(IsFinite(thruster.force), kName, "the force must be finite");
  const PlacedPoint at = PlaceOf(kName, thruster.at, bodies);
  AddForce(at, Rotate(SinCos(bodies[at.body].theta), thruster.force), bodies);
}

void ApplyWrench(const Wrench& wrench, std::span<Body> bodies) {
  constexpr const char* kName = "wrench";
  Require(IsFinite(wrench.force) && std::isfinite(wrench.torque), kName, "force and torque must be finite");
  const PlacedPoint at = PlaceOf(kName, wrench.at, bodies);
  AddForce(at, wrench.force, bodies);
  bodies[at.body].torque += wrench.torque;
}

}  // namespace

void ClearLoads(std::span<Body> bodies) {
  for (Body& body : bodies) {
    body.force = {};
    body.torque = 0;
  }
}

void ApplySpring(const Spring& spring, std::span<Body> bodies) {
  const LineOfForce line = PlaceSpring(spring, bodies);
  const double stretch_per_length = spring.rest_length == 0 ? 1 : (line.length - spring.rest_length) / line.length;
  line.Pull(spring.stiffness * stretch_per_length, bodies);
}

void ApplyDamper(const Damper& damper, std::span<Body> bodies) {
  const LineOfForce line = PlaceDamper(damper, bodies);
  line.Pull(damper.coefficient * line.rate() / line.length, bodies);
}

void ApplyMutualAttraction(const MutualAttraction& attraction, std::span<Body> bodies) {
  ForEachPair(attraction, bodies, [&](std::size_t i, std::size_t j, Vec2 between, double distance) {
    const double per_length = attraction.strength * bodies[i].mass * bodies[j].mass / (distance * distance * distance);
    const Vec2 force = per_length * between;
    bodies[i].force = bodies[i].force + force;
    bodies[j].force = bodies[j].force - force;
  });
}

void SetLoads(const Loads& loads, std::span<Body> bodies) {
  ClearLoads(bodies);
  ApplyGravity(loads.gravity, bodies);
  for (const Spring& spring : loads.springs) ApplySpring(spring, bodies);
  for (const Damper& damper : loads.dampers) ApplyDamper(damper, bodies);
  for (const Thruster& thruster : loads.thrusters) ApplyThruster(thruster, bodies);
  for (const Wrench& wrench : loads.wrenches) ApplyWrench(wrench, bodies);
  if (loads.attraction) ApplyMutualAttraction(*loads.attraction, bodies);
}

double PotentialEnergy(const Loads& loads, std::span<const Body> bodies) {
  double energy = 0;
  ForEachMovable(bodies, [&](const Body& b) { energy -= b.mass * Dot(loads.gravity, b.x); });
  for (const Spring& spring : loads.springs) {
    const double stretch = PlaceSpring(spring, bodies).length - spring.rest_length;
    energy += spring.stiffness * stretch * stretch / 2;
  }
  for (const Wrench& wrench : loads.wrenches) {
    const Body& body = bodies[static_cast<std::size_t>(wrench.at.body)];
    if (body.fixed) continue;
    const Vec2 p = WorldPoint(body, wrench.at.point);
    energy -= Dot(wrench.force, p) + wrench.torque * body.theta;
  }
  double of_attraction = 0;
  if (loads.attraction) {
    ForEachPair(*loads.attraction, bodies, [&](std::size_t i, std::size_t j, Vec2 /*between*/, double distance) {
      of_attraction -= loads.attraction->strength * bodies[i].mass * bodies[j].mass / distance;
    });
  }
  energy += of_attraction;
  return energy;
}

double KineticEnergy(std::span<const Body> bodies) {
  double twice = 0;
  ForEachMovable(bodies, [&](const Body& b) { twice += b.mass * Dot(b.v, b.v) + b.inertia * b.omega * b.omega; });
  return twice / 2;
}

}  // namespace lcpbench
