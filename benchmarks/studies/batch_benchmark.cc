// Times StepSolver::SolveBatch from an engine's arrays to forces: 100,000 islands of 1 to 16 rows
// (benchmarks/studies/island_batch.h), in the plane and in space, J in double and in single precision, fresh in every
// pass, because all together are larger than the caches. Items are rows. `left`: the share of problems that lanes did
// not solve; `refused`: how many answers the verifier refused; `floor` reads the arrays once in order and writes f
// once; `one_by_one` is StepSolver::Solve.

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "benchmarks/studies/island_batch.h"
#include "benchmarks/studies/study.h"
#include "solvers/linear_algebra/instruction_set.h"
#include "solvers/step/step_solver.h"

namespace lcpbench {
namespace {

constexpr std::int32_t kIslands = 100'000;
constexpr int kMostIslandRows = 16;
KeptWorkload<IslandBatch> kept_islands;

void TimeRows(benchmark::State& state, IslandBatch* work, bool single, InstructionSet instructions) {
  StepOptions options;
  options.instructions = instructions;
  StepSolver solver(options);
  solver.Reserve(kMostIslandRows, Index{2} * kMostIslandRows);
  const StepRows rows = work->arrays.View(single);
  for (auto _ : state) solver.SolveBatch(rows, work->start, work->f.data(), work->answers);
  state.counters["left"] = static_cast<double>(solver.left()) / static_cast<double>(work->answers.size());
}

void TimeRowsOneByOne(benchmark::State& state, IslandBatch* work, bool single) {
  StepSolver solver;
  solver.Reserve(kMostIslandRows, Index{2} * kMostIslandRows);
  const StepRows rows = work->arrays.View(single);
  for (auto _ : state) {
    for (std::size_t k = 0; k < work->answers.size(); ++k) {
      work->answers[k] = solver.Solve(work->RowsOf(k, rows), nullptr, work->f.data() + work->start[k]);
    }
  }
}

void TimeFloor(benchmark::State& state, IslandBatch* work, bool single) {
  for (auto _ : state) work->ReadAllOnce(single);
}

void RegisterAll() {
  for (const int p : {3, 6}) {
    for (const bool single : {false, true}) {
      using RowMethod = std::function<void(benchmark::State&, IslandBatch*)>;
      std::vector<std::pair<std::string, RowMethod>> methods;
      methods.emplace_back("floor", [single](auto& state, auto* work) { TimeFloor(state, work, single); });
      methods.emplace_back("one_by_one", [single](auto& state, auto* work) { TimeRowsOneByOne(state, work, single); });
      for (const InstructionSet instructions : AvailableInstructionSets()) {
        methods.emplace_back(ToString(instructions), [single, instructions](auto& state, auto* work) {
          TimeRows(state, work, single, instructions);
        });
      }
      for (const auto& [method, run] : methods) {
        const std::string name = std::string(p == 3 ? "plane/" : "space/") + (single ? "single/" : "double/") + method;
        const auto time = [p, single, method = method, run = run](benchmark::State& state) {
          IslandBatch& work = kept_islands.Get(std::to_string(p), p, kIslands, kMostIslandRows);
          run(state, &work);
          if (method != "floor") state.counters["refused"] = work.CountRefused(single);
          CountPerItem(state, work.start.back());
        };
        benchmark::RegisterBenchmark(name.c_str(), time)->Unit(benchmark::kMillisecond);
      }
    }
  }
}

}  // namespace
}  // namespace lcpbench

int main(int argc, char** argv) {
  lcpbench::RegisterAll();
  return lcpbench::RunStudy(argc, argv);
}
