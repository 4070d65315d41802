#include "solvers/io/fclib_file.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <map>
#include <numeric>
#include <utility>
#include <vector>

#include "solvers/io/hdf5_file.h"
#include "solvers/io/same_bits.h"
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
constexpr char kId[] = "/lcpbench/id";
constexpr char kRowOrder[] = "/lcpbench/row_order";
constexpr char kJ[] = "/lcpbench/J";
constexpr char kInverseMass[] = "/lcpbench/inverse_mass";

using Entry = Eigen::Triplet<double, int>;

Hdf5Datasets AllDatasets() {
  Hdf5Datasets wanted{{kId, std::string()}};
  for (const std::string matrix : {kW, kV, kR, kJ}) {
    for (const char* part : {"/nzmax", "/m", "/n", "/nz", "/p", "/i"}) {
      wanted.emplace_back(matrix + part, std::vector<int>());
    }
    wanted.emplace_back(matrix + "/x", std::vector<double>());
  }
  for (const char* integers : {kDimension, kRowOrder}) wanted.emplace_back(integers, std::vector<int>());
  for (const char* reals : {kQ, kMu, kS, kNormalForces, kBilateralForces, kInverseMass}) {
    wanted.emplace_back(reals, std::vector<double>());
  }
  return wanted;
}

// The datasets of one file, and what is wrong with them.
class File {
 public:
  explicit File(const std::string& path) : path_(path) {
    for (auto& [name, values] : ReadHdf5(path, AllDatasets())) datasets_.emplace(name, std::move(values));
  }

  [[noreturn]] void Reject(const std::string& place, const std::string& expected, const std::string& found) const {
    throw InputError(path_ + ": " + place + ": expected " + expected + ", found " + found);
  }

  bool Has(const std::string& name) const { return datasets_.count(name) > 0; }
  const std::string& Text(const std::string& name) const { return std::get<std::string>(datasets_.at(name)); }
  const std::vector<int>& Integers(const std::string& name) const {
    return std::get<std::vector<int>>(Find(name, "a dataset of integers"));
  }
  int Integer(const std::string& name, int least, int most) const {
    const std::vector<int>& values = Integers(name);
    const std::string expected = "one number from " + std::to_string(least) + " to " + std::to_string(most);
    if (values.size() != 1) Reject(name, expected, std::to_string(values.size()) + " numbers");
    if (values[0] < least || values[0] > most) Reject(name, expected, std::to_string(values[0]));
    return values[0];
  }
  // Finite ones, `count` where that is known.
  const std::vector<double>& Reals(const std::string& name, std::optional<std::int64_t> count = std::nullopt) const {
    const auto& values = std::get<std::vector<double>>(Find(name, "a dataset of numbers"));
    for (size_t k = 0; k < values.size(); ++k) {
      if (std::isfinite(values[k])) continue;
      Reject(name, "finite numbers", std::to_string(values[k]) + " at " + std::to_string(k));
    }
    if (count) RequireCount(name, values.size(), *count);
    return values;
  }
  void RequireCount(const std::string& name, size_t found, std::int64_t expected) const {
    if (static_cast<std::int64_t>(found) == expected) return;
    Reject(name, std::to_string(expected) + " numbers", std::to_string(found));
  }

 private:
  const Hdf5Dataset& Find(const std::string& name, const char* expected) const {
    const auto found = datasets_.find(name);
    if (found == datasets_.end()) Reject(name, expected, "none");
    return found->second;
  }

  std::string path_;
  std::map<std::string, Hdf5Dataset> datasets_;
};

// A matrix as its entries: its sizes are promises until something of that length stands beside them.
struct Matrix {
  int rows = 0;
  int columns = 0;
  std::vector<Entry> entries;
};

