#include "support/clock.h"

#include <chrono>
#include <thread>

#include "tests/support/test.h"

namespace lcpbench {
namespace {

// An interval lies between one of the monotonic clock inside it and one around it, but for the rate and the offset that
// are measured.
TEST(Stopwatch, AgreesWithTheMonotonicClock) {
  Stopwatch watch;
  for (int k = 1; k <= 10; ++k) {
    const double before = SteadyNow();
    watch.Start();
    const double begin = SteadyNow();
    std::this_thread::sleep_for(std::chrono::milliseconds(k));
    const double end = SteadyNow();
    const double seconds = watch.Seconds();
    const double after = SteadyNow();
    EXPECT_GE(seconds, 0.999 * (end - begin) - 1e-6);
    EXPECT_LE(seconds, 1.001 * (after - before) + 1e-6);
  }
}

TEST(Stopwatch, AnEmptyIntervalTakesSomeTime) {
  Stopwatch watch;
  for (int k = 0; k < 1000; ++k) {
    watch.Start();
    EXPECT_GT(watch.Seconds(), 0);
  }
}

}  // namespace
}  // namespace lcpbench
