#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "solvers/linear_algebra/active_block.h"
#include "solvers/linear_algebra/body_space.h"

namespace lcpbench {

/// ActiveBlock through the bodies (BodySpace, theta = shift D_F), for A = J M^-1 J^T with rows on at most two movable
/// bodies each: where contacts are redundant K is smaller and its factor sparser than A_FF's, and a dependent row is no
/// small pivot.
///
/// A row that enters or leaves F adds or removes one column of J^T: a rank-1 change of K, whose pattern is that of all
/// rows. A Factor with the shift of the one before updates the factor where that is predicted to take less time than a
/// new one, from counts alone (entries of L from the changed bodies to the root, and flop of a factorization), never
/// from the clock. [Davis, Hager 2001, by CHOLMOD]
///
/// Precision: r - J_F x cancels, about eps / shift of r is lost; and a row that leaves F takes its weight 1 / shift out
/// of the factor, which loses as much in K. Solve refines with residuals of A_FF itself until they are rounding, and
/// factors anew where updates have worn the factor out.
///
/// Departures from ActiveBlock: CHOLMOD allocates in Factor and the first Solve; the clock is read before a
/// factorization and after it only; CountDependentRows counts those rows of F that must depend on others, being more
/// than the degrees of freedom of their bodies: a lower bound.
class BodyActiveBlock final : public ActiveBlock {
 public:
  /// @throws std::runtime_error as CholmodFactor::Analyze
  void Analyze(const LcpProblem& problem) override;
  void Load(const LcpProblem& problem, const Eigen::VectorXd& scale) override;
  bool Factor(const std::vector<char>& active, double shift, const Deadline* deadline) override;
  void Solve(double* x) override;
  void Multiply(const double* x, double* y) const override;
  double factor_time() const override;
  Index CountDependentRows() const override;

  /// For tests: how often each way was taken since Load.
  std::int64_t factorizations() const { return factorizations_; }
  std::int64_t updates() const { return updates_; }

 private:
  void FactorAnew();
  double NewFactorTime() const;
  double UpdateTime() const;
  double Residual();

  Index n_ = 0;
  BodySpace bodies_;
  bool by_supernodes_ = false;  // a new factor
  double flop_time_ = 0;        // of it
  std::vector<double> path_;    // entries of L from a column to the root
  Eigen::VectorXd diagonal_;    // of S A S

  // State.
  bool valid_ = false;    // there is a factor
  bool updated_ = false;  // and it is not as FactorAnew left it
  double shift_ = 0;
  std::vector<char> active_;
  std::vector<int> entering_, leaving_;
  std::int64_t factorizations_ = 0;
  std::int64_t updates_ = 0;
  Eigen::VectorXd theta_, right_, residual_, x_, step_;
};

}  // namespace lcpbench
