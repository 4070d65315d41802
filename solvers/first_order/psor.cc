#include "solvers/first_order/psor.h"

#include <algorithm>
#include <cmath>
#include "solvers/first_order/sweeps/first_order_engine.h"

namespace lcpbench {
namespace {

// Of a rate: sweeps that are passed over after a change of omega, for which the steps still tell of the old one, and
// sweeps that it is averaged over.
constexpr int kSettlingSweeps = 2;
constexpr int kMeasuredSweeps = 8;
// Share of the way from omega - 1 (the rate of an omega at or above the best) to 1 from which on a rate counts as that
// of an omega below the best.
constexpr double kBelowBest = 0.3;
// Above, sweeps at the best omega of the slowest mode hardly damp the others: A is not consistently ordered.
constexpr double kLargest = 1.9;
// Of the distance from 1 when omega seems too large; of the distance to 2 that one change may take at most.
constexpr double kRetreat = 0.9;
constexpr double kLargestAdvance = 0.5;

class AdaptiveRelaxation {
 public:
  explicit AdaptiveRelaxation(double first) : omega_(first) {}
  double Next() const { return omega_; }
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

PsorOptions PsorOptions::FromSettings(const Settings& settings) {
  SettingsReader reader("psor", settings);
  PsorOptions options;
  options.form = ReadRowForm(&reader);
  options.sweep = ReadSweepOrder(&reader);
  options.first_relaxation = reader.Number("first-relaxation", options.first_relaxation, 0.0, 2.0);
  options.end_when_hopeless = reader.YesOrNo("end-when-hopeless", options.end_when_hopeless);
  options.self_check = reader.SelfCheck();
  reader.Finish();
  CheckRelaxation("psor", "first-relaxation", options.first_relaxation);
  return options;
}

class PsorEngine final : public SweepEngine<PsorOptions> {
 public:
  explicit PsorEngine(const PsorOptions& options) : SweepEngine(options) {
    CheckRelaxation("psor", "first-relaxation", options.first_relaxation);
  }

  void Solve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) {
    test_.EndWhenHopeless(options_.end_when_hopeless);
    Run(problem, options, AdaptiveRelaxation(options_.first_relaxation), result);
  }
};

template class EngineSolver<PsorOptions, PsorEngine>;

}  // namespace lcpbench
