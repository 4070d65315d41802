#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <functional>
#include <memory>
#include <string_view>
#include <vector>

#include "solvers/lcp/problem.h"
#include "solvers/lcp/solver.h"

/// What the two Ipopt backends share. Internal to solvers/: no Ipopt header is seen from here, and none is installed.
namespace lcpbench::ipopt {

/// Coordinates of a sparse matrix, each position at most once.
struct Entries {
  std::vector<int> row;
  std::vector<int> column;
  std::vector<double> value;

  void Add(Index i, Index j, double x) {
    row.push_back(static_cast<int>(i));
    column.push_back(static_cast<int>(j));
    value.push_back(x);
  }
  size_t size() const { return value.size(); }
};

/// min 1/2 x.H x + c.x  subject to  G x = d,  x_j >= 0 where nonnegative[j].
/// H and G are constant, so that all derivatives are exact: the gradient is H x + c.
struct QuadraticProgram {
  Eigen::VectorXd c;              ///< one entry per variable
  Eigen::VectorXd d;              ///< one entry per constraint
  std::vector<bool> nonnegative;  ///< one entry per variable
  Entries hessian;                ///< lower triangle of H
  Entries jacobian;               ///< G

  double Objective(const double* x) const;
  /// gradient: one entry per variable
  void Gradient(const double* x, double* gradient) const;
  /// values = G x: one entry per constraint
  void Constraints(const double* x, double* values) const;
};

inline double QuadraticProgram::Objective(const double* x) const {
  double sum = 0;
  for (Index j = 0; j < c.size(); ++j) sum += c[j] * x[j];
  for (size_t k = 0; k < hessian.size(); ++k) {
    const int i = hessian.row[k];
    const int j = hessian.column[k];
    sum += (i == j ? 0.5 : 1.0) * hessian.value[k] * x[i] * x[j];
  }
  return sum;
}

inline void QuadraticProgram::Gradient(const double* x, double* gradient) const {
  std::copy_n(c.data(), c.size(), gradient);
  for (size_t k = 0; k < hessian.size(); ++k) {
    const int i = hessian.row[k];
    const int j = hessian.column[k];
    gradient[i] += hessian.value[k] * x[j];
    if (i != j) gradient[j] += hessian.value[k] * x[i];
  }
}

inline void QuadraticProgram::Constraints(const double* x, double* values) const {
  std::fill_n(values, d.size(), 0.0);
  for (size_t k = 0; k < jacobian.size(); ++k) values[jacobian.row[k]] += jacobian.value[k] * x[jacobian.column[k]];
}

/// A starting point. Multipliers have Ipopt's signs: H x + c + G^T y - z = 0.
struct Start {
  Eigen::VectorXd x;
  Eigen::VectorXd z;  ///< of the bounds x >= 0, one per variable
  Eigen::VectorXd y;  ///< of the constraints
};

/// The Jacobi-scaled LCP with |b| = 1 that the programs are written in; tolerances and starting values have no units
/// there. A = D^-1/2 A D^-1/2, b = D^-1/2 b / |D^-1/2 b|; D_ii = |A_ii|, and 1 where A_ii = 0.
class ScaledLcp {
 public:
  explicit ScaledLcp(const LcpProblem& problem);

  Index size() const { return b_.size(); }
  const LcpProblem& problem() const { return problem_; }
  const Eigen::VectorXd& b() const { return b_; }
  /// f of the problem = ForceUnit * f of the scaled one, row by row; w likewise.
  const Eigen::VectorXd& ForceUnit() const { return force_unit_; }
  const Eigen::VectorXd& GapUnit() const { return gap_unit_; }
  /// Scale of row i: D_ii^-1/2.
  double InverseRoot(Index i) const { return inverse_root_[i]; }

  /// S = D^-1/2 J M^-1/2 without the columns that are empty or of zero inverse mass; S S^T is the scaled A. Factors
  /// only.
  SparseMatrix Factor() const;
  /// Whether the lifted form is the sparser one: A has many more entries than J.
  bool LiftedIsSparser() const;

 private:
  LcpProblem problem_;
  Eigen::VectorXd inverse_root_;
  Eigen::VectorXd b_;
  Eigen::VectorXd force_unit_;
  Eigen::VectorXd gap_unit_;
};

/// One way to write the LCP as a program. The first n variables are the scaled f.
struct Formulation {
  std::string_view name;
  QuadraticProgram program;
  /// A start with the given scaled f and w (both already off their bounds), primal and dual.
  std::function<Start(const Eigen::VectorXd& f, const Eigen::VectorXd& w)> start;
};

/// Runs Ipopt on formulations of one problem, one after the other until one gives an answer. Ipopt is silent, reads no
/// options file, and is stopped by the tier test of the project itself; see ipopt_common.cc for every option and its
/// reason.
class Runner {
 public:
  /// Ipopt iterations per formulation where LcpOptions names no limit. Ordinary problems take 5 to 40 (measured); the
  /// rest of the allowance is for redundant joints.
  static constexpr std::int64_t kDefaultIterations = 200;

  Runner();
  ~Runner();

  void Prepare(const ScaledLcp& scaled);
  void Solve(const std::vector<Formulation>& formulations, const LcpOptions& options, LcpResult* result);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace lcpbench::ipopt
