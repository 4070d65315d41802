#include "benchmarks/studies/growth_report.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace lcpbench {

double SizeSeries::Exponent() const {
  const auto n = static_cast<double>(points.size());
  double x = 0;
  double y = 0;
  for (const SizePoint& point : points) {
    x += std::log(point.size) / n;
    y += std::log(point.seconds) / n;
  }
  double xx = 0;
  double xy = 0;
  for (const SizePoint& point : points) {
    xx += (std::log(point.size) - x) * (std::log(point.size) - x);
    xy += (std::log(point.size) - x) * (std::log(point.seconds) - y);
  }
  return xy / xx;
}

void GrowthReporter::ReportRuns(const std::vector<Run>& runs) {
  ConsoleReporter::ReportRuns(runs);
  for (const Run& run : runs) {
    const auto size = run.counters.find(kSizeCounter);
    if (run.run_type != Run::RT_Iteration || size == run.counters.end()) continue;
    const std::string& full = run.run_name.function_name;
    const std::string name = full.substr(0, full.rfind('/'));
    const auto peak = run.counters.find(kPeakCounter);
    const SizePoint point{size->second.value, run.cpu_accumulated_time / static_cast<double>(run.iterations),
                          peak == run.counters.end() ? 0 : peak->second.value};
    auto it = std::find_if(series_.begin(), series_.end(), [&](const SizeSeries& s) { return s.name == name; });
    if (it == series_.end()) it = series_.insert(it, {name, {}});
    if (it->points.empty() || it->points.back().size != point.size) {
      it->points.push_back(point);
    } else {
      SizePoint& last = it->points.back();
      last.seconds = std::min(last.seconds, point.seconds);
      last.peak_bytes = std::max(last.peak_bytes, point.peak_bytes);
    }
  }
}

void PrintPerSize(const std::vector<SizeSeries>& series, double scale) {
  for (const SizeSeries& one : series) {
    std::printf("%-32s", one.name.c_str());
    for (const SizePoint& point : one.points) {
      std::printf("  %8.3f (%7.0f)", scale * point.seconds / point.size, point.size);
      if (point.peak_bytes > 0) std::printf(" %5.0f MB", 1e-6 * point.peak_bytes);
    }
    if (one.points.size() > 1) std::printf("  p = %.2f", one.Exponent());
    std::printf("\n");
  }
}

int RunBenchmarks(int argc, char** argv, void (*register_all)(), GrowthReporter::PrintTable print) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  register_all();
  GrowthReporter reporter(print);
  benchmark::RunSpecifiedBenchmarks(&reporter);
  return 0;
}

std::string TakeOption(int* argc, char** argv, std::string_view name) {
  const std::string begin = std::string(name) + "=";
  std::string value;
  int kept = 0;
  for (int i = 0; i < *argc; ++i) {
    const std::string_view argument = argv[i];
    if (argument.starts_with(begin)) {
      value = argument.substr(begin.size());
    } else {
      argv[kept++] = argv[i];
    }
  }
  *argc = kept;
  return value;
}

}  // namespace lcpbench
