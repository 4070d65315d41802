#include "solvers/friction/relaxation.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "solvers/auto/auto_solver.h"
#include "support/array_index.h"

namespace lcpbench {
namespace {

using Triplet = Eigen::Triplet<double, int>;

// The rows of the relaxed problem as sums of the given ones; forces are given back by its transpose.
struct RelaxedRows {
  SparseMatrix P;
  RowBounds bounds;
};

RelaxedRows RelaxRows(const LcpProblem& problem) {
  const Index n = problem.size();
  std::vector<const FrictionRow*> tangent(At(n), nullptr);
  std::vector<char> is_tangent(At(n), 0);
  for (const FrictionRow& row : problem.friction_rows()) {
    is_tangent[At(row.row)] = 1;
    if (row.mu != 0) tangent[At(row.normal)] = &row;
  }
  std::vector<Triplet> entries;
  RelaxedRows relaxed;
  int m = 0;
  for (Index i = 0; i < n; ++i) {
    if (is_tangent[At(i)] != 0) continue;
    for (const int side : {1, -1}) {
      if (side < 0 && tangent[At(i)] == nullptr) continue;
      entries.emplace_back(m, static_cast<int>(i), 1);
      if (tangent[At(i)] != nullptr) {
        entries.emplace_back(m, static_cast<int>(tangent[At(i)]->row), side * tangent[At(i)]->mu);
      }
      relaxed.bounds.bilateral.push_back(problem.is_bilateral(i) ? 1 : 0);
      ++m;
    }
  }
  relaxed.P.resize(m, n);
  relaxed.P.setFromTriplets(entries.begin(), entries.end());
  return relaxed;
}

}  // namespace

RelaxationOptions RelaxationOptions::FromSettings(const Settings& settings) {
  SettingsReader reader("relaxation", settings);
  reader.Finish();
  return {};
}

class RelaxationEngine {
 public:
  explicit RelaxationEngine(const RelaxationOptions& /*options*/) {}
  static constexpr bool kTakesFriction = true;

  std::string WhyUnsupported(const LcpProblem& problem) const {
    std::vector<Index> normals;
    for (const FrictionRow& row : problem.friction_rows()) {
      if (row.slip != 0) return "sliding rows";
      normals.push_back(row.normal);
    }
    std::ranges::sort(normals);
    if (std::ranges::adjacent_find(normals) != normals.end()) return "several friction rows of one contact";
    return WhyNotSymmetric(problem);
  }

  void Prepare(const LcpProblem& problem) {
    RelaxedRows relaxed = RelaxRows(problem);
    rows_ = std::move(relaxed.P);
    relaxed_ = problem.WithRows(rows_, rows_ * problem.b(), std::move(relaxed.bounds));
    auto_.Prepare(*relaxed_);
  }

  void Solve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) {
    result->model = FrictionModel::kRelaxation;
    LcpOptions of_relaxed = options;
    Eigen::VectorXd start;
    if (options.initial_f != nullptr) {
      start = StartOf(problem, *options.initial_f);
      of_relaxed.initial_f = &start;
    }
    auto_.Solve(relaxed_->WithB(rows_ * problem.b()), of_relaxed, &inner_);
    result->status = inner_.status;
    result->iterations = inner_.iterations;
    result->detail = inner_.detail;
    result->f = rows_.transpose() * inner_.f;
    if (inner_.status != LcpStatus::kInfeasible) return;
    result->status = LcpStatus::kNumericalFailure;
    result->detail = "the relaxed problem has no solution";
  }

 private:
  // a+- of forces clipped to their cones.
  Eigen::VectorXd StartOf(const LcpProblem& problem, const Eigen::VectorXd& f) const {
    Eigen::VectorXd start(rows_.rows());
    for (Index k = 0; k < rows_.rows(); ++k) {
      Index normal = -1, tangent = -1;
      double mu = 0;
      for (SparseMatrix::InnerIterator it(rows_, k); it; ++it) {
        if (problem.kind(it.col()) == RowKind::kFriction) {
          tangent = it.col();
          mu = it.value();
        } else {
          normal = it.col();
        }
      }
      start[k] = tangent < 0 ? f[normal] : std::max((f[normal] + f[tangent] / mu) / 2, 0.0);
    }
    return start;
  }

  SparseMatrix rows_;
  std::optional<LcpProblem> relaxed_;
  AutoSolver auto_{AutoOptions{}};
  LcpResult inner_;
};

template class EngineSolver<RelaxationOptions, RelaxationEngine>;

}  // namespace lcpbench
