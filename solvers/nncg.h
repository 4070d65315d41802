#pragma once

#include <memory>

#include "solvers/first_order_options.h"
#include "solvers/lcp/settings.h"
#include "solvers/lcp/solver.h"

namespace lcpbench {

struct NncgOptions {
  enum class Direction {
    kOptimal,         ///< least energy over the plane of the sweep's step and the previous step
    kFletcherReeves,  ///< the published rule, without a line search
  };
  Direction direction = Direction::kOptimal;
  RowForm form = RowForm::kAuto;
  bool coloured = true;
  static NncgOptions FromSettings(const Settings& settings);
};

class NncgSolver final : public LcpSolver {
 public:
  static constexpr std::int64_t kDefaultIterations = 10000;

  explicit NncgSolver(NncgOptions options = {});
  ~NncgSolver() override;

  std::string WhyUnsupported(const LcpProblem& problem) const override;

 protected:
  void DoPrepare(const LcpProblem& problem) override;
  void DoSolve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) override;

 private:
  struct Workspace;
  NncgOptions options_;
  std::unique_ptr<Workspace> work_;
};

}  // namespace lcpbench
