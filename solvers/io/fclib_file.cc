#include "solvers/io/fclib_file.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <numeric>
#include <utility>
#include <vector>

#include "solvers/io/file_ending.h"
#include "solvers/io/hdf5_file.h"
#include "solvers/io/same_bits.h"
#include "support/input_error.h"
#include "support/printable.h"

namespace lcpbench {
namespace {

// Where fclib's files keep what, and our own group beside.
constexpr int kMost = std::numeric_limits<int>::max() - 1;
constexpr int kCompressedColumns = -1;
constexpr int kCompressedRows = -2;
constexpr int kLeastDimension = 2;
constexpr int kMostDimension = 3;

constexpr char kLocal[] = "/fclib_local";
constexpr char kGlobal[] = "/fclib_global";
constexpr char kDimension[] = "/fclib_local/spacedim";
constexpr char kW[] = "/fclib_local/W";
constexpr char kV[] = "/fclib_local/V";
constexpr char kR[] = "/fclib_local/R";
constexpr char kQ[] = "/fclib_local/vectors/q";
constexpr char kMu[] = "/fclib_local/vectors/mu";
constexpr char kS[] = "/fclib_local/vectors/s";
constexpr char kGlobalDimension[] = "/fclib_global/spacedim";
constexpr char kM[] = "/fclib_global/M";
constexpr char kH[] = "/fclib_global/H";
constexpr char kG[] = "/fclib_global/G";
constexpr char kLoads[] = "/fclib_global/vectors/f";
constexpr char kVelocities[] = "/fclib_global/vectors/w";
constexpr char kGlobalMu[] = "/fclib_global/vectors/mu";
constexpr char kGlobalB[] = "/fclib_global/vectors/b";
constexpr char kNormalForces[] = "/solution/r";
constexpr char kBilateralForces[] = "/solution/l";
constexpr char kId[] = "/lcpbench/id";
constexpr char kRowOrder[] = "/lcpbench/row_order";
constexpr char kJ[] = "/lcpbench/J";
constexpr char kInverseMass[] = "/lcpbench/inverse_mass";

using Entry = Eigen::Triplet<double, int>;

Hdf5Datasets AllDatasets() {
  Hdf5Datasets wanted{{kId, std::string()}};
  for (const std::string matrix : {kW, kV, kR, kJ, kM, kH, kG}) {
    for (const char* part : {"/nzmax", "/m", "/n", "/nz", "/p", "/i"}) {
      wanted.emplace_back(matrix + part, std::vector<int>());
    }
    wanted.emplace_back(matrix + "/x", std::vector<double>());
  }
  for (const char* integers : {kDimension, kGlobalDimension, kRowOrder})
    wanted.emplace_back(integers, std::vector<int>());
  for (const char* reals :
       {kQ, kMu, kS, kLoads, kVelocities, kGlobalMu, kGlobalB, kNormalForces, kBilateralForces, kInverseMass}) {
    wanted.emplace_back(reals, std::vector<double>());
  }
  return wanted;
}

// The datasets of one file, and what is wrong with them.
class File {
 public:
  explicit File(const std::string& path) : path_(path) {
    for (auto& [name, values] : ReadHdf5(path, AllDatasets(), {kLocal, kGlobal}))
      datasets_.emplace(name, std::move(values));
  }

  [[noreturn]] void Reject(const std::string& place, const std::string& expected, const std::string& found) const {
    throw InputError(path_ + ": " + place + ": expected " + expected + ", found " + found);
  }

