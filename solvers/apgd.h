#pragma once

#include <memory>

#include "solvers/first_order_options.h"
#include "solvers/lcp/settings.h"
#include "solvers/lcp/solver.h"

namespace lcpbench {

struct ApgdOptions {
  RowForm form = RowForm::kAuto;
  bool restart = true;
  static ApgdOptions FromSettings(const Settings& settings);
};

class ApgdSolver final : public LcpSolver {
 public:
  static constexpr std::int64_t kDefaultIterations = 20000;

  explicit ApgdSolver(ApgdOptions options = {});
  ~ApgdSolver() override;

  std::string WhyUnsupported(const LcpProblem& problem) const override;

 protected:
  void DoPrepare(const LcpProblem& problem) override;
  void DoSolve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) override;

 private:
  struct Workspace;
  ApgdOptions options_;
  std::unique_ptr<Workspace> work_;
};

}  // namespace lcpbench