void RequireIndex(const File& file, const std::string& name, int index, int end) {
  if (index >= 0 && index < end) return;
  file.Reject(name, "indices from 0 to " + std::to_string(end - 1), std::to_string(index));
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
    for (size_t k = 0; k < x.size(); ++k) {
      RequireIndex(file, p_name, p[k], matrix.rows);
      RequireIndex(file, i_name, i[k], matrix.columns);
      matrix.entries.emplace_back(p[k], i[k], x[k]);
    }
    return matrix;
  }
  const bool by_columns = form == kCompressedColumns;
  const int outer = by_columns ? matrix.columns : matrix.rows;
  file.RequireCount(p_name, p.size(), std::int64_t{outer} + 1);
  const int inner = by_columns ? matrix.rows : matrix.columns;
  int last = 0;
  for (size_t k = 0; k < p.size(); last = p[k++]) {
    const int most = k == 0 ? 0 : places;
    if (p[k] < last || p[k] > most) {
      file.Reject(p_name, "a place from " + std::to_string(last) + " to " + std::to_string(most),
                  std::to_string(p[k]) + " at " + std::to_string(k));
    }
    for (int e = last; e < p[k]; ++e) {
      const int a = static_cast<int>(k) - 1, b = i[static_cast<size_t>(e)];
      RequireIndex(file, i_name, b, inner);
      matrix.entries.emplace_back(by_columns ? b : a, by_columns ? a : b, x[static_cast<size_t>(e)]);
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
  std::iota(rows.begin(), rows.end(), 0);
  if (!file.Has(kRowOrder)) return rows;
  const std::vector<int>& given = file.Integers(kRowOrder);
  file.RequireCount(kRowOrder, given.size(), n);
  for (const int row : given) RequireIndex(file, kRowOrder, row, n);
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
  // The row of the problem; -1 for a tangential one.
  const auto of_contact = [&](int row) {
    return row % local.dimension == 0 ? local.contact_rows[static_cast<size_t>(row / local.dimension)] : -1;
  };
  const auto of_bilateral = [&](int row) { return local.bilateral_rows[static_cast<size_t>(row)]; };
  std::vector<Entry> entries;
  const auto add = [&](const Matrix& part, auto row_of, auto column_of, bool mirrored) {
    for (const Entry& entry : part.entries) {
      const int row = row_of(entry.row()), column = column_of(entry.col());
      if (row < 0 || column < 0) continue;
      entries.emplace_back(row, column, entry.value());
      if (mirrored) entries.emplace_back(column, row, entry.value());
    }
  };
  add(local.W, of_contact, of_contact, false);
  add(local.V, of_contact, of_bilateral, true);
  add(local.R, of_bilateral, of_bilateral, false);
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
  RowBounds bounds = RowBounds::WithBilateralRows(n, {local.bilateral_rows.begin(), local.bilateral_rows.end()});
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

// In compressed columns or rows, as Eigen has it.
template <int order>
void AddMatrix(const Eigen::SparseMatrix<double, order, int>& matrix, const std::string& name, Hdf5Datasets* file) {
  const auto add = [&](const char* part, auto values) { file->emplace_back(name + part, std::move(values)); };
  const auto count = static_cast<int>(matrix.nonZeros());
  const int *const p = matrix.outerIndexPtr(), *const i = matrix.innerIndexPtr();
  add("/nzmax", std::vector{count});
  add("/m", std::vector{static_cast<int>(matrix.rows())});
  add("/n", std::vector{static_cast<int>(matrix.cols())});
  add("/nz", std::vector{order == Eigen::ColMajor ? kCompressedColumns : kCompressedRows});
  add("/p", std::vector(p, p + matrix.outerSize() + 1));
  add("/i", std::vector(i, i + count));
  add("/x", std::vector(matrix.valuePtr(), matrix.valuePtr() + count));
}

using ByColumns = Eigen::SparseMatrix<double, Eigen::ColMajor, int>;

struct Blocks {
  ByColumns W, V, R;
};

// @param place  of every row among those of its kind
Blocks Divide(const LcpProblem& problem, const std::vector<int>& place) {
  const auto bilateral = static_cast<Index>(problem.bilateral_rows().size());
  const Index contact_rows = kLeastDimension * (problem.size() - bilateral);
  const auto index_of = [&](Index row) {
    return (problem.is_bilateral(row) ? 1 : kLeastDimension) * place[static_cast<size_t>(row)];
  };
  std::vector<Entry> entries[2][2];  // by whether the row and the column are bilateral
  const SparseMatrix& A = problem.SparseA();
  for (Index i = 0; i < A.rows(); ++i) {
    for (SparseMatrix::InnerIterator it(A, i); it; ++it) {
      std::vector<Entry>& part = entries[problem.is_bilateral(i) ? 1 : 0][problem.is_bilateral(it.col()) ? 1 : 0];
      part.emplace_back(index_of(i), index_of(it.col()), it.value());
    }
  }
  const auto make = [](Index rows, Index columns, const std::vector<Entry>& part) {
    ByColumns matrix(rows, columns);
    matrix.setFromTriplets(part.begin(), part.end());
    return matrix;
  };
  Blocks blocks{make(contact_rows, contact_rows, entries[0][0]), make(contact_rows, bilateral, entries[0][1]),
                make(bilateral, bilateral, entries[1][1])};
  if (SameBits(blocks.V, ByColumns(make(bilateral, contact_rows, entries[1][0]).transpose()))) return blocks;
  throw InputError("problem '" + problem.id() +
                   "': expected the same entries between contacts and bilateral rows in both triangles of A, as FCLib "
                   "keeps one of them, found others");
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
  const Index n = problem.size();
  if (n > kMost / kLeastDimension) {
    throw InputError("problem '" + problem.id() + "': expected at most " + std::to_string(kMost / kLeastDimension) +
                     " rows, found " + std::to_string(n));
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
  std::vector<double> q(static_cast<size_t>(blocks.W.rows()), 0.0), s;
  for (size_t k = 0; k < rows.size(); ++k) {
    const double b = problem.b()[rows[k]];
    if (kLeastDimension * k < q.size()) {
      q[kLeastDimension * k] = b;
    } else {
      s.push_back(b);
    }
  }

  Hdf5Datasets file{{kDimension, std::vector{kLeastDimension}}};
  AddMatrix(blocks.W, kW, &file);
  if (!s.empty()) {
    AddMatrix(blocks.V, kV, &file);
    AddMatrix(blocks.R, kR, &file);
    file.emplace_back(kS, std::move(s));
  }
  file.emplace_back(kMu, std::vector<double>(q.size() / kLeastDimension, 0.0));
  file.emplace_back(kQ, std::move(q));
  file.emplace_back("/fclib_local/info/title", problem.id());
  file.emplace_back("/fclib_local/info/description",
                    std::string("frictionless: a linear complementarity problem in the normal rows"));
  file.emplace_back(kId, problem.id());
  file.emplace_back(kRowOrder, std::move(rows));
  if (problem.has_factors()) {
    AddMatrix(problem.J(), kJ, &file);
    const Eigen::VectorXd& masses = problem.inverse_mass();
    file.emplace_back(kInverseMass, std::vector<double>(masses.begin(), masses.end()));
  }
  WriteHdf5(path, file);
}

}  // namespace lcpbench
