#include "solvers/friction/shift_rounds.h"

#include <algorithm>
#include <cmath>

#include "solvers/linear_algebra/tableau_rules.h"
#include "support/array_index.h"

namespace lcpbench {
namespace {

// A relaxation that does not end leaves the rest of the time to other methods.
constexpr double kShareOfTime = 0.2;
// What a relaxation need not be better than: Newton's method goes on from it. For the same reason this may be added to
// its diagonal where the tableau fails at rows that depend on each other.
constexpr double kFineEnough = 1e-6;
constexpr double kProximal[] = {1e-9, 1e-6, 1e-4};
// Larger forces for it are of a problem without a solution.
constexpr double kPartOfLoads = 1e-2;

}  // namespace

ShiftRounds::ShiftRounds(SmallPivoting* tableau, const WithinOptions& plain) : tableau_(tableau) {
  if (plain.make_plain) solver_ = std::make_unique<RelaxationSolver>(plain);
}

void ShiftRounds::Reserve(Index max_rows) {
  for (PaddedVector* const numbers : {&shift_, &gaps_, &loads_, &start_, &row_, &b_, &f_, &diagonal_}) {
    numbers->Lengthen(max_rows);
  }
  const Index most = std::min(max_rows, SmallPivoting::kMaxRows);
  A_.Lengthen(most * most);
  relaxed_.Reserve(max_rows);
  bilateral_.reserve(At(max_rows));
}

void ShiftRounds::Start(const ContactRows& rows) {
  Reserve(rows.size());
  shift_.head(rows.size()).setZero();
  is_first_ = true;
  is_assembled_ = false;
  status_ = LcpStatus::kNotRun;
}

const char* ShiftRounds::TakeRounds(const ContactRows& rows, int count, ModeSteps* newton, PaddedVector* phi,
                                    FrictionAnswer* answer) {
  for (int k = 0; k < count && !answer->IsOver(); ++k) {
    if (const char* method = TakeRound(rows, newton, phi, answer)) return method;
    if (!is_solved()) break;
  }
  return nullptr;
}

const char* ShiftRounds::TakeRound(const ContactRows& rows, ModeSteps* newton, PaddedVector* phi,
                                   FrictionAnswer* answer) {
  constexpr ModeSteps::Limits kAfterwards{.steps = 8, .eps = 1e-8};
  if (!(answer->Remaining() > 0)) return nullptr;
  const bool was_first = is_first_;
  ++answer->iterations();
  if (rows.is_dense() ? RelaxDense(rows, answer, phi) : RelaxProblem(rows, answer, phi)) {
    return was_first ? "relaxation" : "shift";
  }
  if (!has_forces()) return nullptr;
  rows.ComputeGaps(*phi, &gaps_);
  for (const FrictionRow& row : rows.laws().friction) {
    if (!CanStick(row)) continue;
    shift_[row.normal] = row.mu * std::abs(gaps_[row.row]);
    is_first_ = is_first_ && shift_[row.normal] == 0;
  }
  return newton->TakeDampedSteps(rows, kAfterwards, phi, answer) ? (was_first ? "mode-newton" : "shift") : nullptr;
}

// P A P^T.
void ShiftRounds::AssembleDense(const ContactRows& rows) {
  relaxed_.Set(rows.size(), rows.laws().friction);
  const Index m = relaxed_.size();
  bilateral_.assign(At(m), 0);
  for (Index k = 0; k < m; ++k) {
    const RelaxedRows::Row& row = relaxed_.rows()[At(k)];
    row_.head(rows.size()).setZero();
    const auto add = [&](Index i, double factor) {
      rows.VisitRow(i, [&](Index j, double a) { row_[j] += factor * a; });
    };
    add(row.normal, 1);
    if (row.tangent >= 0) add(row.tangent, row.factor);
    for (Index l = 0; l < m; ++l) A_[k * m + l] = RelaxedRows::Load(relaxed_.rows()[At(l)], row_);
    diagonal_[k] = A_[k * m + k];
    bilateral_[At(k)] = std::ranges::binary_search(rows.laws().joints, row.normal) ? 1 : 0;
  }
  is_assembled_ = true;
}

bool ShiftRounds::RelaxDense(const ContactRows& rows, FrictionAnswer* answer, PaddedVector* phi) {
  if (!is_assembled_) AssembleDense(rows);
  const Index n = rows.size(), m = relaxed_.size();
  status_ = LcpStatus::kUnsupported;
  if (m > SmallPivoting::kMaxRows) return false;
  loads_.head(n) = rows.b() + shift_.head(n);
  SmallPivoting::Request request;
  const double tolerance = std::max(answer->tolerance(), kFineEnough);
  request.row_limit = tableau::kMargin * std::sqrt(tolerance);
  request.initial_f = is_first_ ? nullptr : start_.data();
  for (Index k = 0; k < m; ++k) {
    const RelaxedRows::Row& row = relaxed_.rows()[At(k)];
    b_[k] = RelaxedRows::Load(row, loads_);
    if (!is_first_) start_[k] = f_[k];
  }
  const auto is_solved = [&] {
    const SmallPivoting::Answer found =
        tableau_->SolveDense(m, A_.data(), diagonal_.data(), b_.data(), bilateral_.data(), request, f_.data());
    return found.Judge(tolerance) != SmallPivoting::Answer::Judgement::kWrong;
  };
  bool has_arrived = is_solved();
  for (const double eps : kProximal) {
    if (has_arrived) break;
    for (Index k = 0; k < m; ++k) A_[k * m + k] = diagonal_[k] += eps;
    has_arrived = is_solved();
    if (has_arrived && !(eps * f_.head(m).norm() <= kPartOfLoads * b_.head(m).norm())) return false;
  }
  if (!has_arrived) return false;
  status_ = LcpStatus::kSolved;
  phi->Lengthen(n);
  relaxed_.GetForces(f_.data(), phi);
  return answer->Take(*phi);
}

bool ShiftRounds::RelaxProblem(const ContactRows& rows, FrictionAnswer* answer, PaddedVector* phi) {
  const LcpProblem& problem = answer->problem();
  const Index n = rows.size();
  LcpOptions of_round = answer->options();
  of_round.max_iterations = 0;
  of_round.time_limit_s = kShareOfTime * answer->Remaining();
  const Eigen::VectorXd before = result_.f;
  of_round.initial_f = is_first_ ? nullptr : &before;
  loads_.head(n) = problem.b();
  for (Index i = 0; i < n; ++i) loads_[i] += shift_[i] * rows.root(i);
  solver_->Solve(problem.WithB(loads_.head(n)), of_round, &result_);
  answer->ForgetTime();
  status_ = result_.status;
  if (!result_.f.allFinite()) status_ = LcpStatus::kUnsupported;
  if (!has_forces()) return false;
  rows.ToScaled(result_.f, phi);
  return answer->TakeForces(result_.f);
}

}  // namespace lcpbench
