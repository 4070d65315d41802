#include "solvers/friction/shift_rounds.h"

#include <cmath>
#include <memory>

namespace lcpbench {

void ShiftRounds::Reserve(Index max_rows) {
  for (Eigen::VectorXd* const numbers : {&shift_, &f_, &start_, &gaps_}) ContactRows::Lengthen(max_rows, numbers);
}

void ShiftRounds::Start(const ContactRows& rows) {
  Reserve(rows.size());
  shift_.head(rows.size()).setZero();
  is_shifted_ = false;
  status_ = LcpStatus::kNotRun;
}

const char* ShiftRounds::Run(const ContactRows& rows, int count, ModeSteps* newton, Eigen::VectorXd* phi,
                             FrictionAnswer* answer) {
  for (int k = 0; k < count && !answer->IsOver(); ++k) {
    if (const char* method = RunOne(rows, newton, phi, answer)) return method;
    if (!is_solved()) break;
  }
  return nullptr;
}

const char* ShiftRounds::RunOne(const ContactRows& rows, ModeSteps* newton, Eigen::VectorXd* phi,
                                FrictionAnswer* answer) {
  constexpr ModeSteps::Limits kAfterwards{.steps = 8, .eps = 1e-8};
  if (!(answer->Remaining() > 0)) return nullptr;
  start_.swap(f_);
  const bool is_first = !is_shifted_;
  status_ = relax_(*answer, shift_, is_first ? nullptr : &start_, &f_);
  ++answer->iterations();
  const auto f = f_.head(rows.size());
  if (status_ == LcpStatus::kUnsupported || status_ == LcpStatus::kTimeLimit || !f.allFinite()) return nullptr;
  if (answer->TakeForces(f_)) return is_first ? "relaxation" : "shift";
  rows.ToScaled(f_, phi);
  rows.ComputeGaps(*phi, &gaps_);
  for (const Index i : rows.laws().normals) shift_[i] = 0;
  for (const FrictionRow& row : rows.laws().friction) {
    shift_[row.normal] = row.mu * std::abs(gaps_[row.row]) * rows.root(row.normal);
    is_shifted_ = is_shifted_ || shift_[row.normal] != 0;
  }
  return newton->Run(rows, kAfterwards, phi, answer) ? (is_first ? "mode-newton" : "shift") : nullptr;
}

ShiftRounds::Relax RelaxProblems(const WithinOptions& options) {
  // Of the time that is left: a relaxation that does not end leaves the rest to other methods.
  constexpr double kShareOfTime = 0.2;
  const auto solver = std::make_shared<RelaxationSolver>(options);
  const auto result = std::make_shared<LcpResult>();
  return [solver, result](const FrictionAnswer& answer, const Eigen::VectorXd& shift, const Eigen::VectorXd* start,
                          Eigen::VectorXd* f) {
    const LcpProblem& problem = answer.problem();
    const Index n = problem.size();
    LcpOptions of_round = answer.options();
    of_round.max_iterations = 0;
    of_round.time_limit_s = kShareOfTime * answer.Remaining();
    Eigen::VectorXd initial_f;
    if (start != nullptr) {
      initial_f = start->head(n);
      of_round.initial_f = &initial_f;
    }
    solver->Solve(problem.WithB(problem.b() + shift.head(n)), of_round, result.get());
    f->head(n) = result->f;
    return result->status;
  };
}

}  // namespace lcpbench
