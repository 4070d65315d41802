#include "solvers/friction/shift.h"

#include <string>

#include "solvers/friction/shift_rounds.h"

namespace lcpbench {

class ShiftEngine {
 public:
  explicit ShiftEngine(const WithinOptions& options) : relaxation_(options), rounds_(nullptr, options) {}
  static constexpr bool kTakesFriction = true;

  std::string WhyUnsupported(const LcpProblem& problem) const { return relaxation_.WhyUnsupported(problem); }
  void Prepare(const LcpProblem& problem) {
    rows_.Prepare(problem);
    newton_.Reset();
  }
  void Solve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) {
    constexpr int kMostRounds = 60;
    rows_.SetB(problem);
    rounds_.Start(rows_);
    FrictionAnswer answer(rows_, &problem, options, result);
    if (rounds_.TakeRounds(rows_, kMostRounds, &newton_, &phi_, &answer) != nullptr) return;
    answer.Fail("no fixed point of the shift within 60 rounds");
  }

 private:
  const RelaxationSolver relaxation_;
  ContactRows rows_;
  ModeSteps newton_;
  ShiftRounds rounds_;
  PaddedVector phi_;
};

template class EngineSolver<WithinOptions, ShiftEngine>;

}  // namespace lcpbench
