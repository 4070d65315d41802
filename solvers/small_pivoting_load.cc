#include <algorithm>
#include <cmath>
#include <limits>

#include "solvers/power_of_two.h"
#include "solvers/small_pivoting.h"
#include "solvers/vector_register.h"

namespace lcpbench {
namespace {

using Index = Eigen::Index;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

size_t At(Index i) { return static_cast<size_t>(i); }

}  // namespace

bool SmallPivoting::LoadDense(const LcpProblem& problem) {
  SetSize(problem.size());
  diagonal_.head(n_) = problem.DiagonalA();
  b_.head(n_) = problem.b();
  for (const Index i : problem.bilateral_rows()) joints_.push_back(i);
  if (!Scale()) return false;
  // A is symmetric, so its columns serve as rows. What a register reads beyond a row's end is multiplied by 0; beyond
  // the last row there is nothing to read.
  const double* A = problem.DenseA().data();
  const Index registers = stride_ / kRegister;
  for (Index i = 0; i < n_; ++i) {
    const double* from = A + i * n_;
    const double s = scale_[i];
    double* to = matrix_.data() + i * stride_;
    double* to_tableau = tableau_.data() + i * stride_;
    if (i * n_ + stride_ <= n_ * n_) {
      for (Index v = 0; v < registers; ++v) {
        const Register row = AsRegisters(from)[v] * s * AsRegisters(scale_.data())[v];
        AsRegisters(to)[v] = row;
        AsRegisters(to_tableau)[v] = row;
      }
    } else {
      for (Index j = 0; j < n_; ++j) to[j] = to_tableau[j] = from[j] * s * scale_[j];
      for (Index j = n_; j < stride_; ++j) to[j] = to_tableau[j] = 0;
    }
  }
  return true;
}

bool SmallPivoting::LoadPart(const LcpProblem& problem, std::span<const Index> rows) {
  SetSize(static_cast<Index>(rows.size()));
  for (Index i = 0; i < n_; ++i) {
    const Index given = rows[At(i)];
    diagonal_[i] = problem.DiagonalA()[given];
    b_[i] = problem.b()[given];
    local_[At(given)] = static_cast<int>(i);
    if (problem.is_bilateral(given)) joints_.push_back(i);
  }
  if (!Scale()) return false;
  std::fill(matrix_.data(), matrix_.data() + n_ * stride_, 0.0);
  for (Index i = 0; i < n_; ++i) {
    double* to = matrix_.data() + i * stride_;
    for (SparseMatrix::InnerIterator it(problem.SparseA(), rows[At(i)]); it; ++it) {
      // Rows that are no part of this island are left out of it: they carry no force.
      const auto j = static_cast<Index>(local_[At(it.col())]);
      if (j < n_ && rows[At(j)] == it.col()) to[j] = it.value() * scale_[i] * scale_[j];
    }
  }
  std::copy(matrix_.data(), matrix_.data() + n_ * stride_, tableau_.data());
  return true;
}

void SmallPivoting::SetSize(Index n) {
  n_ = n;
  stride_ = (n + kRegister - 1) / kRegister * kRegister;
  joints_.clear();
}

// diagonal_ and b_ are the given ones here and scaled ones afterwards; the rest follows from them. False unless all of
// the diagonal is positive.
bool SmallPivoting::Scale() {
  for (Index i = n_; i < stride_; ++i) {
    diagonal_[i] = 1;
    b_[i] = 0;
  }
  Register largest = {};
  Register squared = {};
  IntegerRegister at = kFirstRows;
  IntegerRegister is_wrong = {};
  const Index registers = stride_ / kRegister;
  for (Index v = 0; v < registers; ++v) {
    const Register d = AsRegisters(diagonal_.data())[v];
    is_wrong |= !(d > 0);
    // ScaleOfDiagonal of eight rows at once; 0 where there is no row.
    const IntegerRegister exponent = (reinterpret_cast<const IntegerRegister&>(d) >> kMantissaBits) - kExponentBias;
    const IntegerRegister bits = (kExponentBias - (exponent >> 1)) << kMantissaBits;
    const Register scale = at < n_ ? reinterpret_cast<const Register&>(bits) : Register{};
    const Register one = d * scale * scale;
    Register root;
    Eigen::Map<Eigen::Array<double, kRegister, 1>>(reinterpret_cast<double*>(&root)) =
        Eigen::Map<const Eigen::Array<double, kRegister, 1>>(reinterpret_cast<const double*>(&one)).sqrt();
    const Register inverse = at < n_ ? 1 / root : Register{};
    const Register b = AsRegisters(b_.data())[v] * scale;
    AsRegisters(scale_.data())[v] = scale;
    AsRegisters(root_.data())[v] = root;
    AsRegisters(inverse_root_.data())[v] = inverse;
    AsRegisters(b_.data())[v] = b;
    const Register size = b < 0 ? -b : b;
    largest = size > largest ? size : largest;
    const Register relative = b * inverse;
    squared += relative * relative;
    at += kRegister;
  }
  largest = -largest;
  b_scale_ = ScaleOfLargest(-Least(&largest));
  inverse_b_scale_ = 1 / b_scale_;
  const double norm = Sum(&squared);
  b_norm_ = norm == 0 ? 1.0 : std::sqrt(norm) * b_scale_;
  for (Index v = 0; v < registers; ++v) {
    const Register b = AsRegisters(b_.data())[v] * b_scale_;
    AsRegisters(b_.data())[v] = b;
    AsRegisters(q_.data())[v] = b;
    AsRegisters(weight_.data())[v] = AsRegisters(inverse_root_.data())[v];
    AsRegisters(sign_.data())[v] = Register{} - 1.0;
    AsRegisters(least_force_.data())[v] = Register{};
    AsRegisters(blocked_weight_.data())[v] = Register{};
  }
  for (const Index i : joints_) {
    weight_[i] = 0;
    least_force_[i] = -kInfinity;
  }
  for (Index k = 0; k < kRegister; ++k) {
    if (is_wrong[k] != 0) return false;
  }
  return true;
}

}  // namespace lcpbench
