#include "benchmarks/studies/study.h"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>
#include <utility>
#include <vector>

#include "support/exit_status.h"

namespace lcpbench {
namespace {

struct Point {
  double items = 1;
  double seconds = std::numeric_limits<double>::infinity();
  std::map<std::string, double> counters;
  double per_item() const { return seconds / items; }
};

using Points = std::map<double, Point>;  // by size

// p of seconds ~ items^p by least squares through the logarithms.
double Exponent(const Points& points) {
  const auto n = static_cast<double>(points.size());
  double x = 0;
  double y = 0;
  for (const auto& [size, point] : points) {
    x += std::log(point.items) / n;
    y += std::log(point.seconds) / n;
  }
  double xx = 0;
  double xy = 0;
  for (const auto& [size, point] : points) {
    const double dx = std::log(point.items) - x;
    xx += dx * dx;
    xy += dx * (std::log(point.seconds) - y);
  }
  return xy / xx;
}

class TableReporter : public benchmark::ConsoleReporter {
 public:
  explicit TableReporter(const Study& study) : ConsoleReporter(OO_Tabular), study_(study) {}

  void ReportRuns(const std::vector<Run>& runs) override {
    ConsoleReporter::ReportRuns(runs);
    for (const Run& run : runs) {
      if (run.run_type != Run::RT_Iteration) continue;
      const std::string& name = run.run_name.function_name;
      const std::size_t last = name.rfind('/');
      const std::size_t middle = name.rfind('/', last - 1);
      const Name key(name.substr(0, middle), name.substr(middle + 1, last - middle - 1));
      if (std::find(order_.begin(), order_.end(), key) == order_.end()) order_.push_back(key);
      Point& point = points_[key][std::stod(name.substr(last + 1))];
      point.seconds = std::min(point.seconds, run.cpu_accumulated_time / static_cast<double>(run.iterations));
      for (const auto& [counter, value] : run.counters) {
        if (counter == kItems) {
          point.items = value.value;
        } else {
          point.counters[counter] = std::max(point.counters[counter], value.value);
        }
      }
    }
  }

  void Finalize() override {
    std::printf("\n%s\n", study_.heading);
    std::map<std::string, std::map<double, std::pair<double, int>>> means;  // by method and size: of logarithms
    for (const Name& name : order_) {
      const Points& points = points_.at(name);
      std::printf("%-36s", (name.first + "/" + name.second).c_str());
      for (const auto& [size, point] : points) {
        Print(name, size, point);
        auto& [sum, count] = means[name.second][size];
        sum += std::log(point.per_item());
        ++count;
      }
      const bool grows = points.begin()->second.items < points.rbegin()->second.items;
      std::printf(grows ? "  p = %.2f\n" : "\n", grows ? Exponent(points) : 0);
    }
    for (const auto& [method, by_size] : means) {
      if (by_size.begin()->second.second == 1) continue;  // of one subject
      std::printf("%-36s", ("geometric mean/" + method).c_str());
      for (const auto& [size, mean] : by_size) {
        std::printf("  %8.0f: %9.3f", size, study_.scale * std::exp(mean.first / mean.second));
      }
      std::printf("\n");
    }
  }

 private:
  using Name = std::pair<std::string, std::string>;  // subject, method

  void Print(const Name& name, double size, const Point& point) const {
    std::printf("  %8.0f: %9.3f", size, study_.scale * point.per_item());
    const auto reference = points_.find({name.first, study_.reference});
    if (reference != points_.end() && reference->second.count(size) > 0) {
      std::printf(" (%5.2f)", point.per_item() / reference->second.at(size).per_item());
    }
    for (const auto& [counter, value] : point.counters) std::printf(" %s %.3g", counter.c_str(), value);
  }

  Study study_;
  std::vector<Name> order_;
  std::map<Name, Points> points_;
};

}  // namespace

int RunStudy(int argc, char** argv, const Study& study) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return kMisuse;
  TableReporter reporter(study);
  benchmark::RunSpecifiedBenchmarks(&reporter);
  return 0;
}

}  // namespace lcpbench
