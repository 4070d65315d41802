#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "benchmarks/studies/step_arrays.h"
#include "benchmarks/studies/studies.h"
#include "solvers/lcp/verify.h"
#include "solvers/linear_algebra/instruction_set.h"
#include "solvers/step/step_solver.h"
#include "support/array_index.h"

namespace lcpbench {
namespace {

constexpr Index kMostIslandRows = 64;
constexpr std::size_t kMostIslands = 100'000;
// A batch of large islands has fewer of them.
constexpr Index kMostRows = 2'000'000;
// Where a number of a body in the plane is in one of six.
constexpr std::array<int, 3> kInSpace{0, 1, 5};

// The same bodies and rows in a plane of space.
StepArrays InSpace(const StepArrays& plane) {
  StepArrays space = plane;
  space.columns_per_body = 6;
  space.J.assign(2 * plane.J.size(), 0.0);
  space.inverse_mass.assign(2 * plane.inverse_mass.size(), 0.0);
  for (std::size_t k = 0; k < plane.J.size(); ++k) space.J[6 * (k / 3) + At(kInSpace[k % 3])] = plane.J[k];
  for (std::size_t k = 0; k < space.inverse_mass.size(); ++k) {
    // Translations have the mass of the first one, rotations the moment of inertia.
    space.inverse_mass[k] = plane.inverse_mass[3 * (k / 6) + (k % 6 < 3 ? 0 : 2)];
  }
  for (std::size_t k = 0; k < plane.inverse_mass.size(); ++k) {
    space.inverse_mass[6 * (k / 3) + At(kInSpace[k % 3])] = plane.inverse_mass[k];
  }
  return space;
}

// Many small problems in one piece of memory, as an engine has them after it has found its islands: drawn from a
// stream's by their weights, each with bodies of its own.
struct IslandBatch {
  IslandBatch(const FreshStream& stream, int p) {
    std::vector<double> weights;
    for (std::size_t k = 0; k < stream.problems.size(); ++k) {
      const LcpProblem& problem = stream.problems[k];
      if (!problem.is_plain() || !problem.has_factors() || !problem.has_two_body_rows()) continue;
      if (problem.columns_per_body() > p || problem.size() > kMostIslandRows) continue;
      const StepArrays island = StepArrays::Of(problem);
      islands.push_back(island.columns_per_body == p ? island : InSpace(island));
      islands.back().Round();
      weights.push_back(stream.planned[k].weight);
    }
    arrays.columns_per_body = p;
    std::mt19937_64 engine(1);  // NOLINT(bugprone-random-generator-seed): the same problems in every run
    std::discrete_distribution<std::size_t> draw(weights.begin(), weights.end());
    while (!islands.empty() && drawn.size() < kMostIslands && arrays.rows() < kMostRows) {
      arrays.Append(islands[drawn.emplace_back(draw(engine))]);
      start.push_back(static_cast<std::int32_t>(arrays.rows()));
    }
    arrays.Round();
    f.resize(arrays.b.size());
    answers.resize(drawn.size());
  }

  // Which share of the answers the verifier refuses, on J as the solver had it.
  double RefusedShare(bool single) const {
    double refused = 0;
    for (std::size_t k = 0; k < drawn.size(); ++k) {
      const LcpProblem problem = islands[drawn[k]].Problem(single);
      LcpResult result;
      result.status = answers[k].status;
      result.f = Eigen::Map<const Eigen::VectorXd>(f.data() + start[k], problem.size());
      if (result.status != LcpStatus::kSolved || !Verify(problem, result, LcpOptions{}.tolerance).passes) ++refused;
    }
    return refused / static_cast<double>(drawn.size());
  }

  std::vector<StepArrays> islands;
  std::vector<std::size_t> drawn;  // of them
  StepArrays arrays;
  std::vector<std::int32_t> start{0};  // by problem, as StepSolver::SolveBatch
  std::vector<double> f;
  std::vector<StepAnswer> answers;
};

// Every number once in order, and f written: the least that memory asks for.
void ReadAllOnce(IslandBatch* work, bool single) {
  const StepArrays& arrays = work->arrays;
  const std::size_t width = 2 * At(arrays.columns_per_body);  // of a row
  double of_bodies = 0;
  for (const double m : arrays.inverse_mass) of_bodies += m;
  for (std::size_t i = 0; i < arrays.b.size(); ++i) {
    double sum = arrays.b[i] + arrays.body[2 * i] + arrays.body[2 * i + 1] + arrays.bilateral[i];
    for (std::size_t c = width * i; c < width * (i + 1); ++c) {
      sum += single ? static_cast<double>(arrays.J_single[c]) : arrays.J[c];
    }
    work->f[i] = sum;
  }
  work->answers[0].rho = of_bodies;
  for (StepAnswer& answer : work->answers) answer.status = LcpStatus::kNotRun;
}

// A benchmark on the batches of all streams: the one before goes when another begins.
struct BatchBenchmark {
  FreshProblems* problems;
  FreshStream* stream;
  int p;
  bool single;
  std::optional<InstructionSet> instructions;  // none: the floor
  int threads = 1;

  std::string Name() const {
    return "batch/" + stream->name + (p == 3 ? "/plane" : "/space") + (single ? "/single/" : "/double/") +
           (instructions ? std::string(ToString(*instructions)) : "floor") + "/threads:" + std::to_string(threads);
  }

  void Run(benchmark::State& state) const {
    static std::pair<const FreshStream*, int> kept_of;
    static std::unique_ptr<IslandBatch> kept;
    problems->Load(stream);
    if (!kept || kept_of != std::pair<const FreshStream*, int>(stream, p)) {
      kept.reset();
      kept = std::make_unique<IslandBatch>(*stream, p);
      kept_of = {stream, p};
    }
    if (kept->drawn.empty()) {
      state.SkipWithError("no plain problems on two bodies a row");
    } else if (instructions) {
      StepSolver solver({.instructions = *instructions, .threads = threads});
      solver.Reserve(kMostIslandRows, 2 * kMostIslandRows);
      const StepRows rows = kept->arrays.View(single);
      for (auto _ : state) solver.SolveBatch(rows, kept->start, kept->f.data(), kept->answers);
      state.counters["left"] = static_cast<double>(solver.left()) / static_cast<double>(kept->drawn.size());
      state.counters["refused"] = kept->RefusedShare(single);
    } else {
      for (auto _ : state) ReadAllOnce(kept.get(), single);
    }
    CountPerRow(state, static_cast<double>(kept->arrays.rows()));
  }
};

void Register(const BatchBenchmark& batch) {
  auto* const registered =
      benchmark::RegisterBenchmark(batch.Name().c_str(), [batch](benchmark::State& state) { batch.Run(state); });
  registered->Unit(benchmark::kMillisecond);
  if (batch.threads > 1) registered->UseRealTime();
}

}  // namespace

void RegisterBatch(FreshProblems* problems) {
  for (FreshStream* stream : problems->streams()) {
    if (stream->planned.front().size_class->least > kMostIslandRows) continue;
    for (const int p : {3, 6}) {
      for (const bool single : {false, true}) {
        Register({problems, stream, p, single, std::nullopt});
        for (const InstructionSet instructions : AvailableInstructionSets()) {
          for (const int threads : {1, 2}) Register({problems, stream, p, single, instructions, threads});
        }
      }
    }
  }
}

}  // namespace lcpbench
