#include "solvers/rows/row_input.h"

#include <bit>
#include <cmath>
#include <numeric>
#include <string>
#include <utility>

#include "solvers/lcp/compressed_rows.h"
#include "solvers/lcp/number_range.h"
#include "support/array_index.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

// Up to so many rows a solve takes some ten microseconds.
constexpr Index kRowsWithoutClock = 24;

[[noreturn]] void Reject(const std::string& what) { throw InputError("step rows: " + what); }

// A number that is not what it must be, named by its row or body.
void RejectNumber(const StepRows& rows, const double* initial_f) {
  const Index p = rows.columns_per_body;
  const auto require = [](bool holds, const char* name, const char* place, Index index, double found,
                          const char* expected) {
    if (!holds) {
      Reject(std::string(name) + " of " + place + " " + std::to_string(index) + " is " + std::to_string(found) +
             ", expected " + expected);
    }
  };
  for (Index i = 0; i < rows.rows; ++i) {
    require(std::isfinite(rows.b[i]), "b", "row", i, rows.b[i], "a finite number");
    if (initial_f != nullptr)
      require(std::isfinite(initial_f[i]), "initial f", "row", i, initial_f[i], "a finite number");
    for (Index side = 0; side < 2; ++side) {
      const std::int32_t body = rows.body[2 * i + side];
      require(body >= -1 && body < rows.bodies, "body", "row", i, body,
              ("one in [-1, " + std::to_string(rows.bodies) + ")").c_str());
      for (Index c = 0; c < p; ++c) {
        const Index at = (2 * i + side) * p + c;
        const double j = rows.J != nullptr ? rows.J[at] : static_cast<double>(rows.J_single[at]);
        require(std::isfinite(j), "J", "row", i, j, "a finite number");
        if (body < 0) continue;
        const double m = rows.inverse_mass[body * p + c];
        require(std::isfinite(m) && m >= 0, "inverse mass", "body", body, m, "a finite number >= 0");
      }
    }
  }
}

}  // namespace

bool CheckRows(const StepRows& rows, const double* initial_f) {
  const Index p = rows.columns_per_body;
  if (p != 3 && p != 6) Reject("columns per body must be 3 or 6, found " + std::to_string(p));
  if (rows.rows < 0 || rows.bodies < 0) Reject("rows and bodies must be >= 0");
  if (rows.rows == 0) return true;
  const void* const J = rows.J != nullptr ? static_cast<const void*>(rows.J) : rows.J_single;
  const std::pair<const void*, const char*> arrays[] = {
      {rows.body, "body"}, {rows.b, "b"}, {J, "J"}, {rows.bodies > 0 ? rows.inverse_mass : rows.b, "inverse mass"}};
  for (const auto& [array, name] : arrays) {
    if (array == nullptr) Reject(std::string(name) + " is missing");
  }

  NumberRange of_factors(kFactorRange);
  NumberRange of_loads(kLoadRange);
  bool has_sign = false;
  bool is_known = true;
  const auto look_at_masses = [&](Index first, Index bodies) {
    of_factors.Look(rows.inverse_mass + first * p, bodies * p);
    has_sign = has_sign || HasSign(rows.inverse_mass + first * p, bodies * p);
  };
  WithNumbers(rows, [&](const auto* numbers, auto width) { of_factors.Look(numbers, 2 * width * rows.rows); });
  of_loads.Look(rows.b, rows.rows);
  for (Index k = 0; k < 2 * rows.rows; ++k) is_known &= rows.body[k] >= -1 && rows.body[k] < rows.bodies;
  if (is_known && rows.bodies <= 2 * rows.rows) {
    look_at_masses(0, rows.bodies);
  } else if (is_known) {  // few rows name bodies of a large world: only these are looked at
    for (Index k = 0; k < 2 * rows.rows; ++k) {
      if (rows.body[k] >= 0) look_at_masses(rows.body[k], 1);
    }
  }
  bool is_finite = true;
  for (Index i = 0; i < rows.rows && initial_f != nullptr; ++i) is_finite &= std::isfinite(initial_f[i]);
  // -0.0 is allowed, but seldom: the slow way decides.
  if (!is_known || !is_finite || has_sign || of_factors.has_large() || of_loads.has_large()) {
    RejectNumber(rows, initial_f);
  }
  return !of_factors.has_large() && of_loads.is_within() && (!of_factors.has_small() || HasDiagonalInRange(rows));
}

