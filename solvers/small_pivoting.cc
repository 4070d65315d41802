#include "solvers/small_pivoting.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

#include "solvers/power_of_two.h"

namespace lcpbench {
namespace {

using Index = Eigen::Index;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// A pivot below this part of the row's diagonal entry (or of the inverse's scale) is rounding: the row depends on F.
constexpr double kLeastPivot = 1e-11;
// Violations below this part of the largest force or gap are rounding.
constexpr double kNoise = 1e-14;
// rho up to which the point needs no refinement.
constexpr double kGoodEnough = 1e-14;

// Eight doubles: one register or several, whatever the machine has. Loads need no alignment.
constexpr Index kLanes = 8;
using Lanes [[gnu::vector_size(kLanes * sizeof(double)), gnu::aligned(alignof(double)), gnu::may_alias]] = double;

using Integers [[gnu::vector_size(kLanes * sizeof(double)), gnu::may_alias]] = std::int64_t;

constexpr Integers kFirstRows = {0, 1, 2, 3, 4, 5, 6, 7};

const Lanes* AsLanes(const double* x) { return reinterpret_cast<const Lanes*>(x); }
Lanes* AsLanes(double* x) { return reinterpret_cast<Lanes*>(x); }

// By pointer, since passing registers that a machine may lack has no fixed convention.
double Sum(const Lanes* x) {
  const double* v = reinterpret_cast<const double*>(x);
  return ((v[0] + v[4]) + (v[2] + v[6])) + ((v[1] + v[5]) + (v[3] + v[7]));
}

double Least(const Lanes* x) {
  const double* v = reinterpret_cast<const double*>(x);
  const double a = std::min(std::min(v[0], v[4]), std::min(v[2], v[6]));
  const double b = std::min(std::min(v[1], v[5]), std::min(v[3], v[7]));
  return std::min(a, b);
}

// rows += factor * p with factor = row[r], for rows of `count` registers; column r is set to factor * p[r].
template <int count>
void Eliminate(double* tableau, Index n, Index r, const double* pivot_row) {
  Lanes p[count];
  for (int v = 0; v < count; ++v) p[v] = AsLanes(pivot_row)[v];
  const double inverse = pivot_row[r];
  for (Index i = 0; i < n; ++i) {
    double* row = tableau + i * count * kLanes;
    const double factor = row[r];
    // With two registers a row the work is cheaper than a wrong guess of the branch.
    if (count > 2 && factor == 0) continue;
    for (int v = 0; v < count; ++v) AsLanes(row)[v] += factor * p[v];
    row[r] = factor * inverse;
  }
}

void EliminateLong(double* tableau, Index n, Index r, Index stride, const double* pivot_row) {
  for (Index i = 0; i < n; ++i) {
    double* __restrict row = tableau + i * stride;
    const double factor = row[r];
    if (factor == 0) continue;
    for (Index j = 0; j < stride; ++j) row[j] += factor * pivot_row[j];
    row[r] = factor * pivot_row[r];
  }
}

}  // namespace

void SmallPivoting::Reserve(Index max_rows) {
  const Index stride = (max_rows + kLanes - 1) / kLanes * kLanes;
  if (stride <= q_.size()) return;
  for (Eigen::VectorXd* v : {&matrix_, &tableau_}) v->setZero(stride * stride);
  for (Eigen::VectorXd* v : {&b_, &q_, &scale_, &root_, &inverse_root_, &weight_, &sign_, &least_force_, &force_, &w_,
                             &pivot_row_, &correction_, &blocked_weight_}) {
    v->setZero(stride);
  }
}

bool SmallPivoting::Load(const LcpProblem& problem) {
  n_ = problem.size();
  stride_ = (n_ + kLanes - 1) / kLanes * kLanes;
  const double* d = problem.DiagonalA().data();
  for (Index i = 0; i < n_; ++i) scale_[i] = ScaleOfDiagonal(d[i]);
  const auto scale = scale_.head(n_).array();
  if (!(problem.DiagonalA().minCoeff() > 0)) return false;
  root_.head(n_) = (problem.DiagonalA().array() * scale * scale).sqrt();
  inverse_root_.head(n_) = root_.head(n_).array().inverse();
  b_.head(n_) = problem.b().array() * scale;
  for (Index i = n_; i < stride_; ++i) scale_[i] = root_[i] = inverse_root_[i] = b_[i] = 0;
  Lanes largest = {};
  Lanes squared = {};
  const Index registers = stride_ / kLanes;
  for (Index v = 0; v < registers; ++v) {
    const Lanes b = AsLanes(b_.data())[v];
    const Lanes size = b < 0 ? -b : b;
    largest = size > largest ? size : largest;
    const Lanes relative = b * AsLanes(inverse_root_.data())[v];
    squared += relative * relative;
  }
  largest = -largest;
  b_scale_ = ScaleOfLargest(-Least(&largest));
  const double norm = Sum(&squared);
  b_norm_ = norm == 0 ? 1.0 : std::sqrt(norm) * b_scale_;
  for (Index v = 0; v < registers; ++v) {
    AsLanes(b_.data())[v] *= b_scale_;
    AsLanes(q_.data())[v] = AsLanes(b_.data())[v];
    AsLanes(weight_.data())[v] = AsLanes(inverse_root_.data())[v];
    AsLanes(sign_.data())[v] = Lanes{} - 1.0;
    AsLanes(least_force_.data())[v] = Lanes{};
    AsLanes(blocked_weight_.data())[v] = Lanes{};
  }
  for (const Index i : problem.bilateral_rows()) {
    weight_[i] = 0;
    least_force_[i] = -kInfinity;
  }
  // A is symmetric, so its columns serve as rows. What a register reads beyond a row's end is multiplied by 0; beyond
  // the last row there is nothing to read.
  const Eigen::MatrixXd& A = problem.DenseA();
  for (Index i = 0; i < n_; ++i) {
    const double* from = A.data() + i * n_;
    const double s = scale_[i];
    double* to = matrix_.data() + i * stride_;
    double* to_tableau = tableau_.data() + i * stride_;
    if (i * n_ + stride_ <= n_ * n_) {
      for (Index v = 0; v < registers; ++v) {
        const Lanes row = AsLanes(from)[v] * s * AsLanes(scale_.data())[v];
        AsLanes(to)[v] = row;
        AsLanes(to_tableau)[v] = row;
      }
    } else {
      for (Index j = 0; j < n_; ++j) to[j] = to_tableau[j] = from[j] * s * scale_[j];
      for (Index j = n_; j < stride_; ++j) to[j] = to_tableau[j] = 0;
    }
  }
  return true;
}

// Exchanges f_r and w_r. False if rounding is all that the pivot is made of.
bool SmallPivoting::Pivot(Index r) {
  double* row = tableau_.data() + r * stride_;
  const double pivot = row[r];
  const double least = sign_[r] < 0 ? kLeastPivot * root_[r] * root_[r] : 0;
  if (!(pivot > least)) return false;
  ++pivots_;
  const double inverse = 1 / pivot;
  const Index registers = stride_ / kLanes;
  const double q = -q_[r] * inverse;
  double* p = pivot_row_.data();
  const double sign = sign_[r];
  const double weight = weight_[r] == 0 ? 0.0 : sign < 0 ? root_[r] : inverse_root_[r];
  // Column r is row r but for the signs of a principal transform: skew between rows in F and others, else symmetric.
  // Entry r is set within its register: a register that is read soon after one of its doubles was written has to wait.
  Integers at = kFirstRows;
  for (Index v = 0; v < registers; ++v) {
    const Integers is_r = at == r;
    const Lanes t = AsLanes(row)[v];
    const Lanes signs = AsLanes(sign_.data())[v];
    const Lanes q_new = AsLanes(q_.data())[v] + (sign * q) * (t * signs);
    AsLanes(p)[v] = is_r ? Lanes{} + inverse : -inverse * t;
    AsLanes(q_.data())[v] = is_r ? Lanes{} + q : q_new;
    AsLanes(sign_.data())[v] = is_r ? -signs : signs;
    AsLanes(weight_.data())[v] = is_r ? Lanes{} + weight : AsLanes(weight_.data())[v];
    at += kLanes;
  }
  double* tableau = tableau_.data();
  switch (registers) {
    case 1:
      Eliminate<1>(tableau, n_, r, p);
      break;
    case 2:
      Eliminate<2>(tableau, n_, r, p);
      break;
    case 3:
      Eliminate<3>(tableau, n_, r, p);
      break;
    case 4:
      Eliminate<4>(tableau, n_, r, p);
      break;
    case 5:
      Eliminate<5>(tableau, n_, r, p);
      break;
    case 6:
      Eliminate<6>(tableau, n_, r, p);
      break;
    default:
      EliminateLong(tableau, n_, r, stride_, p);
  }
  for (Index v = 0; v < registers; ++v) AsLanes(row)[v] = AsLanes(p)[v];
  return true;
}

// -1 if there is none.
Index SmallPivoting::MostViolated() const {
  // The last bits of a double carry the row, so that one minimum finds both; a violation is not needed to 1e-13. Of
  // equal ones, which negative numbers order by larger bits, the least row wins.
  constexpr std::int64_t kRowBits = kMaxRows - 1;
  Integers row = {kRowBits,     kRowBits - 1, kRowBits - 2, kRowBits - 3,
                  kRowBits - 4, kRowBits - 5, kRowBits - 6, kRowBits - 7};
  Lanes least = {};
  for (Index v = 0; v < stride_ / kLanes; ++v) {
    Lanes marked = AsLanes(q_.data())[v] * AsLanes(weight_.data())[v];
    Integers& bits = reinterpret_cast<Integers&>(marked);
    bits = (bits & ~kRowBits) | row;
    least = marked < least ? marked : least;
    row -= kLanes;
  }
  const double worst = Least(&least);
  if (!(worst < -noise_)) return -1;
  return kRowBits - static_cast<Index>(std::bit_cast<std::int64_t>(worst) & kRowBits);
}

Index SmallPivoting::FirstViolated() const {
  for (Index i = 0; i < n_; ++i) {
    if (violated(i)) return i;
  }
  return -1;
}

void SmallPivoting::FindForces() {
  for (Index v = 0; v < stride_ / kLanes; ++v) {
    const Lanes f = AsLanes(sign_.data())[v] > 0 ? AsLanes(q_.data())[v] : Lanes{};
    const Lanes least = AsLanes(least_force_.data())[v];
    AsLanes(force_.data())[v] = f > least ? f : least;
  }
}

// rho of force_. Leaves w.
double SmallPivoting::Rho() {
  const Index registers = stride_ / kLanes;
  for (Index v = 0; v < registers; ++v) AsLanes(w_.data())[v] = AsLanes(b_.data())[v];
  for (Index v = 0; v < registers; v += 2) {
    // Two registers of w at a time, over all forces: w stays where it is computed.
    const Index second = v + 1 < registers ? v + 1 : v;
    Lanes w0 = {};
    Lanes w1 = {};
    for (Index j = 0; j < n_; ++j) {
      const double* row = matrix_.data() + j * stride_;
      const double f = force_[j];
      w0 += f * AsLanes(row)[v];
      w1 += f * AsLanes(row)[second];
    }
    AsLanes(w_.data())[v] += w0;
    if (second != v) AsLanes(w_.data())[second] += w1;
  }
  Lanes sum = {};
  for (Index v = 0; v < registers; ++v) {
    const Lanes gap = AsLanes(w_.data())[v] * AsLanes(inverse_root_.data())[v];
    const Lanes force = (AsLanes(force_.data())[v] - AsLanes(least_force_.data())[v]) * AsLanes(root_.data())[v];
    const Lanes residual = gap < force ? gap : force;
    sum += residual * residual;
  }
  return std::sqrt(Sum(&sum)) / b_norm_;
}

// f_F -= A_FF^-1 w_F.
void SmallPivoting::Refine() {
  const Index registers = stride_ / kLanes;
  for (Index v = 0; v < registers; ++v)
    AsLanes(w_.data())[v] = AsLanes(sign_.data())[v] > 0 ? AsLanes(w_.data())[v] : Lanes{};
  for (Index i = 0; i < n_; ++i) {
    const double* row = tableau_.data() + i * stride_;
    Lanes sum = {};
    for (Index v = 0; v < registers; ++v) sum += AsLanes(row)[v] * AsLanes(w_.data())[v];
    correction_[i] = sign_[i] > 0 ? Sum(&sum) : 0;
  }
  for (Index i = 0; i < n_; ++i) q_[i] -= correction_[i];
}

bool SmallPivoting::RowsMeet(double limit) const {
  for (Index i = 0; i < n_; ++i) {
    const double* row = matrix_.data() + i * stride_;
    const double force = row[i] * force_[i];
    const double defect = std::abs(least_force_[i] < 0 ? w_[i] : std::min(w_[i], force));
    // (|A| |f|)_i is at least both |A f|_i and A_ii f_i: most rows pass by that alone.
    if (defect <= limit * (std::max(std::abs(w_[i] - b_[i]), std::abs(force)) + std::abs(b_[i]))) continue;
    double size = std::abs(b_[i]);
    for (Index j = 0; j < n_; ++j) size += std::abs(row[j] * force_[j]);
    if (!(defect <= limit * size)) return false;
  }
  return true;
}

double SmallPivoting::Solve(const LcpProblem& problem, Eigen::VectorXd* f) {
  pivots_ = 0;
  if (!Load(problem)) return kInfinity;
  noise_ = kNoise;
  for (const Index r : problem.bilateral_rows()) Pivot(r);
  const int greedy = static_cast<int>(2 * n_);
  const int limit = static_cast<int>(6 * n_) + 20;
  for (bool any_blocked = false;;) {
    const Index r = pivots_ > greedy ? FirstViolated() : MostViolated();
    if (r < 0) break;
    if (pivots_ >= limit) return kInfinity;
    if (!Pivot(r)) {
      std::swap(weight_[r], blocked_weight_[r]);
      any_blocked = true;
      continue;
    }
    if (any_blocked) {  // F has changed, and what depends on it
      for (Index i = 0; i < n_; ++i) weight_[i] += blocked_weight_[i];
      blocked_weight_.setZero();
      any_blocked = false;
    }
    noise_ = std::max(noise_, kNoise * std::abs(q_[r]));
  }
  FindForces();
  double rho = Rho();
  if (rho > kGoodEnough) {
    const double before = rho;
    Refine();
    FindForces();
    rho = Rho();
    if (!(rho <= before)) {
      // Refinement in the same precision may lose the last digit.
      for (Index i = 0; i < n_; ++i) q_[i] += correction_[i];
      FindForces();
      rho = Rho();
    }
  }
  for (Index i = 0; i < n_; ++i) (*f)[i] = force_[i] * (scale_[i] / b_scale_);
  return rho;
}

}  // namespace lcpbench
