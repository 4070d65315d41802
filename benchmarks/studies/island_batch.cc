#include "benchmarks/studies/island_batch.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <random>
#include <string>
#include <utility>

#include "model/contact/assembly.h"
#include "model/scenes/scene.h"
#include "solvers/lcp/verify.h"
#include "solvers/rows/row_solver.h"

namespace lcpbench {
namespace {

std::size_t At(std::int64_t i) { return static_cast<std::size_t>(i); }

// Of each family and size.
constexpr std::uint64_t kSceneSeeds = 40;
// Where a number of a body in the plane is in one of six.
constexpr std::array<int, 3> kInSpace{0, 1, 5};

class Scene {
 public:
  explicit Scene(const LcpProblem& problem) : arrays_(ProblemArrays::Of(problem)) { is_taken_ = copy_.Take(arrays_); }
  const StepRows& rows() const { return copy_.rows(); }
  bool IsSolvedWhenRounded() const {
    if (!is_taken_) return false;
    StepRows rounded = rows();
    const std::vector<float> J(rounded.J, rounded.J + 6 * rounded.rows);
    rounded.J = nullptr;
    rounded.J_single = J.data();
    std::vector<double> f(At(rounded.rows));
    return StepSolver().Solve(rounded, nullptr, f.data()).status == LcpStatus::kSolved;
  }

 private:
  ProblemArrays arrays_;  // read in place
  TwoBodyCopy copy_;
  bool is_taken_ = false;
};

}  // namespace

IslandBatch::IslandBatch(int p, std::int32_t problems, int most_rows) : columns_per_body(p), start{0} {
  std::vector<std::vector<std::unique_ptr<Scene>>> scenes(At(most_rows) + 1);
  for (int n = 1; n <= most_rows; ++n) {
    for (const SceneFamily& family : AllScenes()) {
      for (std::uint64_t seed = 1; seed <= kSceneSeeds; ++seed) {
        auto scene = std::make_unique<Scene>(AssembleContactLcp(family.generate(n, seed)).problem);
        if (scene->IsSolvedWhenRounded()) scenes[At(n)].push_back(std::move(scene));
      }
    }
  }
  std::mt19937_64 engine(1);  // NOLINT(bugprone-random-generator-seed): the same problems in every run
  for (std::int32_t k = 0; k < problems; ++k) {
    const int n = 1 + static_cast<int>(engine() % static_cast<std::uint64_t>(most_rows));
    if (engine() % 2 == 0) {
      AddScene(scenes[At(n)][engine() % scenes[At(n)].size()]->rows());
    } else {
      AddRandom(n, engine());
    }
  }
  first_body.push_back(static_cast<std::int32_t>(inverse_mass.size()) / p);
  J_single.assign(J.begin(), J.end());
  f.resize(b.size());
  answers.resize(At(problems));
}

void IslandBatch::AddScene(const StepRows& rows) {
  const int p = columns_per_body;
  first_body.push_back(static_cast<std::int32_t>(inverse_mass.size()) / p);
  for (Index k = 0; k < 2 * rows.rows; ++k) {
    AddBody(rows.body[k]);
    double numbers[6] = {};
    for (int c = 0; c < 3; ++c) numbers[p == 3 ? c : kInSpace[At(c)]] = rows.J[3 * k + c];
    J.insert(J.end(), numbers, numbers + p);
  }
  for (Index k = 0; k < rows.bodies; ++k) {
    double numbers[6] = {rows.inverse_mass[3 * k], rows.inverse_mass[3 * k], rows.inverse_mass[3 * k]};
    for (int c = 3; c < 6; ++c) numbers[c] = rows.inverse_mass[3 * k + 2];
    for (int c = 0; c < 3; ++c) numbers[p == 3 ? c : kInSpace[At(c)]] = rows.inverse_mass[3 * k + c];
    inverse_mass.insert(inverse_mass.end(), numbers, numbers + p);
  }
  for (Index i = 0; i < rows.rows; ++i) {
    b.push_back(rows.b[i]);
    bilateral.push_back(rows.bilateral != nullptr ? rows.bilateral[i] : 0);
  }
  start.push_back(static_cast<std::int32_t>(b.size()));
}

void IslandBatch::AddBody(std::int32_t local) {
  local_body.push_back(local);
  body.push_back(local < 0 ? -1 : first_body.back() + local);
}

// Contacts and a few joints of bodies among each other and with the ground; b = J v + gaps, so that there is an answer.
void IslandBatch::AddRandom(int rows, std::uint64_t seed) {
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform;
  const int p = columns_per_body;
  const int bodies = 1 + static_cast<int>(engine() % static_cast<std::uint64_t>(1 + (rows / 2)));
  first_body.push_back(static_cast<std::int32_t>(inverse_mass.size()) / p);
  std::vector<double> velocity(At(std::int64_t{bodies} * p));
  for (double& v : velocity) v = normal(engine);
  for (int k = 0; k < bodies; ++k) {
    const double mass = std::exp2(normal(engine));
    for (int c = 0; c < p; ++c) inverse_mass.push_back((c < p / 2 + (p == 3 ? 1 : 0) ? 1 : 3 + uniform(engine)) / mass);
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
      J.insert(J.end(), numbers, numbers + p);
      AddBody(on);
    }
    b.push_back(load);
    bilateral.push_back(is_joint ? 1 : 0);
  }
  start.push_back(static_cast<std::int32_t>(b.size()));
}

