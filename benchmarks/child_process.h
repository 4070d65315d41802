#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace lcpbench {

/// This program run again, so that a crash, a hang or exhausted memory is an outcome and not the end of the study.
/// A new program and not a fork: OpenMP's threads do not survive fork, and CHOLMOD then waits for them forever.
struct ChildOutcome {
  bool ok = false;        ///< exit status 0
  std::string output;     ///< standard output
  std::string failure;    ///< how it ended, in words, with the last line of its standard error; empty when ok
  double peak_bytes = 0;  ///< resident at most
};

struct ChildLimits {
  double time_s = 0;               ///< killed after this
  std::uint64_t memory_bytes = 0;  ///< address space; 0 for no limit; not kept under sanitizers
};

/// Runs this program (Linux: /proc/self/exe) with `arguments` and waits for it. It is killed when this process ends.
/// @throws std::runtime_error where the system gives no process or pipe
ChildOutcome RunSelf(const std::vector<std::string>& arguments, const ChildLimits& limits);

}  // namespace lcpbench
