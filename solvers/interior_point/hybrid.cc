#include "solvers/interior_point/hybrid.h"

#include <algorithm>
#include <cstdint>
#include <string>

#include "solvers/lcp/residual.h"
#include "solvers/linear_algebra/cost_model.h"

namespace lcpbench {
namespace {

// Below, a factorization takes no longer than a few sweeps, and its answers have more digits.
constexpr Index kLeastRows = 500;
// Above, ordering and analysis may take longer than the sweeps, so they wait until they are needed.
constexpr Index kMostRowsAnalysed = 20000;
// Warm start: the active set is tried before the sweeps where a factorization takes no longer than so many, with
// pivots that take no longer than so many together.
constexpr double kCheapFactorization = 17;
constexpr double kGuessWork = 90;
// A start is used where its rho is below this share of that of f = 0.
constexpr double kWorthTrying = 0.5;

}  // namespace

void HybridOptions::Read(SettingsReader* reader) {
  constexpr double kMost = 100000;
  least_iterations = static_cast<int>(reader->Number("least_iterations", least_iterations, 0, kMost));
  most_iterations = static_cast<int>(reader->Number("most_iterations", most_iterations, 0, kMost));
  self_check = reader->SelfCheck();
}

class HybridEngine {
 public:
  explicit HybridEngine(const HybridOptions& options)
      : options_(options),
        sweeps_(NncgOptions{
            .end_when_hopeless = true, .least_iterations = options.least_iterations, .self_check = options.self_check}),
        interior_(IpmOptions{.self_check = options.self_check}) {}

  std::string WhyUnsupported(const LcpProblem& problem) const { return interior_.WhyUnsupported(problem); }
  void Prepare(const LcpProblem& problem);
  void Solve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result);
  const IpmStatistics& statistics() const { return interior_.statistics(); }

 private:
  const HybridOptions options_;
  NncgSolver sweeps_;
  IpmSolver interior_;
  GivenFormTest start_test_;
  bool sweeps_first_ = false;
  double sweeps_per_factorization_ = 0;  // 0: not known before the interior point is set up
};

void HybridEngine::Prepare(const LcpProblem& problem) {
  sweeps_per_factorization_ = 0;
  sweeps_first_ = options_.most_iterations > 0 && problem.size() >= kLeastRows;
  if (!sweeps_first_) {
    interior_.Prepare(problem);
    return;
  }
  sweeps_.Prepare(problem);
  start_test_.Reset(problem, GivenFormTest::Rows::kGivenWhenNeeded);
  if (problem.size() > kMostRowsAnalysed) return;
  interior_.Prepare(problem);
  const IpmStatistics& factor = interior_.statistics();
  sweeps_per_factorization_ = CostModel::SweepsPerFactorization(problem, factor.factor_flops, factor.fill);
}

void HybridEngine::Solve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) {
  const Deadline deadline(options);
  LcpOptions rest = options;
  Eigen::VectorXd start;  // where the next method goes on
  std::int64_t done = 0;
  std::string detail;
  // Runs one of the methods for at most `wanted` iterations of those that are left (0: any number), from where the one
  // before has stopped. True if there is nothing left to do, or no limit left to do it in.
  const auto run = [&](LcpSolver* solver, const char* name, std::int64_t wanted) {
    rest.max_iterations = wanted;
    rest.time_limit_s = deadline.Remaining();
    if (options.max_iterations > 0) {
      const std::int64_t left = options.max_iterations - done;
      rest.max_iterations = wanted > 0 ? std::min(wanted, left) : left;
    }
    const bool iterations_are_left = options.max_iterations <= 0 || rest.max_iterations > 0;
    if (!iterations_are_left || !(rest.time_limit_s > 0)) {
      result->status = iterations_are_left ? LcpStatus::kTimeLimit : LcpStatus::kIterationLimit;
      return true;
    }
    solver->Solve(problem, rest, result);
    done += result->iterations;
    result->iterations = done;
    if (detail.find(name) == std::string::npos) detail += (detail.empty() ? "" : "; ") + std::string(name);
    result->detail = detail + (result->detail.empty() ? "" : ": " + result->detail);
    if (result->f.allFinite()) start = result->f;
    if (start.size() > 0) rest.initial_f = &start;
    return result->status == LcpStatus::kSolved || result->status == LcpStatus::kInfeasible ||
           result->status == LcpStatus::kTimeLimit;
  };

  if (sweeps_first_ && options.initial_f != nullptr) {
    start_test_.SetB(problem);
    const long double rho = start_test_.Rho(*options.initial_f);
    if (!(rho < kWorthTrying * start_test_.Rho(Eigen::VectorXd::Zero(problem.size())))) rest.initial_f = nullptr;
  }
  if (sweeps_per_factorization_ > 0 && rest.initial_f != nullptr && sweeps_per_factorization_ <= kCheapFactorization) {
    interior_.UseWarmStart(IpmSolver::WarmStart::kGuessOnly);
    if (run(&interior_, "ipm", static_cast<std::int64_t>(kGuessWork / sweeps_per_factorization_))) return;
  }
  if (sweeps_first_ && run(&sweeps_, "nncg", std::max(options_.least_iterations, options_.most_iterations))) return;
  interior_.UseWarmStart(sweeps_first_ ? IpmSolver::WarmStart::kAfterSweeps : IpmSolver::WarmStart::kFull);
  run(&interior_, "ipm", 0);
}

const IpmStatistics& HybridSolver::statistics() const { return engine_->statistics(); }

template class EngineSolver<HybridOptions, HybridEngine>;

}  // namespace lcpbench
