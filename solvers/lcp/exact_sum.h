#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace lcpbench {

/// A sum of products of doubles without any rounding: a fixed-point number that every product fits in.  [Kulisch 1971]
/// Up to 2^28 products. Internal to solvers/lcp/.
class ExactSum {
 public:
  /// Empties it.
  void Clear() { digits_.fill(0); }

  /// Adds x y, both finite.
  void Add(double x, double y) {
    int x_exponent = 0;
    int y_exponent = 0;
    const auto integer = [](double fraction) { return static_cast<std::int64_t>(std::ldexp(fraction, kBits)); };
    const std::int64_t a = integer(std::frexp(x, &x_exponent));
    const std::int64_t b = integer(std::frexp(y, &y_exponent));
    const int place = x_exponent + y_exponent - kLeastExponent;
    // By halves of b, so that products stay below 2^63.
    constexpr int kHalf = 30;
    const std::int64_t high = b / (std::int64_t{1} << kHalf);
    const std::int64_t low = b - high * (std::int64_t{1} << kHalf);
    const std::int64_t a_high = a / (std::int64_t{1} << kHalf);
    const std::int64_t a_low = a - a_high * (std::int64_t{1} << kHalf);
    AddInteger(a_high * high, place + 2 * kHalf);
    AddInteger(a_high * low, place + kHalf);
    AddInteger(a_low * high, place + kHalf);
    AddInteger(a_low * low, place);
  }

  /// Rounded once or twice; 0 only where the sum is.
  long double Value() {
    for (std::size_t k = 0; k + 1 < kDigits; ++k) {
      digits_[k + 1] += digits_[k] >> kDigit;
      digits_[k] &= kMask;
    }
    long double value = 0;
    for (std::size_t k = kDigits; k-- > 0;) value = value * (kMask + 1) + static_cast<long double>(digits_[k]);
    return std::ldexp(value, kLeastExponent - 2 * kBits);
  }

 private:
  static constexpr int kBits = 53;
  static constexpr int kDigit = 32;
  static constexpr std::int64_t kMask = (std::int64_t{1} << kDigit) - 1;
  // What frexp gives at least, -1073, and the bits of the fractions, both twice.
  static constexpr int kLeastExponent = 2 * -1073;
  // From 2^(kLeastExponent - 2 kBits) to 2^2048, and what carries.
  static constexpr std::size_t kDigits = (2048 - kLeastExponent + 2 * kBits) / kDigit + 3;

  // value 2^place times the unit of the last digit, |value| < 2^62.
  void AddInteger(std::int64_t value, int place) {
    const std::int64_t sign = value < 0 ? -1 : 1;
    const auto size = static_cast<std::uint64_t>(value < 0 ? -value : value);
    const auto at = static_cast<std::size_t>(place / kDigit);
    const int shift = place % kDigit;
    // size 2^shift in three digits.
    const std::uint64_t low = (size & kMask) << shift;
    const std::uint64_t high = ((size >> kDigit) << shift) + (low >> kDigit);
    digits_[at] += sign * static_cast<std::int64_t>(low & kMask);
    digits_[at + 1] += sign * static_cast<std::int64_t>(high & kMask);
    digits_[at + 2] += sign * static_cast<std::int64_t>(high >> kDigit);
  }

  std::array<std::int64_t, kDigits> digits_{};
};

}  // namespace lcpbench
