#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace lcpbench {

/// A sparse symmetric matrix with a fixed pattern and changing diagonal, analysed once and factorized many times by
/// CHOLMOD.
/// [Chen, Davis, Hager, Rajamanickam, Algorithm 887, ACM TOMS 35, 2008; AMD ordering: Amestoy, Davis, Duff]
///
/// CHOLMOD's types stay in the source file. One object serves one thread at a time, and runs on one thread: OpenMP
/// teams and OpenBLAS are held to one thread meanwhile where these libraries are loaded (Debian's CHOLMOD asks for
/// teams of four whatever OMP_NUM_THREADS says). Solve allocates nothing after the first call; Factorize allocates
/// inside CHOLMOD: the permuted copy of the matrix, and workspace.
class CholmodFactor {
 public:
  enum class Definiteness {
    kPositiveDefinite,  ///< LL' by supernodes or LDL' by columns, whichever is predicted to be faster
    kQuasidefinite,     ///< LDL' with pivots of both signs, by columns [Vanderbei 1995]
  };
  using ColumnMatrix = Eigen::SparseMatrix<double, Eigen::ColMajor, int>;

  CholmodFactor();
  ~CholmodFactor();
  CholmodFactor(const CholmodFactor&) = delete;
  CholmodFactor& operator=(const CholmodFactor&) = delete;

  /// Symbolic analysis. `lower` is the lower triangle with sorted columns and every diagonal entry stored; it is
  /// copied.
  /// @param order  order[k] is the row to eliminate k-th, for callers that know more than the matrix shows (its
  ///     elimination tree is postordered afterwards, which changes neither fill nor work); empty: AMD of the matrix.
  /// @throws MemoryRefusal where the predicted factor is larger than the memory that is left
  /// @throws std::runtime_error with CHOLMOD's status (out of memory, too large, `order` not a permutation)
  void Analyze(Definiteness definiteness, const ColumnMatrix& lower, const Eigen::VectorXi& order = {});

  /// The same for a positive definite matrix whose rows are in elimination order, postordered, so that a factorization
  /// reads it in place instead of permuting it first.
  void AnalyzeAsOrdered(const ColumnMatrix& lower);

  /// Takes over the values of `lower` where its pattern is that of the matrix analysed last, whose analysis is kept.
  /// Returns false and changes nothing where the pattern differs.
  bool TakeValues(const ColumnMatrix& lower);

  Eigen::Index size() const;
  /// Predicted work of one factorization [flop] and entries of L.
  double flops() const;
  double fill() const;

  void SetDiagonal(Eigen::Index i, double value);
  /// The matrix itself, lower triangle by columns: size() + 1 starts, rows, and values that may be changed.
  const int* column_starts() const;
  const int* row_indices() const;
  double* values();

  /// False if a pivot is zero (or, for kPositiveDefinite, not positive); why() then says so in words, with CHOLMOD's
  /// status. Solve must not be called after that.
  bool Factorize();
  const std::string& why() const;

  /// x = K^-1 r with the latest factorization; x may be r.
  void Solve(const Eigen::VectorXd& r, Eigen::VectorXd* x);

 private:
  struct State;
  void AnalyzeBy(Definiteness definiteness, const ColumnMatrix& lower, int ordering, const int* order);
  std::unique_ptr<State> state_;
};

/// How the nodes of a graph are ordered for little fill of a symmetric factor.
enum class GraphOrder {
  kMinimumDegree,     ///< AMD [Amestoy, Davis, Duff, Algorithm 837, ACM TOMS 30, 2004]
  kNestedDissection,  ///< METIS [Karypis, Kumar, SIAM J. Sci. Comput. 20, 1998], where CHOLMOD was built with it
};

/// order[k] = the node to eliminate k-th, postordered along the elimination tree, so that columns of like structure
/// follow each other. Empty where this build cannot order so.
/// @param graph  lower triangle of the adjacency matrix; only its pattern is read; the diagonal does not matter
Eigen::VectorXi OrderGraph(const Eigen::SparseMatrix<double, Eigen::ColMajor, int>& graph, GraphOrder order);

}  // namespace lcpbench