  bool Has(const std::string& name) const { return datasets_.count(name) > 0; }
  bool HasAnyBelow(const std::string& group) const {
    const auto first = datasets_.lower_bound(group + '/');
    return first != datasets_.end() && first->first.starts_with(group + '/');
  }
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
  std::string name;
  int rows = 0;
  int columns = 0;
  std::vector<Entry> entries;
  /// Triplets whose indices fit both ways: `entries` has them with p as rows.
  bool is_ambiguous = false;
};

void RequireIndex(const File& file, const std::string& name, int index, int end) {
  if (index >= 0 && index < end) return;
  file.Reject(name, "indices from 0 to " + std::to_string(end - 1), std::to_string(index));
}

// One entry in every `row_step` rows and `column_step` columns: of contacts the normal ones.
std::vector<Entry> EveryNth(const std::vector<Entry>& entries, int row_step, int column_step, bool swapped) {
  std::vector<Entry> kept;
  for (const Entry& entry : entries) {
    const int row = swapped ? entry.col() : entry.row(), column = swapped ? entry.row() : entry.col();
    if (row % row_step != 0 || column % column_step != 0) continue;
    kept.emplace_back(row / row_step, column / column_step, entry.value());
  }
  return kept;
}

// By place, without those that are 0.
std::map<std::pair<int, int>, double> Summed(const std::vector<Entry>& entries) {
  std::map<std::pair<int, int>, double> sums;
  for (const Entry& entry : entries) sums[{entry.row(), entry.col()}] += entry.value();
  std::erase_if(sums, [](const auto& sum) { return sum.second == 0; });
  return sums;
}

// The matrices of one file. One program wrote it, so that p has the rows, or the columns, of all its triplets.
class Matrices {
 public:
  Matrices(const File& file, FclibTriplets triplets) : file_(file), triplets_(triplets) {}

  Matrix Read(const std::string& name) {
    Matrix matrix;
    matrix.name = name;
    matrix.rows = file_.Integer(name + "/m", 0, kMost);
    matrix.columns = file_.Integer(name + "/n", 0, kMost);
    const int places = file_.Integer(name + "/nzmax", 0, kMost);
    const int form = file_.Integer(name + "/nz", kCompressedRows, kMost);
    const std::vector<int>& p = file_.Integers(name + "/p");
    const std::vector<int>& i = file_.Integers(name + "/i");
    const std::vector<double>& x = file_.Reals(name + "/x", form >= 0 ? form : places);
    file_.RequireCount(name + "/i", i.size(), form >= 0 ? form : places);
    if (form < 0) {
      ReadCompressed(p, i, x, form == kCompressedColumns, &matrix);
    } else {
      file_.RequireCount(name + "/p", p.size(), form);
      ReadTriplets(p, i, x, &matrix);
    }
    return matrix;
  }

  // What the problem needs of the matrices that have been read, see EveryNth; all of them are to be read before.
  std::vector<Entry> Entries(const Matrix& matrix, int row_step = 1, int column_step = 1) const {
    std::vector<Entry> by_rows = EveryNth(matrix.entries, row_step, column_step, false);
    if (!matrix.is_ambiguous || triplets_ == FclibTriplets::kRowsFirst) return by_rows;
    std::vector<Entry> by_columns = EveryNth(matrix.entries, row_step, column_step, true);
    if (triplets_ == FclibTriplets::kColumnsFirst) return by_columns;
    if (Summed(by_rows) == Summed(by_columns)) return by_rows;
    file_.Reject(
        matrix.name,
        "triplets of which one reading is possible, or `lcpbench convert --fclib-triplets rows-first` (as fclib.h "
        "has it) or columns-first (as Siconos writes them)",
        "some that can be read both ways");
  }

 private:
  void ReadCompressed(const std::vector<int>& p, const std::vector<int>& i, const std::vector<double>& x,
                      bool by_columns, Matrix* matrix) const {
    const std::string p_name = matrix->name + "/p", i_name = matrix->name + "/i";
    const int outer = by_columns ? matrix->columns : matrix->rows;
    file_.RequireCount(p_name, p.size(), std::int64_t{outer} + 1);
    const int inner = by_columns ? matrix->rows : matrix->columns;
    int last = 0;
    for (size_t k = 0; k < p.size(); last = p[k++]) {
      const int most = k == 0 ? 0 : static_cast<int>(x.size());
      if (p[k] < last || p[k] > most) {
        file_.Reject(p_name, "a place from " + std::to_string(last) + " to " + std::to_string(most),
                     std::to_string(p[k]) + " at " + std::to_string(k));
      }
      for (int e = last; e < p[k]; ++e) {
        const int a = static_cast<int>(k) - 1, b = i[static_cast<size_t>(e)];
        RequireIndex(file_, i_name, b, inner);
        matrix->entries.emplace_back(by_columns ? b : a, by_columns ? a : b, x[static_cast<size_t>(e)]);
      }
    }
  }

