#include "solvers/lcp/range_scaling.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "solvers/lcp/verify.h"
#include "support/array_index.h"

namespace lcpbench {
namespace {

constexpr int kNone = std::numeric_limits<int>::min();

// floor(log2 |x|); kNone for 0.
int ExponentOf(double x) { return x == 0 ? kNone : std::ilogb(x); }

// f(i, j, e) for every entry of the given form, J or A, which is value[e].
template <typename F>
void ForEachGivenEntry(const ProblemView& given, const F& f) {
  const bool is_dense = given.form == MatrixForm::kDense;
  for (Index i = 0, e = 0; i < given.rows; ++i) {
    const Index end = is_dense ? e + given.rows : given.row_start[At(i) + 1];
    for (const Index begin = e; e < end; ++e) f(At(i), At(is_dense ? e - begin : given.column[At(e)]), At(e));
  }
}

// About log2 of A_ii, or of what stands beside a zero there; kNone for rows of zeros.
std::vector<int> RowExponents(const ProblemView& given) {
  const bool has_factors = given.form == MatrixForm::kFactors;
  std::vector<int> row(At(given.rows), kNone);
  ForEachGivenEntry(given, [&](std::size_t i, std::size_t j, std::size_t e) {
    if (given.value[e] == 0 || (has_factors ? given.inverse_mass[j] == 0 : i != j)) return;
    const int exponent = ExponentOf(given.value[e]);
    row[i] = std::max(row[i], has_factors ? 2 * exponent + ExponentOf(given.inverse_mass[j]) : exponent);
  });
  if (has_factors) return row;
  const std::vector<int> diagonal = row;
  ForEachGivenEntry(given, [&](std::size_t i, std::size_t j, std::size_t e) {
    for (const std::size_t k : {i, j}) {
      if (diagonal[k] == kNone) row[k] = std::max(row[k], ExponentOf(given.value[e]));
    }
  });
  return row;
}

// S A S, or S J C and C^-2 M^-1 with C about M^-1/2, both by powers of two; b is zero.
LcpProblem Scaled(ProblemView given, const std::vector<int>& row) {
  const std::vector<double> b(At(given.rows), 0.0);
  std::vector<double> value(given.value.begin(), given.value.end());
  std::vector<double> inverse_mass(given.inverse_mass.begin(), given.inverse_mass.end());
  std::vector<int> column = row;
  if (given.form == MatrixForm::kFactors) column.assign(inverse_mass.size(), kNone);
  for (std::size_t k = 0; k < inverse_mass.size(); ++k) {
    if (inverse_mass[k] == 0) continue;
    column[k] = ExponentOf(inverse_mass[k]) >> 1;
    inverse_mass[k] = std::ldexp(inverse_mass[k], -2 * column[k]);
  }
  ForEachGivenEntry(given, [&](std::size_t i, std::size_t j, std::size_t e) {
    constexpr double kMost = std::numeric_limits<double>::max();
    const bool moves = row[i] != kNone && column[j] != kNone;  // what does not move does not enter A
    value[e] = moves ? std::clamp(std::ldexp(value[e], row[i] + column[j]), -kMost, kMost) : 0.0;
  });
  given.value = value;
  given.inverse_mass = inverse_mass;
  given.b = b;
  return LcpProblem::FromArrays(given);
}

// The bounds of f~ = t S^-1 f, with t = 2^unit.
RowBounds ScaledBounds(RowBounds bounds, const std::vector<int>& rows, int unit) {
  const auto at = [&rows](Index row) { return rows[At(row)]; };
  for (FrictionRow& row : bounds.friction) {
    row.mu = std::min(std::ldexp(row.mu, at(row.normal) - at(row.row)), std::numeric_limits<double>::max());
  }
  for (BoundedRow& row : bounds.bounded) {
    row.lower = std::ldexp(row.lower, unit - at(row.row));
    row.upper = std::ldexp(row.upper, unit - at(row.row));
    // A finite bound beyond doubles is none.
    if (row.lower == std::numeric_limits<double>::infinity()) row.lower = std::numeric_limits<double>::max();
    if (row.upper == -std::numeric_limits<double>::infinity()) row.upper = std::numeric_limits<double>::lowest();
  }
  return bounds;
}

}  // namespace

RangeScaling::RangeScaling(const LcpProblem& problem) : row_(RowExponents(problem.view())), matrix_(problem) {
  for (int& exponent : row_) {
    if (exponent != kNone) exponent = problem.has_extreme_matrix() ? -(exponent >> 1) : 0;
  }
  if (problem.has_extreme_matrix()) matrix_ = Scaled(problem.view(), row_);
}

RangeScaling::Load RangeScaling::Scale(const LcpProblem& problem) const {
  Eigen::VectorXd b = problem.b();
  int largest = kNone;
  for (Index i = 0; i < b.size(); ++i) {
    const int row = row_[At(i)];
    if (b[i] != 0 && row != kNone) largest = std::max(largest, ExponentOf(b[i]) + row);
  }
  const int unit = largest == kNone ? 0 : -largest;
  std::vector<int> rows = row_;
  for (Index i = 0; i < b.size(); ++i) {
    int& row = rows[At(i)];
    if (row == kNone) row = b[i] == 0 ? 0 : -ExponentOf(b[i]) - unit;
    b[i] = std::ldexp(b[i], row + unit);
  }
  LcpProblem scaled = matrix_.WithB(std::move(b));
  if (!problem.is_plain()) scaled = scaled.WithBounds(ScaledBounds(problem.bounds(), rows, unit));
  return {std::move(scaled), std::move(rows), unit};
}

std::optional<Eigen::VectorXd> RangeScaling::ScaledStart(const LcpOptions& options, const Load& load) {
  if (options.initial_f == nullptr) return std::nullopt;
  Eigen::VectorXd start = *options.initial_f;
  for (Index i = 0; i < start.size(); ++i) start[i] = std::ldexp(start[i], load.unit - load.rows[At(i)]);
  if (!start.allFinite()) return std::nullopt;
  return start;
}

void RangeScaling::GiveBack(const LcpProblem& problem, const LcpOptions& options, const Load& load, LcpResult* result) {
  const auto fail = [result](const std::string& why) {
    result->status = LcpStatus::kNumericalFailure;
    result->detail = why;
    result->farkas_ray.reset();
  };
  for (Index i = 0; i < problem.size(); ++i) {
    result->f[i] = std::ldexp(result->f[i], load.rows[At(i)] - load.unit);
  }
  if (!result->f.allFinite()) {
    result->f.setZero();
    // A ray needs no forces.
    if (result->status != LcpStatus::kInfeasible) return fail("forces leave the range of doubles");
  }
  if (result->status == LcpStatus::kSolved && Verify(problem, *result, options.tolerance).false_success) {
    return fail("forces, or gaps, leave the range of doubles");
  }
  if (result->status != LcpStatus::kInfeasible || !result->farkas_ray.has_value()) return;
  // A ray has any length.
  Eigen::VectorXd& ray = *result->farkas_ray;
  int largest = kNone;
  for (Index i = 0; i < ray.size(); ++i) {
    if (ray[i] != 0) largest = std::max(largest, ExponentOf(ray[i]) + load.rows[At(i)]);
  }
  for (Index i = 0; i < ray.size() && largest != kNone; ++i) {
    ray[i] = std::ldexp(ray[i], load.rows[At(i)] - largest);
  }
  if (!VerifyFarkasRay(problem, ray).accepted) fail("the ray found proves nothing for the problem as it is given");
}

}  // namespace lcpbench
