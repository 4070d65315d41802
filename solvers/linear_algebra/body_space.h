#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "solvers/lcp/problem.h"
#include "solvers/linear_algebra/body_graph.h"
#include "solvers/linear_algebra/cholmod_factor.h"

namespace lcpbench {

/// Solves with A^ + diag(theta), A^ = J^ J^^T the scaled Delassus matrix, through the bodies:
///     (A^ + diag(theta))^-1 r = T (r - J^ K^-1 J^^T T r),   K = I + J^^T T J^,   T = diag(1 / theta).
/// K has one 3 x 3 block per movable body and one per pair that shares a row, however many rows it shares; it is
/// positive definite whatever the rank of A^, so redundant contacts cost nothing and need no regularisation. Digits are
/// lost in r - J^ x instead, where theta is tiny: about eps / theta of r, which one step of refinement brings back.
/// [Woodbury; the body-space form of docs/model.md section 8]
///
/// The bodies are ordered by their graph, which is kept from problem to problem where it changes little: BodyGraph.
/// Vectors of rows have one entry per row of the problem; those of bodies three per movable body, in elimination order.
/// Internal to solvers/; one object serves one thread at a time.
class BodySpace {
 public:
  static constexpr Index kAxes = 3;
  static constexpr double kOut = 1e24;

  /// With J^ on the two bodies.
  struct alignas(64) Row : BodyGraph::Ends {
    double first_j[kAxes] = {0, 0, 0};
    double second_j[kAxes] = {0, 0, 0};
  };

  /// Whether the problem has the form for it: factors, rows on at most two movable bodies each.
  static bool Suits(const LcpProblem& problem) { return BodyGraph::Suits(problem); }

  /// The order and the analysis. Arguments, cost and errors as BodyGraph::Prepare.
  void Prepare(const LcpProblem& problem, const std::vector<char>& taking_part, bool will_update);
  /// J^ = J M^-1/2, row i divided by root[i] (D^1/2 for a unit diagonal of A^).  O(nnz J)
  void Load(const LcpProblem& problem, const Eigen::VectorXd& root);

  /// Symbolic analyses of the latest Prepare, as BodyGraph::analyses.
  int analyses() const { return graph_.analyses(); }
  Index rows() const { return static_cast<Index>(rows_.size()); }
  const Row& row(Index i) const { return rows_[static_cast<size_t>(i)]; }
  int bodies() const { return graph_.bodies(); }
  const CholmodFactor& factor() const { return factor_; }

  /// y = A^ f.  O(rows)
  void Multiply(const double* f, double* y) const;

  /// K for theta > 0. Rows of at least kOut leave K. False as CholmodFactor::Factorize.
  bool Factorize(const Eigen::VectorXd& theta);
  /// Lets `rows` join K with their theta (`join`), or leave it, by a change of the factor of rank |rows|; sorts them.
  /// [Davis, Hager 2001] Needs will_update. False as CholmodFactor::Update; only Factorize may follow then.
  bool Update(std::vector<int>* rows, const Eigen::VectorXd& theta, bool join);
  const std::string& why() const { return factor_.why(); }
  /// x = (A^ + diag(theta))^-1 r with the latest theta, 0 for rows that are out; x may be r.
  void Solve(const Eigen::VectorXd& r, Eigen::VectorXd* x);

 private:
  void ToBodies(const double* f, Eigen::VectorXd* x) const;  // x = J^^T f
  void ToRows(const Eigen::VectorXd& x, double* w) const;    // w = J^ x

  std::vector<Row> rows_;
  BodyGraph graph_;
  CholmodFactor factor_;
  Eigen::VectorXd weight_;          // T
  Eigen::VectorXd body_, product_;  // of Solve
  mutable Eigen::VectorXd image_;   // of Multiply
};

}  // namespace lcpbench
