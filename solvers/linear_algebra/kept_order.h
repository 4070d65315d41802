#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <utility>
#include <vector>

#include "solvers/lcp/problem.h"

namespace lcpbench {

/// The elimination order of a graph, kept for a later graph that differs from it a little: as contacts come and go in
/// motion, a few nodes and edges change. (`lcpbench run --suite sequences` measures what that is worth.)
///
/// For problems that are steps of a sequence (LcpSolver::SetInSequence). Nodes go by names, which outlast their
/// numbers: a body is named by its columns of J, a contact by its two bodies. Whoever uses a kept order asks
/// afterwards, with the work that its analysis predicts, whether it still serves.
///
/// An answer then depends, in its rounding, on the problem before. Problems of less than kLeastRows are not worth that.
/// Internal to solvers/; one object serves one thread at a time.
class KeptOrder {
 public:
  using Name = std::uint64_t;

  /// @param names  of the nodes, all different; none: nothing is kept
  /// @param order  order[k]: the node to eliminate k-th
  /// @param work   of a factorization in this order, in any unit
  /// O(n log n)
  void Keep(const std::vector<Name>& names, const Eigen::VectorXi& order, double work);
  void Clear() { known_.clear(); }

  /// The nodes in the order that is kept. A new one comes right after the last of its neighbours: earlier, it would
  /// join what is eliminated apart.
  /// @param starts, indices  the graph by columns, without the entries of one triangle or with all
  /// Empty where there is no kept order, or more than kMostNew of the nodes are new.  O(n log n + edges)
  Eigen::VectorXi Find(const std::vector<Name>& names, const int* starts, const int* indices);
  /// Whether a factorization in a found order is not so much more work than in the one that was kept that it is worth
  /// ordering anew.
  /// After one that does not, the next kPause problems are not asked for theirs: where the graph changes so that orders
  /// wear out, to find that out costs an analysis.
  bool Serves(double work) {
    if (work <= kMostWork * work_) return true;
    pause_ = kPause;
    return false;
  }

  /// Part of the nodes, or of the edges where a node's name does not tell them.
  static constexpr double kMostNew = 0.05;
  static constexpr double kMostWork = 1.25;
  static constexpr int kPause = 8;
  static constexpr Index kLeastRows = 1000;

 private:
  std::vector<std::pair<Name, int>> known_;  // by name, with the place in the order
  double work_ = 0;
  int pause_ = 0;
};

/// The movable bodies of a row with at most two, by their triples of columns of J counted from 0; -1 for none.
std::pair<int, int> BodiesOfRow(const LcpProblem& problem, Index row);

/// Names of the rows of a problem in factors with at most two movable bodies a row: the two bodies, and how many rows
/// of these two come before. Empty for other problems, and for more than 2^24 bodies or 2^16 rows of one pair. O(n log
/// n)
std::vector<KeptOrder::Name> NamesOfRows(const LcpProblem& problem);

/// Name of a pair of bodies, in any order, as BodiesOfRow gives them.
KeptOrder::Name NameOfPair(int body, int other);

}  // namespace lcpbench
