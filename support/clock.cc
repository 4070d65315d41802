#include "support/clock.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <limits>

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

struct Moment {
  std::uint64_t ns = 0;
  std::uint64_t ticks = 0;
};

// Clock and counter at one time: of some reads those between which least passed, so that an interruption of the thread
// does not count.
Moment Now() {
  constexpr int kReads = 10;
  Moment now;
  std::uint64_t least = std::numeric_limits<std::uint64_t>::max();
  for (int k = 0; k < kReads; ++k) {
    const std::uint64_t before = SteadyNanoseconds();
    const std::uint64_t ticks = Counter();
    const std::uint64_t passed = SteadyNanoseconds() - before;
    if (passed >= least) continue;
    least = passed;
    now = {before + passed / 2, ticks};
  }
  return now;
}

std::uint64_t Ticks(const Rate& rate) { return rate.by_counter ? Counter() : SteadyNanoseconds(); }

Rate MeasuredRate() {
  Rate rate;
  if (rate.by_counter) {
    constexpr std::uint64_t kCalibration = 20'000'000;  // ns
    const Moment first = Now();
    Moment last = first;
    while (last.ns - first.ns < kCalibration) last = Now();
    rate.tick_s = 1e-9 * static_cast<double>(last.ns - first.ns) / static_cast<double>(last.ticks - first.ticks);
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
  // Signed: the counters of two processors may differ, and the thread may have moved.
  const auto ticks = static_cast<std::int64_t>(Ticks(rate) - start_) - static_cast<std::int64_t>(rate.empty);
  return rate.tick_s * static_cast<double>(std::max<std::int64_t>(ticks, 1));
}

}  // namespace lcpbench
