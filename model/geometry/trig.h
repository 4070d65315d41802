#pragma once

#include "model/geometry/vec2.h"

namespace lcpbench {

/// A rotation of the plane by an angle, as its cosine and sine.
struct Rotation {
  double cos = 1;
  double sin = 0;
};

/// cos(theta) and sin(theta), theta [rad] finite, each correctly rounded to nearest: the same bits on every machine and
/// with every mathematics library, which std::sin does not promise. Exact for theta = 0. About 0.1 microseconds; MPFR
/// [Fousse et al. 2007] decides the rare cases in which the fast evaluation cannot.
/// @return NaN, NaN for an angle that is not finite
Rotation SinCos(double theta);

/// cos(theta) and sin(theta) as sums of two doubles, to about 32 digits; `high` is SinCos(theta). MPFR always: about 10
/// microseconds.
struct RotationParts {
  Rotation high;
  Rotation low;
};
RotationParts SinCosParts(double theta);

/// R(theta) a.
constexpr Vec2 Rotate(Rotation r, Vec2 a) { return {r.cos * a.x - r.sin * a.y, r.sin * a.x + r.cos * a.y}; }

/// The angle of a direction, counter-clockwise from the x axis, in (-pi, pi] [rad]: atan2(y, x) correctly rounded to
/// nearest by MPFR, hence the same bits on every machine, which std::atan2 does not promise. A few microseconds: for
/// building shapes, not for inner loops.
/// @param direction  any length > 0; (0, 0) gives 0, a number that is not finite may give NaN
double AngleOf(Vec2 direction);

}  // namespace lcpbench
