#pragma once

#include <cstdint>

#include "model/geometry/vec2.h"

namespace lcpbench {

/// From low to high.
struct Range {
  double low = 0;
  double high = 1;
};

/// Seeded random numbers with the same bits on every machine and with every standard library, whose own distributions
/// do not promise that: SplitMix64 [Steele, Lea, Flood 2014], turned into doubles with + - * / sqrt only.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}

  /// 64 random bits. Draw once per statement: C++ leaves the order of two draws in one expression to the compiler.
  std::uint64_t Bits() {
    state_ += 0x9E3779B97F4A7C15U;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9U;
    z = (z ^ (z >> 27U)) * 0x94D049BB133111EBU;
    return z ^ (z >> 31U);
  }

  /// Uniform in [0, 1): the upper 53 bits.
  double Uniform() { return static_cast<double>(Bits() >> 11U) * 0x1p-53; }
  /// Uniform in [lower, upper).
  double Uniform(double lower, double upper) { return lower + (upper - lower) * Uniform(); }
  double Uniform(Range range) { return Uniform(range.low, range.high); }
  /// Uniform in 0..count-1, count >= 1 (bias count / 2^53).
  int Integer(int count) { return static_cast<int>(Uniform() * static_cast<double>(count)); }
  /// Uniform in first..last.
  int Integer(int first, int last) { return first + Integer(last - first + 1); }
  /// -1 or +1.
  double Sign() { return (Bits() >> 63U) != 0 ? 1.0 : -1.0; }

  /// Uniform in the unit disc, by rejection.
  Vec2 InUnitDisc() {
    for (;;) {
      const double x = Uniform(-1, 1);
      const double y = Uniform(-1, 1);
      if (x * x + y * y <= 1) return {x, y};
    }
  }

  /// Uniform on the unit circle.
  Vec2 UnitVector() {
    for (;;) {
      const Vec2 a = InUnitDisc();
      const double length = Norm(a);
      // Short vectors have few significant bits left.
      if (length > 0.1) return (1 / length) * a;
    }
  }

 private:
  std::uint64_t state_;
};

}  // namespace lcpbench
