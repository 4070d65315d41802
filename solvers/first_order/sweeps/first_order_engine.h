#pragma once

#include <cmath>
#include <string>

#include "solvers/first_order/sweeps/paced_passes.h"
#include "solvers/first_order/sweeps/row_work.h"
#include "solvers/first_order/sweeps/stopping_test.h"

/// Internal to solvers/first_order/.
namespace lcpbench {

/// What the engines of all first-order solvers (solvers/lcp/engine_solver.h) have in common.
template <typename Options>
class FirstOrderEngine {
 public:
  explicit FirstOrderEngine(const Options& options) : options_(options) { test_.SetSelfCheck(options.self_check); }

 protected:
  void Prepare(const LcpProblem& problem, bool coloured) {
    rows_.Prepare(problem, options_.form, coloured);
    test_.Prepare(problem);
  }
  /// A Gauss-Seidel pass over all rows. False when the time is up.
  bool RunSweep(bool backward, double omega, PacedPasses* passes, StepSums* sums) {
    return passes->Run(backward, [&](Index begin, Index end) {
      rows_.rows->Sweep(begin, end, backward, omega, &rows_.f, &rows_.image, sums);
    });
  }

  const Options options_;
  RowWork rows_;
  StoppingTest test_;
};

/// A solver by sweeps alone.
template <typename Options>
class SweepEngine : public FirstOrderEngine<Options> {
 public:
  using FirstOrderEngine<Options>::FirstOrderEngine;

  std::string WhyUnsupported(const LcpProblem& problem) const { return WhyNoRows(problem, this->options_.form); }
  void Prepare(const LcpProblem& problem) {
    FirstOrderEngine<Options>::Prepare(problem, this->options_.sweep == SweepOrder::kColoured);
  }

 protected:
  /// @param relaxation  Next() gives omega for the next sweep; Observe(StepSums) hears of each sweep
  template <typename Relaxation>
  void Run(const LcpProblem& problem, const LcpOptions& options, Relaxation relaxation, LcpResult* result) {
    RowWork& work = this->rows_;
    StoppingTest& test = this->test_;
    work.Start(problem, options.initial_f);
    PacedPasses passes(options, *work.rows, work.scaled.size);
    bool over = test.Begin(problem, options, Options::kDefaultSweeps, &work, &passes, result);
    bool backward = false;
    while (!over) {
      StepSums sums;
      if (!this->RunSweep(backward, relaxation.Next(), &passes, &sums)) {
        test.EndOutOfTime();
        break;
      }
      relaxation.Observe(sums);
      if (this->options_.sweep == SweepOrder::kSymmetric) backward = !backward;
      over = test.Continue(std::sqrt(sums.residual));
    }
    test.Finish();
  }
};

}  // namespace lcpbench
