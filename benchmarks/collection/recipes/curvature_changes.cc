#include "benchmarks/collection/recipes/curvature_changes.h"

#include <cmath>
#include <string>
#include <variant>

#include "benchmarks/collection/recipes/portable_power.h"
#include "model/contact/assembly.h"
#include "model/geometry/trig.h"
#include "model/scenes/random.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

Vec2 ScaledAbout(Vec2 fixed, Vec2 point, double factor) { return fixed + factor * (point - fixed); }

// The edge scaled about a point of the body frame; vertices and straight edges stay themselves.
void Scale(Vec2 fixed, double factor, Feature* feature) {
  if (auto* arc = std::get_if<ArcEdge>(feature)) {
    arc->center = ScaledAbout(fixed, arc->center, factor);
    arc->radius *= factor;
  } else if (auto* ellipse = std::get_if<EllipseEdge>(feature)) {
    ellipse->center = ScaledAbout(fixed, ellipse->center, factor);
    ellipse->a *= factor;
    ellipse->b *= factor;
  } else if (auto* oval = std::get_if<SuperellipseEdge>(feature)) {
    oval->center = ScaledAbout(fixed, oval->center, factor);
    oval->a *= factor;
    oval->b *= factor;
  }
}

bool IsConvexCurve(const Feature& feature) {
  if (const auto* arc = std::get_if<ArcEdge>(&feature)) return arc->side == Side::kConvex;
  if (const auto* ellipse = std::get_if<EllipseEdge>(&feature)) return ellipse->side == Side::kConvex;
  if (const auto* oval = std::get_if<SuperellipseEdge>(&feature)) return oval->side == Side::kConvex;
  return false;
}

Vec2 InBodyFrame(const Body& body, Vec2 world) {
  const Rotation rotation = SinCos(body.theta);
  const Vec2 d = world - body.x;
  return {rotation.cos * d.x + rotation.sin * d.y, -rotation.sin * d.x + rotation.cos * d.y};
}

}  // namespace

void ContrastCurvature(ContactSystem* system, double contrast, std::uint64_t seed) {
  if (!(contrast >= 1 && std::isfinite(contrast))) {
    throw InputError("expected a contrast >= 1, found " + std::to_string(contrast));
  }
  const AssembledLcp assembled = AssembleContactLcp(*system);
  Random random(seed);
  for (const RowInfo& row : assembled.rows) {
    Constraint& constraint = system->constraints[static_cast<size_t>(row.constraint)];
    if (constraint.type != ConstraintType::kContact) continue;
    const auto shrink = [&](int body, Vec2 point, Feature* feature) {
      if (!IsConvexCurve(*feature)) return;
      const double factor = 1 / PortablePower(contrast, random.Uniform());
      Scale(InBodyFrame(system->bodies[static_cast<size_t>(body)], point), factor, feature);
    };
    shrink(constraint.body1, row.p1, &constraint.feature1);
    shrink(constraint.body2, row.p2, &constraint.feature2);
  }
}

void MakeConformal(ContactSystem* system, double clearance) {
  if (!(clearance > 0 && clearance < 1)) {
    throw InputError("expected a clearance in (0, 1), found " + std::to_string(clearance));
  }
  const AssembledLcp assembled = AssembleContactLcp(*system);
  bool any = false;
  for (const RowInfo& row : assembled.rows) {
    Constraint& constraint = system->constraints[static_cast<size_t>(row.constraint)];
    if (constraint.type != ConstraintType::kContact) continue;
    const auto fit = [&](int body, Vec2 point, Feature* feature, const Feature& other) {
      const auto* inner = std::get_if<ArcEdge>(feature);
      const auto* outer = std::get_if<ArcEdge>(&other);
      if (inner == nullptr || outer == nullptr) return;
      if (inner->side != Side::kConvex || outer->side != Side::kConcave) return;
      any = true;
      Scale(InBodyFrame(system->bodies[static_cast<size_t>(body)], point),
            (1 - clearance) * outer->radius / inner->radius, feature);
    };
    fit(constraint.body1, row.p1, &constraint.feature1, constraint.feature2);
    fit(constraint.body2, row.p2, &constraint.feature2, constraint.feature1);
  }
  if (!any) throw InputError("expected a convex arc in a concave one, found none in '" + system->name + "'");
}

}  // namespace lcpbench
