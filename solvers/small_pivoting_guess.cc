#include "solvers/small_pivoting.h"
#include "solvers/vector_register.h"

namespace lcpbench {
namespace {

using Index = Eigen::Index;

// Active sets that are tried before the tableau: the guess, and what its violated rows make of it.
constexpr int kMaxGuesses = 2;

}  // namespace

// force_ for one or two rows: the first active set, of none, one or both rows, whose forces and gaps have their signs.
// False if rounding leaves none.
bool SmallPivoting::SolveInClosedForm() {
  for (Index v = 0; v < stride_ / kRegister; ++v) AsRegisters(force_.data())[v] = Register{};
  const double* A = matrix_.data();
  const auto may_rest = [&](Index i, double gap) { return least_force_[i] == 0 && gap >= 0; };
  const auto may_push = [&](Index i, double force) { return force >= least_force_[i]; };
  const double f0 = -b_[0] / A[0];
  if (n_ == 1) {
    force_[0] = may_rest(0, b_[0]) ? 0.0 : f0;
    return true;
  }
  const double a11 = A[stride_ + 1];
  const double f1 = -b_[1] / a11;
  if (may_rest(0, b_[0]) && may_rest(1, b_[1])) return true;
  if (may_push(0, f0) && may_rest(1, b_[1] + A[1] * f0)) {
    force_[0] = f0;
    return true;
  }
  if (may_push(1, f1) && may_rest(0, b_[0] + A[1] * f1)) {
    force_[1] = f1;
    return true;
  }
  const double determinant = A[0] * a11 - A[1] * A[1];
  if (!(determinant > kLeastPivot * A[0] * a11)) return false;
  force_[0] = (A[1] * b_[1] - a11 * b_[0]) / determinant;
  force_[1] = (A[1] * b_[0] - A[0] * b_[1]) / determinant;
  return may_push(0, force_[0]) && may_push(1, force_[1]);
}

// force_ := -A_FF^-1 b_F by L D L^T, the tableau serving as workspace. Rows that depend on others leave F.
void SmallPivoting::SolveGuess() {
  const Index registers = stride_ / kRegister;
  double* tableau = tableau_.data();
  Register* y = AsRegisters(q_.data());
  for (Index v = 0; v < registers; ++v) {
    y[v] = -AsRegisters(b_.data())[v];
    AsRegisters(force_.data())[v] = Register{};
  }
  for (const Index i : guess_) {
    for (Index v = 0; v < registers; ++v) {
      AsRegisters(tableau + i * stride_)[v] = AsRegisters(matrix_.data() + i * stride_)[v];
    }
  }
  // Forward. Row i > r ends up with L_ir left of its diagonal and D_i L_ji from there on; what the whole-register steps
  // do to y left of r is never read again.
  size_t kept = 0;
  for (size_t k = 0; k < guess_.size(); ++k) {
    const Index r = guess_[k];
    const double* row = tableau + r * stride_;
    const double pivot = row[r];
    if (!(pivot > kLeastPivot * root_[r] * root_[r])) continue;
    guess_[kept++] = r;
    const double inverse = 1 / pivot;
    const double y_r = q_[r] * inverse;
    correction_[r] = y_r;
    const Index first = r / kRegister;
    const IntegerRegister is_r = kFirstRows == r % kRegister;
    const IntegerRegister is_after = kFirstRows > r % kRegister;
    for (Index v = first; v < registers; ++v) y[v] -= y_r * AsRegisters(row)[v];
    for (size_t m = k + 1; m < guess_.size(); ++m) {
      const Index i = guess_[m];
      const double factor = row[i] * inverse;
      if (factor == 0) continue;  // row i has zeros left of its diagonal where it had no L_ir yet
      Register* to = AsRegisters(tableau + i * stride_);
      const Register before = is_r ? Register{} + factor : to[first];
      const Register after = before - factor * AsRegisters(row)[first];
      to[first] = is_after ? after : before;
      for (Index v = first + 1; v < registers; ++v) to[v] -= factor * AsRegisters(row)[v];
    }
  }
  guess_.resize(kept);
  // Backward, each force subtracted from all rows before it at once.
  for (size_t k = kept; k-- > 0;) {
    const Index r = guess_[k];
    const double f = correction_[r];
    force_[r] = f;
    const double* row = tableau + r * stride_;
    for (Index v = 0; v <= r / kRegister; ++v) AsRegisters(correction_.data())[v] -= f * AsRegisters(row)[v];
  }
}

// Block principal pivoting from the guess, a few steps of it. Returns the last rho, with force_ and w_ of it. Spoils q_
// and the tableau.
double SmallPivoting::TryGuess() {
  const double limit = kRightRho * b_norm_;
  for (int round = 1;; ++round) {
    ++pivots_;
    SolveGuess();
    const double rho = Rho();
    if (rho <= kRightRho || round == kMaxGuesses) {
      IntegerRegister is_negative = {};
      for (Index v = 0; v < stride_ / kRegister; ++v) {
        const Register f = AsRegisters(force_.data())[v];
        const Register least = AsRegisters(least_force_.data())[v];
        is_negative |= f < least;
        AsRegisters(force_.data())[v] = f > least ? f : least;
      }
      // Forces that are rounding only may be all that a row has: its gap is then another without them.
      bool any_is_negative = false;
      for (Index k = 0; k < kRegister; ++k) any_is_negative = any_is_negative || is_negative[k] != 0;
      return any_is_negative ? Rho() : rho;
    }
    guess_.clear();
    for (Index i = 0; i < n_; ++i) {
      const double f = force_[i] * root_[i];
      const bool enters = f != 0 ? f >= -limit : w_[i] * inverse_root_[i] < -limit;
      if (least_force_[i] < 0 || enters) guess_.push_back(i);
    }
  }
}

}  // namespace lcpbench
