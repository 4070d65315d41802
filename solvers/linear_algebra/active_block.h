#pragma once

#include <Eigen/Core>
#include <vector>

#include "solvers/lcp/solver.h"

namespace lcpbench {

/// A symmetric positive semidefinite matrix A with the Cholesky factor of a shifted principal block
///     K_FF = A_FF + shift D_FF,   D = diag A, shift > 0,
/// for methods that change F by many rows at a time. Two forms: SparseActiveBlock and DenseActiveBlock. Vectors are by
/// row of the problem. Internal to solvers/. Only Analyze allocates.
class ActiveBlock {
 public:
  virtual ~ActiveBlock() = default;

  /// What depends on the structure of A only.
  virtual void Analyze(const LcpProblem& problem) = 0;
  /// Takes the values S A S, S = diag(scale). To be called before a first Factor.
  virtual void Load(const LcpProblem& problem, const Eigen::VectorXd& scale) = 0;

  /// F := rows with active[i] != 0, all with A_ii > 0. Mathematically every pivot is at least shift A_ii; rounding is
  /// held to that, so factoring cannot fail. The clock is read every kWorkPerClockRead multiply-adds.
  /// @param deadline  nullptr for none
  /// @returns false if the deadline passed meanwhile; there is no factor then
  virtual bool Factor(const std::vector<char>& active, double shift, const Deadline* deadline) = 0;
  /// Some 10 us of them.
  static constexpr double kWorkPerClockRead = 1 << 15;
  /// x_F := K_FF^-1 x_F, other entries := 0.
  virtual void Solve(double* x) = 0;
  /// y := A x.
  virtual void Multiply(const double* x, double* y) const = 0;
  /// Nanoseconds that a Factor of all rows and what goes with it take, roughly, for a choice between forms. Measured
  /// with AVX-512 on one machine; the ratio of the two forms matters only.
  virtual double factor_time() const = 0;
  /// Rows of the last factor that depend on others: whose pivot is little more than the shift.  O(n)
  virtual Index CountDependentRows() const = 0;
  static constexpr double kDependentPivot = 10;  ///< in shift A_ii
};

}  // namespace lcpbench
