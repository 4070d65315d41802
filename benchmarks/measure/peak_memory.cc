#include "benchmarks/measure/peak_memory.h"

#include <malloc.h>

#include <cstdio>
#include <fstream>
#include <string>

namespace lcpbench {

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
