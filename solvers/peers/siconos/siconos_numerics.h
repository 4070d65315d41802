#pragma once

#include <NumericsMatrix.h>
#include <SolverOptions.h>
#include <SparseBlockMatrix.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <string_view>
#include <vector>

#include "solvers/lcp/problem.h"
#include "solvers/lcp/settings.h"
#include "solvers/lcp/solver.h"

namespace lcpbench {

/// A problem in Siconos's form, w = M z + q, over variables of its own: M = S A S, q = S b, f = S z, where row i of S
/// has one factor, in the column of the row of A that variable i stands for. A base of what knows which variables a
/// problem has. Memory, of n^2 numbers or as many as the blocks have, stays for the next problem.
class SiconosMatrix {
 public:
  /// How M is stored: column by column, or in sparse blocks.
  enum class Storage { kDense, kBlocks };

  SiconosMatrix() = default;
  SiconosMatrix(const SiconosMatrix&) = delete;
  SiconosMatrix& operator=(const SiconosMatrix&) = delete;

  /// The number of variables n.
  Index size() const { return static_cast<Index>(variables_.size()); }
  /// Stored entries of M.
  std::size_t entries() const { return values_.size(); }
  /// q = scale S b, for any b of a problem with the same matrix.
  void SetB(const Eigen::VectorXd& b, double scale = 1);
  /// *f = scale S z.
  void SetForces(const Eigen::VectorXd& z, Eigen::VectorXd* f, double scale = 1) const;

 protected:
  struct Variable {
    Index row = 0;      ///< of A; variables of one row follow each other in blocks
    double factor = 1;  ///< 0: a dummy, coupled to nothing, where q is 0
    double dummy = 1;   ///< what M has there
  };

  ~SiconosMatrix() { Clear(); }
  void Clear();
  /// Fills values_ with the blocks of M, whose ends are in ends_. O(nnz of A)
  /// @param A  rows and columns without a variable have no entries
  void FillBlocks(const SparseMatrix& A);
  /// matrix() of values_, once they are filled.
  void Finish(Storage storage);
  NumericsMatrix* matrix() { return matrix_.get(); }
  double* q() { return q_.data(); }

  std::vector<Variable> variables_;
  std::vector<double> values_;
  std::vector<unsigned int> ends_;  ///< of blocks of variables

 private:
  static void FreeShell(NumericsMatrix* matrix);

  std::vector<double> q_;
  // The compressed rows of blocks.
  std::vector<std::size_t> row_starts_;
  std::vector<std::size_t> columns_;
  std::vector<double*> blocks_;
  SparseBlockStructuredMatrix sparse_{};
  std::unique_ptr<NumericsMatrix, void (*)(NumericsMatrix*)> matrix_{nullptr, &FreeShell};
};

/// Options of one of Siconos's solvers. Kept, as a user keeps them, unless a method has hung something of the problem
/// before on them. Numbers are set anew, since methods write to them.
class SiconosOptions {
 public:
  /// As the library makes them. @param solver  the same in every call
  SolverOptions* Fresh(int solver);
  /// Those of the last Fresh.
  SolverOptions& get() { return *own_; }

 private:
  std::unique_ptr<SolverOptions, void (*)(SolverOptions*)> own_{nullptr, &solver_options_delete};
  std::vector<int> integers_;  // of own_, as the library makes them
  std::vector<double> reals_;
};

/// In how many sweeps or steps a solve is asked for. The clock, read in between, tells how many the next call gets.
struct SiconosPortions {
  std::int64_t most = 0;   ///< of all; of one call where it begins anew
  std::int64_t first = 0;  ///< of the first call
  bool counts = true;      ///< whether the method tells how many it made
  /// Whether a call goes on from z. Else it begins anew, and the last one gets what is left of the time.
  bool continues = true;
  double growth = 2;  ///< so many times the last portion at most, but for the last call
};

/// What takes 5 to 20 ms, by an estimate. @param cost_power  what one costs, as a power of n of a dense problem
std::int64_t FirstPortion(const SiconosMatrix& matrix, int cost_power);

/// Calls the driver until it solves, gives up or meets a limit, and notes status, iterations and detail.
/// @param call  a driver on *z and *own; returns its code, 0 for solved
void SolveInPortions(const SiconosPortions& portions, const Deadline& deadline, const std::function<int()>& call,
                     SolverOptions* own, Eigen::VectorXd* z, LcpResult* result);

/// Solvers of contacts with friction. @throws InputError for impossible settings
std::unique_ptr<LcpSolver> MakeSiconosContacts(std::string_view key, SettingsReader* reader);

}  // namespace lcpbench
