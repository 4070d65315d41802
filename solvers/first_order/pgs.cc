#include "solvers/first_order/pgs.h"

#include <string>

#include "solvers/first_order/sweeps/sweep_loop.h"

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

class PgsEngine {
 public:
  explicit PgsEngine(const PgsOptions& options) : options_(options) {
    CheckRelaxation("pgs", "relaxation", options.relaxation);
    work_.test.SetSelfCheck(options.self_check);
  }

  std::string WhyUnsupported(const LcpProblem& problem) const { return WhyNoRows(problem, options_.form); }
  void Prepare(const LcpProblem& problem) { work_.Prepare(problem, options_.form, options_.sweep); }
  void Solve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) {
    ConstantRelaxation relaxation{options_.relaxation};
    work_.Solve(problem, options_.sweep, options, PgsOptions::kDefaultSweeps, &relaxation, result);
  }

 private:
  const PgsOptions options_;
  SweepWorkspace work_;
};

template class EngineSolver<PgsOptions, PgsEngine>;

}  // namespace lcpbench
