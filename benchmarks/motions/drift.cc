#include "benchmarks/motions/drift.h"

#include <cmath>
#include <optional>

#include "benchmarks/motions/scene_source.h"
#include "model/motion/row_matching.h"
#include "model/scenes/random.h"
#include "solvers/registry.h"

namespace lcpbench {
namespace {

// Of the motion: what its solver is asked for, and what it may take [s].
constexpr double kMotionTolerance = 1e-9;
constexpr double kMotionTimeLimit = 10;

// Remembers the latest problem, and pairs it with the next of its kind when asked.
class PairCollector {
 public:
  void Observe(const MotionProblem& met) {
    if (met.kind == MotionProblemKind::kImpact || met.problem.size() == 0) return;
    const std::vector<std::optional<int>> previous = matching_.Follow(met.system, met.rows);
    if (wanted_ && latest_.has_value() && latest_kind_ == met.kind) {
      std::vector<int> row_before;
      row_before.reserve(previous.size());
      for (const std::optional<int>& row : previous) row_before.push_back(row.value_or(-1));
      pairs_.push_back({*latest_, met.problem, std::move(row_before)});
      wanted_ = false;
    }
    latest_ = met.problem;
    latest_kind_ = met.kind;
  }

  void WantOne() { wanted_ = true; }
  std::vector<ConsecutiveProblems> Take() { return std::move(pairs_); }

 private:
  RowMatching matching_;
  std::optional<LcpProblem> latest_;
  MotionProblemKind latest_kind_ = MotionProblemKind::kTimeStep;
  bool wanted_ = false;
  std::vector<ConsecutiveProblems> pairs_;
};

LcpProblem RowsOf(const LcpProblem& given, const std::vector<int>& rows, const std::string& id) {
  std::vector<Eigen::Triplet<double, int>> entries;
  std::vector<Index> bilateral;
  Eigen::VectorXd b(static_cast<Index>(rows.size()));
  for (int k = 0; k < static_cast<int>(rows.size()); ++k) {
    const int row = rows[static_cast<size_t>(k)];
    b[k] = given.b()[row];
    if (given.is_bilateral(row)) bilateral.push_back(k);
    for (SparseMatrix::InnerIterator it(given.J(), row); it; ++it) {
      entries.emplace_back(k, static_cast<int>(it.col()), it.value());
    }
  }
  SparseMatrix J(b.size(), given.J().cols());
  J.setFromTriplets(entries.begin(), entries.end());
  const Index n = b.size();
  return LcpProblem::FromFactors(id, J, given.inverse_mass(), std::move(b), RowBounds::WithBilateralRows(n, bilateral));
}

}  // namespace

ConsecutiveProblems LoseContacts(const LcpProblem& given, double part, std::uint64_t seed) {
  Random random(seed);
  std::vector<int> before, after, row_before;
  for (int i = 0; i < static_cast<int>(given.size()); ++i) {
    const bool was = random.Uniform(0, 1) >= part || given.is_bilateral(i);
    const bool is = random.Uniform(0, 1) >= part || given.is_bilateral(i);
    if (was) before.push_back(i);
    if (!is) continue;
    after.push_back(i);
    row_before.push_back(was ? static_cast<int>(before.size()) - 1 : -1);
  }
  return {RowsOf(given, before, given.id() + "-before"), RowsOf(given, after, given.id() + "-after"),
          std::move(row_before)};
}

LcpProblem Drift(const LcpProblem& given, double size, std::uint64_t seed) {
  Random random(seed);
  const SparseMatrix& J = given.J();
  Eigen::VectorXd inverse_mass = given.inverse_mass();
  Eigen::VectorXd acceleration(inverse_mass.size());
  double mass_change = 0;
  for (Index k = 0; k < inverse_mass.size(); ++k) {
    if (k % 3 != 1) mass_change = random.Uniform(-size, size);  // x and y share the mass
    acceleration[k] = std::sqrt(inverse_mass[k]) * random.Uniform(-1, 1);
    inverse_mass[k] *= 1 + mass_change;
  }
  const Eigen::VectorXd& D = given.DiagonalA();
  Eigen::VectorXd change = J * acceleration;
  double change_squared = 0;
  double b_squared = 0;
  for (Index i = 0; i < given.size(); ++i) {
    if (D[i] == 0) continue;
    change_squared += change[i] * change[i] / D[i];
    b_squared += given.b()[i] * given.b()[i] / D[i];
  }
  if (change_squared > 0) change *= size * std::sqrt(b_squared / change_squared);
  return LcpProblem::FromFactors(given.id() + "-drifted", J, inverse_mass, given.b() + change,
                                 RowBounds::WithBilateralRows(given.size(), given.bilateral_rows()), given.facts());
}

std::vector<ConsecutiveProblems> PairsOfMotion(const std::string& family, int size, std::uint64_t seed, int pairs,
                                               int spacing) {
  const MovingScene scene = LoadScene(family, size, seed);
  const std::unique_ptr<LcpSolver> solver = MakeSolver("semismooth-newton");
  LcpOptions options;
  options.tolerance = kMotionTolerance;
  options.time_limit_s = kMotionTimeLimit;
  const std::unique_ptr<Motion> motion = StartMotion(scene, options, *solver);
  PairCollector collector;
  motion->set_observer([&](const MotionProblem& met) { collector.Observe(met); });
  for (int step = 1; step <= pairs * spacing && motion->status() == MotionStatus::kMoving; ++step) {
    if (step % spacing == 0) collector.WantOne();
    motion->Advance(scene.step);
  }
  return collector.Take();
}

}  // namespace lcpbench
