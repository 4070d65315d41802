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

// S^-1 of the largest entries of S J C, with C = M^-1/2 by powers of two.
LcpProblem ScaleFactors(const LcpProblem& problem, std::vector<int>* row) {
  SparseMatrix J = problem.J();
  Eigen::VectorXd inverse_mass = problem.inverse_mass();
  std::vector<int> column(static_cast<size_t>(J.cols()), 0);
  for (Index k = 0; k < J.cols(); ++k) {
    if (inverse_mass[k] == 0) continue;
    const int half = ExponentOf(inverse_mass[k]) >> 1;
    column[static_cast<size_t>(k)] = half;
    inverse_mass[k] = std::ldexp(inverse_mass[k], -2 * half);
  }
  for (Index i = 0; i < J.rows(); ++i) {
    int largest = kNone;
    for (SparseMatrix::InnerIterator it(J, i); it; ++it) {
      if (it.value() == 0 || inverse_mass[it.col()] == 0) continue;
      largest = std::max(largest, ExponentOf(it.value()) + column[static_cast<size_t>(it.col())]);
    }
    if (largest != kNone) (*row)[static_cast<size_t>(i)] = -largest;
    for (SparseMatrix::InnerIterator it(J, i); it; ++it) {
      const int exponent = (*row)[static_cast<size_t>(i)] + column[static_cast<size_t>(it.col())];
      // What does not move does not enter A.
      it.valueRef() = inverse_mass[it.col()] == 0 ? 0.0 : std::ldexp(it.value(), exponent);
    }
  }
  return LcpProblem::FromFactors(problem.id(), std::move(J), std::move(inverse_mass),
                                 Eigen::VectorXd::Zero(problem.size()), problem.bounds(), problem.facts());
}

LcpProblem ScaleRows(const LcpProblem& problem, std::vector<int>* row) {
  const Eigen::VectorXd& diagonal = problem.DiagonalA();
  for (Index i = 0; i < problem.size(); ++i) {
    if (diagonal[i] != 0) (*row)[static_cast<size_t>(i)] = -(ExponentOf(diagonal[i]) >> 1);
  }
  const auto scaled = [row](double value, Index i, Index j) {
    const double result = std::ldexp(value, (*row)[static_cast<size_t>(i)] + (*row)[static_cast<size_t>(j)]);
    return std::clamp(result, -std::numeric_limits<double>::max(), std::numeric_limits<double>::max());
  };
  const Eigen::VectorXd b = Eigen::VectorXd::Zero(problem.size());
  if (problem.given_form() == MatrixForm::kDense) {
    Eigen::MatrixXd A = problem.DenseA();
    for (Index j = 0; j < A.cols(); ++j) {
      for (Index i = 0; i < A.rows(); ++i) A(i, j) = scaled(A(i, j), i, j);
    }
    return LcpProblem::FromDense(problem.id(), std::move(A), b, problem.bounds(), problem.facts());
  }
  SparseMatrix A = problem.SparseA();
  for (Index i = 0; i < A.rows(); ++i) {
    for (SparseMatrix::InnerIterator it(A, i); it; ++it) it.valueRef() = scaled(it.value(), i, it.col());
  }
  return LcpProblem::FromSparse(problem.id(), std::move(A), b, problem.bounds(), problem.facts());
}

}  // namespace

RangeScaling::RangeScaling(const LcpProblem& problem)
    : row_(static_cast<size_t>(problem.size()), 0),
      matrix_(!problem.has_extreme_matrix() ? problem
              : problem.has_factors()       ? ScaleFactors(problem, &row_)
                                            : ScaleRows(problem, &row_)) {}

RangeScaling::Load RangeScaling::Scale(const LcpProblem& problem) const {
  Eigen::VectorXd b = problem.b();
  int largest = kNone;
  for (Index i = 0; i < b.size(); ++i) {
    if (b[i] != 0) largest = std::max(largest, ExponentOf(b[i]) + row_[static_cast<size_t>(i)]);
  }
  const int unit = largest == kNone ? 0 : -largest;
  for (Index i = 0; i < b.size(); ++i) b[i] = std::ldexp(b[i], row_[static_cast<size_t>(i)] + unit);
  return {matrix_.WithB(std::move(b)), unit};
}

std::optional<Eigen::VectorXd> RangeScaling::ScaledStart(const LcpOptions& options, const Load& load) const {
  if (options.initial_f == nullptr) return std::nullopt;
  Eigen::VectorXd start = *options.initial_f;
  for (Index i = 0; i < start.size(); ++i) start[i] = std::ldexp(start[i], load.unit - row_[static_cast<size_t>(i)]);
  if (!start.allFinite()) return std::nullopt;
  return start;
}

void RangeScaling::GiveBack(const LcpProblem& problem, const LcpOptions& options, const Load& load,
                            LcpResult* result) const {
  const auto fail = [result](const std::string& why) {
    result->status = LcpStatus::kNumericalFailure;
    result->detail = why;
    result->farkas_ray.reset();
  };
  for (Index i = 0; i < problem.size(); ++i) {
    result->f[i] = std::ldexp(result->f[i], row_[static_cast<size_t>(i)] - load.unit);
  }
  if (!result->f.allFinite()) {
    result->f.setZero();
    // A ray needs no forces.
    if (result->status != LcpStatus::kInfeasible) return fail("forces leave the range of doubles");
  }
  if (result->status == LcpStatus::kSolved && !Verify(problem, *result, options.tolerance).passes) {
    return fail("forces, or gaps, leave the range of doubles");
  }
  if (result->status != LcpStatus::kInfeasible || !result->farkas_ray.has_value()) return;
  // A ray has any length.
  Eigen::VectorXd& ray = *result->farkas_ray;
  int largest = kNone;
  for (Index i = 0; i < ray.size(); ++i) {
    if (ray[i] != 0) largest = std::max(largest, ExponentOf(ray[i]) + row_[static_cast<size_t>(i)]);
  }
  for (Index i = 0; i < ray.size() && largest != kNone; ++i) {
    ray[i] = std::ldexp(ray[i], row_[static_cast<size_t>(i)] - largest);
  }
  if (!VerifyFarkasRay(problem, ray).accepted) fail("the ray leaves the range of doubles");
}

}  // namespace lcpbench
