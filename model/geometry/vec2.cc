#include "model/geometry/vec2.h"

#include <mpfr.h>

#include <cmath>
#include <limits>

namespace lcpbench {
namespace {

// Ziv's test: an evaluation in a wider format whose relative error is below kErrorBound is decisive when both ends of
// its error interval round to the same double. x87's long double has 11 bits more than double; glibc and musl document
// or measure about 1 ulp for sinl and cosl, so 16 ulp leave a wide margin and send about 1 call in 60 to MPFR.
constexpr bool kHasWiderFormat = std::numeric_limits<long double>::digits >= 64;
constexpr long double kErrorBound = 16 * std::numeric_limits<long double>::epsilon();
// Beyond this the fast evaluation would lean on the library's argument reduction; such angles are rare.
constexpr double kFastLimit = 1e5;

bool RoundsUniquely(long double value, double* rounded) {
  const long double error = kErrorBound * std::fabs(value);
  const auto low = static_cast<double>(value - error);
  const auto high = static_cast<double>(value + error);
  *rounded = low;
  return low == high;
}

// One evaluation's variables, kept per thread because MPFR allocates for each.
class MpfrSinCos {
 public:
  explicit MpfrSinCos(int digits) { mpfr_inits2(digits, theta_, sin_, cos_, nullptr); }
  ~MpfrSinCos() {
    mpfr_clears(theta_, sin_, cos_, nullptr);
    mpfr_free_cache();
  }
  MpfrSinCos(const MpfrSinCos&) = delete;
  MpfrSinCos& operator=(const MpfrSinCos&) = delete;

  // Neither value is subnormal unless it equals theta, so that 53 bits are the double's precision: one rounding.
  Rotation operator()(double theta) {
    mpfr_set_d(theta_, theta, MPFR_RNDN);
    mpfr_sin_cos(sin_, cos_, theta_, MPFR_RNDN);
    return {mpfr_get_d(cos_, MPFR_RNDN), mpfr_get_d(sin_, MPFR_RNDN)};
  }

  // What rounding the last evaluation to double left, in more digits.
  Rotation Remainder(Rotation high) {
    mpfr_sub_d(cos_, cos_, high.cos, MPFR_RNDN);
    mpfr_sub_d(sin_, sin_, high.sin, MPFR_RNDN);
    return {mpfr_get_d(cos_, MPFR_RNDN), mpfr_get_d(sin_, MPFR_RNDN)};
  }

 private:
  mpfr_t theta_;
  mpfr_t sin_;
  mpfr_t cos_;
};

}  // namespace

Rotation SinCos(double theta) {
  if (theta == 0) return {1, 0};
  if (kHasWiderFormat && std::fabs(theta) < kFastLimit) {
    Rotation r;
    const auto wide = static_cast<long double>(theta);
    if (RoundsUniquely(std::sin(wide), &r.sin) && RoundsUniquely(std::cos(wide), &r.cos)) return r;
  }
  thread_local MpfrSinCos mpfr(std::numeric_limits<double>::digits);
  return mpfr(theta);
}

RotationParts SinCosParts(double theta) {
  // Beyond two doubles' digits, so that rounding to the first does not depend on the second's.
  constexpr int kDigits = 160;
  thread_local MpfrSinCos mpfr(kDigits);
  RotationParts parts;
  parts.high = mpfr(theta);
  parts.low = mpfr.Remainder(parts.high);
  return parts;
}

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
