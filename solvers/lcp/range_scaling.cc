#include "solvers/lcp/range_scaling.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "solvers/lcp/verify.h"

namespace lcpbench {
namespace {

constexpr int kNone = std::numeric_limits<int>::min();

// floor(log2 |x|); kNone for 0.
int ExponentOf(double x) { return x == 0 ? kNone : std::ilogb(x); }

// f(i, j, value) for every entry of the given form, J or A.
template <typename F>
void ForEachGivenEntry(const LcpProblem& problem, const F& f) {
  if (problem.given_form() == MatrixForm::kDense) {
    const Eigen::MatrixXd& A = problem.DenseA();
    for (Index j = 0; j < A.cols(); ++j) {
      for (Index i = 0; i < A.rows(); ++i) f(i, j, A(i, j));
    }
    return;
  }
  const SparseMatrix& given = problem.has_factors() ? problem.J() : problem.SparseA();
  for (Index i = 0; i < given.rows(); ++i) {
    for (SparseMatrix::InnerIterator it(given, i); it; ++it) f(i, it.col(), it.value());
  }
}

// About log2 of A_ii, or of what stands beside a zero there; kNone for rows of zeros.
std::vector<int> RowExponents(const LcpProblem& problem) {
  std::vector<int> row(static_cast<size_t>(problem.size()), kNone);
  const auto take = [&row](Index i, int exponent) {
    int& largest = row[static_cast<size_t>(i)];
    largest = std::max(largest, exponent);
  };
  if (problem.has_factors()) {
    ForEachGivenEntry(problem, [&](Index i, Index k, double value) {
      const double inverse_mass = problem.inverse_mass()[k];
      if (value != 0 && inverse_mass != 0) take(i, 2 * ExponentOf(value) + ExponentOf(inverse_mass));
    });
    return row;
  }
  ForEachGivenEntry(problem, [&](Index i, Index j, double value) {
    if (i == j) take(i, ExponentOf(value));
  });
  const std::vector<int> diagonal = row;
  ForEachGivenEntry(problem, [&](Index i, Index j, double value) {
    for (const Index k : {i, j}) {
      if (diagonal[static_cast<size_t>(k)] == kNone) take(k, ExponentOf(value));
    }
  });
  return row;
}

// S A S, or S J C and C^-2 M^-1 with C about M^-1/2, both by powers of two.
LcpProblem Scaled(const LcpProblem& problem, const std::vector<int>& row) {
  const Eigen::VectorXd b = Eigen::VectorXd::Zero(problem.size());
  std::vector<int> column = row;
  Eigen::VectorXd inverse_mass;
  if (problem.has_factors()) {
    inverse_mass = problem.inverse_mass();
    column.assign(static_cast<size_t>(inverse_mass.size()), kNone);
    for (Index k = 0; k < inverse_mass.size(); ++k) {
      if (inverse_mass[k] == 0) continue;
      const int half = ExponentOf(inverse_mass[k]) >> 1;
      column[static_cast<size_t>(k)] = half;
      inverse_mass[k] = std::ldexp(inverse_mass[k], -2 * half);
    }
  }
  const auto scaled = [&](Index i, Index j, double value) {
    const int of_row = row[static_cast<size_t>(i)];
    const int of_column = column[static_cast<size_t>(j)];
    if (of_row == kNone || of_column == kNone) return 0.0;  // what does not move does not enter A
    constexpr double kMost = std::numeric_limits<double>::max();
    return std::clamp(std::ldexp(value, of_row + of_column), -kMost, kMost);
  };
  if (problem.given_form() == MatrixForm::kDense) {
    Eigen::MatrixXd A = problem.DenseA();
    ForEachGivenEntry(problem, [&](Index i, Index j, double value) { A(i, j) = scaled(i, j, value); });
    return LcpProblem::FromDense(problem.id(), std::move(A), b, problem.bounds(), problem.facts());
  }
  SparseMatrix given = problem.has_factors() ? problem.J() : problem.SparseA();
  for (Index i = 0; i < given.rows(); ++i) {
    for (SparseMatrix::InnerIterator it(given, i); it; ++it) it.valueRef() = scaled(i, it.col(), it.value());
  }
  if (!problem.has_factors()) {
    return LcpProblem::FromSparse(problem.id(), given, b, problem.bounds(), problem.facts());
  }
  return LcpProblem::FromFactors(problem.id(), given, std::move(inverse_mass), b, problem.bounds(), problem.facts());
}

// Of f~ = t S^-1 f, with t = 2^unit.
RowBounds ScaledBounds(RowBounds bounds, const std::vector<int>& rows, int unit) {
  const auto at = [&rows](Index row) { return rows[static_cast<size_t>(row)]; };
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

RangeScaling::RangeScaling(const LcpProblem& problem) : row_(RowExponents(problem)), matrix_(problem) {
  for (int& exponent : row_) {
    if (exponent != kNone) exponent = problem.has_extreme_matrix() ? -(exponent >> 1) : 0;
  }
  if (problem.has_extreme_matrix()) matrix_ = Scaled(problem, row_);
}

RangeScaling::Load RangeScaling::Scale(const LcpProblem& problem) const {
  Eigen::VectorXd b = problem.b();
  int largest = kNone;
  for (Index i = 0; i < b.size(); ++i) {
    const int row = row_[static_cast<size_t>(i)];
    if (b[i] != 0 && row != kNone) largest = std::max(largest, ExponentOf(b[i]) + row);
  }
  const int unit = largest == kNone ? 0 : -largest;
  std::vector<int> rows = row_;
  for (Index i = 0; i < b.size(); ++i) {
    int& row = rows[static_cast<size_t>(i)];
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
  for (Index i = 0; i < start.size(); ++i)
    start[i] = std::ldexp(start[i], load.unit - load.rows[static_cast<size_t>(i)]);
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
    result->f[i] = std::ldexp(result->f[i], load.rows[static_cast<size_t>(i)] - load.unit);
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
    if (ray[i] != 0) largest = std::max(largest, ExponentOf(ray[i]) + load.rows[static_cast<size_t>(i)]);
  }
  for (Index i = 0; i < ray.size() && largest != kNone; ++i) {
    ray[i] = std::ldexp(ray[i], load.rows[static_cast<size_t>(i)] - largest);
  }
  if (!VerifyFarkasRay(problem, ray).accepted) fail("the ray found proves nothing for the problem as it is given");
}

}  // namespace lcpbench
