// Times StepSolver::SolveBatch from an engine's arrays to forces: 100,000 islands (IslandBatch) of 1 to 16 rows, in the
// plane and in space, J in double and in single precision, and of one size (rows:32) in the plane, on 1 and 2 threads;
// fresh in every pass, because all together are larger than the caches. Items are rows. `left`: the share of problems
// that lanes did not solve; `refused`: how many answers the verifier refused; `floor` reads the arrays once in order
// and writes f once; `one_by_one` is StepSolver::Solve.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "benchmarks/collection/sealed.h"
#include "benchmarks/measure/data_file.h"
#include "benchmarks/studies/step_arrays.h"
#include "benchmarks/studies/study.h"
#include "model/contact/assembly.h"
#include "model/scenes/scene.h"
#include "solvers/lcp/verify.h"
#include "solvers/linear_algebra/instruction_set.h"
#include "solvers/step/step_solver.h"
#include "support/array_index.h"

namespace lcpbench {
namespace {

constexpr int kIslands = 100'000;
constexpr int kMostMixedRows = 16;
constexpr int kMostIslandRows = 64;
constexpr int kSizes[] = {1, 3, 6, 10, 16, 32, 64};
// A batch of large islands has fewer of them: no more rows than this.
constexpr int kMostRows = 2'000'000;
// Seeds of each family and size.
constexpr std::uint64_t kSceneSeeds = 40;
// Where a number of a body in the plane is in one of six.
constexpr std::array<int, 3> kInSpace{0, 1, 5};

bool IsSolvedWhenRounded(StepArrays arrays) {
  arrays.Round();
  std::vector<double> f(arrays.b.size());
  return StepSolver().Solve(arrays.View(true), nullptr, f.data()).status == LcpStatus::kSolved;
}

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

// Contacts and a few joints of bodies among each other and with the ground; b = J v + gaps, so that there is an answer.
StepArrays RandomIsland(int p, int rows, std::uint64_t seed) {
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform;
  StepArrays island;
  island.columns_per_body = p;
  const int bodies = 1 + static_cast<int>(engine() % static_cast<std::uint64_t>(1 + (rows / 2)));
  std::vector<double> velocity(At(std::int64_t{bodies} * p));
  for (double& v : velocity) v = normal(engine);
  for (int k = 0; k < bodies; ++k) {
    const double mass = std::exp2(normal(engine));
    for (int c = 0; c < p; ++c) {
      island.inverse_mass.push_back((c < p / 2 + (p == 3 ? 1 : 0) ? 1 : 3 + uniform(engine)) / mass);
    }
  }
  for (int i = 0; i < rows; ++i) {
    const int first = static_cast<int>(engine() % static_cast<std::uint64_t>(bodies));
    const int other = static_cast<int>(engine() % static_cast<std::uint64_t>(bodies + 1));
    const int second = other == bodies || other == first ? -1 : other;
    double n[3] = {normal(engine), normal(engine), p == 3 ? 0.0 : normal(engine)};
    const double length = std::hypot(n[0], n[1], n[2]);
    for (double& x : n) x /= length;
    const bool is_joint = uniform(engine) < 0.05;
    double load = is_joint || uniform(engine) < 0.5 ? 0.0 : uniform(engine);
    std::vector<double> of_row;
    for (int side = 0; side < 2; ++side) {
      const int on = side == 0 ? first : second;
      const double sign = side == 0 ? 1.0 : -1.0;
      const double r[3] = {uniform(engine) - 0.5, uniform(engine) - 0.5, p == 3 ? 0.0 : uniform(engine) - 0.5};
      const double turn[3] = {r[1] * n[2] - r[2] * n[1], r[2] * n[0] - r[0] * n[2], r[0] * n[1] - r[1] * n[0]};
      double numbers[6] = {n[0], n[1], p == 3 ? turn[2] : n[2], turn[0], turn[1], turn[2]};
      for (int c = 0; c < p; ++c) {
        // Single precision has them exactly.
        numbers[c] = on < 0 ? 0.0 : sign * static_cast<double>(static_cast<float>(numbers[c]));
        if (on >= 0) load += numbers[c] * velocity[At(on * p + c)];
      }
      of_row.insert(of_row.end(), numbers, numbers + p);
    }
    island.Add(first, second, of_row, load, is_joint);
  }
  return island;
}

// Many small problems in one piece of memory, as an engine has them after it has found its islands: half of them
// generated scenes of all families that are not sealed, half random rows; sizes evenly mixed, each with bodies of its
// own. Scenes that have no answer once J is rounded to single precision (self-stress and a load on it) are left out, in
// both precisions.
class IslandBatch {
 public:
  // p is 3 in the plane and 6 in space; scenes lie in a plane of it then.
  IslandBatch(int p, int least_rows, int most_rows) {
    arrays.columns_per_body = p;
    std::vector<std::vector<StepArrays>> scenes(At(most_rows + 1));
    const SealedSet sealed = SealedSet::Read(DataFile("sealed"));
    for (int n = least_rows; n <= most_rows; ++n) {
      for (const SceneFamily& family : AllScenes()) {
        if (sealed.Has(family.key)) continue;
        for (std::uint64_t seed = 1; seed <= kSceneSeeds; ++seed) {
          const LcpProblem problem = AssembleContactLcp(family.generate(n, seed)).problem;
          if (!problem.has_two_body_rows()) continue;
          const StepArrays scene = StepArrays::Of(problem);
          if (IsSolvedWhenRounded(scene)) scenes[At(n)].push_back(p == 3 ? scene : InSpace(scene));
        }
      }
    }
    std::mt19937_64 engine(1);  // NOLINT(bugprone-random-generator-seed): the same problems in every run
    const int islands = std::min(kIslands, kMostRows / most_rows);
    for (int k = 0; k < islands; ++k) {
      const int n = least_rows + static_cast<int>(engine() % static_cast<std::uint64_t>(most_rows - least_rows + 1));
      if (engine() % 2 == 0) {
        Add(scenes[At(n)][engine() % scenes[At(n)].size()]);
      } else {
        Add(RandomIsland(p, n, engine()));
      }
    }
    first_body_.push_back(static_cast<std::int32_t>(arrays.bodies()));
    arrays.Round();
    f.resize(arrays.b.size());
    answers.resize(At(islands));
  }

