// Times derivatives of a solution against its solve, with a new solver object each: the set-up (modes and factor), one
// product each way, and a product at a degenerate point, which solves once more.
//
// Scenes: contacts of discs, chains with joints, and time steps with friction, at 10 to 1000 rows. `over solve`: the
// ratio of processor times to a solve by `auto` in the same process.

#include <array>
#include <ctime>
#include <string>

#include "benchmarks/studies/study.h"
#include "model/contact/assembly.h"
#include "model/scenes/scene.h"
#include "solvers/auto/auto_solver.h"
#include "solvers/derivative/derivative.h"

namespace lcpbench {
namespace {

constexpr std::array kScenes = {"disc-pile", "chain-of-links", "pyramids", "card-house"};
constexpr std::array kSizes = {10, 30, 100, 300, 1000};
constexpr std::uint64_t kSeed = 1;
constexpr double kStep = 0.01;          // [s]
constexpr double kTimeOfSolves = 0.05;  // [s]

double ProcessorTime() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

LcpResult SolveFresh(const LcpProblem& problem) {
  LcpResult result;
  AutoSolver().Solve(problem, {}, &result);
  return result;
}

struct Workload {
  LcpProblem problem;
  Eigen::VectorXd f;
  Derivative derivative;
  ProblemChange change;  // of b, by velocities of bodies
  double solve_s = 0;

  Workload(const std::string& scene, int rows)
      : problem(AssembleInstant(GenerateScene(scene, rows, kSeed), kStep).problem),
        f(SolveFresh(problem).f),
        derivative(problem, f) {
    change.b = problem.J() * Eigen::VectorXd::LinSpaced(problem.J().cols(), -1, 1);
    const double begin = ProcessorTime();
    int solves = 0;
    for (; ProcessorTime() < begin + kTimeOfSolves; ++solves) SolveFresh(problem.CopyOfGivenForm());
    solve_s = (ProcessorTime() - begin) / solves;
  }
};

KeptWorkload<Workload> kept;

void SetUp(const Workload& work) { benchmark::DoNotOptimize(Derivative(work.problem, work.f)); }
void Jvp(const Workload& work) { benchmark::DoNotOptimize(work.derivative.Jvp(work.change)); }
void Vjp(const Workload& work) { benchmark::DoNotOptimize(work.derivative.Vjp(*work.change.b, *work.change.b)); }

struct Part {
  const char* name;
  void (*run)(const Workload& work);
};
constexpr std::array kParts = {Part{"set-up", SetUp}, Part{"jvp", Jvp}, Part{"vjp", Vjp}};

void Register(const std::string& scene, int rows, const Part& part) {
  const auto run = [scene, rows, part](benchmark::State& state) {
    const Workload& work = kept.Get(scene + std::to_string(rows), scene, rows);
    const double begin = ProcessorTime();
    for (auto _ : state) part.run(work);
    const double each = (ProcessorTime() - begin) / static_cast<double>(state.iterations());
    state.counters["over solve"] = each / work.solve_s;
    state.counters["rows"] = static_cast<double>(work.problem.size());
    state.counters["strict"] = work.derivative.strictly_complementary() ? 1 : 0;
    state.counters["unique"] = work.derivative.forces() == Derivative::Forces::kUnique ? 1 : 0;
  };
  const std::string name = scene + "/" + part.name + "/" + std::to_string(rows);
  benchmark::RegisterBenchmark(name.c_str(), run)->Unit(benchmark::kMicrosecond);
}

}  // namespace
}  // namespace lcpbench

int main(int argc, char** argv) {
  for (const char* scene : lcpbench::kScenes) {
    for (const int rows : lcpbench::kSizes) {
      for (const lcpbench::Part& part : lcpbench::kParts) lcpbench::Register(scene, rows, part);
    }
  }
  return lcpbench::RunStudy(argc, argv);
}
