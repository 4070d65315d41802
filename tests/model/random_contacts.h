#pragma once

#include <cmath>
#include <ostream>
#include <random>
#include <string>
#include <variant>
#include <vector>

#include "model/body.h"
#include "model/closest_points.h"
#include "model/feature.h"
#include "model/system.h"
#include "model/trig.h"

namespace lcpbench::testing {

/// What touches what: body 1's feature, then body 2's; `swapped` exchanges the bodies, so that every kind is met with
/// either body owning the normal.
enum class Shape { kVertex, kStraight, kConvexArc, kConcaveArc };

struct PairKind {
  const char* name;
  Shape shape1;
  Shape shape2;
};

inline const std::vector<PairKind>& AllPairKinds() {
  static const std::vector<PairKind> kinds = {
      {"VertexOnStraight", Shape::kVertex, Shape::kStraight},
      {"VertexOnConvexArc", Shape::kVertex, Shape::kConvexArc},
      {"VertexOnConcaveArc", Shape::kVertex, Shape::kConcaveArc},
      {"ConvexArcOnStraight", Shape::kConvexArc, Shape::kStraight},
      {"ConvexArcOnConvexArc", Shape::kConvexArc, Shape::kConvexArc},
      {"ConvexArcInConcaveArc", Shape::kConvexArc, Shape::kConcaveArc},
      {"StraightOnVertex", Shape::kStraight, Shape::kVertex},
      {"ConvexArcOnVertex", Shape::kConvexArc, Shape::kVertex},
      {"ConcaveArcOnVertex", Shape::kConcaveArc, Shape::kVertex},
      {"StraightOnConvexArc", Shape::kStraight, Shape::kConvexArc},
      {"ConcaveArcAroundConvexArc", Shape::kConcaveArc, Shape::kConvexArc},
  };
  return kinds;
}

inline std::ostream& operator<<(std::ostream& out, const PairKind& kind) { return out << kind.name; }

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double Uniform(double low, double high) { return low + (high - low) * (static_cast<double>(engine_()) / 0x1p32); }
  Vec2 Vector(double size) { return {Uniform(-size, size), Uniform(-size, size)}; }

 private:
  std::mt19937 engine_;
};

/// A pair of bodies whose features have gap d at a known place, with random velocities.
struct ContactCase {
  Body body1;
  Body body2;
  Feature feature1;
  Feature feature2;
  // As constructed, in the world frame.
  Vec2 n;
  Vec2 p1;
  Vec2 p2;
  double d = 0;

  ClosestPoints Closest(Regularity required = Regularity::kLocalMinimum) const {
    return FindClosestPoints({feature1, body1.x, SinCos(body1.theta)}, {feature2, body2.x, SinCos(body2.theta)}, {},
                             required);
  }
};

inline Body RandomBody(Random* random) {
  Body body;
  body.mass = random->Uniform(0.5, 5);
  body.inertia = random->Uniform(0.5, 5);
  body.x = random->Vector(3);
  body.theta = random->Uniform(-7, 7);
  body.v = random->Vector(2);
  body.omega = random->Uniform(-3, 3);
  body.force = random->Vector(5);
  body.torque = random->Uniform(-4, 4);
  return body;
}

inline Vec2 ToBody(const Body& body, Vec2 world) {
  const Rotation r = SinCos(body.theta);
  return Rotate({r.cos, -r.sin}, world - body.x);
}

inline Vec2 ToWorld(const Body& body, Vec2 c) { return body.x + Rotate(SinCos(body.theta), c); }

/// The feature of `body` that passes through the world point p with outward normal N.
inline Feature FeatureThrough(Shape shape, const Body& body, Vec2 p, Vec2 N, double radius, Random* random) {
  switch (shape) {
    case Shape::kVertex:
      break;
    case Shape::kStraight: {
      const Vec2 along = Perp(N);  // material on the left: N is on the right-hand side of `along`
      const Vec2 a = p - random->Uniform(0.2, 2) * along;
      const Vec2 b = p + random->Uniform(0.2, 2) * along;
      return StraightEdge{ToBody(body, a), ToBody(body, b)};
    }
    case Shape::kConvexArc:
      return ArcEdge{ToBody(body, p - radius * N), radius, Side::kConvex};
    case Shape::kConcaveArc:
      return ArcEdge{ToBody(body, p + radius * N), radius, Side::kConcave};
  }
  return Vertex{ToBody(body, p)};
}

/// @param d  the gap; every third case is drawn with d = 0 by RandomContact(kind, random)
inline ContactCase RandomContact(const PairKind& kind, double d, Random* random) {
  ContactCase c;
  c.body1 = RandomBody(random);
  c.body2 = RandomBody(random);
  const double angle = random->Uniform(-3.2, 3.2);
  const Rotation r = SinCos(angle);
  c.n = {r.cos, r.sin};
  c.d = d;
  c.p2 = random->Vector(3);
  c.p1 = c.p2 + d * c.n;
  // Within a concave arc the convex one must be smaller, by a margin that keeps D away from 0.
  const auto radius = [&](Shape shape) {
    return shape == Shape::kConcaveArc ? random->Uniform(1.5, 4) : random->Uniform(0.3, 1.2);
  };
  c.feature1 = FeatureThrough(kind.shape1, c.body1, c.p1, -c.n, radius(kind.shape1), random);
  c.feature2 = FeatureThrough(kind.shape2, c.body2, c.p2, c.n, radius(kind.shape2), random);
  return c;
}

inline ContactCase RandomContact(const PairKind& kind, Random* random) {
  const double choice = random->Uniform(0, 3);
  return RandomContact(kind, choice < 1 ? 0 : random->Uniform(-0.15, 0.15), random);
}

inline ContactSystem SystemOf(const ContactCase& c, ConstraintType type = ConstraintType::kContact) {
  Constraint constraint;
  constraint.type = type;
  constraint.feature1 = c.feature1;
  constraint.feature2 = c.feature2;
  return {"pair", {c.body1, c.body2}, {constraint}};
}

/// Signed radius: 0 for a vertex.
inline double SignedRadius(const Feature& feature) {
  if (const auto* arc = std::get_if<ArcEdge>(&feature)) return arc->side == Side::kConvex ? arc->radius : -arc->radius;
  return 0;
}

/// The vertex or the arc's centre, in the body frame.
inline Vec2 Center(const Feature& feature) {
  if (const auto* arc = std::get_if<ArcEdge>(&feature)) return arc->center;
  return std::get<Vertex>(feature).p;
}

inline bool IsStraight(const Feature& feature) { return std::holds_alternative<StraightEdge>(feature); }

}  // namespace lcpbench::testing
