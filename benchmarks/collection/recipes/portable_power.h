#pragma once

#include <cmath>

namespace lcpbench {

/// ratio^u for ratio > 0 and u in [0, 1], by the leading 53 binary digits of u and repeated square roots: IEEE + * and
/// sqrt only, and so the same bits on every machine, which std::pow does not promise. Relative error below 1e-14.
inline double PortablePower(double ratio, double u) {
  if (u >= 1) return ratio;
  constexpr int kDigits = 53;
  double power = 1;
  double root = ratio;
  for (int digit = 0; digit < kDigits && u > 0; ++digit) {
    root = std::sqrt(root);
    u *= 2;
    if (u < 1) continue;
    u -= 1;
    power *= root;
  }
  return power;
}

}  // namespace lcpbench
