#pragma once

#include <Eigen/SparseCore>
#include <istream>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "solvers/lcp/problem.h"

namespace lcpbench {

/// A real matrix as a Matrix Market file holds it. [Boisvert, Pozo, Remington, The Matrix Market exchange formats, NIST
/// report 5935, 1996]
struct MarketMatrix {
  Index rows = 0;             ///< as the header says
  Index columns = 0;          ///< as the header says
  bool is_array = false;      ///< every entry is given, else coordinates; zeros that are given stay entries
  bool is_symmetric = false;  ///< the file has the lower triangle; `entries` has both
  std::vector<Eigen::Triplet<double, int>> entries;  ///< of an array in the order of the file: by columns

  /// With the entries that are stored, also those that are 0.
  SparseMatrix ToSparse() const;
  /// A matrix of one column, or one row, as a vector. @throws InputError with `where` for another shape
  Eigen::VectorXd ToVector(const std::string& where) const;
};

/// Reads `matrix coordinate|array real|integer general|symmetric`. Memory is in proportion to what the file holds,
/// whatever its header promises.
/// @param name  of the file, for error texts
/// @throws InputError naming file, line, what was expected and what was found: another header, a size that is negative
/// or too large, indices outside, an entry given twice or above the diagonal of a symmetric matrix, numbers that are
/// not finite, too few entries or too many
MarketMatrix ReadMarketMatrix(std::istream& input, const std::string& name);

/// Numbers of 17 significant digits, so that reading gives the same bits. Symmetric where the matrix is, bit for bit.
void WriteMarketMatrix(const SparseMatrix& matrix, std::ostream& output);
/// As an array of one column, of 17 significant digits.
void WriteMarketVector(const Eigen::VectorXd& vector, std::ostream& output);

/// What the files of one problem hold.
struct MarketProblem {
  LcpProblem problem;                ///< by factors where they are there
  std::optional<Eigen::VectorXd> x;  ///< f from the files; not judged
};

/// A problem in files named as those of the SuiteSparse collection: `name.mtx` holds A, `name_b.mtx` b, and where they
/// are there `name_x.mtx` a known f, `name_J.mtx` and `name_invM.mtx` the factors, which win over A, and
/// `name_bilateral.mtx` the numbers of bilateral rows, from 1.
/// @param path  of name.mtx, which may be absent where the factors are there; where it ends in .MTX or .mtx.gz so do
/// the others
/// @throws InputError as ReadMarketMatrix, and where the files do not fit each other
MarketProblem ReadMarketProblem(const std::string& path);

/// Writes all files but name_x.mtx; J, invM and bilateral rows where the problem has them, and removes what an earlier
/// problem of this name left. The old files stay until all new ones are written beside them; a process that is killed
/// in between leaves a problem without b, which ReadMarketProblem refuses. @throws InputError for friction and bounded
/// rows, and as TextOutput
void WriteMarketProblem(const LcpProblem& problem, const std::string& path);

}  // namespace lcpbench
