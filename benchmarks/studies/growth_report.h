#pragma once

#include <benchmark/benchmark.h>

#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace lcpbench {

/// What the programs that time one thing over many sizes have in common. Their benchmarks are named `<series>/<size>`
/// and set the counter kSizeCounter to the size as it came out.

inline constexpr const char* kSizeCounter = "size";
/// Optional: the most memory that was resident at a time [bytes].
inline constexpr const char* kPeakCounter = "peak_bytes";

struct SizePoint {
  double size = 0;
  double seconds = 0;     ///< CPU time, the least of the repetitions
  double peak_bytes = 0;  ///< the most of the repetitions; 0 where not measured
};

struct SizeSeries {
  std::string name;
  std::vector<SizePoint> points;  ///< in the order in which they ran

  /// p of seconds ~ size^p by least squares through (log size, log seconds). Two points at least.
  double Exponent() const;
};

/// Google Benchmark's console output, and a table of all series after it.
class GrowthReporter : public benchmark::ConsoleReporter {
 public:
  using PrintTable = void (*)(const std::vector<SizeSeries>& series);

  explicit GrowthReporter(PrintTable print) : ConsoleReporter(OO_Tabular), print_(print) {}
  void ReportRuns(const std::vector<Run>& runs) override;
  void Finalize() override { print_(series_); }

 private:
  PrintTable print_;
  std::vector<SizeSeries> series_;
};

/// A line per series: `unit` times seconds per size at every size, and the exponent; peak memory where measured.
/// @param scale  units in a second
void PrintPerSize(const std::vector<SizeSeries>& series, double scale);

/// The program's main after its own options were taken out of argv: the options of Google Benchmark, then all that is
/// registered.  @return the exit status
int RunBenchmarks(int argc, char** argv, void (*register_all)(), GrowthReporter::PrintTable print);

/// Takes `name`=value out of argv.  @return value; "" where it is not there
std::string TakeOption(int* argc, char** argv, std::string_view name);

/// The one workload that is kept: Google Benchmark runs a benchmark several times in a row, and those of one workload
/// follow each other.
template <typename Workload>
class KeptWorkload {
 public:
  /// Made anew by `make`, after the one before is gone, where `name` differs from before.
  template <typename Make>
  Workload& Get(const std::string& name, const Make& make) {
    if (name_ != name || workload_ == nullptr) {
      workload_.reset();
      workload_ = make();
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
