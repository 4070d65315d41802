// Times what comes before a solve, stage by stage, for every scene family at 10^3 to 10^5 rows: generating the scene,
// assembling J, gamma and b from its contacts, forming A. After Google Benchmark's own output it prints a table: time
// per row and the most memory resident at every size, and the exponent p of time ~ rows^p.
// --largest=N (a power of ten) goes on to N rows or stops there. Takes the options of Google Benchmark besides
// (--benchmark_filter=disc-pile, ...).

#include <benchmark/benchmark.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>

#include "benchmarks/measure/peak_memory.h"
#include "benchmarks/studies/growth_report.h"
#include "model/contact/assembly.h"
#include "model/scenes/scene.h"

namespace lcpbench {
namespace {

constexpr int kSmallest = 1'000;
constexpr int kLargestByDefault = 100'000;
constexpr int kLargestOfAll = 1'000'000;
constexpr std::uint64_t kSeed = 1;
constexpr double kLeastTime = 0.1;  // s

int largest = kLargestByDefault;

// What every stage leaves to the next.
struct Workload {
  ContactSystem system;
  AssembledLcp lcp;

  Workload(const SceneFamily& family, int rows)
      : system(family.generate(rows, kSeed)), lcp(AssembleContactLcp(system)) {}
};

KeptWorkload<Workload> kept;

void Generate(const SceneFamily& family, int rows, benchmark::State* state) {
  for (auto _ : *state) {
    const ContactSystem system = family.generate(rows, kSeed);
    benchmark::DoNotOptimize(system.constraints.data());
  }
}

const Workload& WorkloadOf(const SceneFamily& family, int rows) {
  return kept.Get(std::string(family.key) + "/" + std::to_string(rows),
                  [&] { return std::make_unique<Workload>(family, rows); });
}

void AssembleRows(const SceneFamily& family, int rows, benchmark::State* state) {
  const Workload& work = WorkloadOf(family, rows);
  for (auto _ : *state) {
    const AssembledLcp lcp = AssembleContactLcp(work.system);
    benchmark::DoNotOptimize(lcp.rows.data());
  }
}

// A copy each time, because a problem keeps its A.
void FormMatrix(const SceneFamily& family, int rows, benchmark::State* state) {
  const Workload& work = WorkloadOf(family, rows);
  for (auto _ : *state) {
    const LcpProblem problem = work.lcp.problem.CopyOfGivenForm();
    benchmark::DoNotOptimize(problem.SparseA().valuePtr());
  }
}

struct Stage {
  const char* name;
  void (*run)(const SceneFamily& family, int rows, benchmark::State* state);
};

constexpr std::array kStages = {
    Stage{"generate", Generate},  // seed to bodies and contacts
    Stage{"rows", AssembleRows},  // contacts to J, gamma, b
    Stage{"matrix", FormMatrix},  // J to A, sparse
};

// By size before stage, so that a workload is made once.
void RegisterAll() {
  for (const SceneFamily& family : AllScenes()) {
    for (int rows = kSmallest; rows <= largest; rows *= 10) {
      for (const Stage& stage : kStages) {
        const std::string name = std::string(family.key) + "/" + stage.name + "/" + std::to_string(rows);
        const auto time = [&family, rows, &stage](benchmark::State& state) {
          // What is resident is what the stage needs and makes.
          if (stage.run == &Generate) kept.Drop();
          ResetPeak();
          stage.run(family, rows, &state);
          state.counters[kPeakCounter] = PeakBytes();
          state.counters[kSizeCounter] = rows;
        };
        benchmark::RegisterBenchmark(name.c_str(), time)->Unit(benchmark::kMillisecond)->MinTime(kLeastTime);
      }
    }
  }
}

void PrintTable(const std::vector<SizeSeries>& series) {
  std::printf("\nMicroseconds per row (rows) and peak memory, and p of time ~ rows^p\n");
  PrintPerSize(series, 1e6);
}

}  // namespace
}  // namespace lcpbench

int main(int argc, char** argv) {
  const std::string asked = lcpbench::TakeOption(&argc, argv, "--largest");
  if (!asked.empty()) lcpbench::largest = std::atoi(asked.c_str());
  if (lcpbench::largest < lcpbench::kSmallest || lcpbench::largest > lcpbench::kLargestOfAll) {
    std::fprintf(stderr, "--largest=%s: expected %d to %d rows\n", asked.c_str(), lcpbench::kSmallest,
                 lcpbench::kLargestOfAll);
    return 2;
  }
  return lcpbench::RunBenchmarks(argc, argv, &lcpbench::RegisterAll, &lcpbench::PrintTable);
}
