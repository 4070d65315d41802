#pragma once

#include "model/geometry/vec2.h"

namespace lcpbench {

/// The angle of a direction, counter-clockwise from the x axis, in (-pi, pi] [rad]: atan2(y, x) correctly rounded to
/// nearest by MPFR [Fousse et al. 2007], hence the same bits on every machine, which std::atan2 does not promise. A few
/// microseconds: for building shapes, not for inner loops.
/// @param direction  any length > 0; (0, 0) gives 0, a number that is not finite may give NaN
double AngleOf(Vec2 direction);

}  // namespace lcpbench