// Columns that do not ascend or are out of range end it as a third body does: LcpProblem finds the words for them.
template <Index p>
bool TwoBodyCopy::TakeRows(const ProblemView& arrays) {
  const Index n = arrays.rows;
  if (J_.size() < At(2 * p * n)) J_.resize(At(2 * p * n));
  const int* const start = arrays.row_start.data();
  const int* const column = arrays.column.data();
  const double* const value = arrays.value.data();
  const double* const mass = arrays.inverse_mass.data();
  const auto columns = static_cast<int>(arrays.columns);
  const auto entries = static_cast<int>(arrays.value.size());
  const auto moves = [mass](std::int32_t k) {
    return std::any_of(mass + k * p, mass + (k + 1) * p, [](double m) { return m > 0; });
  };
  double* J = J_.data();
  std::int32_t* body = body_.data();
  for (Index i = 0; i < n; ++i, J += 2 * p, body += 2) {
    const int end = start[i + 1];
    if (end < start[i] || end > entries) return false;
    const int* const from = column + start[i];
    if (end - start[i] == 2 * p && FindTwoBodiesOfRow<p>(from, columns, mass, body)) {
      std::copy_n(value + start[i], 2 * p, J);
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
      if (!moves(k)) continue;
      side += k != current ? 1 : 0;
      if (side > 1) return false;
      current = body[side] = k;
      J[side * p + last - k * p] = value[e];
    }
  }
  return true;
}

bool TwoBodyCopy::Take(const ProblemView& arrays) {
  const Index p = arrays.facts.columns_per_body;
  if (arrays.form != MatrixForm::kFactors || (p != 3 && p != 6) || arrays.columns % p != 0) return false;
  bool has_small = false;
  if (!arrays.is_checked) {
    const bool fits = At(arrays.rows) == arrays.b.size() && At(arrays.rows) + 1 == arrays.row_start.size() &&
                      arrays.column.size() == arrays.value.size() && At(arrays.columns) == arrays.inverse_mass.size() &&
                      (arrays.bilateral.empty() || arrays.bilateral.size() == arrays.b.size()) &&
                      arrays.row_start.front() == 0 && At(arrays.row_start.back()) == arrays.value.size();
    if (!fits) return false;
    NumberRange of_loads(kLoadRange);
    of_loads.Look(arrays.b.data(), arrays.rows);
    NumberRange range(kFactorRange);
    range.Look(arrays.value.data(), std::ssize(arrays.value));
    range.Look(arrays.inverse_mass.data(), arrays.columns);
    // -0.0 is 0, and seldom: it goes the long way.
    const bool has_sign = HasSign(arrays.inverse_mass.data(), arrays.columns);
    if (!of_loads.is_within() || range.has_large() || has_sign) return false;
    has_small = range.has_small();
  }
  rows_.body = arrays.body.data();
  rows_.J = arrays.value.data();
  if (arrays.body.empty()) {
    if (body_.size() < At(2 * arrays.rows)) body_.resize(At(2 * arrays.rows));
    rows_.body = body_.data();
    if (!FindTwoBodies(arrays.row_start, arrays.column, arrays.inverse_mass, static_cast<int>(p), body_.data())) {
      if (!(p == 3 ? TakeRows<3>(arrays) : TakeRows<6>(arrays))) return false;
      rows_.J = J_.data();
    }
  }
  rows_.columns_per_body = static_cast<int>(p);
  rows_.rows = arrays.rows;
  rows_.bodies = arrays.columns / p;
  rows_.b = arrays.b.data();
  rows_.bilateral = arrays.bilateral.empty() ? nullptr : arrays.bilateral.data();
  rows_.inverse_mass = arrays.inverse_mass.data();
  rows_.friction = arrays.friction;
  rows_.bounded = arrays.bounded;
  return !has_small || HasDiagonalInRange(rows_);
}

bool RowEngine::SolveArrays(const ProblemArrays& arrays, const LcpOptions& options, LcpResult* result) {
  const Index n = arrays.rows;
  if (most_rows_.has_value() && (n > *most_rows_ || options.max_iterations > 0)) return false;
  if (!copy_.Take(arrays)) return false;
  judge_.Reserve(n, copy_.rows().bodies);
  if (all_.size() < At(n)) {
    all_.resize(At(n));
    w_.resize(At(n));
    std::iota(all_.begin(), all_.end(), 0);
  }
  std::optional<Deadline> deadline;
  if (n > kRowsWithoutClock && Deadline::IsNeeded(options)) deadline.emplace(options);
  const RowTask task{copy_.rows(), {all_.data(), At(n)}, judge_, options, deadline.has_value() ? &*deadline : nullptr,
                     w_.data()};
  return SolveRows(task, result);
}

}  // namespace lcpbench
