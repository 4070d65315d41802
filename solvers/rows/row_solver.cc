#include "solvers/rows/row_solver.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "solvers/pivoting/tableau_rules.h"

namespace lcpbench {
namespace {

std::size_t At(std::int64_t i) { return static_cast<std::size_t>(i); }
constexpr Index kRowsWithoutIslands = 16;

}  // namespace

void RowSolver::Reserve(Index max_rows, Index max_bodies) {
  islands_.Reserve(max_rows, max_bodies);
  tableau_.ReserveRows(std::min(max_rows, SmallPivoting::kMaxRows), max_bodies);
  const Index known = static_cast<Index>(all_.size());
  if (known >= max_rows) return;
  all_.resize(At(max_rows));
  std::iota(all_.begin() + known, all_.end(), static_cast<std::int32_t>(known));
}

RowAnswer RowSolver::Solve(const StepRows& rows, const LcpOptions& options, const double* initial_f, double* f,
                           double* w) {
  const SmallPivoting::Request request{tableau::kMargin * std::sqrt(options.tolerance), initial_f, nullptr, true};
  RowAnswer answer;
  const auto solve = [&](std::span<const std::int32_t> part) {
    const SmallPivoting::Answer of_part = tableau_.SolveRows(rows, part, request, f, w);
    answer.iterations += tableau_.pivots();
    answer.rho = std::max(answer.rho, of_part.rho);
    return of_part.rho <= tableau::kMostRho && of_part.rho + of_part.rounding <= options.tolerance && of_part.rows_meet;
  };
  if (rows.rows <= kRowsWithoutIslands) {
    answer.solved = solve({all_.data(), At(rows.rows)});
    return answer;
  }
  islands_.Find(rows);
  for (Index k = 0; k < islands_.count(); ++k) {
    if (islands_.rows(k).size() > SmallPivoting::kMaxRows || !solve(islands_.rows(k))) return answer;
  }
  answer.solved = true;
  return answer;
}

template <int p>
bool TwoBodyCopy::TakeRows(const ProblemArrays& arrays) {
  const Index n = arrays.rows;
  if (body_.size() < At(2 * n)) body_.resize(At(2 * n));
  if (J_.size() < At(2 * p * n)) J_.resize(At(2 * p * n));
  const int* start = arrays.row_start.data();
  const int* column = arrays.column.data();
  const double* value = arrays.value.data();
  const double* mass = arrays.inverse_mass.data();
  double* J = J_.data();
  std::int32_t* body = body_.data();
  for (Index i = 0; i < n; ++i, J += 2 * p, body += 2) {
    for (int c = 0; c < 2 * p; ++c) J[c] = 0;
    body[0] = body[1] = -1;
    for (int e = start[i]; e < start[i + 1]; ++e) {
      const int k = column[e] / p;
      const int c = column[e] - k * p;
      if (mass[column[e]] == 0) continue;
      if (k == body[0] || body[0] < 0) {
        body[0] = k;
        J[c] = value[e];
      } else if (k == body[1] || body[1] < 0) {
        body[1] = k;
        J[p + c] = value[e];
      } else {
        return false;
      }
    }
  }
  return true;
}

bool TwoBodyCopy::Take(const ProblemArrays& arrays) {
  const int p = arrays.facts.columns_per_body;
  if (arrays.columns % p != 0) return false;
  rows_ = {};
  rows_.columns_per_body = p;
  rows_.rows = arrays.rows;
  rows_.bodies = arrays.columns / p;
  if (!(p == 3 ? TakeRows<3>(arrays) : TakeRows<6>(arrays))) return false;
  rows_.body = body_.data();
  rows_.J = J_.data();
  rows_.b = arrays.b.data();
  rows_.bilateral = arrays.bilateral.empty() ? nullptr : arrays.bilateral.data();
  rows_.inverse_mass = arrays.inverse_mass.data();
  return true;
}

}  // namespace lcpbench
