#include "solvers/io/fclib_file.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <limits>
#include <map>
#include <numeric>
#include <utility>
#include <vector>

#include "solvers/io/hdf5_file.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

// Where fclib's files keep what, and our own group beside.
constexpr int kMost = std::numeric_limits<int>::max() - 1;
constexpr int kCompressedColumns = -1;
constexpr int kCompressedRows = -2;
constexpr int kLeastDimension = 2;
constexpr int kMostDimension = 3;

constexpr char kDimension[] = "/fclib_local/spacedim";
constexpr char kW[] = "/fclib_local/W";
constexpr char kV[] = "/fclib_local/V";
constexpr char kR[] = "/fclib_local/R";
constexpr char kQ[] = "/fclib_local/vectors/q";
constexpr char kMu[] = "/fclib_local/vectors/mu";
constexpr char kS[] = "/fclib_local/vectors/s";
constexpr char kNormalForces[] = "/solution/r";
constexpr char kBilateralForces[] = "/solution/l";
constexpr char kOwnGroup[] = "/lcpbench";
constexpr char kId[] = "/lcpbench/id";
constexpr char kRowOrder[] = "/lcpbench/row_order";
constexpr char kJ[] = "/lcpbench/J";
constexpr char kInverseMass[] = "/lcpbench/inverse_mass";

using Entry = Eigen::Triplet<double, int>;

std::vector<Hdf5Request> AllRequests() {
  std::vector<Hdf5Request> requests;
  for (const std::string matrix : {kW, kV, kR, kJ}) {
    for (const char* part : {"/nzmax", "/m", "/n", "/nz", "/p", "/i"}) {
      requests.push_back({matrix + part, Hdf5Kind::kIntegers});
    }
    requests.push_back({matrix + "/x", Hdf5Kind::kReals});
  }
  for (const char* integers : {kDimension, kRowOrder}) requests.push_back({integers, Hdf5Kind::kIntegers});
  for (const char* reals : {kQ, kMu, kS, kNormalForces, kBilateralForces, kInverseMass}) {
    requests.push_back({reals, Hdf5Kind::kReals});
  }
  requests.push_back({kId, Hdf5Kind::kText});
  return requests;
}

// The datasets of one file, and what is wrong with them.
class File {
 public:
  explicit File(const std::string& path) : path_(path), datasets_(ReadHdf5(path, AllRequests())) {}

  [[noreturn]] void Reject(const std::string& place, const std::string& expected, const std::string& found) const {
    throw InputError(path_ + ": " + place + ": expected " + expected + ", found " + found);
  }

  bool Has(const std::string& name) const { return datasets_.count(name) > 0; }
  const std::string& Text(const std::string& name) const { return datasets_.at(name).text; }

  const std::vector<int>& Integers(const std::string& name) const {
    const auto found = datasets_.find(name);
    if (found == datasets_.end()) Reject(name, "a dataset of integers", "none");
    return found->second.integers;
  }
  int Integer(const std::string& name, int least, int most) const {
    const std::vector<int>& values = Integers(name);
    const std::string expected = "one number from " + std::to_string(least) + " to " + std::to_string(most);
    if (values.size() != 1) Reject(name, expected, std::to_string(values.size()) + " numbers");
    if (values[0] < least || values[0] > most) Reject(name, expected, std::to_string(values[0]));
    return values[0];
  }
  // Finite ones.
  const std::vector<double>& Reals(const std::string& name) const {
    const auto found = datasets_.find(name);
    if (found == datasets_.end()) Reject(name, "a dataset of numbers", "none");
    const std::vector<double>& values = found->second.reals;
    for (size_t k = 0; k < values.size(); ++k) {
      if (std::isfinite(values[k])) continue;
      Reject(name, "finite numbers", std::to_string(values[k]) + " at " + std::to_string(k));
    }
    return values;
  }
  const std::vector<double>& Reals(const std::string& name, std::int64_t count) const {
    const std::vector<double>& values = Reals(name);
    RequireCount(name, values.size(), count);
    return values;
  }
  void RequireCount(const std::string& name, size_t found, std::int64_t expected) const {
    if (static_cast<std::int64_t>(found) == expected) return;
    Reject(name, std::to_string(expected) + " numbers", std::to_string(found));
  }

 private:
  std::string path_;
  std::map<std::string, Hdf5Dataset> datasets_;
};

// A matrix as its entries: its sizes are promises until something of that length stands beside them.
struct Matrix {
  int rows = 0;
  int columns = 0;
  std::vector<Entry> entries;
};

void RequireIndices(const File& file, const std::string& name, const std::vector<int>& indices, int end) {
  for (const int index : indices) {
    if (index >= 0 && index < end) continue;
    file.Reject(name, "indices from 0 to " + std::to_string(end - 1), std::to_string(index));
  }
}

