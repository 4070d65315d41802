#include "support/process_watch.h"

#include <malloc.h>
#include <sys/resource.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <limits>
#include <string>

#include "support/clock.h"

namespace lcpbench {
namespace {

constexpr int kProbeSteps = 8000;  // of some four cycles
constexpr int kProbeRuns = 5;
// What reading the clocks may add to the wall-clock time, which counts in passes of some 100 us [s].
constexpr double kClockReads = 5e-6;

}  // namespace

double ThreadTime() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

long long InvoluntarySwitches() {
  rusage usage{};
  getrusage(RUSAGE_THREAD, &usage);
  return usage.ru_nivcsw;
}

double ProbeSpeed() {
  double shortest = std::numeric_limits<double>::infinity();
  volatile std::uint64_t sink = 1;
  for (int run = 0; run < kProbeRuns; ++run) {
    std::uint64_t value = sink;
    const double start = SteadyNow();
    for (int step = 0; step < kProbeSteps; ++step) value = value * 6364136223846793005U + 1442695040888963407U;
    sink = value;
    shortest = std::min(shortest, SteadyNow() - start);
  }
  return shortest;
}

DisturbanceWatch::DisturbanceWatch()
    : probe_s_(ProbeSpeed()), wall_(SteadyNow()), cpu_(ThreadTime()), switches_(InvoluntarySwitches()) {}

Disturbance DisturbanceWatch::Finish() const {
  Disturbance found;
  const double wall = SteadyNow() - wall_;
  if (wall > 0) found.cpu_share = std::min(1.0, (ThreadTime() - cpu_ + kClockReads) / wall);
  found.switches = InvoluntarySwitches() - switches_;
  found.probe_s = std::max(probe_s_, ProbeSpeed());
  return found;
}

// proc(5): 5 written to clear_refs resets VmHWM, which is in kB.
void ResetPeak() {
  malloc_trim(0);
  std::ofstream("/proc/self/clear_refs") << "5";
}

double PeakBytes() {
  std::ifstream status("/proc/self/status");
  std::string line;
  while (std::getline(status, line)) {
    double kilobytes = 0;
    if (std::sscanf(line.c_str(), "VmHWM: %lf kB", &kilobytes) == 1) return 1024 * kilobytes;
  }
  return 0;
}

}  // namespace lcpbench
