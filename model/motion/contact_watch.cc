#include "model/motion/contact_watch.h"

#include <algorithm>
#include <cmath>
#include <variant>

#include "model/contact/contact_row.h"
#include "model/detection/detection.h"
#include "model/motion/motion.h"

namespace lcpbench {
namespace {

const Body& At(std::span<const Body> bodies, int index) { return bodies[static_cast<std::size_t>(index)]; }

bool IsSame(const TouchingConstraint& p, const TouchingConstraint& q) {
  constexpr double kSamePlace = 1e-7;
  constexpr double kApart = 1e-3;
  const auto& [a, at_a] = p;
  const auto& [b, at_b] = q;
  if (a.body1 != b.body1 || a.body2 != b.body2 || a.type != b.type) return false;
  const double arms = Norm(at_a.R1) + Norm(at_a.R2);
  const double apart = std::max(Norm(at_a.R1 - at_b.R1), Norm(at_a.R2 - at_b.R2));
  const bool same_features = a.feature1 == b.feature1 && a.feature2 == b.feature2;
  if (same_features) return (!a.s1 && !a.s2) || apart <= kApart * arms;
  return apart <= kSamePlace * arms && Norm(at_a.n - at_b.n) <= kSamePlace;
}

TouchPoint EvaluateRope(const Constraint& rope, std::span<const Body> bodies) {
  const Body& body1 = At(bodies, rope.body1);
  const Body& body2 = At(bodies, rope.body2);
  const Vec2 vertex1 = std::get<Vertex>(rope.feature1).p;
  const Vec2 vertex2 = std::get<Vertex>(rope.feature2).p;
  const Rotation rotation1 = SinCos(body1.theta);
  const Rotation rotation2 = SinCos(body2.theta);
  if (HasNoDirection(rope, bodies)) {
    // From no distance at all the ends can only part, in the direction of their velocity.
    const Vec2 R1 = Rotate(rotation1, vertex1);
    const Vec2 R2 = Rotate(rotation2, vertex2);
    return {{}, R1, R2, rope.length, -Norm((body1.v - body2.v) + (body1.omega * Perp(R1) - body2.omega * Perp(R2)))};
  }
  const auto [points, row] = ComputeConnectorRow(vertex1, rotation1, body1, vertex2, rotation2, body2, rope.length);
  return {-points.n, points.R1, points.R2, rope.length - points.d, -row.d_dot};
}

}  // namespace

bool IsKnown(const TouchingConstraint& contact, const std::vector<TouchingConstraint>& known) {
  return std::any_of(known.begin(), known.end(),
                     [&contact](const TouchingConstraint& other) { return IsSame(contact, other); });
}

ContactWatch::ContactWatch(const World& world, const ContactFinder& finder)
    : finder_(finder), extents_(finder.extents()) {
  for (const Body& body : world.bodies) spans_.push_back(NormalSpans(OutlineOf(body), Rotation{}));
  constexpr double kThinnestPart = 0.25;
  constexpr double kLeastTolerances = 10;
  // Without outlines there is nothing to find, but a rope.
  const double thinnest = finder.least_width();
  if (thinnest > 0) range_ = std::max(kThinnestPart * thinnest, kLeastTolerances * kContactTolerance);
  flush_angle_ = kContactTolerance / range_;
  const auto reach = [this](int body, const Feature& feature) {
    double& radius = extents_[static_cast<std::size_t>(body)].radius;
    if (const auto* end = std::get_if<Vertex>(&feature)) radius = std::max(radius, Norm(end->p));
  };
  for (const Constraint& joint : world.joints) {
    if (joint.type != ConstraintType::kRope) continue;
    ropes_.push_back(joint);
    reach(joint.body1, joint.feature1);
    reach(joint.body2, joint.feature2);
  }
}

TouchPoint ContactWatch::Evaluate(std::span<const Body> bodies, Constraint* constraint) {
  if (constraint->type == ConstraintType::kRope) return EvaluateRope(*constraint, bodies);
  const ClosestPoints closest = FindClosestPoints(*constraint, bodies);
  if (constraint->s1) constraint->s1 = closest.s1;
  if (constraint->s2) constraint->s2 = closest.s2;
  constraint->nominal_gap = closest.d;
  const ContactRow row = ComputeContactRow(closest, At(bodies, constraint->body1), At(bodies, constraint->body2));
  return {closest.n, closest.R1, closest.R2, closest.d, row.d_dot};
}

bool ContactWatch::LiesOn(std::span<const Body> bodies, const Constraint& constraint, const TouchPoint& touch) const {
  if (constraint.type == ConstraintType::kRope) return true;
  const auto on = [&](int index, const Feature& feature, Vec2 arm, Vec2 outward) {
    const Rotation turn = SinCos(At(bodies, index).theta);
    const Vec2 local_arm = RotateBack(turn, arm);
    const Vec2 local_normal = RotateBack(turn, outward);
    const std::vector<NormalSpan>& spans = spans_[static_cast<std::size_t>(index)];
    return std::any_of(spans.begin(), spans.end(), [&](const NormalSpan& span) {
      if (!(span.feature == feature)) return false;
      if (span.kind == NormalSpan::Kind::kVertex) return span.cone.Contains(local_normal, flush_angle_);
      return span.Holds(local_arm, local_normal);
    });
  };
  return on(constraint.body1, constraint.feature1, touch.R1, -touch.n) &&
         on(constraint.body2, constraint.feature2, touch.R2, touch.n);
}

std::vector<Constraint> ContactWatch::Find(std::span<const Body> bodies) const {
  std::vector<Constraint> found;
  if (finder_.least_width() > 0) found = finder_.Find(bodies, range_, range_);
  for (Constraint rope : ropes_) {
    if (std::abs(Evaluate(bodies, &rope).d) <= range_) found.push_back(rope);
  }
  return found;
}

double ContactWatch::LongestStep(std::span<const Body> bodies, std::span<const double> accelerations, double stride,
                                 double step) const {
  const std::size_t count = bodies.size();
  std::vector<double> speed(count);
  std::vector<double> gain(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double r = extents_[i].radius;
    speed[i] = Norm(bodies[i].v) + r * std::abs(bodies[i].omega);
    gain[i] = Norm({accelerations[3 * i], accelerations[3 * i + 1]}) + r * std::abs(accelerations[3 * i + 2]);
  }
  const auto shorten = [&](std::size_t i, std::size_t j, double room) {
    const double v = speed[i] + speed[j];
    const double a = gain[i] + gain[j];
    // The root of v t + a t^2 / 2 = room.
    if (v * step + a * step * step / 2 > room) step = 2 * room / (v + std::sqrt(v * v + 2 * a * room));
  };
  for (std::size_t i = 0; i < count; ++i) {
    if (spans_[i].empty()) continue;
    for (std::size_t j = i + 1; j < count; ++j) {
      if (spans_[j].empty() || (bodies[i].fixed && bodies[j].fixed)) continue;
      if (finder_.AreJoined(static_cast<int>(i), static_cast<int>(j))) continue;
      const double clearance = Norm(bodies[i].x - bodies[j].x) - extents_[i].radius - extents_[j].radius;
      shorten(i, j, std::max(stride, clearance));
    }
  }
  for (const Constraint& rope : ropes_) {
    shorten(static_cast<std::size_t>(rope.body1), static_cast<std::size_t>(rope.body2), stride);
  }
  return step;
}

}  // namespace lcpbench
