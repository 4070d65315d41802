#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "solvers/lcp/problem.h"
#include "solvers/lcp/step_rows.h"

namespace lcpbench {

/// Finds rows of a plain LCP that cannot carry force, by looking at single entries, so that leaving them out is exact
/// for symmetric PSD A: f_i = 0 together with any solution of the rest is a solution of the whole. Row i is unilateral
/// and
///   - has b_i >= 0 and no A_ij < 0, and no A_ij != 0 with a bilateral j, over the rows j that are left: w_i >= 0
///     whatever they do; or
///   - is the same as a row j that is left (A_ij = A_ii = A_jj, which for PSD A means equal rows), and b_i >= b_j:
///     w_i = w_j + b_i - b_j >= 0.
class IdleRows {
 public:
  /// Looks for equal rows; b is not read.  O(nnz A), allocates.
  void Prepare(const LcpProblem& problem);
  /// Returns the number of idle rows of the prepared problem, or of one that shares its matrix.  O(nnz A), much less
  /// where most b_i < 0.
  Index Find(const LcpProblem& problem);
  /// By row: 0 if idle.
  const std::vector<char>& keep() const { return keep_; }

 private:
  bool IsIdle(const LcpProblem& problem, Index i) const;

  std::vector<char> has_twin_, keep_;
};

/// A partition of 0, ..., n - 1 that only gets coarser. Only Reset to a larger n than before allocates.
class DisjointSets {
 public:
  /// Every member alone.
  void Reset(Index n);
  Index sets() const { return sets_; }
  /// The least member of the set of i.
  Index Root(Index i);
  /// False if i and j were in one set already.
  bool Join(Index i, Index j);

 private:
  std::vector<std::int32_t> parent_;
  Index sets_ = 0;
};

/// The parts of an LCP that no entry of A connects, and no law: a friction row is in the island of its normal row. Each
/// may be solved by itself. In the order of their first rows.
/// @tparam Row  what rows are named by
template <typename Row>
class BasicIslands {
 public:
  /// Finding allocates nothing up to there, but where it says so.
  void Reserve(Index max_rows, Index max_bodies = 0);
  /// Islands among the rows with keep[i] != 0.  O(nnz A)
  /// @param friction  of the problem, here and below; both rows of each are kept
  void Find(const SparseMatrix& A, const std::vector<char>& keep, std::span<const FrictionRow> friction = {});
  /// Islands among all rows of a problem by factors, A not formed: rows that share a column of J which can move belong
  /// together, even where products of J cancel.  O(nnz J), allocates one number per column.
  void FindByColumns(const SparseMatrix& J, const Eigen::VectorXd& inverse_mass,
                     std::span<const FrictionRow> friction = {});
  /// The same by the bodies of a step's rows: bodies that no row names are not looked at.  O(n)
  void Find(const StepRows& rows);

  Index count() const { return static_cast<Index>(begin_.size()) - 1; }
  /// Which one a row that was kept belongs to.
  Index island(Index row) const { return island_[static_cast<size_t>(row)]; }
  /// Ascending.
  std::span<const Row> rows(Index island) const {
    const Row* const begin = begin_.data() + island;
    return {order_.data() + begin[0], static_cast<size_t>(begin[1] - begin[0])};
  }
  /// Rows of the largest one.
  Index largest() const { return largest_; }

 private:
  void Join(std::span<const FrictionRow> friction);
  void Collect(Index n, const std::vector<char>* keep);

  DisjointSets joined_;
  std::vector<Row> island_, order_, begin_, filled_;
  std::vector<std::int32_t> last_row_;  // by body of a step, -1 between calls
  Index largest_ = 0;
};

using Islands = BasicIslands<Index>;
using RowIslands = BasicIslands<std::int32_t>;
extern template class BasicIslands<Index>;
extern template class BasicIslands<std::int32_t>;

/// The movable bodies of a row with at most two, by their place among the bodies that J has columns for; -1 for none.
std::pair<int, int> BodiesOfRow(const LcpProblem& problem, Index row);

/// The kinds of some rows, by their places among these.
/// @param rows  ascending, with the normal row of every friction row
RowBounds BoundsOfRows(const LcpProblem& problem, std::span<const Index> rows);

/// The LCP of some rows alone: in the given form, with the bodies that they touch.
/// @param rows  as BoundsOfRows
LcpProblem Subproblem(const LcpProblem& problem, std::span<const Index> rows);

}  // namespace lcpbench
