#include "solvers/friction/lagged_bounds.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <utility>

#include "solvers/lcp/verify.h"

namespace lcpbench {
namespace {

// A round is solved to this part of the tolerance, so that it is the bounds that decide.
constexpr double kOfTolerance = 0.1;

// The problem with the bounds that the normal forces of f give to friction.
LcpProblem WithLaggedBounds(const LcpProblem& problem, const Eigen::VectorXd& f) {
  RowBounds bounds = problem.bounds();
  for (const FrictionRow& row : bounds.friction) {
    const double most = std::min(row.mu * std::max(f[row.normal], 0.0), std::numeric_limits<double>::max());
    if (row.slip == 0) {
      bounds.bounded.push_back({row.row, -most, most});
    } else {
      bounds.bounded.push_back({row.row, -row.slip * most, -row.slip * most});
    }
  }
  bounds.friction.clear();
  return problem.WithBounds(std::move(bounds));
}

// Friction within the bounds of its own normal forces.
void ClipFriction(const LcpProblem& problem, Eigen::VectorXd* f) {
  for (const FrictionRow& row : problem.friction_rows()) {
    const double most = row.mu * std::max((*f)[row.normal], 0.0);
    double& force = (*f)[row.row];
    force = row.slip == 0 ? std::clamp(force, -most, most) : -row.slip * most;
  }
}

}  // namespace

class LaggedBoundsEngine {
 public:
  explicit LaggedBoundsEngine(const WithinOptions& options) : inner_(options.make_plain()) {}
  static constexpr bool kTakesFriction = true;
  static constexpr bool kTakesBounded = true;

  std::string WhyUnsupported(const LcpProblem& problem) const { return WhyNotFriction(problem); }
  void Prepare(const LcpProblem& /*problem*/) {}

  void Solve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) {
    // Without friction there is nothing to settle.
    if (problem.friction_rows().empty()) return inner_->Solve(problem, options, result);
    const Deadline deadline(options);
    const std::int64_t limit = options.max_iterations > 0 ? options.max_iterations : LaggedBoundsSolver::kDefaultRounds;
    LcpOptions of_round = options;
    of_round.tolerance = kOfTolerance * options.tolerance;
    of_round.max_iterations = 0;
    Eigen::VectorXd f = options.initial_f != nullptr ? *options.initial_f : result->f;
    double least = std::numeric_limits<double>::infinity();
    std::int64_t since_least = 0;
    while (result->iterations < limit && since_least < LaggedBoundsSolver::kPatience) {
      of_round.time_limit_s = deadline.Remaining();
      if (!(of_round.time_limit_s > 0)) {
        result->status = LcpStatus::kTimeLimit;
        return;
      }
      inner_->Solve(WithLaggedBounds(problem, f), of_round, &round_);
      ++result->iterations;
      if (round_.status == LcpStatus::kInfeasible) return TellRay(problem, result);
      f = round_.f;
      of_round.initial_f = &f;
      clipped_ = f;
      ClipFriction(problem, &clipped_);
      const Metrics metrics = ComputeMetrics(problem, clipped_);
      ++since_least;
      if (metrics.rho < least) {
        least = metrics.rho;
        since_least = 0;
        result->f = clipped_;
      }
      if (PassesTier(metrics, options.tolerance)) {
        result->f = clipped_;
        result->status = LcpStatus::kSolved;
        return;
      }
      if (round_.status == LcpStatus::kTimeLimit || !f.allFinite()) {
        result->status = round_.status == LcpStatus::kTimeLimit ? round_.status : LcpStatus::kNumericalFailure;
        return;
      }
    }
    const bool is_limit = result->iterations >= limit;
    result->status = is_limit ? LcpStatus::kIterationLimit : LcpStatus::kNumericalFailure;
    result->detail = "the bounds do not settle";
  }

 private:
  // A ray of a round is one of the problem: finite bounds leave it 0 on friction rows.
  void TellRay(const LcpProblem& problem, LcpResult* result) {
    const bool is_proof = round_.farkas_ray && VerifyFarkasRay(problem, *round_.farkas_ray).accepted;
    result->status = is_proof ? LcpStatus::kInfeasible : LcpStatus::kNumericalFailure;
    if (is_proof) result->farkas_ray = std::move(round_.farkas_ray);
    if (!is_proof) result->detail = "no proven ray";
  }

  const std::unique_ptr<LcpSolver> inner_;
  LcpResult round_;
  Eigen::VectorXd clipped_;
};

template class EngineSolver<WithinOptions, LaggedBoundsEngine>;

}  // namespace lcpbench
