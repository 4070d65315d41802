#include "solvers/small_pivoting.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "solvers/power_of_two.h"

namespace lcpbench {
namespace {

using Index = Eigen::Index;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Doubles per vector register, so that rows are whole registers.
constexpr Index kLanes = 8;
// A pivot below this part of the row's diagonal entry (or of the inverse's scale) is rounding: the row depends on F.
constexpr double kLeastPivot = 1e-11;
// Violations below this part of the largest force or gap are rounding.
constexpr double kNoise = 1e-14;
// rho up to which the point needs no refinement.
constexpr double kGoodEnough = 1e-14;

size_t At(Index i) { return static_cast<size_t>(i); }

}  // namespace

void SmallPivoting::Reserve(Index max_rows) {
  if (max_rows <= static_cast<Index>(active_.size())) return;
  const Index stride = (max_rows + kLanes - 1) / kLanes * kLanes;
  tableau_.assign(At(max_rows * stride), 0);
  for (Eigen::VectorXd* v : {&q_, &scale_, &root_, &w_, &pivot_row_, &correction_}) v->setZero(stride);
  for (std::vector<char>* v : {&active_, &joint_, &blocked_}) v->assign(At(max_rows), 0);
}

bool SmallPivoting::Load(const LcpProblem& problem) {
  const Eigen::MatrixXd& A = problem.DenseA();
  const double* b = problem.b().data();
  n_ = problem.size();
  stride_ = (n_ + kLanes - 1) / kLanes * kLanes;
  double largest = 0;
  double norm = 0;
  for (Index i = 0; i < n_; ++i) {
    const double d = A(i, i);
    if (!(d > 0)) return false;
    const double s = ScaleOfDiagonal(d);
    scale_[i] = s;
    root_[i] = std::sqrt(d * s * s);
    q_[i] = b[i] * s;
    largest = std::max(largest, std::abs(q_[i]));
    norm += (q_[i] / root_[i]) * (q_[i] / root_[i]);
    active_[At(i)] = joint_[At(i)] = blocked_[At(i)] = 0;
  }
  for (const Index i : problem.bilateral_rows()) joint_[At(i)] = 1;
  b_scale_ = ScaleOfLargest(largest);
  b_norm_ = norm == 0 ? 1.0 : std::sqrt(norm) * b_scale_;
  for (Index i = 0; i < n_; ++i) {
    q_[i] *= b_scale_;
    const double* __restrict from = A.data() + i * n_;  // A is symmetric
    double* __restrict to = tableau_.data() + i * stride_;
    const double* __restrict scale = scale_.data();
    const double s = scale_[i];
    for (Index j = 0; j < n_; ++j) to[j] = from[j] * s * scale[j];
    for (Index j = n_; j < stride_; ++j) to[j] = 0;
  }
  return true;
}

// Exchanges f_r and w_r. False if rounding is all that the pivot is made of.
bool SmallPivoting::Pivot(Index r) {
  double* __restrict row = tableau_.data() + r * stride_;
  const double pivot = row[r];
  const double least = active_[At(r)] == 0 ? kLeastPivot * root_[r] * root_[r] : 0;
  if (!(pivot > least)) return false;
  ++pivots_;
  const double inverse = 1 / pivot;
  double* __restrict p = pivot_row_.data();
  for (Index j = 0; j < stride_; ++j) p[j] = -row[j] * inverse;
  p[r] = inverse;
  const double q = -q_[r] * inverse;
  for (Index i = 0; i < n_; ++i) {
    double* __restrict t = tableau_.data() + i * stride_;
    const double factor = t[r];
    if (factor == 0 || i == r) continue;
    t[r] = 0;
    for (Index j = 0; j < stride_; ++j) t[j] += factor * p[j];
    q_[i] += factor * q;
  }
  std::copy(p, p + stride_, row);
  q_[r] = q;
  active_[At(r)] ^= 1;
  return true;
}

Index SmallPivoting::MostViolated(bool least_index) const {
  Index worst = -1;
  double value = 0;
  for (Index i = 0; i < n_; ++i) {
    const double scaled = active_[At(i)] != 0 ? q_[i] * root_[i] : q_[i] / root_[i];
    if (scaled >= value || joint_[At(i)] != 0 || blocked_[At(i)] != 0) continue;
    if (scaled >= -kNoise * largest_force_) continue;
    worst = i;
    if (least_index) break;
    value = scaled;
  }
  return worst;
}

void SmallPivoting::WriteForces(Eigen::VectorXd* f) const {
  for (Index i = 0; i < n_; ++i) {
    const double force = active_[At(i)] != 0 ? q_[i] * (scale_[i] / b_scale_) : 0.0;
    (*f)[i] = joint_[At(i)] != 0 ? force : std::max(force, 0.0);
  }
}

// Also leaves w in the tableau's units.
double SmallPivoting::Rho(const LcpProblem& problem, const Eigen::VectorXd& f) {
  const Eigen::MatrixXd& A = problem.DenseA();
  double* __restrict w = w_.data();
  std::copy(problem.b().data(), problem.b().data() + n_, w);
  for (Index j = 0; j < n_; ++j) {
    const double force = f[j];
    if (force == 0) continue;
    const double* __restrict a = A.data() + j * n_;
    for (Index i = 0; i < n_; ++i) w[i] += a[i] * force;
  }
  double sum = 0;
  for (Index i = 0; i < n_; ++i) {
    w[i] *= scale_[i] * b_scale_;
    const double gap = w[i] / root_[i];
    const double force = f[i] * (b_scale_ / scale_[i]) * root_[i];
    const double residual = joint_[At(i)] != 0 ? gap : std::min(gap, force);
    sum += residual * residual;
  }
  return std::sqrt(sum) / b_norm_;
}

// f_F -= A_FF^-1 w_F.
void SmallPivoting::Refine() {
  for (Index i = 0; i < n_; ++i) {
    double sum = 0;
    if (active_[At(i)] != 0) {
      const double* t = tableau_.data() + i * stride_;
      for (Index j = 0; j < n_; ++j) sum += active_[At(j)] != 0 ? t[j] * w_[j] : 0;
    }
    correction_[i] = sum;
  }
  for (Index i = 0; i < n_; ++i) q_[i] -= correction_[i];
}

bool SmallPivoting::RowsMeet(const LcpProblem& problem, const Eigen::VectorXd& f, double limit) const {
  const Eigen::MatrixXd& A = problem.DenseA();
  for (Index i = 0; i < n_; ++i) {
    const double w = w_[i] / (scale_[i] * b_scale_);
    const double force = A(i, i) * f[i];
    const double defect = std::abs(joint_[At(i)] != 0 ? w : std::min(w, force));
    const double b = problem.b()[i];
    // (|A| |f|)_i is at least both |A f|_i and A_ii f_i: most rows pass by that alone.
    if (defect <= limit * (std::max(std::abs(w - b), std::abs(force)) + std::abs(b))) continue;
    if (!(defect <= limit * (A.col(i).cwiseAbs().dot(f.cwiseAbs()) + std::abs(b)))) return false;
  }
  return true;
}

double SmallPivoting::Solve(const LcpProblem& problem, Eigen::VectorXd* f) {
  pivots_ = 0;
  if (!Load(problem)) return kInfinity;
  largest_force_ = 1;
  for (const Index r : problem.bilateral_rows()) Pivot(r);
  const int greedy = static_cast<int>(2 * n_);
  const int limit = static_cast<int>(6 * n_) + 20;
  for (bool any_blocked = false;;) {
    const Index r = MostViolated(pivots_ > greedy);
    if (r < 0) break;
    if (pivots_ >= limit) return kInfinity;
    if (!Pivot(r)) {
      blocked_[At(r)] = 1;
      any_blocked = true;
      continue;
    }
    if (any_blocked) std::fill(blocked_.begin(), blocked_.end(), 0);  // F has changed, and what depends on it
    any_blocked = false;
    largest_force_ = std::max(largest_force_, std::abs(q_[r]));
  }
  WriteForces(f);
  double rho = Rho(problem, *f);
  if (rho > kGoodEnough) {
    const double before = rho;
    Refine();
    WriteForces(f);
    rho = Rho(problem, *f);
    if (!(rho <= before)) {
      // Refinement in the same precision may lose the last digit.
      for (Index i = 0; i < n_; ++i) q_[i] += correction_[i];
      WriteForces(f);
      rho = Rho(problem, *f);
    }
  }
  return rho;
}

}  // namespace lcpbench
