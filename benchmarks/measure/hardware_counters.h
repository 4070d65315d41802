#pragma once

#include <string>
#include <utility>
#include <vector>

namespace lcpbench {

/// Counters of the kernel's perf events for the calling thread, where it gives them: virtual machines and containers
/// often give none of the hardware's. [perf_event_open(2)]
class HardwareCounters {
 public:
  HardwareCounters();
  ~HardwareCounters();
  HardwareCounters(const HardwareCounters&) = delete;
  HardwareCounters& operator=(const HardwareCounters&) = delete;

  void Start();
  /// Since Start, by name: cycles, instructions, cache-misses, branch-misses, page-faults. Those that the kernel does
  /// not give are not there.
  std::vector<std::pair<std::string, double>> Stop();

  std::vector<std::string> names() const;
  /// Of the first counter that was refused: the kernel's word, else "".
  const std::string& refusal() const { return refusal_; }

 private:
  struct Counter {
    std::string name;
    int file;
  };
  std::vector<Counter> counters_;
  std::string refusal_;
};

}  // namespace lcpbench
