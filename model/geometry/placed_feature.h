#pragma once

#include <optional>

#include "model/geometry/feature.h"
#include "model/geometry/trig.h"
#include "model/geometry/vec2.h"

namespace lcpbench {

/// A body's feature placed in the world: a body-frame point c is at x + R(theta) c.
struct PlacedFeature {
  const Feature& feature;
  Vec2 x;             ///< the body's centre of mass [m]
  Rotation rotation;  ///< SinCos(theta)
  /// Where given, pairs whose contact point depends strongly on the angle are placed by it to twice the digits.
  std::optional<double> theta = std::nullopt;
};

/// How a feature enters the curvature formulas: (r, s) = (1, kappa) for an edge of signed curvature kappa [1/m] (> 0
/// convex, 0 straight, < 0 concave), (0, 1) for a vertex. [MODEL.md section 4]
struct CurvaturePair {
  double r = 1;
  double s = 0;
  bool is_vertex() const { return r == 0; }
};

}  // namespace lcpbench
