#include "benchmarks/measure/hardware_counters.h"

#include <linux/perf_event.h>
#include <sys/ioctl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <cstring>

namespace lcpbench {
namespace {

struct Event {
  const char* name;
  std::uint32_t type;
  std::uint64_t config;
};

constexpr Event kEvents[] = {
    {"cycles", PERF_TYPE_HARDWARE, PERF_COUNT_HW_CPU_CYCLES},
    {"instructions", PERF_TYPE_HARDWARE, PERF_COUNT_HW_INSTRUCTIONS},
    {"cache-misses", PERF_TYPE_HARDWARE, PERF_COUNT_HW_CACHE_MISSES},
    {"branch-misses", PERF_TYPE_HARDWARE, PERF_COUNT_HW_BRANCH_MISSES},
    {"page-faults", PERF_TYPE_SOFTWARE, PERF_COUNT_SW_PAGE_FAULTS},
};

// Of user space: what most kernels allow.
int Open(const Event& event) {
  perf_event_attr attributes{};
  attributes.size = sizeof attributes;
  attributes.type = event.type;
  attributes.config = event.config;
  attributes.disabled = 1;
  attributes.exclude_kernel = 1;
  attributes.exclude_hv = 1;
  attributes.read_format = PERF_FORMAT_TOTAL_TIME_ENABLED | PERF_FORMAT_TOTAL_TIME_RUNNING;
  return static_cast<int>(syscall(SYS_perf_event_open, &attributes, 0, -1, -1, PERF_FLAG_FD_CLOEXEC));
}

}  // namespace

HardwareCounters::HardwareCounters() {
  for (const Event& event : kEvents) {
    const int file = Open(event);
    if (file >= 0) {
      counters_.push_back({event.name, file});
    } else if (refusal_.empty()) {
      refusal_ = std::string(event.name) + ": " + std::strerror(errno);
    }
  }
}

HardwareCounters::~HardwareCounters() {
  for (const Counter& counter : counters_) close(counter.file);
}

std::vector<std::string> HardwareCounters::names() const {
  std::vector<std::string> names;
  names.reserve(counters_.size());
  for (const Counter& counter : counters_) names.push_back(counter.name);
  return names;
}

void HardwareCounters::Start() {
  for (const Counter& counter : counters_) {
    ioctl(counter.file, PERF_EVENT_IOC_RESET, 0);
    ioctl(counter.file, PERF_EVENT_IOC_ENABLE, 0);
  }
}

std::vector<std::pair<std::string, double>> HardwareCounters::Stop() {
  for (const Counter& counter : counters_) ioctl(counter.file, PERF_EVENT_IOC_DISABLE, 0);
  std::vector<std::pair<std::string, double>> counts;
  for (const Counter& counter : counters_) {
    // Value, then the times that it was enabled and that it ran: more events than the processor has counters take
    // turns.
    std::uint64_t values[3] = {};
    if (read(counter.file, values, sizeof values) != static_cast<ssize_t>(sizeof values) || values[2] == 0) continue;
    const double share = static_cast<double>(values[2]) / static_cast<double>(values[1]);
    counts.emplace_back(counter.name, static_cast<double>(values[0]) / share);
  }
  return counts;
}

}  // namespace lcpbench
