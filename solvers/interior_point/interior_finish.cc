#include "solvers/interior_point/interior_finish.h"

#include <algorithm>
#include <cmath>

#include "solvers/linear_algebra/cost_model.h"

namespace lcpbench {
namespace {

constexpr int kRefinements = 8;       // as long as each one leaves ...
constexpr double kRefineGain = 0.25;  // ... at most this fraction of rho
constexpr double kClose = 0.5;        // of the tolerance: what double calls enough before extended precision is asked
constexpr double kMoreDigits = 1e-3;  // of the tolerance: a right F gives them for a solve or two
constexpr double kWithinReach = 100;  // times the tolerance: rho from which sweeps are tried, ...
constexpr double kTryAgain = 0.4;     // ... again where rho has fallen to this fraction
constexpr std::int64_t kSweeps = 60;
constexpr double kNear = 5;  // times the tolerance: rho from which ...
constexpr std::int64_t kSweepsWhereNear = 300;
constexpr double kWorthSweeps = 1e6;  // flop; below, going on is as cheap, and exact

}  // namespace

double SweepsPerFactorization(const LcpProblem& problem, double flops, double fill) {
  return (CostModel::kInteriorFlop * flops + CostModel::kInteriorEntry * fill) / CostModel::Sweep(problem);
}

InteriorFinish::InteriorFinish(bool self_check)
    : sweeps_(NncgOptions{.end_when_hopeless = true, .self_check = self_check}) {}

void InteriorFinish::Reserve(Index n, double factor_work) {
  may_sweep_ = factor_work > kWorthSweeps;
  for (Eigen::VectorXd* v : {&x_, &gap_, &right_, &correction_}) v->setZero(n);
  prepared_ = false;
  Restart();
}

double InteriorFinish::Rho(const ScaledSystem& system, const Eigen::VectorXd& f) {
  system.Multiply(f, &gap_);
  gap_ += system.b();
  return system.rows().Rho(f, gap_);
}

bool InteriorFinish::Refine(IpmRun* run, const Eigen::VectorXd& f, const Eigen::VectorXd& w) {
  ScaledSystem& system = run->system();
  const Index n = f.size();
  const double tolerance = run->options().tolerance;
  for (Index i = 0; i < n; ++i) {
    const bool active = !system.idle(i) && (!system.unilateral(i) || f[i] > w[i]);
    x_[i] = active ? f[i] : 0.0;
  }
  wrong_rows_ = 1;
  double rho = Rho(system, x_);
  bool accepted = false;
  for (int k = 0; k < kRefinements; ++k) {
    if (rho <= kClose * tolerance && run->AcceptScaled(x_, nullptr)) accepted = true;
    if (accepted && rho <= kMoreDigits * tolerance) return true;
    for (Index i = 0; i < n; ++i) {
      const bool active = !system.idle(i) && (!system.unilateral(i) || f[i] > w[i]);
      right_[i] = active ? -gap_[i] : 0.0;
    }
    system.Solve(right_, &correction_);
    Index wrong = 0;
    for (Index i = 0; i < n; ++i) {
      if (right_[i] == 0) continue;
      x_[i] += correction_[i];
      if (!system.unilateral(i) || x_[i] >= 0) continue;
      x_[i] = 0;
      ++wrong;
    }
    const double now = Rho(system, x_);
    if (k == 0) {
      for (Index i = 0; i < n; ++i) wrong += system.unilateral(i) && f[i] <= w[i] && gap_[i] < 0 ? 1 : 0;
      wrong_rows_ = static_cast<double>(wrong) / static_cast<double>(n);
    }
    if (!(now <= kRefineGain * rho) && (accepted || !(now <= kClose * tolerance))) break;
    rho = now;
  }
  // Where steps are cheap a better answer than this one is worth a few more.
  return accepted && may_sweep_;
}

bool InteriorFinish::Sweep(IpmRun* run, const Eigen::VectorXd& f) {
  ScaledSystem& system = run->system();
  const double tolerance = run->options().tolerance;
  const double rho = Rho(system, f);
  if (!(rho <= kWithinReach * tolerance) || rho > kTryAgain * least_tried_) return false;
  least_tried_ = rho;
  Eigen::VectorXd start(f.size());
  for (Index i = 0; i < f.size(); ++i) start[i] = system.rows().GivenForce(i, f[i]);
  return Sweeps(run, start, kClose * tolerance, rho <= kNear * tolerance ? kSweepsWhereNear : kSweeps);
}

bool InteriorFinish::SweepFromBest(IpmRun* run, std::int64_t iterations) {
  const Eigen::VectorXd start = run->best_f();
  return Sweeps(run, start, kClose * run->options().tolerance, iterations);
}

bool InteriorFinish::Sweeps(IpmRun* run, const Eigen::VectorXd& start, double tolerance, std::int64_t iterations) {
  const LcpProblem& problem = run->system().problem();
  if (!prepared_) {
    sweeps_.Prepare(problem);
    prepared_ = true;
  }
  LcpOptions options = run->options();
  options.tolerance = tolerance;
  options.max_iterations = iterations;
  options.initial_f = &start;
  if (!run->TimeLeft(&options.time_limit_s)) return false;
  LcpResult result;
  sweeps_.Solve(problem, options, &result);
  return run->Accept(result.f);
}

bool InteriorFinish::Try(IpmRun* run, const Eigen::VectorXd& f, const Eigen::VectorXd& w) {
  return Refine(run, f, w) || (may_sweep_ && Sweep(run, f));
}

}  // namespace lcpbench
