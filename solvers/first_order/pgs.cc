#include "solvers/first_order/pgs.h"

#include "solvers/first_order/sweeps/first_order_engine.h"

namespace lcpbench {
namespace {

struct ConstantRelaxation {
  double omega;
  double Next() const { return omega; }
  void Observe(const StepSums& /*sums*/) const {}
};

}  // namespace

PgsOptions PgsOptions::FromSettings(const Settings& settings) {
  SettingsReader reader("pgs", settings);
  PgsOptions options;
  options.form = ReadRowForm(&reader);
  options.sweep = ReadSweepOrder(&reader);
  options.relaxation = reader.Number("relaxation", options.relaxation, 0.0, 2.0);
  options.self_check = reader.SelfCheck();
  reader.Finish();
  CheckRelaxation("pgs", "relaxation", options.relaxation);
  return options;
}

class PgsEngine final : public SweepEngine<PgsOptions> {
 public:
  explicit PgsEngine(const PgsOptions& options) : SweepEngine(options) {
    CheckRelaxation("pgs", "relaxation", options.relaxation);
  }

  void Solve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) {
    Run(problem, options, ConstantRelaxation{options_.relaxation}, result);
  }
};

template class EngineSolver<PgsOptions, PgsEngine>;

}  // namespace lcpbench
