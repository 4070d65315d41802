#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "solvers/linear_algebra/active_block.h"
#include "solvers/linear_algebra/body_graph.h"
#include "solvers/linear_algebra/cholmod_factor.h"

namespace lcpbench {

/// ActiveBlock through the bodies, for A = J M^-1 J^T with rows on at most two movable bodies each:
///     (A_FF + shift D_F)^-1 r = T (r - J_F K^-1 J_F^T T r),   K = I + J_F^T T J_F,   T = (shift D_F)^-1,
/// J with its columns times M^-1/2. [Woodbury; MODEL.md section 8] K has one 3 x 3 block per body and one per pair that
/// shares a row, however many rows that are: where contacts are redundant it is smaller and its factor sparser than
/// A_FF's, and a dependent row is no small pivot.
///
/// A row that enters or leaves F adds or removes one column of J^T: a rank-1 change of K, whose pattern is that of all
/// rows. A Factor with the shift of the one before updates the factor where that is predicted to take less time than a
/// new one, from counts alone (entries of L from the changed bodies to the root, and flop of a factorisation), never
/// from the clock. [Davis, Hager 2001, by CHOLMOD]
///
/// Precision: r - J_F x cancels, about eps / shift of r is lost; and a row that leaves F takes its weight 1 / shift out
/// of the factor, which loses as much in K. Solve refines with residuals of A_FF itself until they are rounding, and
/// factors anew where updates have worn the factor out.
///
/// Departures from ActiveBlock: CHOLMOD allocates in Factor and the first Solve; the clock is read before a
/// factorisation and after it only; CountDependentRows counts those rows of F that must depend on others, being more
/// than the freedoms of their bodies: a lower bound.
class BodyActiveBlock final : public ActiveBlock {
 public:
  /// Whether the problem has the form for it.
  static bool Suits(const LcpProblem& problem) { return BodyGraph::Suits(problem); }

  /// @throws std::runtime_error as CholmodFactor::Analyze
  void Analyze(const LcpProblem& problem) override;
  void Load(const LcpProblem& problem, const Eigen::VectorXd& scale) override;
  bool Factor(const std::vector<char>& active, double shift, const Deadline* deadline) override;
  void Solve(double* x) override;
  void Multiply(const double* x, double* y) const override;
  double factor_time() const override;
  Index CountDependentRows() const override;

  /// For tests and measurements: whether updates are allowed (yes at the start), and how often each way was taken since
  /// Load.
  void set_may_update(bool may) { may_update_ = may; }
  std::int64_t factorisations() const { return factorisations_; }
  std::int64_t updates() const { return updates_; }

 private:
  // BodyGraph::Ends, and J M^-1/2 on the two bodies.
  struct alignas(64) Row {
    double first_j[3] = {0, 0, 0};
    double second_j[3] = {0, 0, 0};
    int first = -1;
    int second = -1;
    int below = -1;
  };

  Index freedoms() const { return Index{3} * bodies_; }
  void FindPaths();
  void FactorAnew();
  bool Update();
  double NewFactorTime() const;
  double UpdateTime() const;
  void SolveOnce(const Eigen::VectorXd& r);
  double Residual();

  Index n_ = 0;
  int bodies_ = 0;
  BodyGraph graph_;
  std::vector<Row> rows_;
  CholmodFactor factor_;
  bool by_supernodes_ = false;  // a new factor
  double flop_time_ = 0;        // of it
  std::vector<double> path_;    // entries of L from a body to the root
  Eigen::VectorXd diagonal_;    // of S A S

  // State.
  bool may_update_ = true;
  bool valid_ = false;    // there is a factor
  bool updated_ = false;  // and it is not as FactorAnew left it
  double shift_ = 0;
  std::vector<char> active_;
  std::vector<int> entering_, leaving_;
  std::int64_t factorisations_ = 0;
  std::int64_t updates_ = 0;
  Eigen::VectorXd right_, residual_, x_, step_;
  Eigen::VectorXd body_;           // of SolveOnce and Residual
  mutable Eigen::VectorXd image_;  // of Multiply
};

}  // namespace lcpbench
