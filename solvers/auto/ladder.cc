#include "solvers/auto/ladder.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "solvers/friction/few_contacts.h"
#include "solvers/linear_algebra/tableau_rules.h"
#include "support/array_index.h"

namespace lcpbench {
namespace {

// How often profile pivoting sweeps on where single rows do not pass.
constexpr int kMoreSweeps = 4;
// Parts of the largest force of an island below which forces are taken for rounding, where a row's error asks for it.
constexpr double kRoundingOfForces[] = {1e-13, 1e-11, 1e-9};
// rho of several islands with laws together is at most 2^1/2 times that of one: S of the whole has another least.
constexpr double kPartOfTolerance = 0.7;

}  // namespace

void Ladder::Reserve(Index max_rows, Index max_bodies) {
  if (max_rows <= reserved_rows_ && max_bodies <= reserved_bodies_) return;
  max_rows = reserved_rows_ = std::max(max_rows, reserved_rows_);
  max_bodies = reserved_bodies_ = std::max(max_bodies, reserved_bodies_);
  islands_.Reserve(max_rows, max_bodies);
  tableau_.ReserveRows(std::min(max_rows, SmallPivoting::kMaxRows), max_bodies);
  judge_.Reserve(max_rows, max_bodies);
  profile_.Reserve(std::min(max_rows, limits_.island_rows), max_bodies);
  const Index known = static_cast<Index>(all_.size());
  if (known >= max_rows) return;
  all_.resize(At(max_rows));
  std::iota(all_.begin() + known, all_.end(), static_cast<std::int32_t>(known));
}

void Ladder::ReserveLaws(Index max_rows, Index max_bodies) {
  if (laws_.has_value() && max_rows <= std::ssize(laws_->law) && max_bodies <= reserved_bodies_) return;
  Reserve(max_rows, max_bodies);
  max_rows = reserved_rows_;
  if (!laws_.has_value()) laws_.emplace(&relaxations_, limits_);
  LawWork& own = *laws_;
  for (std::vector<std::int32_t>* const numbers : {&own.law, &own.place}) numbers->resize(At(max_rows));
  own.friction.reserve(At(max_rows));
  own.bounded.reserve(At(max_rows));
  const Index most = std::min(max_rows, kMostLawRows);
  own.contacts.Reserve(most, reserved_bodies_);
  own.ladder.Reserve(most);
  relaxations_.Reserve(most);
  for (PaddedVector* const numbers : {&own.start, &own.gaps, &own.room.gaps, &own.room.f}) {
    numbers->Lengthen(most);
  }
  if (own.result.f.size() < most) own.result.f.resize(most);
}

RowAnswer Ladder::Solve(const StepRows& rows, double tolerance, const Deadline* deadline, const double* initial_f,
                        double* f, double* w) {
  RowAnswer answer;
  Request request{rows, tolerance, deadline, initial_f, f, w};
  const bool has_laws = !rows.friction.empty();
  method_ = "";
  rows_of_method_ = 0;
  if (has_laws) {
    // As many friction rows as others: the check of the laws is its own.
    if (rows.bounded.empty() && TryFixedSizeModes(request, rows.rows, rows.friction, &answer)) {
      answer.solved = true;
      return answer;
    }
    const bool has_friction = std::ranges::any_of(rows.friction, [](const FrictionRow& row) { return row.mu > 0; });
    if (!has_friction || !TakeLaws(rows)) return answer;
    answer.next = AutoRulesOf(AutoStage::kLaws).size();
  }
  if (rows.rows <= (has_laws ? ModeSteps::kFewRows : limits_.undivided_rows)) {
    facts_.is_undivided = true;
    answer.solved = SolvePart(request, {all_.data(), At(rows.rows)}, &answer) == PartEnd::kSolved;
    if (answer.solved || has_laws) return answer;
  }
  facts_.is_undivided = false;
  islands_.Find(rows);
  answer.solved = true;
  for (Index k = 0; k < islands_.count() && !has_laws; ++k) {
    if (std::ssize(islands_.rows(k)) > limits_.island_rows) answer.solved = answer.fits = false;
  }
  if (has_laws && islands_.count() > 1) request.tolerance *= kPartOfTolerance;
  Index rows_since_clock = 0;
  for (Index k = 0; k < islands_.count() && (answer.solved || (has_laws && answer.fits)); ++k) {
    const Part part = islands_.rows(k);
    const bool is_idle = !has_laws && part.size() == 1 && DiagonalOf(rows, part.front()) == 0;
    const PartEnd end = is_idle ? SolveIdleRow(request, part.front()) : SolvePart(request, part, &answer);
    answer.solved = answer.solved && end == PartEnd::kSolved;
    answer.fits = answer.fits && (has_laws || end != PartEnd::kNoRule);
    rows_since_clock += std::ssize(part);
    if (rows_since_clock <= SmallPivoting::kRowsWithoutClock || deadline == nullptr) continue;
    rows_since_clock = 0;
    if (k + 1 == islands_.count() || !deadline->Expired()) continue;
    answer.solved = false;
    break;
  }
  return answer;
}

// The gap of a row that moves nothing is b, whatever its force.
Ladder::PartEnd Ladder::SolveIdleRow(const Request& request, std::int32_t row) {
  const double b = request.rows.b[row];
  const bool is_joint = request.rows.bilateral != nullptr && request.rows.bilateral[row] != 0;
  request.f[row] = 0;
  request.w[row] = b;
  return (is_joint ? b == 0 : b >= 0) ? PartEnd::kSolved : PartEnd::kGaveUp;
}

Ladder::PartEnd Ladder::SolvePart(const Request& request, Part part, RowAnswer* answer) {
  if (!request.rows.friction.empty()) return SolveLaws(request, part, answer);
  facts_.rows = std::ssize(part);
  PartEnd end = PartEnd::kNoRule;
  for (const AutoRule& rule : AutoRulesOf(AutoStage::kRows)) {
    if (rule.Grants(facts_) == 0 || rule.method != only_.value_or(rule.method)) continue;
    if (end != PartEnd::kNoRule && request.deadline != nullptr && request.deadline->Expired()) break;
    // Most of the active set of inexact forces is right.
    const double* const initial_f = end == PartEnd::kInexact ? request.f : request.initial_f;
    end = TryMethod(rule.method, request, part, initial_f, answer);
    if (end == PartEnd::kSolved) break;
  }
  return end;
}

Ladder::PartEnd Ladder::TryMethod(AutoMethod method, const Request& request, Part part, const double* initial_f,
                                  RowAnswer* answer) {
  if (method == AutoMethod::kFixedSizeBpp) return TryFixedSizeBpp(request, part, answer);
  if (method == AutoMethod::kPrincipalPivoting) return TryPrincipalPivoting(request, part, initial_f, answer);
  return TryProfilePivoting(request, part, initial_f, answer);
}

Ladder::PartEnd Ladder::TryFixedSizeBpp(const Request& request, Part part, RowAnswer* answer) {
  const double tolerance = request.tolerance;
  const double row_limit = tableau::kMargin * std::sqrt(tolerance);
  double rho = 0;
  if (!few_.Solve(request.rows, part, tolerance, row_limit, request.f, request.w, &rho)) return PartEnd::kGaveUp;
  ++answer->iterations;
  answer->rho = std::max(answer->rho, rho);
  return PartEnd::kSolved;
}

Ladder::PartEnd Ladder::TryPrincipalPivoting(const Request& request, Part part, const double* initial_f,
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

Ladder::PartEnd Ladder::TryProfilePivoting(const Request& request, Part part, const double* initial_f,
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

// Whether the lists are such as LcpProblem takes, which tells what is wrong otherwise.
bool Ladder::TakeLaws(const StepRows& rows) {
  std::vector<std::int32_t>& law = laws_->law;
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  std::fill_n(law.begin(), rows.rows, -1);
  const auto is_joint = [&](Index row) { return rows.bilateral != nullptr && rows.bilateral[row] != 0; };
  const auto is_row = [&](Index row) { return row >= 0 && row < rows.rows && !is_joint(row); };
  for (std::size_t k = 0; k < rows.friction.size(); ++k) {
    const FrictionRow& row = rows.friction[k];
    const bool is_in_range = is_row(row.row) && is_row(row.normal) && row.mu >= 0 &&
                             row.mu <= std::numeric_limits<double>::max() && row.slip >= -1 && row.slip <= 1;
    if (!is_in_range || law[At(row.row)] >= 0) return false;
    law[At(row.row)] = static_cast<std::int32_t>(k);
  }
  for (std::size_t k = 0; k < rows.bounded.size(); ++k) {
    const BoundedRow& row = rows.bounded[k];
    const bool is_in_range = row.lower <= row.upper && row.lower < kInfinity && row.upper > -kInfinity;
    if (!is_row(row.row) || !is_in_range || law[At(row.row)] >= 0) return false;
    law[At(row.row)] = static_cast<std::int32_t>(rows.friction.size() + k);
  }
  return std::ranges::all_of(rows.friction, [&](const FrictionRow& row) { return law[At(row.normal)] < 0; });
}

// Few contacts alone: the rows of `friction`, as many others, and none besides.
bool Ladder::TryFixedSizeModes(const Request& request, Index size, std::span<const FrictionRow> friction,
                               RowAnswer* answer) {
  double rho = 0;
  if (!FewContacts::Solve(request.rows, size, friction, request.tolerance, request.initial_f, request.f, request.w,
                          &rho, &answer->iterations)) {
    return false;
  }
  answer->rho = std::max(answer->rho, rho);
  NameMethod("modes", size);
  return true;
}

void Ladder::NameMethod(const char* method, Index size) {
  if (size > rows_of_method_) method_ = method;
  rows_of_method_ = std::max(rows_of_method_, size);
}

Ladder::PartEnd Ladder::SolveLaws(const Request& request, Part part, RowAnswer* answer) {
  LawWork& own = *laws_;
  const Index n = std::ssize(part);
  const StepRows& step = request.rows;
  own.friction.clear();
  for (const std::int32_t row : part) {
    const std::int32_t law = own.law[At(row)];
    if (law >= 0 && law < std::ssize(step.friction)) own.friction.push_back(step.friction[At(law)]);
  }
  if (n < step.rows && TryFixedSizeModes(request, n, own.friction, answer)) return PartEnd::kSolved;
  for (const std::int32_t row : part) request.f[row] = 0;
  if (n > kMostLawRows) return PartEnd::kNoRule;
  PrepareLaws(request, part);
  FrictionAnswer found(own.contacts, nullptr, own.options, &own.result, &own.room);
  std::size_t next = 0;
  const char* const method = own.ladder.Solve(own.contacts, &next, &found, &own.result);
  answer->iterations += own.result.iterations;
  for (Index i = 0; i < n; ++i) request.f[part[At(i)]] = own.result.f[i];
  if (method == nullptr) {
    answer->next = std::min(next, answer->next);
    return PartEnd::kInexact;
  }
  NameMethod(method, n);
  answer->rho = std::max(answer->rho, found.rho());
  if (request.w == nullptr) return PartEnd::kSolved;
  own.contacts.ComputeGapsOf(own.result.f, &own.gaps);
  for (Index i = 0; i < n; ++i) request.w[part[At(i)]] = own.gaps[i];
  return PartEnd::kSolved;
}

// Laws and rows of a part, whose friction rows are known, counted in it; options and result of its solve.
void Ladder::PrepareLaws(const Request& request, Part part) {
  LawWork& own = *laws_;
  const auto count = std::ssize(request.rows.friction);
  own.bounded.clear();
  for (std::size_t i = 0; i < part.size(); ++i) {
    own.place[At(part[i])] = static_cast<std::int32_t>(i);
    const std::int32_t law = own.law[At(part[i])];
    if (law < count) continue;
    own.bounded.emplace_back(request.rows.bounded[At(law - count)]).row = static_cast<Index>(i);
  }
  for (FrictionRow& row : own.friction) {
    row.row = own.place[At(row.row)];
    row.normal = own.place[At(row.normal)];
  }
  own.contacts.Prepare(request.rows, part, own.friction, own.bounded);
  own.options.tolerance = request.tolerance;
  own.options.initial_f = request.initial_f == nullptr ? nullptr : &own.start;
  for (std::size_t i = 0; i < part.size() && request.initial_f != nullptr; ++i) {
    own.start[static_cast<Index>(i)] = request.initial_f[part[i]];
  }
  own.options.time_limit_s =
      request.deadline == nullptr ? std::numeric_limits<double>::infinity() : request.deadline->Remaining();
  own.result.status = LcpStatus::kNumericalFailure;
  own.result.iterations = 0;
  own.result.f.head(std::ssize(part)).setZero();
}

}  // namespace lcpbench
