#pragma once

#include <benchmark/benchmark.h>

#include <memory>
#include <string>

#include "support/exit_status.h"

namespace lcpbench {

/// The counter of every study: the time per item (a row, a contact, a problem) [s].
inline void CountPerItem(benchmark::State& state, double items) {
  state.counters["per item"] = {items, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert};
}

/// Runs what is registered, with the options of Google Benchmark (--benchmark_filter=disc-pile,
/// --benchmark_repetitions=5, --benchmark_format=csv, ...). @return the exit status
inline int RunStudy(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return kMisuse;
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}

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
