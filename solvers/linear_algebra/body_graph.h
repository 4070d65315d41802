#pragma once

#include <Eigen/Core>
#include <vector>

#include "solvers/lcp/problem.h"
#include "solvers/linear_algebra/cholmod_factor.h"

namespace lcpbench {

/// Which movable bodies the rows of A = J M^-1 J^T join, the order in which the bodies are eliminated, and the analysis
/// in that order of
///     K = I + J^T T J,   T diagonal,
/// which has one 3 x 3 block per body and one per pair of bodies that share a row. [docs/model.md section 8]
///
/// The order comes from the graph of bodies, a ninth of the entries of K, and is expanded by three. In a sequence
/// (LcpSolver::SetInSequence) order and analysis are kept for a problem whose rows join the same bodies. Internal to
/// solvers/.
class BodyGraph {
 public:
  /// A row's two bodies by their places in the order, -1 for none, first < second; and where their common block begins
  /// in a column of the first one, counted from below the diagonal block.
  struct Ends {
    int first = -1;
    int second = -1;
    int below = -1;
    bool operator==(const Ends&) const = default;
  };

  static bool Suits(const LcpProblem& problem) {
    return problem.has_factors() && problem.columns_per_body() == 3 && problem.has_two_body_rows();
  }

  /// @param taking_part  rows with 0 join nothing; empty: all take part
  /// @param will_update  as CholmodFactor::AnalyzeAsOrdered, the same in every call
  /// @param factor  holds the analysis; the same in every call, and changed by nobody else
  /// O(rows log rows) and what has to be ordered and analysed; nested dissection is tried too where a factorization is
  /// long enough to pay for it.
  /// @throws std::runtime_error as CholmodFactor::Analyze
  void Prepare(const LcpProblem& problem, const std::vector<char>& taking_part, bool will_update,
               CholmodFactor* factor);

  /// In the order.
  int bodies() const { return bodies_; }
  const std::vector<Ends>& ends() const { return ends_; }
  /// Place of the body that a column of J belongs to, -1 for none.
  int place(Index column) const { return place_[static_cast<size_t>(column / 3)]; }
  /// Symbolic analyses of the latest Prepare: 0 if the one before was kept, else one for every order tried and, where
  /// the first one is taken after all, one more.
  int analyses() const { return analyses_; }

 private:
  void Order(Index triples, bool will_update, CholmodFactor* factor);

  std::vector<Ends> ends_;
  std::vector<Ends> ends_before_;  // of the problem analysed last, by triples of columns of J
  std::vector<int> place_;         // of every triple
  int bodies_ = 0;
  int analyses_ = 0;
};

}  // namespace lcpbench
