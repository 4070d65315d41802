#include "solvers/auto/row_solver.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "solvers/linear_algebra/tableau_rules.h"
#include "support/array_index.h"

namespace lcpbench {
namespace {

// How often profile pivoting sweeps on where single rows do not pass.
constexpr int kMoreSweeps = 4;
// Parts of the largest force of an island below which forces are taken for rounding, where a row's error asks for it.
constexpr double kRoundingOfForces[] = {1e-13, 1e-11, 1e-9};

}  // namespace

void RowSolver::Reserve(Index max_rows, Index max_bodies) {
  if (max_rows <= reserved_rows_ && max_bodies <= reserved_bodies_) return;
  max_rows = reserved_rows_ = std::max(max_rows, reserved_rows_);
  max_bodies = reserved_bodies_ = std::max(max_bodies, reserved_bodies_);
  islands_.Reserve(max_rows, max_bodies);
  tableau_.ReserveRows(std::min(max_rows, SmallPivoting::kMaxRows), max_bodies);
  judge_.Reserve(max_rows, max_bodies);
  profile_.Reserve(std::min(max_rows, AutoFacts::kMostIslandRows), max_bodies);
  const Index known = static_cast<Index>(all_.size());
  if (known >= max_rows) return;
  all_.resize(At(max_rows));
  std::iota(all_.begin() + known, all_.end(), static_cast<std::int32_t>(known));
}

RowAnswer RowSolver::Solve(const StepRows& rows, double tolerance, const Deadline* deadline, const double* initial_f,
                           double* f, double* w) {
  RowAnswer answer;
  const Request request{rows, tolerance, deadline, initial_f, f, w};
  if (rows.rows <= AutoFacts::kMostUndividedRows) {
    facts_.is_undivided = true;
    answer.solved = SolvePart(request, {all_.data(), At(rows.rows)}, &answer) == PartEnd::kSolved;
    if (answer.solved) return answer;
  }
  facts_.is_undivided = false;
  islands_.Find(rows);
  answer.solved = true;
  for (Index k = 0; k < islands_.count(); ++k) {
    if (std::ssize(islands_.rows(k)) > AutoFacts::kMostIslandRows) answer.solved = answer.fits = false;
  }
  Index rows_since_clock = 0;
  for (Index k = 0; k < islands_.count() && answer.solved; ++k) {
    const Part part = islands_.rows(k);
    const bool is_idle = part.size() == 1 && DiagonalOf(rows, part.front()) == 0;
    const PartEnd end = is_idle ? SolveIdleRow(request, part.front()) : SolvePart(request, part, &answer);
    answer.solved = end == PartEnd::kSolved;
    answer.fits = end != PartEnd::kNoRule;
    rows_since_clock += std::ssize(part);
    if (rows_since_clock <= SmallPivoting::kRowsWithoutClock || deadline == nullptr) continue;
    rows_since_clock = 0;
    answer.solved = answer.solved && (k + 1 == islands_.count() || !deadline->Expired());
  }
  return answer;
}

// The gap of a row that moves nothing is b, whatever its force.
RowSolver::PartEnd RowSolver::SolveIdleRow(const Request& request, std::int32_t row) {
  const double b = request.rows.b[row];
  const bool is_joint = request.rows.bilateral != nullptr && request.rows.bilateral[row] != 0;
  request.f[row] = 0;
  request.w[row] = b;
  return (is_joint ? b == 0 : b >= 0) ? PartEnd::kSolved : PartEnd::kGaveUp;
}

RowSolver::PartEnd RowSolver::SolvePart(const Request& request, Part part, RowAnswer* answer) {
  facts_.rows = std::ssize(part);
  PartEnd end = PartEnd::kNoRule;
  for (const AutoRule& rule : rules_) {
    if (rule.Grants(facts_) == 0 || rule.method != only_.value_or(rule.method)) continue;
    if (end != PartEnd::kNoRule && request.deadline != nullptr && request.deadline->Expired()) break;
    // Most of the active set of inexact forces is right.
    const double* const initial_f = end == PartEnd::kInexact ? request.f : request.initial_f;
    end = Ask(rule.method, request, part, initial_f, answer);
    if (end == PartEnd::kSolved) break;
  }
  return end;
}

RowSolver::PartEnd RowSolver::Ask(AutoMethod method, const Request& request, Part part, const double* initial_f,
                                  RowAnswer* answer) {
  if (method == AutoMethod::kFixedSizeBpp) return AskFixedSizeBpp(request, part, answer);
  if (method == AutoMethod::kPrincipalPivoting) return AskPrincipalPivoting(request, part, initial_f, answer);
  return AskProfilePivoting(request, part, initial_f, answer);
}

RowSolver::PartEnd RowSolver::AskFixedSizeBpp(const Request& request, Part part, RowAnswer* answer) {
  const double tolerance = request.tolerance;
  const double row_limit = tableau::kMargin * std::sqrt(tolerance);
  double rho = 0;
  if (!few_.Solve(request.rows, part, tolerance, row_limit, request.f, request.w, &rho)) return PartEnd::kGaveUp;
  ++answer->iterations;
  answer->rho = std::max(answer->rho, rho);
  return PartEnd::kSolved;
}

RowSolver::PartEnd RowSolver::AskPrincipalPivoting(const Request& request, Part part, const double* initial_f,
                                                   RowAnswer* answer) {
  SmallPivoting::Request of_part;
  of_part.initial_f = initial_f;
  of_part.deadline = request.deadline;
  double rho = 0;
  const SmallPivoting::End end =
      tableau_.SolveRows(request.rows, part, request.tolerance, of_part, &judge_, request.f, request.w, &rho);
  answer->iterations += tableau_.pivots();
  if (end == SmallPivoting::End::kInexact) return PartEnd::kInexact;
  if (end == SmallPivoting::End::kGaveUp) return PartEnd::kGaveUp;
  answer->rho = std::max(answer->rho, rho);
  return PartEnd::kSolved;
}

RowSolver::PartEnd RowSolver::AskProfilePivoting(const Request& request, Part part, const double* initial_f,
                                                 RowAnswer* answer) {
  profile_.Solve(request.rows, part, {request.tolerance / 2, initial_f, request.deadline}, request.f);
  answer->iterations += profile_.iterations();
  double rho = 0;
  bool passes = Passes(request, part, &rho);
  for (int k = 0; k < kMoreSweeps && !passes && profile_.SweepOn(request.f); ++k) {
    passes = Passes(request, part, &rho);
  }
  for (const double rounding : kRoundingOfForces) {
    if (passes) break;
    profile_.Polish(rounding, request.f);
    passes = Passes(request, part, &rho);
  }
  answer->rho = std::max(answer->rho, rho);
  return passes ? PartEnd::kSolved : PartEnd::kGaveUp;
}

}  // namespace lcpbench