  // Problem k alone, its bodies counted from 0, of a view of all.
  StepRows RowsOf(std::size_t k, const StepRows& all) const {
    StepRows rows = PartOf(all, start[k], start[k + 1]);
    rows.body = local_body_.data() + 2 * std::int64_t{start[k]};
    rows.bodies = first_body_[k + 1] - first_body_[k];
    rows.inverse_mass += std::int64_t{first_body_[k]} * all.columns_per_body;
    return rows;
  }

  // How many of the answers the verifier refuses, on J as the solver had it.
  double CountRefused(bool single) const {
    double refused = 0;
    const StepRows all = arrays.View(single);
    for (std::size_t k = 0; k < answers.size(); ++k) {
      const LcpProblem problem = ProblemOf(RowsOf(k, all));
      LcpResult result;
      result.status = answers[k].status;
      result.f = Eigen::Map<const Eigen::VectorXd>(f.data() + start[k], problem.size());
      const Verdict verdict = Verify(problem, result, LcpOptions{}.tolerance);
      if (result.status != LcpStatus::kSolved || !verdict.passes) ++refused;
    }
    return refused;
  }

  StepArrays arrays;
  std::vector<std::int32_t> start{0};  // by problem, as StepSolver::SolveBatch
  std::vector<double> f;
  std::vector<StepAnswer> answers;

 private:
  void Add(const StepArrays& problem) {
    first_body_.push_back(static_cast<std::int32_t>(arrays.bodies()));
    local_body_.insert(local_body_.end(), problem.body.begin(), problem.body.end());
    arrays.Append(problem);
    start.push_back(static_cast<std::int32_t>(arrays.rows()));
  }

  std::vector<std::int32_t> local_body_;  // as arrays.body, the bodies of each problem counted from 0
  std::vector<std::int32_t> first_body_;  // by problem
};

KeptWorkload<IslandBatch> kept_islands;

void TimeRows(benchmark::State& state, IslandBatch* work, bool single, const StepOptions& options) {
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

void RegisterSize(int n) {
  for (const InstructionSet instructions : AvailableInstructionSets()) {
    for (const int threads : {1, 2}) {
      const std::string name = "rows:" + std::to_string(n) + "/" + std::string(ToString(instructions)) +
                               "/threads:" + std::to_string(threads);
      const auto time = [n, instructions, threads](benchmark::State& state) {
        IslandBatch& work = kept_islands.Get("rows " + std::to_string(n), 3, n, n);
        TimeRows(state, &work, false, {.instructions = instructions, .threads = threads});
        state.counters["refused"] = work.CountRefused(false);
        CountPerItem(state, work.start.back());
      };
      benchmark::RegisterBenchmark(name.c_str(), time)->Unit(benchmark::kMillisecond)->UseRealTime();
    }
  }
}

void RegisterAll() {
  for (const int n : kSizes) RegisterSize(n);
  for (const int p : {3, 6}) {
    for (const bool single : {false, true}) {
      using RowMethod = std::function<void(benchmark::State&, IslandBatch*)>;
      std::vector<std::pair<std::string, RowMethod>> methods;
      methods.emplace_back("floor", [single](auto& state, auto* work) {
        for (auto _ : state) ReadAllOnce(work, single);
      });
      methods.emplace_back("one_by_one", [single](auto& state, auto* work) { TimeRowsOneByOne(state, work, single); });
      for (const InstructionSet instructions : AvailableInstructionSets()) {
        methods.emplace_back(ToString(instructions), [single, instructions](auto& state, auto* work) {
          TimeRows(state, work, single, {.instructions = instructions});
        });
      }
      for (const auto& [method, run] : methods) {
        const std::string name = std::string(p == 3 ? "plane/" : "space/") + (single ? "single/" : "double/") + method;
        const auto time = [p, single, method = method, run = run](benchmark::State& state) {
          IslandBatch& work = kept_islands.Get(std::to_string(p), p, 1, kMostMixedRows);
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
