#include "solvers/rows/row_solver.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <optional>

#include "solvers/lcp/number_range.h"
#include "solvers/pivoting/tableau_rules.h"
#include "solvers/rows/tiny_rows.h"

namespace lcpbench {
namespace {

std::size_t At(std::int64_t i) { return static_cast<std::size_t>(i); }
constexpr Index kRowsWithoutIslands = 16;
// Parts of the largest force of an island below which forces are taken for rounding, where a row's error asks for it.
constexpr double kRoundingOfForces[] = {1e-13, 1e-11, 1e-9};

}  // namespace

void RowSolver::Reserve(Index max_rows, Index max_bodies) {
  islands_.Reserve(max_rows, max_bodies);
  tableau_.ReserveRows(std::min(max_rows, SmallPivoting::kMaxRows), max_bodies);
  profile_.Reserve(std::min(max_rows, kMostIslandRows), max_bodies);
  judge_.Reserve(max_bodies);
  const Index known = static_cast<Index>(all_.size());
  if (known >= max_rows) return;
  all_.resize(At(max_rows));
  std::iota(all_.begin() + known, all_.end(), static_cast<std::int32_t>(known));
}

RowAnswer RowSolver::Solve(const StepRows& rows, const LcpOptions& options, const double* initial_f, double* f,
                           double* w) {
  RowAnswer answer;
  answer.solved = true;
  std::optional<Deadline> deadline;
  if (rows.rows > SmallPivoting::kRowsWithoutClock && std::isfinite(options.time_limit_s)) deadline.emplace(options);
  const Request request{rows, options, initial_f, deadline.has_value() ? &*deadline : nullptr, f, w};
  if (rows.rows <= kRowsWithoutIslands &&
      SolveDense(request, {all_.data(), At(rows.rows)}, &answer) == DenseEnd::kSolved) {
    return answer;
  }
  islands_.Find(rows);
  for (Index k = 0; k < islands_.count(); ++k) {
    if (Index{static_cast<Index>(islands_.rows(k).size())} > kMostIslandRows) return {};
  }
  Index rows_since_clock = 0;
  for (Index k = 0; k < islands_.count() && answer.solved; ++k) {
    SolvePart(request, islands_.rows(k), &answer);
    rows_since_clock += std::ssize(islands_.rows(k));
    if (rows_since_clock <= SmallPivoting::kRowsWithoutClock || !deadline.has_value()) continue;
    rows_since_clock = 0;
    answer.solved = answer.solved && (k + 1 == islands_.count() || !deadline->Expired());
  }
  return answer;
}

// Up to a tableau's size. Not solved: nothing is added to the answer but iterations. Another method, please.
RowSolver::DenseEnd RowSolver::SolveDense(const Request& request, std::span<const std::int32_t> part,
                                          RowAnswer* answer) {
  const double tolerance = request.options.tolerance;
  const double row_limit = tableau::kMargin * std::sqrt(tolerance);
  if (std::ssize(part) <= TinyRows::kMostRows) {
    double rho = 0;
    if (TinyRows::Solve(request.rows, part, tolerance, row_limit, request.f, request.w, &rho)) {
      ++answer->iterations;
      answer->rho = std::max(answer->rho, rho);
      return DenseEnd::kSolved;
    }
  }
  const SmallPivoting::Answer found = tableau_.SolveRows(
      request.rows, part, {row_limit, request.initial_f, request.deadline, true}, request.f, request.w);
  answer->iterations += tableau_.pivots();
  const DenseEnd unsolved = std::isfinite(found.rho) ? DenseEnd::kInexact : DenseEnd::kGaveUp;
  if (!(found.rho <= std::min(tableau::kMostRho, tolerance) && found.rows_meet)) return unsolved;
  double rho = found.rho;
  if (rho + found.rounding > tolerance && !judge_.Passes(request.rows, part, tolerance, request.f, request.w, &rho)) {
    return unsolved;
  }
  answer->rho = std::max(answer->rho, rho);
  return DenseEnd::kSolved;
}

void RowSolver::SolvePart(const Request& request, std::span<const std::int32_t> part, RowAnswer* answer) {
  const double tolerance = request.options.tolerance;
  if (part.size() == 1 && DiagonalOf(request.rows, part.front()) == 0) {
    // Its gap is b, whatever its force.
    const std::int32_t row = part.front();
    const double b = request.rows.b[row];
    const bool is_joint = request.rows.bilateral != nullptr && request.rows.bilateral[row] != 0;
    request.f[row] = 0;
    request.w[row] = b;
    answer->solved = answer->solved && (is_joint ? b == 0 : b >= 0);
    return;
  }
  const bool fits_tableau = std::ssize(part) <= SmallPivoting::kMaxRows;
  const DenseEnd end = fits_tableau ? SolveDense(request, part, answer) : DenseEnd::kGaveUp;
  if (end == DenseEnd::kSolved) return;
  if (request.deadline != nullptr && request.deadline->Expired()) {
    answer->solved = false;
    return;
  }
  // Above, and where rows depend on others; from the tableau's forces where they are inexact, since most of its active
  // set is right.
  const double* const initial_f = end == DenseEnd::kInexact ? request.f : request.initial_f;
  profile_.Solve(request.rows, part, {tolerance / 2, initial_f, request.deadline}, request.f);
  answer->iterations += profile_.iterations();
  double rho = 0;
  const auto judge = [&] { return judge_.Passes(request.rows, part, tolerance, request.f, request.w, &rho); };
  bool passes = judge();
  for (const double rounding : kRoundingOfForces) {
    if (passes) break;
    profile_.Polish(rounding, request.f);
    passes = judge();
  }
  answer->solved = answer->solved && passes;
  answer->rho = std::max(answer->rho, rho);
}

// Columns that do not ascend or are out of range end it as a third body does: LcpProblem finds the words for them.
template <Index p>
bool TwoBodyCopy::TakeRows(const ProblemArrays& arrays) {
  const Index n = arrays.rows;
  if (body_.size() < At(2 * n)) body_.resize(At(2 * n));
  if (J_.size() < At(2 * p * n)) J_.resize(At(2 * p * n));
  const int* const start = arrays.row_start.data();
  const int* const column = arrays.column.data();
  const double* const value = arrays.value.data();
  const double* const mass = arrays.inverse_mass.data();
  if (moves_.size() < At(arrays.columns / p)) moves_.resize(At(arrays.columns / p));
  unsigned char* const moves = moves_.data();
  for (Index k = 0; k < arrays.columns / p; ++k) {
    double sum = 0;
    for (int c = 0; c < p; ++c) sum += mass[k * p + c];
    moves[k] = sum > 0 ? 1 : 0;
  }
  const auto columns = static_cast<int>(arrays.columns);
  const auto entries = static_cast<int>(arrays.column.size());
  double* J = J_.data();
  std::int32_t* body = body_.data();
  for (Index i = 0; i < n; ++i, J += 2 * p, body += 2) {
    const int end = start[i + 1];
    if (end < start[i] || end > entries) return false;
    const int* const from = column + start[i];
    // Both bodies' entries in full, as scenes have them.
    bool is_full = end - start[i] == 2 * p && from[0] >= 0 && from[p] > from[0] && from[p] + p <= columns;
    if (is_full) {
      int differences = from[0] % p | from[p] % p;
      for (int c = 1; c < p; ++c) differences |= (from[c] - from[0] - c) | (from[p + c] - from[p] - c);
      is_full = differences == 0;
    }
    if (is_full) {
      const double* const numbers = value + start[i];
      const std::int32_t first = from[0] / p;
      const std::int32_t second = from[p] / p;
      for (int c = 0; c < 2 * p; ++c) J[c] = numbers[c];
      body[0] = moves[first] != 0 ? first : -1;
      body[1] = moves[second] != 0 ? second : -1;
      continue;
    }
    for (int c = 0; c < 2 * p; ++c) J[c] = 0;
    body[0] = body[1] = -1;
    int side = -1;
    std::int32_t current = -1;
    int last = -1;
    for (int e = start[i]; e < end; ++e) {
      if (column[e] <= last || column[e] >= columns) return false;
      last = column[e];
      const std::int32_t k = last / p;
      if (moves[k] == 0) continue;
      side += k != current ? 1 : 0;
      if (side > 1) return false;
      current = body[side] = k;
      J[side * p + last - k * p] = value[e];
    }
  }
  return true;
}

bool TwoBodyCopy::Take(const ProblemArrays& arrays) {
  const int p = arrays.facts.columns_per_body;
  const auto count = static_cast<Index>(arrays.value.size());
  const bool fits = arrays.form == MatrixForm::kFactors && (p == 3 || p == 6) && arrays.columns % p == 0 &&
                    At(arrays.rows) == arrays.b.size() && At(arrays.rows) + 1 == arrays.row_start.size() &&
                    arrays.column.size() == arrays.value.size() && At(arrays.columns) == arrays.inverse_mass.size() &&
                    (arrays.bilateral.empty() || arrays.bilateral.size() == arrays.b.size()) &&
                    arrays.row_start.front() == 0 && arrays.row_start.back() == count;
  if (!fits) return false;
  NumberRange of_factors(kFactorRange);
  NumberRange of_loads(kLoadRange);
  of_factors.Look(arrays.value.data(), count);
  of_factors.Look(arrays.inverse_mass.data(), arrays.columns);
  of_loads.Look(arrays.b.data(), arrays.rows);
  if (of_factors.has_large() || !of_loads.is_within()) return false;
  // -0.0 is 0, and seldom: it goes the long way.
  std::uint64_t signs = 0;
  for (const double m : arrays.inverse_mass) signs |= std::bit_cast<std::uint64_t>(m);
  if (signs >> 63U != 0 || !(p == 3 ? TakeRows<3>(arrays) : TakeRows<6>(arrays))) return false;
  rows_.columns_per_body = p;
  rows_.rows = arrays.rows;
  rows_.bodies = arrays.columns / p;
  rows_.body = body_.data();
  rows_.J = J_.data();
  rows_.b = arrays.b.data();
  rows_.bilateral = arrays.bilateral.empty() ? nullptr : arrays.bilateral.data();
  rows_.inverse_mass = arrays.inverse_mass.data();
  return !of_factors.has_small() || HasDiagonalInRange(rows_);
}

}  // namespace lcpbench
