// Times BatchSolver: many problems of 10, 20 and 30 rows, one per SIMD lane, with each instruction set of this machine,
// beside one problem after another by `auto` and `dantzig` in the same run.
//
// A batch: 512 seeds of one scene family, so that lanes hold different problems. Items (study.h) are problems; counted
// are also the share of problems that lanes left to `auto`, and how many of the 512 answers the verifier refused.
// `dense` is the form without LcpProblem objects. Set-up (DenseA, symmetry) is not timed.
//
// rows/*: StepSolver::SolveBatch from an engine's arrays to forces: 100,000 islands of 1 to 16 rows
// (benchmarks/studies/ island_batch.h), in the plane and in space, J in double and in single precision, fresh in every
// pass, because all together are larger than the caches. Items are rows. `left`: the share of problems that lanes did
// not solve; `floor` reads the arrays once in order and writes f once; `one_by_one` is StepSolver::Solve.

#include <array>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "benchmarks/studies/island_batch.h"
#include "benchmarks/studies/study.h"
#include "model/contact/assembly.h"
#include "model/scenes/scene.h"
#include "solvers/batch/solve_batch.h"
#include "solvers/lcp/verify.h"
#include "solvers/registry.h"
#include "solvers/step/step_solver.h"

namespace lcpbench {
namespace {

constexpr std::array kSizes = {10, 20, 30};
constexpr std::uint64_t kSeeds = 512;
constexpr const char* kFallbackCounter = "fallback";

struct Workload {
  int rows = 0;
  std::vector<LcpProblem> problems;
  std::vector<LcpResult> results;
  std::vector<double> A, b, f;
  std::vector<std::uint32_t> bilateral;
  std::vector<LcpStatus> status;

  Workload(std::string_view key, int n) : rows(n), results(kSeeds), status(kSeeds) {
    for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
      problems.push_back(AssembleContactLcp(GenerateScene(key, n, seed)).problem);
      const LcpProblem& problem = problems.back();
      A.insert(A.end(), problem.DenseA().data(), problem.DenseA().data() + problem.DenseA().size());
      b.insert(b.end(), problem.b().data(), problem.b().data() + problem.size());
      bilateral.push_back(0);
      for (const Index i : problem.bilateral_rows()) bilateral.back() |= 1U << static_cast<unsigned>(i);
    }
    f.resize(b.size());
  }

  // Answers of the dense form become results, too.
  void TakeDense() {
    for (std::size_t p = 0; p < problems.size(); ++p) {
      results[p] = {};
      results[p].status = status[p];
      results[p].f = Eigen::Map<const Eigen::VectorXd>(f.data() + p * static_cast<std::size_t>(rows), rows);
    }
  }

  double CountRefused() const {
    double refused = 0;
    for (std::size_t p = 0; p < problems.size(); ++p) {
      const Verdict verdict = Verify(problems[p], results[p], LcpOptions{}.tolerance);
      const bool proved = results[p].status == LcpStatus::kInfeasible && verdict.farkas && verdict.farkas->accepted;
      if (!proved && !(results[p].status == LcpStatus::kSolved && verdict.passes)) ++refused;
    }
    return refused;
  }
};

KeptWorkload<Workload> kept;

void TimeBatch(benchmark::State& state, Workload* work, BatchInstructions instructions) {
  BatchOptions options;
  options.instructions = instructions;
  BatchSolver solver(options);
  solver.Reserve(static_cast<Index>(kSeeds));
  solver.Solve(work->problems, {}, work->results);
  for (auto _ : state) solver.Solve(work->problems, {}, work->results);
  state.counters[kFallbackCounter] = static_cast<double>(solver.fallbacks()) / static_cast<double>(kSeeds);
}

void TimeDense(benchmark::State& state, Workload* work) {
  BatchSolver solver;
  const DenseBatch batch{work->rows, static_cast<Index>(kSeeds), work->A.data(), work->b.data(),
                         work->bilateral.data()};
  for (auto _ : state) solver.Solve(batch, {}, work->f.data(), work->status.data());
  work->TakeDense();
  state.counters[kFallbackCounter] = static_cast<double>(solver.fallbacks()) / static_cast<double>(kSeeds);
}

// A problem is prepared, hence known, only once per batch: Prepare is part of what one pays for one after another.
void TimeOneByOne(benchmark::State& state, Workload* work, const char* key) {
  const std::unique_ptr<LcpSolver> solver = MakeSolver(key);
  solver->Reserve(work->rows);
  const auto solve_all = [&] {
    for (std::size_t p = 0; p < work->problems.size(); ++p) solver->Solve(work->problems[p], {}, &work->results[p]);
  };
  solve_all();
  for (auto _ : state) solve_all();
}

using Method = std::function<void(benchmark::State&, Workload*)>;

std::vector<std::pair<std::string, Method>> Methods() {
  std::vector<std::pair<std::string, Method>> methods;
  for (const char* key : {"auto", "dantzig"}) {
    methods.emplace_back(key, [key](benchmark::State& state, Workload* work) { TimeOneByOne(state, work, key); });
  }
  for (const BatchInstructions instructions : AvailableBatchInstructions()) {
    methods.emplace_back(ToString(instructions), [instructions](benchmark::State& state, Workload* work) {
      TimeBatch(state, work, instructions);
    });
  }
  methods.emplace_back("dense", TimeDense);
  return methods;
}

// By problems before method, so that a workload is made once.
void RegisterAll() {
  for (const int rows : kSizes) {
    for (const SceneFamily& family : AllScenes()) {
      for (const auto& [method, run] : Methods()) {
        const std::string name = std::string(family.key) + "/" + method + "/" + std::to_string(rows);
        const auto time = [key = family.key, rows, run = run](benchmark::State& state) {
          Workload& work = kept.Get(std::string(key) + "/" + std::to_string(rows), key, rows);
          run(state, &work);
          state.counters["refused"] = work.CountRefused();
          CountPerItem(state, kSeeds);
        };
        benchmark::RegisterBenchmark(name.c_str(), time)->Unit(benchmark::kMicrosecond);
      }
    }
  }
}

constexpr std::int32_t kIslands = 100'000;
constexpr int kMostIslandRows = 16;
KeptWorkload<IslandBatch> kept_islands;

void TimeRows(benchmark::State& state, IslandBatch* work, bool single, BatchInstructions instructions) {
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

void RegisterRows() {
  for (const int p : {3, 6}) {
    for (const bool single : {false, true}) {
      using RowMethod = std::function<void(benchmark::State&, IslandBatch*)>;
      std::vector<std::pair<std::string, RowMethod>> methods;
      methods.emplace_back("floor", [single](auto& state, auto* work) { TimeFloor(state, work, single); });
      methods.emplace_back("one_by_one", [single](auto& state, auto* work) { TimeRowsOneByOne(state, work, single); });
      for (const BatchInstructions instructions : AvailableBatchInstructions()) {
        methods.emplace_back(ToString(instructions), [single, instructions](auto& state, auto* work) {
          TimeRows(state, work, single, instructions);
        });
      }
      for (const auto& [method, run] : methods) {
        const std::string name =
            std::string("rows/") + (p == 3 ? "plane/" : "space/") + (single ? "single/" : "double/") + method;
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
  lcpbench::RegisterRows();
  lcpbench::RegisterAll();
  return lcpbench::RunStudy(argc, argv);
}
