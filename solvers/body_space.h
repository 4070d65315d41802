#pragma once

#include <Eigen/Core>
#include <string>
#include <utility>
#include <vector>

#include "solvers/cholmod_factor.h"
#include "solvers/graph_order.h"
#include "solvers/lcp/problem.h"

namespace lcpbench {

/// Solves with A^ + diag(theta), A^ = J^ J^^T the scaled Delassus matrix, through the bodies:
///     (A^ + diag(theta))^-1 r = T (r - J^ K^-1 J^^T T r),   K = I + J^^T T J^,   T = diag(1 / theta).
/// K has one 3 x 3 block per movable body and one per pair that shares a row, however many rows it shares; it is
/// positive definite whatever the rank of A^, so redundant contacts cost nothing and need no regularisation. Digits are
/// lost in r - J^ x instead, where theta is tiny: about eps / theta of r, which one step of refinement brings back.
/// [Woodbury; the body-space form of MODEL.md section 8]
///
/// The order comes from the graph of bodies, a ninth of the entries of K, and is expanded by three. [as oracle.h]
/// Vectors of rows have one entry per row of the problem; those of bodies three per movable body, in elimination order.
/// Internal to solvers/; one object serves one thread at a time.
class BodySpace {
 public:
  /// Whether the problem has the form for it: factors, rows on at most two movable bodies each.
  static bool Suits(const LcpProblem& problem) { return problem.has_factors() && problem.has_two_body_rows(); }

  /// Orders the bodies and analyses K. `root` = D^1/2; rows with taking_part[i] = 0 are left out of K and of A^.
  /// O(rows) and the ordering; nested dissection is tried too where a factorisation is long enough to pay for it.
  /// Where the rows join the same bodies in the same order as those of the problem before, order and analysis are kept,
  /// bit for bit what they would be: O(rows).
  /// @throws std::runtime_error as CholmodFactor::Analyze
  void Prepare(const LcpProblem& problem, const Eigen::VectorXd& root, const std::vector<char>& taking_part);

  /// Symbolic analyses of the latest Prepare: 0 if the one before was kept, else one for every order tried and, where
  /// the first one is taken after all, one more.
  int analyses() const { return analyses_; }

  Index rows() const { return static_cast<Index>(rows_.size()); }
  int bodies() const { return bodies_; }
  const CholmodFactor& factor() const { return factor_; }
  GraphOrder order() const { return order_; }

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
  // A row's two bodies, -1 for none, first < second; J^ on them; and where their common block begins in a column of
  // the first one, counted from below the diagonal block.
  struct alignas(64) Row {
    double first_j[3] = {0, 0, 0};
    double second_j[3] = {0, 0, 0};
    int first = -1;
    int second = -1;
    int below = -1;
  };

  void ReadRows(const LcpProblem& problem, const Eigen::VectorXd& root, const std::vector<char>& taking_part);
  bool JoinsAsBefore();
  void Order();
  CholmodFactor::ColumnMatrix Graph() const;
  void Analyze(const CholmodFactor::ColumnMatrix& graph, GraphOrder order, const Eigen::VectorXi& nodes);
  void Relabel(const Eigen::VectorXi& nodes);

  std::vector<Row> rows_;
  int bodies_ = 0;
  int analyses_ = 0;
  std::vector<std::pair<int, int>> joined_;  // by every row, as numbered before the order is chosen
  Eigen::VectorXi nodes_;                    // that order
  GraphOrder order_ = GraphOrder::kMinimumDegree;
  CholmodFactor factor_;
  Eigen::VectorXd weight_;          // T
  Eigen::VectorXd body_, product_;  // of Solve
  mutable Eigen::VectorXd image_;   // of Multiply
};

}  // namespace lcpbench
