#pragma once

#include <memory>
#include <string>

namespace lcpbench {

/// The table that a program of this folder prints after Google Benchmark's own output. Its benchmarks are named
/// `<subject>/<method>/<size>`; their counters are kItems and what else the table shall show.
struct Study {
  const char* heading;         ///< of the table
  double scale;                ///< its unit of time in a second
  const char* reference = "";  ///< the method that all others are compared with
};

/// Counter: what the time is divided by, 1 or more.
inline constexpr const char* kItems = "items";

/// Runs what is registered, with the options of Google Benchmark. The table has a line per subject and method: at every
/// size the time per item (the least CPU time of all repetitions), its ratio to that of the reference and the other
/// counters (the largest); the exponent p of time ~ items^p by least squares; and the geometric mean over subjects.
/// @return the exit status
int RunStudy(int argc, char** argv, const Study& study);

/// The one workload that is kept: Google Benchmark runs a benchmark several times in a row, and those of one workload
/// follow each other.
template <typename Workload>
class KeptWorkload {
 public:
  /// Made anew of the arguments, after the one before is gone, where `name` differs from before.
  template <typename... Arguments>
  Workload& Get(const std::string& name, const Arguments&... arguments) {
    if (name_ != name || workload_ == nullptr) {
      workload_.reset();
      workload_ = std::make_unique<Workload>(arguments...);
      name_ = name;
    }
    return *workload_;
  }
  void Drop() { workload_.reset(); }

 private:
  std::string name_;
  std::unique_ptr<Workload> workload_;
};

}  // namespace lcpbench
