#include "solvers/friction/four_rows.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <utility>

#include "solvers/friction/relaxed_rows.h"
#include "support/array_index.h"

namespace lcpbench {

FourRows::FourRows(const LcpProblem& problem) {
  std::vector<const FrictionRow*> tangent_of(At(problem.size()), nullptr);
  for (const FrictionRow& row : problem.friction_rows()) {
    if (row.mu > 0) tangent_of[At(row.normal)] = &row;
  }
  std::vector<Eigen::Triplet<double, int>> signs, coupling;
  RowBounds bounds;
  const auto add_row = [&](Index row, double sign) {
    if (sign != 0) signs.emplace_back(static_cast<int>(bounds.bilateral.size()), static_cast<int>(row), sign);
    bounds.bilateral.push_back(problem.is_bilateral(row) ? 1 : 0);
  };
  for (Index row = 0; row < problem.size(); ++row) {
    if (problem.kind(row) == RowKind::kFriction) continue;
    const auto p = static_cast<int>(bounds.bilateral.size());
    add_row(row, 1);
    const FrictionRow* const tangent = tangent_of[At(row)];
    if (tangent == nullptr) continue;
    const int plus = p + 1, minus = p + 2, sigma = p + 3;
    for (const double sign : {1, -1, 0}) add_row(tangent->row, sign);
    const double diagonal = problem.DiagonalA()[tangent->row];
    const double unit = diagonal > 0 ? std::ldexp(1.0, std::ilogb(diagonal)) : 1;
    for (const int beta : {plus, minus}) {
      coupling.emplace_back(beta, sigma, unit);
      coupling.emplace_back(sigma, beta, -unit);
    }
    coupling.emplace_back(sigma, p, unit * tangent->mu);
    contacts_.push_back({tangent->row, sigma, unit});
  }
  const auto size = static_cast<Index>(bounds.bilateral.size());
  rows_.resize(size, problem.size());
  rows_.setFromTriplets(signs.begin(), signs.end());
  SparseMatrix A(size, size);
  A.setFromTriplets(coupling.begin(), coupling.end());
  A += problem.WithRows(rows_, LoadsOf(problem.b()), bounds).SparseA();
  lcp_ = LcpProblem::FromSparse(problem.id(), A, LoadsOf(problem.b()), std::move(bounds));
}

Eigen::VectorXd FourRows::VariablesOf(const Eigen::VectorXd& f, const Eigen::VectorXd& w) const {
  Eigen::VectorXd variables = rows_ * f;
  for (Index k = 0; k < variables.size(); ++k) {
    if (!lcp_->is_bilateral(k)) variables[k] = std::max(variables[k], 0.0);
  }
  for (const Contact& contact : contacts_) variables[contact.sigma] = std::abs(w[contact.tangent]) / contact.unit;
  return variables;
}

class FourRowEngine {
 public:
  explicit FourRowEngine(const WithinOptions& options) : plain_(options.make_plain()) {}
  static constexpr bool kTakesFriction = true;

  std::string WhyUnsupported(const LcpProblem& problem) const {
    const std::string why = WhyNotPlanar(problem);
    return why.empty() ? WhyNotFriction(problem) : why;
  }

  void Prepare(const LcpProblem& problem) {
    four_.emplace(problem);
    plain_->Prepare(four_->lcp());
  }

  void Solve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) {
    LcpOptions of_lcp = options;
    Eigen::VectorXd start;
    if (options.initial_f != nullptr) {
      Eigen::VectorXd w;
      problem.ComputeW(*options.initial_f, &w);
      start = four_->VariablesOf(*options.initial_f, w);
      of_lcp.initial_f = &start;
    }
    plain_->Solve(four_->lcp().WithB(four_->LoadsOf(problem.b())), of_lcp, &inner_);
    *result = inner_;
    result->f = four_->ForcesOf(inner_.f);
    result->farkas_ray.reset();
    if (inner_.status != LcpStatus::kInfeasible) return;
    result->status = LcpStatus::kNumericalFailure;
    result->detail = "a ray of the LCP of four rows, which proves nothing";
  }

 private:
  std::optional<FourRows> four_;
  const std::unique_ptr<LcpSolver> plain_;
  LcpResult inner_;
};

template class EngineSolver<WithinOptions, FourRowEngine>;

}  // namespace lcpbench
