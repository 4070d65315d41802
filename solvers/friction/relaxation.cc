#include "solvers/friction/relaxation.h"

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "solvers/friction/relaxed_rows.h"
#include "solvers/lcp/law_metrics.h"
#include "support/array_index.h"

namespace lcpbench {
namespace {

Eigen::VectorXd LoadsOf(const RelaxedRows& rows, const Eigen::VectorXd& b) {
  Eigen::VectorXd loads(rows.size());
  for (Index k = 0; k < rows.size(); ++k) loads[k] = RelaxedRows::Load(rows.rows()[At(k)], b);
  return loads;
}

LcpProblem Relax(const LcpProblem& problem, const RelaxedRows& rows) {
  std::vector<Eigen::Triplet<double, int>> entries;
  RowBounds bounds;
  for (const RelaxedRows::Row& row : rows.rows()) {
    const auto k = static_cast<int>(bounds.bilateral.size());
    entries.emplace_back(k, static_cast<int>(row.normal), 1);
    if (row.tangent >= 0) entries.emplace_back(k, static_cast<int>(row.tangent), row.factor);
    bounds.bilateral.push_back(problem.is_bilateral(row.normal) ? 1 : 0);
  }
  SparseMatrix P(rows.size(), problem.size());
  P.setFromTriplets(entries.begin(), entries.end());
  return problem.WithRows(P, LoadsOf(rows, problem.b()), std::move(bounds));
}

}  // namespace

LcpProblem RelaxationOf(const LcpProblem& problem) {
  RelaxedRows rows;
  rows.Set(problem.size(), problem.friction_rows());
  return Relax(problem, rows);
}

class RelaxationEngine {
 public:
  explicit RelaxationEngine(const WithinOptions& options)
      : of_tolerance_(options.of_tolerance), plain_(options.make_plain()) {}
  static constexpr bool kTakesFriction = true;

  std::string WhyUnsupported(const LcpProblem& problem) const {
    const std::string why = WhyNotPlanar(problem);
    return why.empty() ? WhyNotFriction(problem) : why;
  }

  void Prepare(const LcpProblem& problem) {
    rows_.Set(problem.size(), problem.friction_rows());
    relaxed_ = Relax(problem, rows_);
    plain_->Prepare(*relaxed_);
  }

  void Solve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) {
    result->model = FrictionModel::kRelaxation;
    LcpOptions of_relaxed = options;
    of_relaxed.tolerance *= of_tolerance_;
    Eigen::VectorXd start;
    if (options.initial_f != nullptr) {
      start.resize(rows_.size());
      for (Index k = 0; k < rows_.size(); ++k) start[k] = RelaxedRows::StartOf(rows_.rows()[At(k)], *options.initial_f);
      of_relaxed.initial_f = &start;
    }
    plain_->Solve(relaxed_->WithB(LoadsOf(rows_, problem.b())), of_relaxed, &inner_);
    result->status = inner_.status;
    result->iterations = inner_.iterations;
    result->detail = inner_.detail;
    rows_.GetForces(inner_.f.data(), &result->f);
    if (inner_.status == LcpStatus::kInfeasible) {
      result->status = LcpStatus::kNumericalFailure;
      result->detail = "the relaxed problem has no solution";
    } else if (inner_.status == LcpStatus::kSolved) {
      // The tolerance is relative to another load there.
      problem.ComputeW(result->f, &gaps_);
      const double residual = RelaxationResidual(problem, result->f, gaps_);
      result->detail = "the relaxed law's answer: a contact that slips also opens";
      if (residual <= options.tolerance) return;
      result->status = LcpStatus::kNumericalFailure;
      result->detail = "the relaxed answer is not within the tolerance";
    }
  }

 private:
  RelaxedRows rows_;
  std::optional<LcpProblem> relaxed_;
  const double of_tolerance_;
  const std::unique_ptr<LcpSolver> plain_;
  LcpResult inner_;
  Eigen::VectorXd gaps_;
};

template class EngineSolver<WithinOptions, RelaxationEngine>;

}  // namespace lcpbench
