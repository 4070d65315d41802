#include "benchmarks/studies/island_batch.h"

#include <array>
#include <cmath>
#include <random>
#include <utility>

#include "model/contact/assembly.h"
#include "model/scenes/scene.h"
#include "solvers/lcp/verify.h"
#include "support/array_index.h"

namespace lcpbench {
namespace {

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

}  // namespace

IslandBatch::IslandBatch(int p, std::int32_t problems, int most_rows) : start{0} {
  arrays.columns_per_body = p;
  std::vector<std::vector<StepArrays>> scenes(At(most_rows) + 1);
  for (int n = 1; n <= most_rows; ++n) {
    for (const SceneFamily& family : AllScenes()) {
      for (std::uint64_t seed = 1; seed <= kSceneSeeds; ++seed) {
        const LcpProblem problem = AssembleContactLcp(family.generate(n, seed)).problem;
        if (!problem.has_two_body_rows()) continue;
        const StepArrays scene = StepArrays::Of(problem);
        if (IsSolvedWhenRounded(scene)) scenes[At(n)].push_back(p == 3 ? scene : InSpace(scene));
      }
    }
  }
  std::mt19937_64 engine(1);  // NOLINT(bugprone-random-generator-seed): the same problems in every run
  for (std::int32_t k = 0; k < problems; ++k) {
    const int n = 1 + static_cast<int>(engine() % static_cast<std::uint64_t>(most_rows));
    if (engine() % 2 == 0) {
      Add(scenes[At(n)][engine() % scenes[At(n)].size()]);
    } else {
      Add(RandomIsland(p, n, engine()));
    }
  }
  first_body.push_back(static_cast<std::int32_t>(arrays.bodies()));
  arrays.Round();
  f.resize(arrays.b.size());
  answers.resize(At(problems));
}

void IslandBatch::Add(const StepArrays& problem) {
  first_body.push_back(static_cast<std::int32_t>(arrays.bodies()));
  local_body.insert(local_body.end(), problem.body.begin(), problem.body.end());
  arrays.Append(problem);
  start.push_back(static_cast<std::int32_t>(arrays.rows()));
}

StepRows IslandBatch::RowsOf(std::size_t k, const StepRows& all) const {
  StepRows rows = PartOf(all, start[k], start[k + 1]);
  rows.body = local_body.data() + 2 * std::int64_t{start[k]};
  rows.bodies = first_body[k + 1] - first_body[k];
  rows.inverse_mass += std::int64_t{first_body[k]} * all.columns_per_body;
  return rows;
}

double IslandBatch::CountRefused(bool single) const {
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

void IslandBatch::ReadAllOnce(bool single) {
  const std::size_t width = 2 * At(arrays.columns_per_body);  // of a row
  double of_bodies = 0;
  for (const double m : arrays.inverse_mass) of_bodies += m;
  for (std::size_t i = 0; i < arrays.b.size(); ++i) {
    double sum = arrays.b[i] + arrays.body[2 * i] + arrays.body[2 * i + 1] + arrays.bilateral[i];
    for (std::size_t c = width * i; c < width * (i + 1); ++c) {
      sum += single ? static_cast<double>(arrays.J_single[c]) : arrays.J[c];
    }
    f[i] = sum;
  }
  answers[0].rho = of_bodies;
  for (StepAnswer& answer : answers) answer.status = LcpStatus::kNotRun;
}

}  // namespace lcpbench
