#include "support/clock.h"

#include <algorithm>
#include <array>
#include <chrono>

#if defined(__x86_64__)
#include <cpuid.h>
#include <x86intrin.h>
#endif

namespace lcpbench {
namespace {

std::uint64_t SteadyNanoseconds() {
  return static_cast<std::uint64_t>(
      std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch())
          .count());
}

#if defined(__x86_64__)

// CPUID leaf 0x80000007, EDX bit 8: the counter runs at a constant rate in every state of the processor.
bool HasConstantCounter() {
  constexpr unsigned kLeaf = 0x80000007;
  constexpr unsigned kInvariant = 1U << 8U;
  unsigned a = 0;
  unsigned b = 0;
  unsigned c = 0;
  unsigned d = 0;
  return __get_cpuid(kLeaf, &a, &b, &c, &d) != 0 && (d & kInvariant) != 0;
}

std::uint64_t Counter() {
  _mm_lfence();
  const std::uint64_t ticks = __rdtsc();
  _mm_lfence();
  return ticks;
}

#else

bool HasConstantCounter() { return false; }
std::uint64_t Counter() { return 0; }

#endif

struct Rate {
  bool by_counter = HasConstantCounter();
  double tick_s = 1e-9;
  std::uint64_t empty = 0;  // ticks
};

std::uint64_t Ticks(const Rate& rate) { return rate.by_counter ? Counter() : SteadyNanoseconds(); }

Rate MeasuredRate() {
  Rate rate;
  if (rate.by_counter) {
    constexpr std::uint64_t kCalibration = 20'000'000;  // ns
    const std::uint64_t clock = SteadyNanoseconds();
    const std::uint64_t ticks = Counter();
    std::uint64_t passed = 0;
    while (passed < kCalibration) passed = SteadyNanoseconds() - clock;
    rate.tick_s = 1e-9 * static_cast<double>(passed) / static_cast<double>(Counter() - ticks);
  }
  std::array<std::uint64_t, 1001> empty{};
  for (std::uint64_t& ticks : empty) {
    const std::uint64_t start = Ticks(rate);
    ticks = Ticks(rate) - start;
  }
  std::nth_element(empty.begin(), empty.begin() + empty.size() / 2, empty.end());
  rate.empty = empty[empty.size() / 2];
  return rate;
}

const Rate& TheRate() {
  static const Rate rate = MeasuredRate();
  return rate;
}

}  // namespace

double SteadyNow() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

Stopwatch::Stopwatch() { TheRate(); }

void Stopwatch::Start() { start_ = Ticks(TheRate()); }

double Stopwatch::Seconds() const {
  const Rate& rate = TheRate();
  const std::uint64_t ticks = Ticks(rate) - start_;
  return rate.tick_s * static_cast<double>(std::max(ticks, rate.empty + 1) - rate.empty);
}

}  // namespace lcpbench
