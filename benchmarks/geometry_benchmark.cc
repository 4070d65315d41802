// Times the way from outlines to the LCP, stage by stage, on packings of 10^3 to 10^5 real contacts. After Google
// Benchmark's own output it prints a table: time per contact at every size, and the exponent p of time ~ contacts^p.
// Takes the options of Google Benchmark (--benchmark_filter=ellipses, --benchmark_out=times.json, ...).

#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "benchmarks/geometry_packings.h"
#include "model/assembly.h"
#include "model/broad_phase.h"
#include "model/detection.h"
#include "model/narrow_phase.h"

namespace lcpbench {
namespace {

constexpr std::array kSizes = {1'000, 10'000, 100'000};
constexpr std::uint64_t kSeed = 1;
constexpr const char* kContactCounter = "contacts";

BoundingBox BoxOf(const PlacedOutline& placed, double margin) {
  const Vec2 around{margin, margin};
  BoundingBox all = placed.boxes.front();
  for (const BoundingBox& box : placed.boxes) {
    all.lower = {std::min(all.lower.x, box.lower.x), std::min(all.lower.y, box.lower.y)};
    all.upper = {std::max(all.upper.x, box.upper.x), std::max(all.upper.y, box.upper.y)};
  }
  return {all.lower + placed.x - around, all.upper + placed.x + around};
}

// One packing, with what every stage leaves to the next.
struct Workload {
  Packing packing;
  std::vector<const Outline*> outlines;  // into packing
  std::vector<BoundingBox> boxes;        // of the bodies, within which a contact may lie
  ContactSystem system;
  AssembledLcp lcp;

  Workload(const PackingFamily& family, int size)
      : packing(family.make(size, kSeed)),
        outlines(packing.OutlinePointers()),
        system{"packing", packing.bodies, DetectContacts(packing.bodies, outlines, packing.options)},
        lcp(AssembleContactLcp(system)) {
    for (size_t i = 0; i < packing.bodies.size(); ++i) {
      const PlacedOutline placed = PlaceOutline(packing.outlines[i], packing.bodies[i].x, packing.bodies[i].theta);
      boxes.push_back(BoxOf(placed, packing.options.tolerance));
    }
  }
};

// Only the current workload is kept. Google Benchmark runs a benchmark several times in a row, and the stages of one
// workload follow each other.
const Workload& CurrentWorkload(const PackingFamily& family, int size) {
  static std::string current;
  static std::unique_ptr<Workload> workload;
  const std::string name = std::string(family.key) + "/" + std::to_string(size);
  if (current != name) {
    workload.reset();
    workload = std::make_unique<Workload>(family, size);
    current = name;
  }
  return *workload;
}

void FindPairs(const Workload& work) {
  const auto pairs = FindOverlappingPairs(work.boxes);
  benchmark::DoNotOptimize(pairs.data());
}

void Place(const Workload& work) {
  const Packing& packing = work.packing;
  for (size_t i = 0; i < packing.bodies.size(); ++i) {
    const PlacedOutline placed = PlaceOutline(packing.outlines[i], packing.bodies[i].x, packing.bodies[i].theta);
    benchmark::DoNotOptimize(placed.spans.data());
  }
}

void Detect(const Workload& work) {
  const auto contacts = DetectContacts(work.packing.bodies, work.outlines, work.packing.options);
  benchmark::DoNotOptimize(contacts.data());
}

void AssembleRows(const Workload& work) {
  const AssembledLcp lcp = AssembleContactLcp(work.system);
  benchmark::DoNotOptimize(lcp.rows.data());
}

// A copy each time, because a problem keeps its A.
void FormMatrix(const Workload& work) {
  const LcpProblem problem = work.lcp.problem.CopyOfGivenForm();
  benchmark::DoNotOptimize(problem.SparseA().valuePtr());
}

struct Stage {
  const char* name;
  void (*run)(const Workload& work);
};

constexpr std::array kStages = {
    Stage{"broad-phase", FindPairs},  // boxes of the bodies to overlapping pairs
    Stage{"place", Place},            // outlines into the world
    Stage{"detect", Detect},          // outlines to contacts, with place and broad-phase
    Stage{"rows", AssembleRows},      // contacts to J, gamma, b
    Stage{"matrix", FormMatrix},      // J to A, sparse
};

// The times of one stage on one family of packings.
struct Series {
  std::string name;
  std::vector<std::pair<double, double>> points;  // contacts, seconds: the least of the repetitions

  void Add(double contacts, double seconds) {
    if (points.empty() || points.back().first != contacts) {
      points.emplace_back(contacts, seconds);
    } else {
      points.back().second = std::min(points.back().second, seconds);
    }
  }

  // The slope of the straight line through (log contacts, log seconds), by least squares.
  double Exponent() const {
    const auto n = static_cast<double>(points.size());
    double x = 0;
    double y = 0;
    for (const auto& [contacts, seconds] : points) {
      x += std::log(contacts) / n;
      y += std::log(seconds) / n;
    }
    double xx = 0;
    double xy = 0;
    for (const auto& [contacts, seconds] : points) {
      xx += (std::log(contacts) - x) * (std::log(contacts) - x);
      xy += (std::log(contacts) - x) * (std::log(seconds) - y);
    }
    return xy / xx;
  }
};

// Google Benchmark's console output, and the table after it.
class GrowthReporter : public benchmark::ConsoleReporter {
 public:
  GrowthReporter() : ConsoleReporter(OO_Tabular) {}

  void ReportRuns(const std::vector<Run>& runs) override {
    ConsoleReporter::ReportRuns(runs);
    for (const Run& run : runs) {
      const auto contacts = run.counters.find(kContactCounter);
      if (run.run_type != Run::RT_Iteration || contacts == run.counters.end()) continue;
      const std::string name = run.run_name.function_name;
      AddPoint(name.substr(0, name.rfind('/')), contacts->second.value,
               run.cpu_accumulated_time / static_cast<double>(run.iterations));
    }
  }

  void Finalize() override {
    std::printf("\nMicroseconds per contact (contacts), and p of time ~ contacts^p\n");
    for (const Series& series : series_) {
      std::printf("%-24s", series.name.c_str());
      for (const auto& [contacts, seconds] : series.points) {
        std::printf("  %8.3f (%6.0f)", 1e6 * seconds / contacts, contacts);
      }
      if (series.points.size() > 1) std::printf("  p = %.2f", series.Exponent());
      std::printf("\n");
    }
  }

 private:
  void AddPoint(const std::string& name, double contacts, double seconds) {
    auto it = std::find_if(series_.begin(), series_.end(), [&](const Series& series) { return series.name == name; });
    if (it == series_.end()) it = series_.insert(it, {name, {}});
    it->Add(contacts, seconds);
  }

  std::vector<Series> series_;
};

// By size before stage, so that a workload is made once.
void RegisterAll() {
  for (const PackingFamily& family : AllPackings()) {
    for (const int size : kSizes) {
      for (const Stage& stage : kStages) {
        const std::string name = std::string(family.key) + "/" + stage.name + "/" + std::to_string(size);
        const auto time = [&family, size, &stage](benchmark::State& state) {
          const Workload& work = CurrentWorkload(family, size);
          for (auto _ : state) stage.run(work);
          state.counters["bodies"] = static_cast<double>(work.packing.bodies.size());
          state.counters[kContactCounter] = static_cast<double>(work.system.constraints.size());
        };
        benchmark::RegisterBenchmark(name.c_str(), time)->Unit(benchmark::kMillisecond);
      }
    }
  }
}

}  // namespace
}  // namespace lcpbench

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  lcpbench::RegisterAll();
  lcpbench::GrowthReporter reporter;
  benchmark::RunSpecifiedBenchmarks(&reporter);
  return 0;
}
