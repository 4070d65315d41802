#pragma once

#include <memory>

#include "solvers/first_order_options.h"
#include "solvers/lcp/settings.h"
#include "solvers/lcp/solver.h"

namespace lcpbench {

struct PsorOptions {
  RowForm form = RowForm::kAuto;
  SweepOrder sweep = SweepOrder::kColoured;

  /// omega of the first sweeps, in (0, 2), before anything is measured.
  double first_relaxation = 1.6;

  /// Options `form`, `sweep` and `first-relaxation`.
  static PsorOptions FromSettings(const Settings& settings);
};

class PsorSolver final : public LcpSolver {
 public:
  static constexpr std::int64_t kDefaultSweeps = 20000;

  /// @throws InputError for a relaxation outside (0, 2)
  explicit PsorSolver(PsorOptions options = {});
  ~PsorSolver() override;

  std::string WhyUnsupported(const LcpProblem& problem) const override;

 protected:
  void DoPrepare(const LcpProblem& problem) override;
  void DoSolve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) override;

 private:
  struct Workspace;
  PsorOptions options_;
  std::unique_ptr<Workspace> work_;
};

}  // namespace lcpbench
