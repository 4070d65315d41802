#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>

/// Internal to solvers/: scaling without rounding.
namespace lcpbench {

inline constexpr int kExponentBias = 1023;
inline constexpr int kMantissaBits = 52;

/// e for x = m 2^e, 1 <= m < 2; subnormal numbers give the lowest e.
inline std::int64_t Exponent(double x) {
  return static_cast<std::int64_t>((std::bit_cast<std::uint64_t>(x) >> kMantissaBits) & 0x7ff) - kExponentBias;
}

/// 2^exponent, exponent in [-1022, 1023].
inline double PowerOfTwo(std::int64_t exponent) {
  return std::bit_cast<double>(static_cast<std::uint64_t>(kExponentBias + exponent) << kMantissaBits);
}

/// s such that s^2 d is in [1, 4), for d > 0.
inline double ScaleOfDiagonal(double d) { return PowerOfTwo(-(Exponent(d) >> 1)); }

/// t such that t x is in [1, 2) for x > 0; 1 for 0. The reciprocal of the largest exponents is no normal number; such x
/// overflow elsewhere.
inline double ScaleOfLargest(double x) {
  return x > 0 ? PowerOfTwo(std::clamp<std::int64_t>(-Exponent(x), -1022, 1023)) : 1.0;
}

}  // namespace lcpbench
