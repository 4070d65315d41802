#include "solvers/friction/shift_rounds.h"

#include <cmath>

namespace lcpbench {

bool ShiftRounds::Run(const ContactRows& rows, ModeSteps* newton, Eigen::VectorXd* phi, FrictionAnswer* answer,
                      bool* is_relaxed) {
  constexpr ModeSteps::Limits kAfterwards{.steps = 8, .eps = 1e-8};
  const LcpProblem& problem = answer->problem();
  LcpOptions options = answer->options();
  options.max_iterations = 0;
  options.time_limit_s = answer->Remaining();
  if (!(options.time_limit_s > 0)) return false;
  if (relaxed_.f.size() == rows.size() && shift_.any()) {
    start_ = relaxed_.f;
    options.initial_f = &start_;
  }
  relaxation_.Solve(problem.WithB(problem.b() + shift_), options, &relaxed_);
  ++answer->iterations();
  *is_relaxed = true;
  if (relaxed_.status == LcpStatus::kUnsupported || relaxed_.status == LcpStatus::kTimeLimit) return false;
  if (!relaxed_.f.allFinite()) return false;
  if (answer->TakeForces(relaxed_.f)) return true;
  rows.ToScaled(relaxed_.f, phi);
  rows.ComputeGaps(*phi, &gaps_);
  for (const ContactRows::Contact& contact : rows.contacts()) {
    if (!contact.can_stick()) continue;
    shift_[contact.normal] = contact.given_mu * std::abs(gaps_[contact.tangent]) * rows.root(contact.tangent);
  }
  *is_relaxed = false;
  return newton->Run(rows, kAfterwards, phi, answer);
}

}  // namespace lcpbench
