#include "solvers/derivative/derivative.h"

#include <algorithm>
#include <ctime>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "benchmarks/studies/studies.h"
#include "solvers/auto/auto_solver.h"

namespace lcpbench {
namespace {

constexpr double kTimeOfSolves = 0.05;  // [s]

double ProcessorTime() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

LcpResult SolveFresh(const LcpProblem& problem) {
  LcpResult result;
  AutoSolver().Solve(problem, {}, &result);
  return result;
}

struct Point {
  LcpProblem problem;
  Eigen::VectorXd f;
  Derivative derivative;
  ProblemChange change;  // of b, by velocities of bodies
};

// The problems of a stream that have factors and an answer, and what `auto` takes for all of them.
struct Points {
  explicit Points(const FreshStream& stream) {
    for (const LcpProblem& problem : stream.problems) {
      if (!problem.has_factors()) continue;
      const LcpResult result = SolveFresh(problem);
      if (result.status != LcpStatus::kSolved) continue;
      const Eigen::VectorXd velocities = Eigen::VectorXd::LinSpaced(problem.J().cols(), -1, 1);
      all.push_back({problem, result.f, Derivative(problem, result.f), {.b = problem.J() * velocities}});
    }
    const double begin = ProcessorTime();
    int passes = 0;
    for (; ProcessorTime() < begin + kTimeOfSolves; ++passes) {
      for (const Point& point : all) SolveFresh(point.problem.CopyOfGivenForm());
    }
    solve_s = (ProcessorTime() - begin) / passes;
  }

  // The share of the points for which `holds` is true.
  template <typename Holds>
  double Share(const Holds& holds) const {
    return static_cast<double>(std::count_if(all.begin(), all.end(), holds)) / static_cast<double>(all.size());
  }

  std::vector<Point> all;
  double solve_s = 0;
};

struct Part {
  const char* name;
  void (*run)(const Point& point);
};
constexpr Part kParts[] = {
    {"set-up", [](const Point& point) { benchmark::DoNotOptimize(Derivative(point.problem, point.f)); }},
    {"jvp", [](const Point& point) { benchmark::DoNotOptimize(point.derivative.Jvp(point.change)); }},
    {"vjp",
     [](const Point& point) { benchmark::DoNotOptimize(point.derivative.Vjp(*point.change.b, *point.change.b)); }}};

}  // namespace

void RegisterDerivatives(FreshProblems* problems) {
  for (FreshStream* stream : problems->streams()) {
    const auto points = std::make_shared<std::optional<Points>>();
    for (const Part& part : kParts) {
      const auto run = [problems, stream, points, &part](benchmark::State& state) {
        problems->Load(stream);
        if (!*points) points->emplace(*stream);
        const std::vector<Point>& all = (*points)->all;
        if (all.empty()) {
          state.SkipWithError("no problems by factors with an answer");
          return;
        }
        const double begin = ProcessorTime();
        for (auto _ : state) {
          for (const Point& point : all) part.run(point);
        }
        const double each = (ProcessorTime() - begin) / static_cast<double>(state.iterations());
        state.counters["over solve"] = each / (*points)->solve_s;
        state.counters["strict"] =
            (*points)->Share([](const Point& point) { return point.derivative.strictly_complementary(); });
        state.counters["unique"] = (*points)->Share(
            [](const Point& point) { return point.derivative.forces() == Derivative::Forces::kUnique; });
      };
      benchmark::RegisterBenchmark(("derivative/" + stream->name + "/" + part.name).c_str(), run)
          ->Unit(benchmark::kMicrosecond);
    }
  }
}

}  // namespace lcpbench
