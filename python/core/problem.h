#pragma once

#include "python/core/arrays.h"
#include "solvers/lcp/compressed_rows.h"
#include "solvers/lcp/problem.h"

namespace lcpbench::python {

/// The arguments that describe a problem, as a caller names them; None where there is nothing.
struct ProblemArguments {
  nb::handle A;             ///< n x n: an array, or a SciPy sparse matrix with both triangles
  nb::handle b;             ///< n
  nb::handle J;             ///< n x columns: an array, or a SciPy sparse matrix
  nb::handle inverse_mass;  ///< columns
  nb::handle bilateral;     ///< n bool, or indices of rows
  nb::handle friction;      ///< row, normal, mu and perhaps slip: members of an object, or of a dict
  nb::handle bounded;       ///< row, lower and upper, likewise
};

/// The problem that a caller describes, in the caller's arrays.
class GivenProblem {
 public:
  /// @throws InputError naming the argument
  explicit GivenProblem(const ProblemArguments& arguments);

  /// The problem; needs no GIL. Each array is copied once where its order allows.
  /// @param facts  what the caller has proved about A
  /// @throws InputError naming the argument, and MemoryRefusal
  LcpProblem Make(const MatrixFacts& facts = {}) const;

  /// A matrix alone: an array, without its zeros, or a SciPy sparse matrix.
  /// @throws InputError naming the argument
  static SparseMatrix ReadSparseMatrix(nb::handle matrix, const char* name);

 private:
  GivenProblem() = default;
  struct Sparse {
    Vector<std::int32_t> starts, indices;
    Vector<double> values;
    CompressedArrays arrays;
  };
  static Sparse ReadSparse(nb::handle value, const char* name);
  SparseMatrix MakeSparse(const char* name) const;
  void TakeMatrix(nb::handle matrix, const char* name);
  SparseMatrix MakeFactor(const char* name) const;

  MatrixForm form_ = MatrixForm::kDense;
  std::optional<Sparse> sparse_;      // of A, or of J
  std::optional<DenseMatrix> dense_;  // likewise
  Vector<double> b_, inverse_mass_;
  RowBounds bounds_;
};

/// Friction and bounded rows.
/// @throws InputError naming the argument and the row
std::vector<FrictionRow> ReadFriction(nb::handle friction);
std::vector<BoundedRow> ReadBounded(nb::handle bounded);  ///< as ReadFriction

/// The problem, A replaced by (A + A^T) / 2 where `symmetrize` is a number: the most asymmetry that it may have
/// (LcpProblem::Asymmetry). Needs no GIL.
/// @param symmetrize  ReadSymmetrize of the argument
/// @param facts       of the new A
/// @throws InputError naming the argument, where the asymmetry is larger
LcpProblem WithSymmetry(LcpProblem problem, double symmetrize, const MatrixFacts& facts = {});
/// The argument; -1 for None.
double ReadSymmetrize(nb::handle symmetrize);

/// The class Problem.
void BindProblem(nb::module_& module);

}  // namespace lcpbench::python