StepRows IslandBatch::Rows(bool single) const {
  StepRows rows;
  rows.columns_per_body = columns_per_body;
  rows.rows = static_cast<Index>(b.size());
  rows.bodies = static_cast<Index>(inverse_mass.size()) / columns_per_body;
  rows.body = body.data();
  rows.J = single ? nullptr : J.data();
  rows.J_single = single ? J_single.data() : nullptr;
  rows.b = b.data();
  rows.bilateral = bilateral.data();
  rows.inverse_mass = inverse_mass.data();
  return rows;
}

StepRows IslandBatch::RowsOf(std::size_t k, bool single) const {
  StepRows rows = PartOf(Rows(single), start[k], start[k + 1]);
  rows.body = local_body.data() + 2 * std::int64_t{start[k]};
  rows.bodies = first_body[k + 1] - first_body[k];
  rows.inverse_mass += std::int64_t{first_body[k]} * columns_per_body;
  return rows;
}

double IslandBatch::CountRefused(bool single) const {
  double refused = 0;
  const int p = columns_per_body;
  for (std::size_t k = 0; k + 1 < start.size(); ++k) {
    ProblemArrays arrays;
    arrays.id = std::to_string(k);
    arrays.rows = start[k + 1] - start[k];
    arrays.facts.symmetric = arrays.facts.positive_semidefinite = true;
    arrays.facts.columns_per_body = p;
    arrays.row_start.push_back(0);
    std::vector<std::int32_t> bodies;  // in the order in which rows name them
    for (std::int64_t i = start[k]; i < start[k + 1]; ++i) {
      std::vector<std::pair<int, double>> entries;
      for (std::int64_t side = 2 * i; side < 2 * i + 2; ++side) {
        if (body[At(side)] < 0) continue;
        std::size_t local = 0;
        while (local < bodies.size() && bodies[local] != body[At(side)]) ++local;
        if (local == bodies.size()) {
          bodies.push_back(body[At(side)]);
          const double* mass = inverse_mass.data() + std::int64_t{body[At(side)]} * p;
          arrays.inverse_mass.insert(arrays.inverse_mass.end(), mass, mass + p);
        }
        for (int c = 0; c < p; ++c) {
          const double number = single ? static_cast<double>(J_single[At(side * p + c)]) : J[At(side * p + c)];
          entries.emplace_back(static_cast<int>(local) * p + c, number);
        }
      }
      std::sort(entries.begin(), entries.end());
      for (const auto& [column, value] : entries) {
        arrays.column.push_back(column);
        arrays.value.push_back(value);
      }
      arrays.row_start.push_back(static_cast<int>(arrays.column.size()));
    }
    arrays.columns = static_cast<Index>(arrays.inverse_mass.size());
    arrays.b.assign(b.begin() + start[k], b.begin() + start[k + 1]);
    arrays.bilateral.assign(bilateral.begin() + start[k], bilateral.begin() + start[k + 1]);
    const LcpProblem problem = LcpProblem::FromArrays(arrays);
    LcpResult result;
    result.status = answers[k].status;
    result.f = Eigen::Map<const Eigen::VectorXd>(f.data() + start[k], problem.size());
    const Verdict verdict = Verify(problem, result, LcpOptions{}.tolerance);
    if (result.status != LcpStatus::kSolved || !verdict.passes) ++refused;
  }
  return refused;
}

void IslandBatch::ReadAllOnce(bool single) {
  const int p = columns_per_body;
  double of_bodies = 0;
  for (const double m : inverse_mass) of_bodies += m;
  for (std::size_t i = 0; i < b.size(); ++i) {
    double sum = b[i] + body[2 * i] + body[2 * i + 1] + bilateral[i];
    const std::size_t first = 2 * At(p) * i;
    for (std::size_t c = first; c < first + 2 * At(p); ++c) sum += single ? static_cast<double>(J_single[c]) : J[c];
    f[i] = sum;
  }
  answers[0].rho = of_bodies;
  for (StepAnswer& answer : answers) answer.status = LcpStatus::kNotRun;
}

}  // namespace lcpbench
