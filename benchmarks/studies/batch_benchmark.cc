// Times SolveBatch: many problems of 10, 20 and 30 rows, one per SIMD lane, with each instruction set of this machine,
// beside one problem after another by `auto` and `dantzig` in the same run.
//
// A batch: 512 seeds of one scene family, so that lanes hold different problems. The table after Google Benchmark's own
// output has nanoseconds per problem, the least of all repetitions; in brackets the share of problems that lanes left
// to `auto`; and, after an exclamation mark, how many of the 512 answers the verifier refused. `dense` is the form
// without LcpProblem objects. Set-up (DenseA, symmetry) is not timed.
// Takes the options of Google Benchmark (--benchmark_filter=disc-pile, --benchmark_min_time=0.05, ...).

#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "model/contact/assembly.h"
#include "model/scenes/scene.h"
#include "solvers/auto/auto_solver.h"
#include "solvers/batch/solve_batch.h"
#include "solvers/lcp/verify.h"
#include "solvers/pivoting/dantzig.h"

namespace lcpbench {
namespace {

constexpr std::array kSizes = {10, 20, 30};
constexpr std::uint64_t kSeeds = 512;
constexpr const char* kFallbackCounter = "fallback";
constexpr const char* kRefusedCounter = "refused";

struct Workload {
  std::string_view family;
  int rows = 0;
  std::vector<LcpProblem> problems;
  std::vector<LcpResult> results;
  std::vector<double> A, b, f;
  std::vector<std::uint32_t> bilateral;
  std::vector<LcpStatus> status;

  Workload(std::string_view key, int n) : family(key), rows(n), results(kSeeds), status(kSeeds) {
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

// Only the current workload is kept: the methods on one follow each other.
Workload& CurrentWorkload(std::string_view family, int rows) {
  static std::unique_ptr<Workload> workload;
  if (workload == nullptr || workload->family != family || workload->rows != rows) {
    workload = std::make_unique<Workload>(family, rows);
  }
  return *workload;
}

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
template <typename Solver>
void TimeOneByOne(benchmark::State& state, Workload* work) {
  Solver solver;
  solver.Reserve(work->rows);
  const auto solve_all = [&] {
    for (std::size_t p = 0; p < work->problems.size(); ++p) solver.Solve(work->problems[p], {}, &work->results[p]);
  };
  solve_all();
  for (auto _ : state) solve_all();
}

struct Method {
  std::string name;
  std::function<void(benchmark::State&, Workload*)> run;
};

std::vector<Method> Methods() {
  std::vector<Method> methods;
  methods.push_back({"auto", TimeOneByOne<AutoSolver>});
  methods.push_back({"dantzig", TimeOneByOne<DantzigSolver>});
  for (const BatchInstructions instructions : AvailableBatchInstructions()) {
    methods.push_back({std::string(ToString(instructions)), [instructions](benchmark::State& state, Workload* work) {
                         TimeBatch(state, work, instructions);
                       }});
  }
  methods.push_back({"dense", TimeDense});
  return methods;
}

// Google Benchmark's console output, and the table after it.
class TableReporter : public benchmark::ConsoleReporter {
 public:
  explicit TableReporter(std::vector<Method> methods) : ConsoleReporter(OO_Tabular), methods_(std::move(methods)) {}

  void ReportRuns(const std::vector<Run>& runs) override {
    ConsoleReporter::ReportRuns(runs);
    for (const Run& run : runs) {
      if (run.run_type != Run::RT_Iteration) continue;
      const std::string& name = run.run_name.function_name;
      const std::size_t slash = name.rfind('/');
      Cell& cell = cells_[name.substr(0, slash)][name.substr(slash + 1)];
      const double ns = 1e9 * run.cpu_accumulated_time / static_cast<double>(run.iterations) / kSeeds;
      cell.ns = cell.ns == 0 ? ns : std::min(cell.ns, ns);
      if (const auto it = run.counters.find(kFallbackCounter); it != run.counters.end()) cell.fallback = it->second;
      if (const auto it = run.counters.find(kRefusedCounter); it != run.counters.end()) cell.refused = it->second;
    }
  }

  void Finalize() override {
    std::printf("\nNanoseconds per problem (share left to auto) !refused answers\n%-24s", "family/rows");
    for (const Method& method : methods_) std::printf("%18s", method.name.c_str());
    std::printf("\n");
    double all_refused = 0;
    for (const int rows : kSizes) {
      std::map<std::string, std::pair<double, int>> means;
      for (const auto& [row, cells] : cells_) {
        if (!row.ends_with("/" + std::to_string(rows))) continue;
        std::printf("%-24s", row.c_str());
        for (const Method& method : methods_) {
          const auto it = cells.find(method.name);
          if (it == cells.end()) {
            std::printf("%18s", "-");
            continue;
          }
          const Cell& cell = it->second;
          std::printf("%8.1f (%4.1f%%)%c%-2.0f", cell.ns, 100 * cell.fallback, cell.refused > 0 ? '!' : ' ',
                      cell.refused);
          all_refused += cell.refused;
          means[method.name].first += std::log(cell.ns);
          ++means[method.name].second;
        }
        std::printf("\n");
      }
      std::printf("%-24s", ("geometric mean/" + std::to_string(rows)).c_str());
      for (const Method& method : methods_) {
        const auto& [sum, count] = means[method.name];
        std::printf("%8.1f%10s", count > 0 ? std::exp(sum / count) : 0.0, "");
      }
      std::printf("\n");
    }
    std::printf("Answers refused by the verifier: %.0f\n", all_refused);
  }

 private:
  struct Cell {
    double ns = 0;
    double fallback = 0;
    double refused = 0;
  };
  std::vector<Method> methods_;
  std::map<std::string, std::map<std::string, Cell>> cells_;
};

// By problems before method, so that a workload is made once.
void RegisterAll(const std::vector<Method>& methods) {
  for (const int rows : kSizes) {
    for (const SceneFamily& family : AllScenes()) {
      for (const Method& method : methods) {
        const std::string name = std::string(family.key) + "/" + std::to_string(rows) + "/" + method.name;
        const auto time = [key = family.key, rows, run = method.run](benchmark::State& state) {
          Workload& work = CurrentWorkload(key, rows);
          run(state, &work);
          state.counters[kRefusedCounter] = work.CountRefused();
        };
        benchmark::RegisterBenchmark(name.c_str(), time)->Unit(benchmark::kMicrosecond);
      }
    }
  }
}

}  // namespace
}  // namespace lcpbench

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  const std::vector<lcpbench::Method> methods = lcpbench::Methods();
  lcpbench::RegisterAll(methods);
  lcpbench::TableReporter reporter(methods);
  benchmark::RunSpecifiedBenchmarks(&reporter);
  return 0;
}
