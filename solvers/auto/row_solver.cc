#include "solvers/auto/row_solver.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "solvers/pivoting/tableau_rules.h"
#include "solvers/rows/tiny_rows.h"

namespace lcpbench {
namespace {

std::size_t At(std::int64_t i) { return static_cast<std::size_t>(i); }
// Rounding of a sum over a row's two bodies and the rows of each, in units of epsilon times the sum of absolute values.
constexpr double kRoundings = 32;
// Parts of the largest force of an island below which forces are taken for rounding, where a row's error asks for it.
constexpr double kRoundingOfForces[] = {1e-13, 1e-11, 1e-9};
// Of bodies in space.
constexpr Index kMostColumns = 6;

// (|A| |f|)_row over the rows `part`.  O(part)
template <typename Real>
double SizeOfGap(const StepRows& rows, const Real* J, std::span<const std::int32_t> part, const double* f, Index row) {
  const Index p = rows.columns_per_body;
  double size = 0;
  for (const std::int32_t other : part) {
    if (f[other] == 0) continue;
    long double entry = 0;
    for (Index s = 0; s < 4; ++s) {
      const Index own = 2 * row + s / 2;
      const Index its = 2 * Index{other} + s % 2;
      if (rows.body[own] < 0 || rows.body[own] != rows.body[its]) continue;
      for (Index c = 0; c < p; ++c) {
        entry += static_cast<long double>(J[own * p + c]) * rows.inverse_mass[rows.body[own] * p + c] * J[its * p + c];
      }
    }
    size += static_cast<double>(std::abs(entry * f[other]));
  }
  return size;
}

}  // namespace

void RowSolver::Reserve(Index max_rows, Index max_bodies) {
  islands_.Reserve(max_rows, max_bodies);
  tableau_.ReserveRows(std::min(max_rows, SmallPivoting::kMaxRows), max_bodies);
  profile_.Reserve(std::min(max_rows, AutoFacts::kMostIslandRows), max_bodies);
  if (velocity_.size() < At(kMostColumns * max_bodies)) {
    velocity_.resize(At(kMostColumns * max_bodies), 0.0);
    size_.resize(At(kMostColumns * max_bodies), 0.0);
    extended_velocity_.resize(At(kMostColumns * max_bodies), 0.0L);
  }
  const Index known = static_cast<Index>(all_.size());
  if (known >= max_rows) return;
  all_.resize(At(max_rows));
  std::iota(all_.begin() + known, all_.end(), static_cast<std::int32_t>(known));
}

// Whether f passes for the rows `part`, by the given numbers in sums of type Sum, with a bound of what their rounding
// can hide. Writes w.
template <Index p, typename Real, typename Sum>
RowSolver::Known RowSolver::Judge(const StepRows& rows, const Real* J, std::span<const std::int32_t> part,
                                  double tolerance, const double* f, double* w, double* rho, Sum* v) {
  const auto for_sides = [&](Index row, auto&& visit) {
    for (Index s = 0; s < 2; ++s) {
      const std::int32_t body = rows.body[2 * row + s];
      if (body >= 0) visit(J + (2 * row + s) * p, static_cast<Index>(body) * p);
    }
  };
  double* const size = size_.data();
  for (const std::int32_t row : part) {
    if (f[row] == 0) continue;
    for_sides(row, [&](const Real* j, Index at) {
      for (int c = 0; c < p; ++c) {
        const Sum change = rows.inverse_mass[at + c] * (static_cast<Sum>(j[c]) * f[row]);
        v[at + c] += change;
        size[at + c] += static_cast<double>(std::abs(change));
      }
    });
  }
  const double row_limit = tableau::kMargin * std::sqrt(tolerance);
  double r_square = 0;
  double b_square = 0;
  double rounding_square = 0;
  bool rows_meet = true;
  for (const std::int32_t row : part) {
    double d = 0;
    Sum gap = rows.b[row];
    double magnitude = std::abs(rows.b[row]);
    for_sides(row, [&](const Real* jacobian, Index at) {
      for (int c = 0; c < p; ++c) {
        const auto j = static_cast<double>(jacobian[c]);
        d += rows.inverse_mass[at + c] * (j * j);
        gap += static_cast<Sum>(j) * v[at + c];
        magnitude += std::abs(j) * size[at + c];
      }
    });
    const std::int32_t* const bodies = rows.body + Index{2} * row;
    if (bodies[0] == bodies[1]) d = DiagonalOf(rows, row);
    const auto sum = static_cast<double>(gap);
    w[row] = sum;
    const bool is_joint = rows.bilateral != nullptr && rows.bilateral[row] != 0;
    const double force = d * f[row];
    const double defect = is_joint ? sum : std::min(sum, force);
    const double inverse = d > 0 ? 1 / d : 1;
    r_square += defect * defect * inverse;
    b_square += rows.b[row] * rows.b[row] * inverse;
    rounding_square += magnitude * magnitude * inverse;
    // (|A| |f|)_i is at least both |A f|_i and |A_ii f_i|: most rows pass by that alone. `magnitude` is more than it.
    const double least = std::abs(rows.b[row]) + std::max(std::abs(sum - rows.b[row]), std::abs(force));
    rows_meet = rows_meet && (is_joint || f[row] >= 0) && std::abs(defect) <= row_limit * magnitude &&
                (std::abs(defect) <= row_limit * least ||
                 std::abs(defect) <= row_limit * (std::abs(rows.b[row]) + SizeOfGap(rows, J, part, f, row)));
  }
  for (const std::int32_t row : part) {
    for_sides(row, [&](const Real*, Index at) {
      for (int c = 0; c < p; ++c) v[at + c] = size[at + c] = 0;
    });
  }
  const double norm = b_square > 0 ? std::sqrt(b_square) : 1;
  *rho = std::sqrt(r_square) / norm;
  const auto unit = static_cast<double>(std::numeric_limits<Sum>::epsilon());
  const double rounding = kRoundings * unit * std::sqrt(rounding_square) / norm;
  if (!(*rho <= tolerance && rows_meet)) return Known::kWrong;
  return *rho + rounding <= tolerance ? Known::kRight : Known::kUnclear;
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
    // Of inexact forces most of the active set is right.
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
  if (!TinyRows::Solve(request.rows, part, tolerance, row_limit, request.f, request.w, &rho)) return PartEnd::kGaveUp;
  ++answer->iterations;
  answer->rho = std::max(answer->rho, rho);
  return PartEnd::kSolved;
}

RowSolver::PartEnd RowSolver::AskPrincipalPivoting(const Request& request, Part part, const double* initial_f,
                                                   RowAnswer* answer) {
  using Judgement = SmallPivoting::Answer::Judgement;
  const double tolerance = request.tolerance;
  const double row_limit = tableau::kMargin * std::sqrt(tolerance);
  const SmallPivoting::Answer found =
      tableau_.SolveRows(request.rows, part, {row_limit, initial_f, request.deadline, true}, request.f, request.w);
  answer->iterations += tableau_.pivots();
  const Judgement judgement = found.Judge(tolerance);
  double rho = found.rho;
  if (judgement == Judgement::kWrong || (judgement == Judgement::kUnclear && !JudgePart(request, part, &rho))) {
    return std::isfinite(found.rho) ? PartEnd::kInexact : PartEnd::kGaveUp;
  }
  answer->rho = std::max(answer->rho, rho);
  return PartEnd::kSolved;
}

RowSolver::PartEnd RowSolver::AskProfilePivoting(const Request& request, Part part, const double* initial_f,
                                                 RowAnswer* answer) {
  profile_.Solve(request.rows, part, {request.tolerance / 2, initial_f, request.deadline}, request.f);
  answer->iterations += profile_.iterations();
  double rho = 0;
  bool passes = JudgePart(request, part, &rho);
  for (const double rounding : kRoundingOfForces) {
    if (passes) break;
    profile_.Polish(request.rows, rounding, request.f);
    passes = JudgePart(request, part, &rho);
  }
  answer->rho = std::max(answer->rho, rho);
  return passes ? PartEnd::kSolved : PartEnd::kGaveUp;
}

// In double, and in extended precision where rounding may hide more than the tolerance, as with large ratios of masses.
bool RowSolver::JudgePart(const Request& request, std::span<const std::int32_t> part, double* rho) {
  const StepRows& rows = request.rows;
  const auto by = [&](const auto* J, auto* v) {
    return rows.columns_per_body == 3 ? Judge<3>(rows, J, part, request.tolerance, request.f, request.w, rho, v)
                                      : Judge<6>(rows, J, part, request.tolerance, request.f, request.w, rho, v);
  };
  const auto in = [&](auto* v) { return rows.J != nullptr ? by(rows.J, v) : by(rows.J_single, v); };
  const Known known = in(velocity_.data());
  return known == Known::kRight || (known == Known::kUnclear && in(extended_velocity_.data()) == Known::kRight);
}

}  // namespace lcpbench
