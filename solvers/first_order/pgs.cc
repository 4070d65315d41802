#include "solvers/first_order/pgs.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include "solvers/first_order/contact_sweeps.h"
#include "solvers/first_order/first_order_engine.h"
#include "solvers/lcp/verify.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

// To measure a rate, so many sweeps after a change of omega are passed over, whose steps still tell of the old one, and
// so many are averaged.
constexpr int kSettlingSweeps = 2;
constexpr int kMeasuredSweeps = 8;
// Share of the way from omega - 1 (the rate of an omega at or above the best) to 1 from which on a rate counts as that
// of an omega below the best.
constexpr double kBelowBest = 0.3;
// Above, sweeps at the best omega of the slowest mode hardly damp the others: A is not consistently ordered.
constexpr double kLargest = 1.9;
// Where omega seems too large, its distance from 1 shrinks to this part; one change takes at most this part of its
// distance to 2.
constexpr double kRetreat = 0.9;
constexpr double kLargestAdvance = 0.5;

// Up to so many rows begin with an omega of at most 1: their sweeps arrive, or tell a better one, soon.
constexpr Index kFewRows = 6;

class AdaptiveRelaxation {
 public:
  explicit AdaptiveRelaxation(double first) : omega_(first) {}
  double omega() const { return omega_; }
  void Observe(const StepSums& sums) {
    ++sweeps_;
    if (sweeps_ <= kSettlingSweeps) {
      first_change_ = sums.change;
    } else if (sweeps_ == kSettlingSweeps + kMeasuredSweeps) {
      // The change is a square.
      Adapt(std::pow(sums.change / first_change_, 0.5 / kMeasuredSweeps));
      sweeps_ = 0;
    }
  }

 private:
  void Adapt(double rate) {
    if (!(rate < 1)) return;  // rows are still joining and leaving: nothing is known
    const double least = omega_ - 1;
    if (rate > least + kBelowBest * (1 - least)) {
      const double jacobi = (rate + omega_ - 1) / (omega_ * std::sqrt(rate));
      const double best = jacobi < 1 ? 2 / (1 + std::sqrt(1 - jacobi * jacobi)) : kLargest;
      omega_ = std::min({best, omega_ + kLargestAdvance * (2 - omega_), std::max(kLargest, omega_)});
    } else {
      omega_ = std::min(omega_, 1 + kRetreat * std::max(omega_ - 1, 0.0));
    }
  }

  double omega_;
  int sweeps_ = 0;  // since omega was last looked at
  double first_change_ = 0;
};

}  // namespace

void PgsOptions::Read(SettingsReader* reader) {
  form = ReadRowForm(reader);
  const std::string order = reader->Choice("sweep", "coloured", {"forward", "symmetric", "coloured"});
  if (order == "forward") sweep = SweepOrder::kForward;
  if (order == "symmetric") sweep = SweepOrder::kSymmetric;
  relaxation = reader->Number(adaptive ? "first_relaxation" : "relaxation", relaxation, 0.0, 2.0);
}

class PgsEngine final : public FirstOrderEngine, public RowEngine {
 public:
  explicit PgsEngine(const PgsOptions& options)
      : FirstOrderEngine({.form = options.form,
                          .coloured = options.sweep == SweepOrder::kColoured,
                          .end_when_hopeless = options.end_when_hopeless,
                          .default_limit = PgsOptions::kDefaultSweeps}),
        options_(options) {
    if (options.relaxation > 0 && options.relaxation < 2) return;
    throw InputError(std::string(options.adaptive ? "psor: option 'first_relaxation'" : "pgs: option 'relaxation'") +
                     " must be in (0, 2), found " + std::to_string(options.relaxation));
  }

  static constexpr bool kTakesFriction = true;
  static constexpr bool kTakesBounded = true;

  void Prepare(const LcpProblem& problem) { problem.is_plain() ? PrepareRows(problem) : contacts_.Prepare(problem); }
  void Solve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) {
    if (!problem.is_plain()) return SweepContacts(problem, options, result);
    TakeProblem(problem, options);
    SolveTaken(options, result);
  }
  bool SolveRows(const RowTask& task, LcpResult* result) override {
    if (!TakeRows(task)) return false;
    SolveTaken(task.options, result);
    return result->status != LcpStatus::kNumericalFailure;
  }

 private:
  void SolveTaken(const LcpOptions& options, LcpResult* result) {
    const bool is_few = options_.adaptive && rows_.scaled.size <= kFewRows;
    AdaptiveRelaxation relaxation(is_few ? std::min(options_.relaxation, 1.0) : options_.relaxation);
    bool backward = false;
    Iterate(options, result, [&]() -> std::optional<double> {
      StepSums sums;
      if (!Sweep(backward, relaxation.omega(), &sums)) return {};
      if (options_.adaptive) relaxation.Observe(sums);
      if (options_.sweep == SweepOrder::kSymmetric) backward = !backward;
      return std::sqrt(sums.residual);
    });
  }

  // Checks where the changes of a sweep are as small as rho may be, and then after twice as many sweeps as before.
  void SweepContacts(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) {
    const Deadline deadline(options);
    const std::int64_t limit = options.max_iterations > 0 ? options.max_iterations : PgsOptions::kDefaultSweeps;
    AdaptiveRelaxation relaxation(options_.adaptive ? 1.0 : options_.relaxation);
    contacts_.Start(problem, options.initial_f);
    Eigen::VectorXd f(problem.size());
    double least = std::numeric_limits<double>::infinity();
    const auto check = [&] {
      contacts_.GetForces(&f);
      const Metrics metrics = ComputeMetrics(problem, f);
      const bool passes = PassesTier(metrics, options.tolerance);  // which the least rho need not do
      if (passes || metrics.rho < least || least == std::numeric_limits<double>::infinity()) {
        least = metrics.rho;
        result->f = f;
      }
      return passes;
    };
    std::int64_t next_check = 0;
    while (result->iterations < limit && !deadline.Expired()) {
      StepSums sums;
      sums.change = contacts_.Sweep(relaxation.omega());
      ++result->iterations;
      if (!std::isfinite(sums.change)) {
        result->detail = "forces leave the range of doubles";
        return;
      }
      if (options_.adaptive) relaxation.Observe(sums);
      if (std::sqrt(sums.change) > options.tolerance * contacts_.load() || result->iterations < next_check) continue;
      next_check = 2 * result->iterations;
      if (check()) {
        result->status = LcpStatus::kSolved;
        return;
      }
    }
    result->status = check()              ? LcpStatus::kSolved
                     : deadline.Expired() ? LcpStatus::kTimeLimit
                                          : LcpStatus::kIterationLimit;
  }

  const PgsOptions options_;
  ContactSweeps contacts_;
};

template class EngineSolver<PgsOptions, PgsEngine>;

}  // namespace lcpbench
