#include "solvers/friction/mode_newton.h"

#include <string>

#include "solvers/friction/mode_steps.h"
#include "solvers/friction/normal_map_path.h"

namespace lcpbench {

class ModeNewtonEngine {
 public:
  explicit ModeNewtonEngine(const ModeNewtonOptions& /*options*/) {}
  static constexpr bool kTakesFriction = true;
  static constexpr bool kTakesBounded = true;

  std::string WhyUnsupported(const LcpProblem& problem) const { return WhyNotFriction(problem); }
  void Prepare(const LcpProblem& problem) {
    rows_.Prepare(problem);
    newton_.Reset();
  }
  void Solve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) {
    rows_.SetB(problem);
    FrictionAnswer answer(rows_, &problem, options, result);
    rows_.ToScaled(options.initial_f == nullptr ? result->f : *options.initial_f, &phi_);
    if (answer.Take(phi_) || path_.ApproachByNewton(rows_, &newton_, &phi_, &answer)) return;
    answer.Fail("no step reduces the residual to the tolerance");
  }

 private:
  ContactRows rows_;
  ModeSteps newton_;
  NormalMapPath path_;
  PaddedVector phi_;
};

template class EngineSolver<ModeNewtonOptions, ModeNewtonEngine>;

}  // namespace lcpbench
