#pragma once

#include <Eigen/Core>
#include <string>
#include <utility>
#include <vector>

#include "solvers/lcp/problem.h"
#include "solvers/linear_algebra/cholmod_factor.h"

namespace lcpbench {

/// Solves with A^ + diag(theta), A^ = J^ J^^T the scaled Delassus matrix, through the bodies:
///     (A^ + diag(theta))^-1 r = T (r - J^ K^-1 J^^T T r),   K = I + J^^T T J^,   T = diag(1 / theta).
/// K has one 3 x 3 block per movable body and one per pair that shares a row, however many rows it shares; it is
/// positive definite whatever the rank of A^, so redundant contacts cost nothing and need no regularisation. Digits are
/// lost in r - J^ x instead, where theta is tiny: about eps / theta of r, which one step of refinement brings back.
/// [Woodbury; the body-space form of docs/model.md section 8]
///
/// The bodies are ordered by their graph, a ninth of the entries of K. In a sequence (LcpSolver::SetInSequence) order
/// and analysis are kept for a problem whose rows join the same bodies.
/// Vectors of rows have one entry per row of the problem; those of bodies three per movable body, in elimination order.
/// Internal to solvers/; one object serves one thread at a time.
class BodySpace {
 public:
  static constexpr int kAxes = 3;
  static constexpr double kOut = 1e24;

  /// A row's two bodies by their places in the order, -1 for none, first < second; J^ on them; and where their common
  /// block begins in a column of the first one, counted from below the diagonal block.
  struct alignas(64) Row {
    double first_j[kAxes] = {0, 0, 0};
    double second_j[kAxes] = {0, 0, 0};
    int first = -1;
    int second = -1;
    int below = -1;
  };

  /// Whether the problem has the form for it: factors, rows on at most two movable bodies each.
  static bool Suits(const LcpProblem& problem) {
    return problem.has_factors() && problem.columns_per_body() == kAxes && problem.has_two_body_rows();
  }

  /// The order and the analysis; nested dissection is tried too where a factorization is long enough to pay for it.
  /// O(rows) besides.
  /// @param taking_part  rows with 0 join nothing; empty: all take part
  /// @throws std::runtime_error as CholmodFactor::Analyze
  void Prepare(const LcpProblem& problem, const std::vector<char>& taking_part);
  /// J^ = J M^-1/2, row i divided by root[i] (D^1/2 for a unit diagonal of A^).  O(nnz J)
  void Load(const LcpProblem& problem, const Eigen::VectorXd& root);

  /// Symbolic analyses of the latest Prepare: 0 if the one before was kept, else one for every order tried and, where
  /// the first one is taken after all, one more.
  int analyses() const { return analyses_; }
  Index rows() const { return static_cast<Index>(rows_.size()); }
  const CholmodFactor& factor() const { return factor_; }

  /// y = A^ f.  O(rows)
  void Multiply(const double* f, double* y) const;

  /// K for theta > 0. Rows of at least kOut leave K. False as CholmodFactor::Factorize.
  bool Factorize(const Eigen::VectorXd& theta);
  const std::string& why() const { return factor_.why(); }
  /// x = (A^ + diag(theta))^-1 r with the latest theta, 0 for rows that are out; x may be r.
  void Solve(const Eigen::VectorXd& r, Eigen::VectorXd* x);

 private:
  void Order(Index triples);
  void ToBodies(const double* f, Eigen::VectorXd* x) const;  // x = J^^T f
  void ToRows(const Eigen::VectorXd& x, double* w) const;    // w = J^ x

  std::vector<Row> rows_;
  std::vector<std::pair<int, int>> bodies_of_rows_;  // of the problem analysed last, by triples of columns of J
  std::vector<int> place_;                           // of every triple in the order, -1 for none
  int bodies_ = 0;
  int analyses_ = 0;
  CholmodFactor factor_;
  Eigen::VectorXd weight_;          // T
  Eigen::VectorXd body_, product_;  // of Solve
  mutable Eigen::VectorXd image_;   // of Multiply
};

}  // namespace lcpbench
