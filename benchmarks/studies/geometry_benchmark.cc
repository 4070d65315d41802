// Times the way from outlines to the LCP, stage by stage, on packings of 10^3 to 10^5 real contacts. After Google
// Benchmark's own output it prints a table: time per contact at every size, and the exponent p of time ~ contacts^p.
// Takes the options of Google Benchmark (--benchmark_filter=ellipses, --benchmark_out=times.json, ...).

#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "benchmarks/studies/geometry_packings.h"
#include "benchmarks/studies/growth_report.h"
#include "model/contact/assembly.h"
#include "model/detection/detection.h"
#include "model/detection/narrow_phase.h"
#include "model/geometry/broad_phase.h"

namespace lcpbench {
namespace {

constexpr std::array kSizes = {1'000, 10'000, 100'000};
constexpr std::uint64_t kSeed = 1;

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

KeptWorkload<Workload> kept;

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

// By size before stage, so that a workload is made once.
void RegisterAll() {
  for (const PackingFamily& family : AllPackings()) {
    for (const int size : kSizes) {
      for (const Stage& stage : kStages) {
        const std::string name = std::string(family.key) + "/" + stage.name + "/" + std::to_string(size);
        const auto time = [&family, size, &stage](benchmark::State& state) {
          const std::string key = std::string(family.key) + "/" + std::to_string(size);
          const Workload& work = kept.Get(key, [&] { return std::make_unique<Workload>(family, size); });
          for (auto _ : state) stage.run(work);
          state.counters["bodies"] = static_cast<double>(work.packing.bodies.size());
          state.counters[kSizeCounter] = static_cast<double>(work.system.constraints.size());
        };
        benchmark::RegisterBenchmark(name.c_str(), time)->Unit(benchmark::kMillisecond);
      }
    }
  }
}

void PrintTable(const std::vector<SizeSeries>& series) {
  std::printf("\nMicroseconds per contact (contacts), and p of time ~ contacts^p\n");
  PrintPerSize(series, 1e6);
}

}  // namespace
}  // namespace lcpbench

int main(int argc, char** argv) {
  return lcpbench::RunBenchmarks(argc, argv, &lcpbench::RegisterAll, &lcpbench::PrintTable);
}