Matrix ReadMatrix(const File& file, const std::string& name) {
  Matrix matrix;
  matrix.rows = file.Integer(name + "/m", 0, kMost);
  matrix.columns = file.Integer(name + "/n", 0, kMost);
  const int places = file.Integer(name + "/nzmax", 0, kMost);
  const int form = file.Integer(name + "/nz", kCompressedRows, kMost);
  const std::string p_name = name + "/p", i_name = name + "/i";
  const std::vector<int>& p = file.Integers(p_name);
  const std::vector<int>& i = file.Integers(i_name);
  const std::vector<double>& x = file.Reals(name + "/x", form >= 0 ? form : places);
  file.RequireCount(i_name, i.size(), form >= 0 ? form : places);
  if (form >= 0) {
    file.RequireCount(p_name, p.size(), form);
    RequireIndices(file, p_name, p, matrix.rows);
    RequireIndices(file, i_name, i, matrix.columns);
    for (size_t k = 0; k < x.size(); ++k) matrix.entries.emplace_back(p[k], i[k], x[k]);
    return matrix;
  }
  const bool by_columns = form == kCompressedColumns;
  const int outer = by_columns ? matrix.columns : matrix.rows;
  const int inner = by_columns ? matrix.rows : matrix.columns;
  file.RequireCount(p_name, p.size(), std::int64_t{outer} + 1);
  int last = 0;
  for (size_t k = 0; k < p.size(); ++k) {
    const int least = last, most = k == 0 ? 0 : places;
    if (p[k] < least || p[k] > most) {
      file.Reject(p_name, "a place from " + std::to_string(least) + " to " + std::to_string(most),
                  std::to_string(p[k]) + " at " + std::to_string(k));
    }
    last = p[k];
  }
  for (int a = 0; a < outer; ++a) {
    for (auto k = static_cast<size_t>(p[static_cast<size_t>(a)]);
         k < static_cast<size_t>(p[static_cast<size_t>(a) + 1]); ++k) {
      if (i[k] < 0 || i[k] >= inner) {
        file.Reject(i_name, "indices from 0 to " + std::to_string(inner - 1), std::to_string(i[k]));
      }
      matrix.entries.emplace_back(by_columns ? i[k] : a, by_columns ? a : i[k], x[k]);
    }
  }
  return matrix;
}

void RequireShape(const File& file, const std::string& name, const Matrix& matrix, int rows, int columns) {
  if (matrix.rows == rows && matrix.columns == columns) return;
  file.Reject(name, std::to_string(rows) + " x " + std::to_string(columns) + " entries",
              std::to_string(matrix.rows) + " x " + std::to_string(matrix.columns));
}

SparseMatrix ToSparse(const Matrix& matrix) {
  SparseMatrix sparse(matrix.rows, matrix.columns);
  sparse.setFromTriplets(matrix.entries.begin(), matrix.entries.end());
  return sparse;
}

// What the file holds, in its own order.
struct LocalProblem {
  int dimension = kLeastDimension;
  Matrix W, V, R;
  std::vector<double> q, s;
  std::vector<int> contact_rows, bilateral_rows;  // of our problem

  Index size() const { return static_cast<Index>(contact_rows.size() + bilateral_rows.size()); }
};

// For every contact, and then every bilateral row, its row in the problem.
std::vector<int> ReadRowOrder(const File& file, int n) {
  std::vector<int> rows(static_cast<size_t>(n));
  for (int k = 0; k < n; ++k) rows[static_cast<size_t>(k)] = k;
  if (!file.Has(kRowOrder)) return rows;
  const std::vector<int>& given = file.Integers(kRowOrder);
  file.RequireCount(kRowOrder, given.size(), n);
  RequireIndices(file, kRowOrder, given, n);
  std::vector<int> sorted = given;
  std::sort(sorted.begin(), sorted.end());
  if (sorted != rows) file.Reject(kRowOrder, "every row once", "one twice");
  return given;
}

LocalProblem ReadLocal(const File& file) {
  LocalProblem local;
  local.dimension = file.Integer(kDimension, kLeastDimension, kMostDimension);
  local.W = ReadMatrix(file, kW);
  if (local.W.rows != local.W.columns || local.W.rows % local.dimension != 0) {
    file.Reject(kW, "a square matrix of " + std::to_string(local.dimension) + " rows for every contact",
                std::to_string(local.W.rows) + " x " + std::to_string(local.W.columns) + " entries");
  }
  const int contacts = local.W.rows / local.dimension;
  local.q = file.Reals(kQ, local.W.rows);
  for (const double mu : file.Reals(kMu, contacts)) {
    if (mu == 0) continue;
    file.Reject(kMu, "friction coefficients 0, others are not supported", std::to_string(mu));
  }
  int bilateral = 0;
  const std::string m = "/m";
  if (file.Has(kV + m) || file.Has(kR + m)) {
    local.R = ReadMatrix(file, kR);
    bilateral = local.R.rows;
    RequireShape(file, kR, local.R, bilateral, bilateral);
    local.s = file.Reals(kS, bilateral);
    local.V = ReadMatrix(file, kV);
    RequireShape(file, kV, local.V, local.W.rows, bilateral);
  }
  if (bilateral > kMost - contacts) {
    file.Reject(kR, "at most " + std::to_string(kMost) + " rows", std::to_string(bilateral) + " more");
  }
  const std::vector<int> rows = ReadRowOrder(file, contacts + bilateral);
  local.contact_rows.assign(rows.begin(), rows.begin() + contacts);
  local.bilateral_rows.assign(rows.begin() + contacts, rows.end());
  return local;
}

