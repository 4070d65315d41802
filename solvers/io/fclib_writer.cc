#include <cstring>
#include <string>
#include <vector>

#include "solvers/io/fclib_file.h"
#include "solvers/io/fclib_layout.h"
#include "solvers/io/hdf5_writer.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

using namespace fclib_layout;

std::string Part(const char* matrix, const char* part) { return std::string(matrix) + part; }

// A matrix in compressed columns or rows.
struct Compressed {
  int rows = 0;
  int columns = 0;
  int form = kCompressedColumns;
  std::vector<int> p{0};
  std::vector<int> i;
  std::vector<double> x;

  void Add(Index index, double value) {
    i.push_back(static_cast<int>(index));
    x.push_back(value);
  }
  void EndOuter() { p.push_back(static_cast<int>(i.size())); }
};

void WriteMatrix(const Compressed& matrix, const char* name, Hdf5Writer* file) {
  file->AddGroup(name);
  file->AddIntegers(Part(name, "/nzmax"), {static_cast<int>(matrix.x.size())});
  file->AddIntegers(Part(name, "/m"), {matrix.rows});
  file->AddIntegers(Part(name, "/n"), {matrix.columns});
  file->AddIntegers(Part(name, "/nz"), {matrix.form});
  file->AddIntegers(Part(name, "/p"), matrix.p);
  file->AddIntegers(Part(name, "/i"), matrix.i);
  file->AddReals(Part(name, "/x"), matrix.x.data(), matrix.x.size());
}

struct Blocks {
  Compressed W, V, R;
  Compressed V_transposed;  // A_BC by rows, for comparison
};

// @param place  of every row among those of its kind
Blocks Divide(const LcpProblem& problem, const std::vector<int>& place) {
  using ByColumns = Eigen::SparseMatrix<double, Eigen::ColMajor, int>;
  const SparseMatrix& A = problem.SparseA();
  const ByColumns columns = A;
  const auto bilateral = static_cast<int>(problem.bilateral_rows().size());
  const int contact_rows = kLeastDimension * (static_cast<int>(problem.size()) - bilateral);
  Blocks blocks;
  blocks.W.rows = blocks.W.columns = blocks.V.rows = contact_rows;
  blocks.V.columns = blocks.R.rows = blocks.R.columns = bilateral;
  const auto index_of = [&](Index row) {
    return (problem.is_bilateral(row) ? 1 : kLeastDimension) * place[static_cast<size_t>(row)];
  };
  for (Index j = 0; j < columns.cols(); ++j) {
    if (!problem.is_bilateral(j)) {
      for (ByColumns::InnerIterator it(columns, j); it; ++it) {
        if (!problem.is_bilateral(it.row())) blocks.W.Add(index_of(it.row()), it.value());
      }
      for (int row = 0; row < kLeastDimension; ++row) blocks.W.EndOuter();  // tangential columns are empty
      continue;
    }
    for (ByColumns::InnerIterator it(columns, j); it; ++it) {
      (problem.is_bilateral(it.row()) ? blocks.R : blocks.V).Add(index_of(it.row()), it.value());
    }
    for (SparseMatrix::InnerIterator it(A, j); it; ++it) {
      if (!problem.is_bilateral(it.col())) blocks.V_transposed.Add(index_of(it.col()), it.value());
    }
    blocks.R.EndOuter();
    blocks.V.EndOuter();
    blocks.V_transposed.EndOuter();
  }
  return blocks;
}

Compressed RowsOf(const SparseMatrix& matrix) {
  Compressed rows;
  rows.rows = static_cast<int>(matrix.rows());
  rows.columns = static_cast<int>(matrix.cols());
  rows.form = kCompressedRows;
  for (Index i = 0; i < matrix.rows(); ++i) {
    for (SparseMatrix::InnerIterator it(matrix, i); it; ++it) rows.Add(it.col(), it.value());
    rows.EndOuter();
  }
  return rows;
}

void RequireSymmetricCoupling(const Blocks& blocks, const std::string& id) {
  const Compressed &V = blocks.V, &other = blocks.V_transposed;
  if (V.p == other.p && V.i == other.i &&
      (V.x.empty() || std::memcmp(V.x.data(), other.x.data(), sizeof(double) * V.x.size()) == 0)) {
    return;
  }
  throw InputError("problem '" + id +
                   "': expected the same entries between contacts and bilateral rows in both triangles of A, as FCLib "
                   "keeps one of them, found others");
}

void WriteOwnGroup(const LcpProblem& problem, const std::vector<int>& rows, Hdf5Writer* file) {
  file->AddGroup(kOwnGroup);
  file->AddText(kId, problem.id());
  file->AddIntegers(kRowOrder, rows);
  if (!problem.has_factors()) return;
  WriteMatrix(RowsOf(problem.J()), kJ, file);
  const Eigen::VectorXd& masses = problem.inverse_mass();
  file->AddReals(kInverseMass, masses.data(), static_cast<size_t>(masses.size()));
}

}  // namespace

void WriteFclibProblem(const LcpProblem& problem, const std::string& path) {
  if (!problem.has_standard_bounds()) {
    throw InputError("problem '" + problem.id() + "': expected unilateral and bilateral rows only, found other bounds");
  }
  const Index n = problem.size();
  if (n > kMost / kLeastDimension) {
    throw InputError("problem '" + problem.id() + "': expected at most " + std::to_string(kMost / kLeastDimension) +
                     " rows, found " + std::to_string(n));
  }
  const SparseMatrix& A = problem.SparseA();
  if (!Eigen::Map<const Eigen::VectorXd>(A.valuePtr(), A.nonZeros()).allFinite()) {
    throw InputError("problem '" + problem.id() + "': expected factors whose product is finite, found an overflow");
  }
  // Contacts first; and where a row stands among those of its kind.
  std::vector<int> rows, place(static_cast<size_t>(n));
  for (const bool bilateral : {false, true}) {
    const size_t before = rows.size();
    for (Index row = 0; row < n; ++row) {
      if (problem.is_bilateral(row) != bilateral) continue;
      place[static_cast<size_t>(row)] = static_cast<int>(rows.size() - before);
      rows.push_back(static_cast<int>(row));
    }
  }
  const Blocks blocks = Divide(problem, place);
  RequireSymmetricCoupling(blocks, problem.id());
  std::vector<double> q(static_cast<size_t>(blocks.W.rows), 0.0), s;
  for (size_t k = 0; k < rows.size(); ++k) {
    const double b = problem.b()[rows[k]];
    if (kLeastDimension * k < q.size()) {
      q[kLeastDimension * k] = b;
    } else {
      s.push_back(b);
    }
  }

  Hdf5Writer file(path);
  file.AddGroup("/fclib_local");
  file.AddIntegers(kDimension, {kLeastDimension});
  WriteMatrix(blocks.W, kW, &file);
  if (!s.empty()) {
    WriteMatrix(blocks.V, kV, &file);
    WriteMatrix(blocks.R, kR, &file);
  }
  file.AddGroup("/fclib_local/vectors");
  const std::vector<double> mu(q.size() / kLeastDimension, 0.0);
  file.AddReals(kQ, q.data(), q.size());
  file.AddReals(kMu, mu.data(), mu.size());
  if (!s.empty()) file.AddReals(kS, s.data(), s.size());
  file.AddGroup("/fclib_local/info");
  file.AddText("/fclib_local/info/title", problem.id());
  file.AddText("/fclib_local/info/description", "frictionless: a linear complementarity problem in the normal rows");
  WriteOwnGroup(problem, rows, &file);
  file.Close();
}

}  // namespace lcpbench
