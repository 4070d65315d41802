#pragma once

#include <cstdint>

namespace lcpbench {

/// Seconds of a monotonic clock.
double SteadyNow();

/// Times one short interval of the calling thread, of nanoseconds to hours: by the cycle counter of an x86-64 processor
/// whose counter runs at a constant rate, else by the monotonic clock. Instructions do not move across Start and
/// Seconds. What an empty interval takes, the median of many, is measured once per process and taken off.
class Stopwatch {
 public:
  /// Measures the rate and the empty interval where that was not done yet (some 20 ms, once).
  Stopwatch();
  /// An interval begins.
  void Start();
  /// How long the interval since Start is, at least the resolution of the clock [s].
  double Seconds() const;

 private:
  std::uint64_t start_ = 0;
};

}  // namespace lcpbench
