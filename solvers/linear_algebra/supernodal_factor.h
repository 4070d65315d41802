#pragma once

#include <cstddef>
#include <vector>

namespace lcpbench {

/// L of A = L L^T by supernodes: runs of columns of like structure, kept as dense column-major panels.
/// [Ng, Peyton, Block sparse Cholesky algorithms on advanced uniprocessor computers, SIAM J. Sci. Comput. 14, 1993]
///
/// The structure is another's (CHOLMOD's analysis); this computes and holds the numbers. Left-looking: a supernode
/// collects what each earlier one that reaches it owes it, one product of dense blocks each, and is then factorized by
/// itself. Does the same operations as CHOLMOD's own numeric phase (version 3.0.14), in 0.3 to 0.9 of its time: contact
/// problems have thousands of small supernodes, and there that one spends more on OpenMP regions and bookkeeping around
/// the products than on the products.
///
/// Runs on the calling thread as far as the BLAS does. Factorize and Solve allocate nothing. Internal to solvers/; one
/// object serves one thread at a time.
class SupernodalFactor {
 public:
  /// n columns in m supernodes. The arrays are not owned and must stay.
  struct Structure {
    int n = 0;
    int supernodes = 0;
    const int* first_column = nullptr;  ///< m + 1
    const int* row_start = nullptr;     ///< m + 1: where a supernode's rows begin in `rows`
    const int* value_start = nullptr;   ///< m + 1: where its panel begins among the values
    const int* rows = nullptr;          ///< of every supernode, ascending; its own columns first
    std::size_t values = 0;             ///< entries of all panels
    std::size_t largest_update = 0;     ///< at least the entries of any product that one supernode owes another
    const int* order = nullptr;         ///< order[k] is the row of the given matrix that is eliminated k-th
  };

  SupernodalFactor() = default;

  /// @param starts, rows  lower triangle of the given matrix by columns, any order within a column
  /// O(its entries + size of L), allocates.
  void Prepare(const Structure& structure, const int* starts, const int* rows);
  /// Frees everything.
  void Clear() { *this = {}; }
  bool ready() const { return structure_.n > 0; }

  /// @param values  of the given matrix, in the order of Prepare's `rows`
  /// @returns false at a pivot that is not positive
  bool Factorize(const double* values);
  /// x = A^-1 x.
  void Solve(double* x);

 private:
  struct Panel {
    double* values = nullptr;
    const int* rows = nullptr;
    int first = 0;
    int columns = 0;
    int height = 0;  // rows; leading dimension of `values`
  };

  Panel PanelOf(int supernode);
  void Scatter(const Panel& panel, const double* values);
  void Collect(const Panel& from, int begin, const Panel& to, int inner, int outer);
  void Multiply(const double* block, const Panel& from, int inner, int outer);
  void Enqueue(int supernode, int at_row);
  void SolveSmall(const Panel& panel, double* own);
  void SolveSmallTransposed(const Panel& panel, double* own);

  Structure structure_;
  std::vector<int> starts_, rows_, source_;  // the matrix in elimination order; source_ empty: it was given so
  std::vector<int> supernode_of_;            // by column
  std::vector<int> head_, next_, reached_;   // lists of supernodes by whom they owe next, and their first row owed
  std::vector<int> place_, target_;
  std::vector<double> l_, update_, x_, gathered_;
};

}  // namespace lcpbench
