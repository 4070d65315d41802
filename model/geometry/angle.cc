#include "model/geometry/angle.h"

#include <mpfr.h>

#include <limits>

namespace lcpbench {

double AngleOf(Vec2 direction) {
  mpfr_t x;
  mpfr_t y;
  mpfr_t angle;
  mpfr_inits2(std::numeric_limits<double>::digits, x, y, angle, nullptr);
  mpfr_set_d(x, direction.x, MPFR_RNDN);
  mpfr_set_d(y, direction.y, MPFR_RNDN);
  mpfr_atan2(angle, y, x, MPFR_RNDN);
  const double rounded = mpfr_get_d(angle, MPFR_RNDN);
  mpfr_clears(x, y, angle, nullptr);
  return rounded;
}

}  // namespace lcpbench
