#include "solvers/small_pivoting.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "solvers/vector_register.h"

namespace lcpbench {
namespace {

using Index = Eigen::Index;

size_t At(Index i) { return static_cast<size_t>(i); }

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Violations below this part of the largest force or gap are rounding.
constexpr double kNoise = 1e-14;
// rho up to which the point needs no refinement.
constexpr double kGoodEnough = 1e-14;
// Some microseconds of them.
constexpr int kPivotsPerClockRead = 8;

// rows += factor * p with factor = row[r], for rows of `count` registers; column r is set to factor * p[r].
template <int count>
void Eliminate(double* tableau, Index n, Index r, const double* pivot_row) {
  Register p[count];
  IntegerRegister is_r[count];
  for (int v = 0; v < count; ++v) {
    p[v] = AsRegisters(pivot_row)[v];
    is_r[v] = kFirstRows + kRegister * v == r;
  }
  for (Index i = 0; i < n; ++i) {
    double* row = tableau + i * count * kRegister;
    const double factor = row[r];
    // With two registers a row the work is cheaper than a wrong guess of the branch.
    if (count > 2 && factor == 0) continue;
    for (int v = 0; v < count; ++v) {
      const Register others = is_r[v] ? Register{} : AsRegisters(row)[v];
      AsRegisters(row)[v] = others + factor * p[v];
    }
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

void SmallPivoting::Reserve(Index max_rows, Index problem_rows) {
  if (static_cast<Index>(local_.size()) < problem_rows) local_.resize(At(problem_rows), 0);
  const Index stride = (max_rows + kRegister - 1) / kRegister * kRegister;
  if (stride <= q_.size()) return;
  for (Eigen::VectorXd* v : {&matrix_, &tableau_}) v->setZero(stride * stride);
  joints_.reserve(At(stride));
  guess_.reserve(At(stride));
  for (Eigen::VectorXd* v : {&diagonal_, &b_, &q_, &scale_, &root_, &inverse_root_, &weight_, &sign_, &least_force_,
                             &force_, &w_, &pivot_row_, &correction_, &blocked_weight_}) {
    v->setZero(stride);
  }
}

// Exchanges f_r and w_r. False if rounding is all that the pivot is made of.
template <int count>
bool SmallPivoting::Pivot(Index r) {
  double* row = tableau_.data() + r * stride_;
  const double pivot = row[r];
  const double least = sign_[r] < 0 ? kLeastPivot * root_[r] * root_[r] : 0;
  if (!(pivot > least)) return false;
  ++pivots_;
  const double inverse = 1 / pivot;
  const Index registers = Registers<count>();
  const double q = -q_[r] * inverse;
  double* p = pivot_row_.data();
  const double sign = sign_[r];
  const double weight = weight_[r] == 0 ? 0.0 : sign < 0 ? root_[r] : inverse_root_[r];
  // Column r is row r but for the signs of a principal transform: skew between rows in F and others, else symmetric.
  // Entry r is set within its register: a register that is read soon after one of its doubles was written has to wait.
  IntegerRegister at = kFirstRows;
  for (Index v = 0; v < registers; ++v) {
    const IntegerRegister is_r = at == r;
    const Register t = AsRegisters(row)[v];
    const Register signs = AsRegisters(sign_.data())[v];
    const Register q_new = AsRegisters(q_.data())[v] + (sign * q) * (t * signs);
    AsRegisters(p)[v] = is_r ? Register{} + inverse : -inverse * t;
    AsRegisters(q_.data())[v] = is_r ? Register{} + q : q_new;
    AsRegisters(sign_.data())[v] = is_r ? -signs : signs;
    AsRegisters(weight_.data())[v] = is_r ? Register{} + weight : AsRegisters(weight_.data())[v];
    at += kRegister;
  }
  double* tableau = tableau_.data();
  if constexpr (count > 0) {
    Eliminate<count>(tableau, n_, r, p);
  } else {
    EliminateLong(tableau, n_, r, stride_, p);
  }
  for (Index v = 0; v < registers; ++v) AsRegisters(row)[v] = AsRegisters(p)[v];
  return true;
}

// -1 if there is none.
template <int count>
Index SmallPivoting::MostViolated() const {
  // The last bits of a double carry the row, so that one minimum finds both; a violation is not needed to 1e-13. Of
  // equal ones, which negative numbers order by larger bits, the least row wins.
  constexpr std::int64_t kRowBits = kMaxRows - 1;
  IntegerRegister row = {kRowBits,     kRowBits - 1, kRowBits - 2, kRowBits - 3,
                         kRowBits - 4, kRowBits - 5, kRowBits - 6, kRowBits - 7};
  Register least = {};
  for (Index v = 0; v < Registers<count>(); ++v) {
    Register marked = AsRegisters(q_.data())[v] * AsRegisters(weight_.data())[v];
    IntegerRegister& bits = reinterpret_cast<IntegerRegister&>(marked);
    bits = (bits & ~kRowBits) | row;
    least = marked < least ? marked : least;
    row -= kRegister;
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
  for (Index v = 0; v < stride_ / kRegister; ++v) {
    const Register f = AsRegisters(sign_.data())[v] > 0 ? AsRegisters(q_.data())[v] : Register{};
    const Register least = AsRegisters(least_force_.data())[v];
    AsRegisters(force_.data())[v] = f > least ? f : least;
  }
}

// rho of force_. Leaves w.
double SmallPivoting::Rho() {
  const Index registers = stride_ / kRegister;
  for (Index v = 0; v < registers; ++v) AsRegisters(w_.data())[v] = AsRegisters(b_.data())[v];
  for (Index v = 0; v < registers; v += 2) {
    // Two registers of w at a time, over all forces: w stays where it is computed.
    const Index second = v + 1 < registers ? v + 1 : v;
    Register w0 = {};
    Register w1 = {};
    for (Index j = 0; j < n_; ++j) {
      const double* row = matrix_.data() + j * stride_;
      const double f = force_[j];
      w0 += f * AsRegisters(row)[v];
      w1 += f * AsRegisters(row)[second];
    }
    AsRegisters(w_.data())[v] += w0;
    if (second != v) AsRegisters(w_.data())[second] += w1;
  }
  Register sum = {};
  for (Index v = 0; v < registers; ++v) {
    const Register gap = AsRegisters(w_.data())[v] * AsRegisters(inverse_root_.data())[v];
    const Register force =
        (AsRegisters(force_.data())[v] - AsRegisters(least_force_.data())[v]) * AsRegisters(root_.data())[v];
    const Register residual = gap < force ? gap : force;
    sum += residual * residual;
  }
  return std::sqrt(Sum(&sum)) / b_norm_;
}

// f_F -= A_FF^-1 w_F.
void SmallPivoting::Refine() {
  const Index registers = stride_ / kRegister;
  for (Index v = 0; v < registers; ++v)
    AsRegisters(w_.data())[v] = AsRegisters(sign_.data())[v] > 0 ? AsRegisters(w_.data())[v] : Register{};
  for (Index i = 0; i < n_; ++i) {
    const double* row = tableau_.data() + i * stride_;
    Register sum = {};
    for (Index v = 0; v < registers; ++v) sum += AsRegisters(row)[v] * AsRegisters(w_.data())[v];
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

SmallPivoting::Answer SmallPivoting::Solve(const LcpProblem& problem, const Request& request, Eigen::VectorXd* f) {
  pivots_ = 0;
  if (!LoadDense(problem)) return {kInfinity, kInfinity, false};
  guess_.clear();
  if (request.initial_f != nullptr) {
    for (Index i = 0; i < n_; ++i) {
      if (IsGuessed(i, (*request.initial_f)[i])) guess_.push_back(i);
    }
  }
  const Answer answer = Finish(request);
  for (Index i = 0; i < n_; ++i) (*f)[i] = GivenForce(i);
  return answer;
}

SmallPivoting::Answer SmallPivoting::SolvePart(const LcpProblem& problem, std::span<const Index> rows,
                                               const Request& request, Eigen::VectorXd* f) {
  pivots_ = 0;
  if (!LoadPart(problem, rows)) return {kInfinity, kInfinity, false};
  guess_.clear();
  if (request.initial_f != nullptr) {
    for (Index i = 0; i < n_; ++i) {
      if (IsGuessed(i, (*request.initial_f)[rows[At(i)]])) guess_.push_back(i);
    }
  }
  const Answer answer = Finish(request);
  for (Index i = 0; i < n_; ++i) (*f)[rows[At(i)]] = GivenForce(i);
  return answer;
}

SmallPivoting::Answer SmallPivoting::Finish(const Request& request) {
  if (!request.self_check) {
    if (n_ <= 2 && SolveInClosedForm()) return {0, 0, true};
    const bool found = FindActiveSet(request.deadline);
    FindForces();
    return {found ? 0 : kInfinity, 0, found};
  }
  Answer answer{Run(request.deadline), kInfinity, false};
  if (answer.rho == kInfinity) return answer;
  double size = 0;
  for (Index i = 0; i < n_; ++i) size += std::abs(force_[i]) * root_[i];
  const auto rows = static_cast<double>(n_);
  answer.rounding = 2 * (rows + 8) * std::numeric_limits<double>::epsilon() * std::sqrt(rows) * size / b_norm_;
  answer.rows_meet = RowsMeet(request.row_limit);
  if (answer.rows_meet) return answer;
  // Where all forces around a row should be 0, its backward error is rounding over rounding.
  double largest = 0;
  for (Index i = 0; i < n_; ++i) largest = std::max(largest, std::abs(force_[i]) * root_[i]);
  for (Index i = 0; i < n_; ++i) {
    if (std::abs(force_[i]) * root_[i] <= kNoise * largest) force_[i] = 0;
  }
  answer.rho = Rho();
  answer.rows_meet = RowsMeet(request.row_limit);
  return answer;
}

// False if the limit of pivots or the deadline came first.
template <int count>
bool SmallPivoting::DrivePivots(const Deadline* deadline) {
  noise_ = kNoise;
  for (const Index r : joints_) Pivot<count>(r);
  for (const Index r : guess_) {
    if (sign_[r] < 0) Pivot<count>(r);
  }
  const int greedy = static_cast<int>(2 * n_);
  const int limit = static_cast<int>(6 * n_) + 20;
  for (bool any_blocked = false;;) {
    const Index r = pivots_ > greedy ? FirstViolated() : MostViolated<count>();
    if (r < 0) return true;
    const bool is_late =
        deadline != nullptr && n_ > kRowsWithoutClock && pivots_ % kPivotsPerClockRead == 0 && deadline->Expired();
    if (pivots_ >= limit || is_late) return false;
    if (!Pivot<count>(r)) {
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
}

bool SmallPivoting::FindActiveSet(const Deadline* deadline) {
  switch (stride_ / kRegister) {
    case 1:
      return DrivePivots<1>(deadline);
    case 2:
      return DrivePivots<2>(deadline);
    case 3:
      return DrivePivots<3>(deadline);
    case 4:
      return DrivePivots<4>(deadline);
    case 5:
      return DrivePivots<5>(deadline);
    case 6:
      return DrivePivots<6>(deadline);
    case 7:
      return DrivePivots<7>(deadline);
    case 8:
      return DrivePivots<8>(deadline);
    default:
      return DrivePivots<0>(deadline);
  }
}

double SmallPivoting::Run(const Deadline* deadline) {
  if (n_ <= 2 && SolveInClosedForm()) {
    const double rho = Rho();
    if (rho <= kGoodEnough) return rho;
  }
  if (!guess_.empty()) {
    const double rho = TryGuess();
    if (rho <= kRightRho) return rho;
    std::copy(b_.data(), b_.data() + stride_, q_.data());
    std::copy(matrix_.data(), matrix_.data() + n_ * stride_, tableau_.data());
  }
  if (!FindActiveSet(deadline)) {
    FindForces();
    return kInfinity;
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
  return rho;
}

}  // namespace lcpbench
