#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "solvers/ipopt/ipopt_engine.h"
#include "solvers/lcp/problem.h"
#include "solvers/lcp/solver.h"

/// What the two Ipopt backends share. Internal to solvers/.
namespace lcpbench::ipopt {

/// The Jacobi-scaled LCP with |b| = 1 that the programs are written in; tolerances and starting values have no units
/// there. A = D^-1/2 A D^-1/2, b = D^-1/2 b / |D^-1/2 b|; D_ii = |A_ii|, and 1 where A_ii = 0.
class ScaledLcp {
 public:
  /// b is still to be given.
  explicit ScaledLcp(const LcpProblem& problem);
  /// b and the units, of that problem or of one that shares its matrix.
  void SetB(const LcpProblem& problem);

  Index size() const { return inverse_root_.size(); }
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

/// One way to write the LCP as a program. The first n variables are the scaled f, the first n entries of c are b.
struct Formulation {
  std::string_view name;
  QuadraticProgram program;
  bool has_gap_constraints = false;  ///< the first n entries of d are -b
  /// A start with the given scaled f and w (both already off their bounds), primal and dual.
  std::function<Start(const Eigen::VectorXd& f, const Eigen::VectorXd& w)> start;
};

/// Runs Ipopt on formulations of one problem, one after the other until one gives an answer; it is stopped by the tier
/// test of the project itself.
class Runner {
 public:
  /// Ipopt iterations per formulation where LcpOptions names no limit. Ordinary problems take 5 to 40 (measured); the
  /// rest of the allowance is for redundant joints.
  static constexpr std::int64_t kDefaultIterations = 200;

  Runner();
  ~Runner();

  /// Builds Ipopt's objects for the first formulation; the others' are built when first tried.
  /// @param formulations  at least one; not owned. Their c and d are filled where they depend on b.
  void Prepare(const ScaledLcp& scaled, std::span<Formulation> formulations);
  /// `problem` shares its matrix with the prepared one.
  void Solve(const LcpProblem& problem, const LcpOptions& options, bool self_check, LcpResult* result);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace lcpbench::ipopt