  void ReadTriplets(const std::vector<int>& p, const std::vector<int>& i, const std::vector<double>& x,
                    Matrix* matrix) {
    const auto all_below = [](const std::vector<int>& indices, int end) {
      return std::all_of(indices.begin(), indices.end(), [end](int index) { return index >= 0 && index < end; });
    };
    const int rows = matrix->rows, columns = matrix->columns;
    const bool fits_by_rows = all_below(p, rows) && all_below(i, columns);
    const bool fits_by_columns = all_below(p, columns) && all_below(i, rows);
    if (triplets_ == FclibTriplets::kByRanges && fits_by_rows != fits_by_columns) {
      triplets_ = fits_by_rows ? FclibTriplets::kRowsFirst : FclibTriplets::kColumnsFirst;
    }
    const bool swapped = triplets_ == FclibTriplets::kColumnsFirst;
    if (!(swapped ? fits_by_columns : fits_by_rows)) {
      for (const int index : p) RequireIndex(file_, matrix->name + "/p", index, swapped ? columns : rows);
      for (const int index : i) RequireIndex(file_, matrix->name + "/i", index, swapped ? rows : columns);
    }
    matrix->is_ambiguous = fits_by_rows && fits_by_columns;
    for (size_t k = 0; k < x.size(); ++k) {
      const bool is_turned = swapped && !matrix->is_ambiguous;
      matrix->entries.emplace_back(is_turned ? i[k] : p[k], is_turned ? p[k] : i[k], x[k]);
    }
  }

  const File& file_;
  FclibTriplets triplets_;  // kByRanges until some matrix of the file tells
};

void RequireShape(const File& file, const std::string& name, const Matrix& matrix, int rows, int columns) {
  if (matrix.rows == rows && matrix.columns == columns) return;
  file.Reject(name, std::to_string(rows) + " x " + std::to_string(columns) + " entries",
              std::to_string(matrix.rows) + " x " + std::to_string(matrix.columns));
}

SparseMatrix ToSparse(Index rows, Index columns, const std::vector<Entry>& entries) {
  SparseMatrix sparse(rows, columns);
  sparse.setFromTriplets(entries.begin(), entries.end());
  return sparse;
}

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

// Contacts and bilateral rows of a file, and the rows of our problem that they are.
struct Rows {
  int dimension = kLeastDimension;
  std::vector<int> of_contacts, of_bilateral;

