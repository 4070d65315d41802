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
/// [Woodbury; the body-space form of MODEL.md section 8]
///
/// The bodies are ordered by their graph, which is kept from problem to problem where it changes little: BodyGraph.
/// Vectors of rows have one entry per row of the problem; those of bodies three per movable body, in elimination order.
/// Internal to solvers/; one object serves one thread at a time.
class BodySpace {
 public:
  /// Whether the problem has the form for it: factors, rows on at most two movable bodies each.
  static bool Suits(const LcpProblem& problem) { return BodyGraph::Suits(problem); }

  /// `root` = D^1/2; rows with taking_part[i] = 0 are left out of K and of A^. Cost and errors as BodyGraph::Prepare.
  void Prepare(const LcpProblem& problem, const Eigen::VectorXd& root, const std::vector<char>& taking_part);

  /// Symbolic analyses of the latest Prepare, as BodyGraph::analyses.
  int analyses() const { return graph_.analyses(); }

  Index rows() const { return static_cast<Index>(rows_.size()); }
  int bodies() const { return bodies_; }
  const CholmodFactor& factor() const { return factor_; }
  GraphOrder order() const { return graph_.order(); }

  /// x = J^^T f.  O(rows)
  void ToBodies(const Eigen::VectorXd& f, Eigen::VectorXd* x) const;
  /// w = J^ x.  O(rows)
  void ToRows(const Eigen::VectorXd& x, Eigen::VectorXd* w) const;
  /// y = A^ f.  O(rows)
  void Multiply(const Eigen::VectorXd& f, Eigen::VectorXd* y) const;

  /// K for theta > 0. Rows of at least kOut leave K. False as CholmodFactor::Factorize.
  bool Factorize(const Eigen::VectorXd& theta);
  const std::string& why() const { return factor_.why(); }
  /// x = (A^ + diag(theta))^-1 r with the latest theta; x may be r.
  void Solve(const Eigen::VectorXd& r, Eigen::VectorXd* x);

  static constexpr double kOut = 1e24;

 private:
  // BodyGraph::Ends, and J^ on the two bodies.
  struct alignas(64) Row {
    double first_j[3] = {0, 0, 0};
    double second_j[3] = {0, 0, 0};
    int first = -1;
    int second = -1;
    int below = -1;
  };

  std::vector<Row> rows_;
  int bodies_ = 0;
  BodyGraph graph_;
  CholmodFactor factor_;
  Eigen::VectorXd weight_;          // T
  Eigen::VectorXd body_, product_;  // of Solve
  mutable Eigen::VectorXd image_;   // of Multiply
};

}  // namespace lcpbench