SparseMatrix AssembleA(const LocalProblem& local) {
  const int d = local.dimension;
  const auto is_normal = [d](int row) { return row % d == 0; };
  const auto contact_row = [&](int row) {
    return local.contact_rows[static_cast<size_t>(row) / static_cast<size_t>(d)];
  };
  const auto bilateral_row = [&](int row) { return local.bilateral_rows[static_cast<size_t>(row)]; };
  std::vector<Entry> entries;
  for (const Entry& entry : local.W.entries) {
    if (!is_normal(entry.row()) || !is_normal(entry.col())) continue;
    entries.emplace_back(contact_row(entry.row()), contact_row(entry.col()), entry.value());
  }
  for (const Entry& entry : local.V.entries) {
    if (!is_normal(entry.row())) continue;
    const int row = contact_row(entry.row()), column = bilateral_row(entry.col());
    entries.emplace_back(row, column, entry.value());
    entries.emplace_back(column, row, entry.value());
  }
  for (const Entry& entry : local.R.entries) {
    entries.emplace_back(bilateral_row(entry.row()), bilateral_row(entry.col()), entry.value());
  }
  SparseMatrix A(local.size(), local.size());
  A.setFromTriplets(entries.begin(), entries.end());
  return A;
}

// Of normal entries and those of bilateral rows, by the rows of the problem.
Eigen::VectorXd Merge(const LocalProblem& local, const std::vector<double>& of_contacts,
                      const std::vector<double>& of_bilateral) {
  Eigen::VectorXd merged(local.size());
  const auto dimension = static_cast<size_t>(local.dimension);
  for (size_t k = 0; k < local.contact_rows.size(); ++k) merged[local.contact_rows[k]] = of_contacts[dimension * k];
  for (size_t k = 0; k < local.bilateral_rows.size(); ++k) merged[local.bilateral_rows[k]] = of_bilateral[k];
  return merged;
}

LcpProblem ToProblem(const File& file, const LocalProblem& local, const std::string& id) {
  const Index n = local.size();
  const std::vector<Index> bilateral(local.bilateral_rows.begin(), local.bilateral_rows.end());
  RowBounds bounds = RowBounds::WithBilateralRows(n, bilateral);
  Eigen::VectorXd b = Merge(local, local.q, local.s);
  if (!file.Has(kJ + std::string("/m")) && !file.Has(kInverseMass)) {
    return LcpProblem::FromSparse(id, AssembleA(local), std::move(b), std::move(bounds));
  }
  const Matrix J = ReadMatrix(file, kJ);
  const std::vector<double>& inverse_mass = file.Reals(kInverseMass);
  RequireShape(file, kJ, J, static_cast<int>(n), static_cast<int>(std::min<size_t>(inverse_mass.size(), kMost)));
  Eigen::VectorXd masses = Eigen::Map<const Eigen::VectorXd>(inverse_mass.data(), J.columns);
  return LcpProblem::FromFactors(id, ToSparse(J), std::move(masses), std::move(b), std::move(bounds));
}

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

FclibProblem ReadFclibProblem(const std::string& path) {
  const File file(path);
  const LocalProblem local = ReadLocal(file);
  const std::string id = file.Has(kId) ? file.Text(kId) : std::filesystem::path(path).stem().string();
  std::optional<Eigen::VectorXd> f;
  if (file.Has(kNormalForces)) {
    const std::vector<double> none;
    const std::vector<double>& of_bilateral =
        local.s.empty() ? none : file.Reals(kBilateralForces, static_cast<std::int64_t>(local.s.size()));
    f = Merge(local, file.Reals(kNormalForces, local.W.rows), of_bilateral);
  }
  try {
    return {ToProblem(file, local, id), std::move(f)};
  } catch (const InputError& error) {  // a negative mass, or entries of one place whose sum overflows
    std::string what = error.what();
    if (!what.starts_with(path)) what = path + ": " + what;
    // An id may be any text, an error is one line.
    std::replace_if(
        what.begin(), what.end(), [](char c) { return c >= 0 && c < ' '; }, '?');
    throw InputError(what);
  }
}

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