  Index size() const { return static_cast<Index>(of_contacts.size() + of_bilateral.size()); }
  RowBounds Bounds() const { return RowBounds::WithBilateralRows(size(), {of_bilateral.begin(), of_bilateral.end()}); }
  // Merges normal entries and those of bilateral rows, by the rows of the problem.
  Eigen::VectorXd Merge(const std::vector<double>& contacts, const std::vector<double>& bilateral) const {
    Eigen::VectorXd merged(size());
    const auto step = static_cast<size_t>(dimension);
    for (size_t k = 0; k < of_contacts.size(); ++k) merged[of_contacts[k]] = contacts[step * k];
    for (size_t k = 0; k < of_bilateral.size(); ++k) merged[of_bilateral[k]] = bilateral[k];
    return merged;
  }
};

// By the columns of two matrices: spacedim for every contact, one for every bilateral row.
Rows ReadRows(const File& file, int dimension, const Matrix& of_contacts, const Matrix& of_bilateral) {
  if (of_contacts.columns % dimension != 0) {
    file.Reject(of_contacts.name, std::to_string(dimension) + " rows for every contact",
                std::to_string(of_contacts.columns));
  }
  const int contacts = of_contacts.columns / dimension, bilateral = of_bilateral.columns;
  if (bilateral > kMost - contacts) {
    file.Reject(of_bilateral.name, "at most " + std::to_string(kMost) + " rows", std::to_string(bilateral) + " more");
  }
  const std::vector<int> rows = ReadRowOrder(file, contacts + bilateral);
  return {dimension, {rows.begin(), rows.begin() + contacts}, {rows.begin() + contacts, rows.end()}};
}

void RequireNoFriction(const File& file, const char* name, int contacts, bool without_friction) {
  for (const double mu : file.Reals(name, contacts)) {
    if (mu == 0 || without_friction) continue;
    file.Reject(name, "friction coefficients 0, or `lcpbench convert --without-friction`, which passes over them",
                std::to_string(mu));
  }
}

LcpProblem WithFactors(const File& file, const Rows& rows, Matrices* matrices, const std::string& id,
                       Eigen::VectorXd b) {
  const Index n = rows.size();
  const Matrix J = matrices->Read(kJ);
  const std::vector<double>& inverse_mass = file.Reals(kInverseMass);
  RequireShape(file, kJ, J, static_cast<int>(n), static_cast<int>(std::min<size_t>(inverse_mass.size(), kMost)));
  Eigen::VectorXd masses = Eigen::Map<const Eigen::VectorXd>(inverse_mass.data(), J.columns);
  return LcpProblem::FromFactors(id, ToSparse(n, J.columns, matrices->Entries(J)), std::move(masses), std::move(b),
                                 rows.Bounds());
}

// The problem of W, V, R, q, s.
std::pair<LcpProblem, Rows> ReadLocal(const File& file, const FclibOptions& options, const std::string& id) {
  Matrices matrices(file, options.triplets);
  const int dimension = file.Integer(kDimension, kLeastDimension, kMostDimension);
  const Matrix W = matrices.Read(kW);
  if (W.rows != W.columns || W.rows % dimension != 0) {
    file.Reject(kW, "a square matrix of " + std::to_string(dimension) + " rows for every contact",
                std::to_string(W.rows) + " x " + std::to_string(W.columns) + " entries");
  }
  const std::vector<double>& q = file.Reals(kQ, W.rows);
  RequireNoFriction(file, kMu, W.rows / dimension, options.without_friction);
  Matrix V, R;
  std::vector<double> s;
  const std::string m = "/m";
  if (file.Has(kV + m) || file.Has(kR + m)) {
    R = matrices.Read(kR);
    RequireShape(file, kR, R, R.rows, R.rows);
    s = file.Reals(kS, R.rows);
    V = matrices.Read(kV);
    RequireShape(file, kV, V, W.rows, R.rows);
  }
  Rows rows = ReadRows(file, dimension, W, R);
  Eigen::VectorXd b = rows.Merge(q, s);
  if (file.Has(kJ + m) || file.Has(kInverseMass)) {
    return {WithFactors(file, rows, &matrices, id, std::move(b)), std::move(rows)};
  }
  std::vector<Entry> entries;
  const auto add = [&](const std::vector<Entry>& part, const std::vector<int>& row_of,
                       const std::vector<int>& column_of, bool mirrored) {
    for (const Entry& entry : part) {
      const int row = row_of[static_cast<size_t>(entry.row())], column = column_of[static_cast<size_t>(entry.col())];
      entries.emplace_back(row, column, entry.value());
      if (mirrored) entries.emplace_back(column, row, entry.value());
    }
  };
  add(matrices.Entries(W, dimension, dimension), rows.of_contacts, rows.of_contacts, false);
  add(matrices.Entries(V, dimension), rows.of_contacts, rows.of_bilateral, true);
  add(matrices.Entries(R), rows.of_bilateral, rows.of_bilateral, false);
  return {LcpProblem::FromSparse(id, ToSparse(rows.size(), rows.size(), entries), std::move(b), rows.Bounds()),
          std::move(rows)};
}

// The inverse of M, which is to be diagonal.
Eigen::VectorXd InverseOfDiagonal(const File& file, const Matrix& M, const std::vector<Entry>& entries) {
  Eigen::VectorXd diagonal = Eigen::VectorXd::Zero(M.rows);
  for (const Entry& entry : entries) {
    if (entry.row() == entry.col()) {
      diagonal[entry.row()] += entry.value();
    } else if (entry.value() != 0) {
      file.Reject(M.name, "a diagonal matrix, others are not supported",
                  "an entry in row " + std::to_string(entry.row()) + " and column " + std::to_string(entry.col()));
    }
  }
  for (Index k = 0; k < diagonal.size(); ++k) {
    if (diagonal[k] > 0 && std::isfinite(diagonal[k]) && std::isfinite(1 / diagonal[k])) continue;
    file.Reject(M.name, "masses > 0 on the diagonal", std::to_string(diagonal[k]) + " at " + std::to_string(k));
  }
  return diagonal.cwiseInverse();
}

// The problem of M, H, G, f, w, b, by factors.
std::pair<LcpProblem, Rows> ReadGlobal(const File& file, const FclibOptions& options, const std::string& id) {
  Matrices matrices(file, options.triplets);
  const int dimension = file.Integer(kGlobalDimension, kLeastDimension, kMostDimension);
  const Matrix H = matrices.Read(kH), M = matrices.Read(kM);
  RequireShape(file, kM, M, H.rows, H.rows);
  const std::vector<double>& f = file.Reals(kLoads, H.rows);
  const std::vector<double>& w = file.Reals(kVelocities, H.columns);
  RequireNoFriction(file, kGlobalMu, H.columns / dimension, options.without_friction);
  Matrix G;
  std::vector<double> of_bilateral;
  if (file.Has(kG + std::string("/m"))) {
    G = matrices.Read(kG);
    RequireShape(file, kG, G, H.rows, G.columns);
    of_bilateral = file.Reals(kGlobalB, G.columns);
  }
  Rows rows = ReadRows(file, dimension, H, G);
  std::vector<Entry> entries;
  const auto add = [&](const std::vector<Entry>& part, const std::vector<int>& row_of) {
    for (const Entry& entry : part) {
      entries.emplace_back(row_of[static_cast<size_t>(entry.col())], entry.row(), entry.value());
    }
  };
  add(matrices.Entries(H, 1, dimension), rows.of_contacts);
  add(matrices.Entries(G), rows.of_bilateral);
  const SparseMatrix J = ToSparse(rows.size(), H.rows, entries);
  Eigen::VectorXd inverse_mass = InverseOfDiagonal(file, M, matrices.Entries(M));
  const Eigen::VectorXd velocities = inverse_mass.cwiseProduct(Eigen::Map<const Eigen::VectorXd>(f.data(), H.rows));
  Eigen::VectorXd b = J * velocities + rows.Merge(w, of_bilateral);
  return {LcpProblem::FromFactors(id, J, std::move(inverse_mass), std::move(b), rows.Bounds()), std::move(rows)};
}

// None where the file has no normal forces, or lists that were created and never written.
std::optional<Eigen::VectorXd> ReadForces(const File& file, const Rows& rows) {
  const auto is_unwritten = [&](const char* name, size_t count) { return count > 0 && file.Reals(name).empty(); };
  const size_t normal = rows.of_contacts.size() * static_cast<size_t>(rows.dimension);
  const size_t bilateral = rows.of_bilateral.size();
  if (!file.Has(kNormalForces) || is_unwritten(kNormalForces, normal)) return std::nullopt;
  const std::vector<double>& r = file.Reals(kNormalForces, static_cast<std::int64_t>(normal));
  if (bilateral == 0) return rows.Merge(r, {});
  if (is_unwritten(kBilateralForces, bilateral)) return std::nullopt;
  return rows.Merge(r, file.Reals(kBilateralForces, static_cast<std::int64_t>(bilateral)));
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

FclibProblem ReadFclibProblem(const std::string& path, const FclibOptions& options) {
  const File file(path);
  const std::string id = file.Has(kId) ? file.Text(kId) : IdOfFile(path);
  const bool is_global = file.HasAnyBelow(kGlobal) && !file.HasAnyBelow(kLocal);
  try {
    auto [problem, rows] = (is_global ? ReadGlobal : ReadLocal)(file, options, id);
    return {std::move(problem), ReadForces(file, rows)};
  } catch (const InputError& error) {  // a negative mass, or entries of one place whose sum overflows
    std::string what = error.what();
    if (!what.starts_with(path)) what = path + ": " + what;
    throw InputError(Printable(what));  // an id may be any text
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
