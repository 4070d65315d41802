#pragma once

#include <optional>
#include <string>

#include "solvers/io/contact_rows.h"
#include "solvers/lcp/problem.h"

namespace lcpbench {

// HDF5 files of the Friction Contact Library's local problems (group fclib_local, FCLib 3.1, fclib.h there):
//
//   u = W r + V l + q,   V^T r + R l + s = 0,   every contact's u and r in the cones of its friction coefficient mu,
//
// u, r of spacedim (2 or 3) rows per contact, the first of them normal. Contacts are our unilateral rows and, where mu
// is not 0, friction rows; l are the forces of bilateral rows: R = A_BB, V = A_CB, s = b_B, W and q hold A_CC and b_C.
// With mu = 0 the cones say that r is normal and 0 <= r_N, u_N, r_N u_N = 0. Global problems (group
// fclib_global) are read where M is diagonal, and not written:
//
//   M v = H r + G l + f, u = H^T v + w, G^T v + b = 0:   J = (H G)^T, inverse masses 1 / M, b = J M^-1 f + (w, b).
//
// Where r_T = 0, tangential columns act on nothing, and tangential rows give nothing but u_T, which nothing asks for.
// So tangential entries of contacts of mu = 0 are written as none, and passed over by the reader, which loses nothing
// of the forces.
//
// The group lcpbench beside it, which fclib passes over, keeps what the format has no place for: the problem's id, for
// every contact (its normal, then its tangent) and then every bilateral row its row in the problem (row_order), and
// where there are factors J and inverse_mass, which then win over W, V and R. Matrices are {nzmax, m, n, nz, p, i, x}
// as in fclib.h.

/// What the list p of triplets has. fclib.h says their rows, Siconos writes their columns.
enum class FclibTriplets {
  /// What the ranges of the indices allow, in one matrix of the file at least. Refused where they allow both and the
  /// problem is not the same either way.
  kByRanges,
  kRowsFirst,    ///< p has the rows
  kColumnsFirst  ///< p has the columns
};

/// How a file is read where the format leaves it open.
struct FclibOptions {
  FclibTriplets triplets = FclibTriplets::kByRanges;  ///< what p is
  TangentRows tangents = TangentRows::kOne;           ///< what is read of problems with friction
};

/// What such a file holds.
struct FclibProblem {
  LcpProblem problem;  ///< without bounded and sliding rows
  /// From the group solution: r of the rows that were read and l, none where one of them was never written. Judged by
  /// nobody.
  std::optional<Eigen::VectorXd> f;
};

/// Matrices as triplets, compressed columns or rows; entries of one place add up. Without the group lcpbench contacts
/// come first, and the id is the file's name without its extension. Read by a child process, see hdf5_file.h: memory is
/// in proportion to the file, whatever it promises.
/// @throws InputError naming file, dataset, what was expected and what was found: no such file, a dataset missing or of
/// another type, sizes that are negative or do not fit each other, a matrix W or R that is not square, indices outside,
/// what is not finite, mu < 0, or > 0 of contacts with two tangents (TangentRows), an invalid row order, triplets that
/// can be read both ways, M that is not diagonal
FclibProblem ReadFclibProblem(const std::string& path, const FclibOptions& options = {});

/// spacedim 2, matrices in compressed columns with all stored entries. Read back bit for bit; a dense problem as a
/// sparse one. Not for several threads at once.
/// @throws InputError for bounded and sliding rows, several friction rows of a contact or such of mu = 0, where A_BC is
/// not A_CB^T bit for bit, where the product of factors overflows, for more rows than the format counts, and where the
/// file cannot be written
void WriteFclibProblem(const LcpProblem& problem, const std::string& path);

}  // namespace lcpbench
