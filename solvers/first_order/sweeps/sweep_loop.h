#pragma once

#include <cmath>

#include "solvers/first_order/sweeps/paced_passes.h"
#include "solvers/first_order/sweeps/row_work.h"
#include "solvers/first_order/sweeps/stopping_test.h"

/// Internal to solvers/.
namespace lcpbench {

/// A Gauss-Seidel pass over all rows. False when the time is up.
inline bool RunSweep(bool backward, double omega, RowWork* work, PacedPasses* passes, StepSums* sums) {
  return passes->Run(backward, [&](Index begin, Index end) {
    work->rows->Sweep(begin, end, backward, omega, &work->f, &work->image, sums);
  });
}

/// What a solver by sweeps alone keeps from one solve to the next, and its solve.
struct SweepWorkspace {
  RowWork work;
  StoppingTest test;

  void Prepare(const LcpProblem& problem, RowForm form, SweepOrder order) {
    work.Prepare(problem, form, order == SweepOrder::kColoured);
    test.Prepare(problem);
  }

  /// @param relaxation  Next() gives omega for the next sweep; Observe(StepSums) hears of each sweep
  template <typename Relaxation>
  void Solve(const LcpProblem& problem, SweepOrder order, const LcpOptions& options, std::int64_t default_limit,
             Relaxation* relaxation, LcpResult* result) {
    work.Start(problem, options.initial_f);
    PacedPasses passes(options, *work.rows, work.scaled.size);
    bool over = test.Begin(problem, options, default_limit, &work, &passes, result);
    bool backward = false;
    while (!over) {
      StepSums sums;
      if (!RunSweep(backward, relaxation->Next(), &work, &passes, &sums)) {
        test.EndOutOfTime();
        break;
      }
      relaxation->Observe(sums);
      if (order == SweepOrder::kSymmetric) backward = !backward;
      over = test.Continue(std::sqrt(sums.residual));
    }
    test.Finish();
  }
};

}  // namespace lcpbench
