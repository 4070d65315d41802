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

// New places of rows, or columns; -1: left out. nullptr: they stay.
using Places = const std::vector<int>*;

std::vector<Entry> Placed(const std::vector<Entry>& entries, Places rows, Places columns, bool swapped) {
  const auto place = [](Places places, int index) {
    return places == nullptr ? index : (*places)[static_cast<size_t>(index)];
  };
  std::vector<Entry> placed;
  for (const Entry& entry : entries) {
    const int row = place(rows, swapped ? entry.col() : entry.row());
    const int column = place(columns, swapped ? entry.row() : entry.col());
    if (row >= 0 && column >= 0) placed.emplace_back(row, column, entry.value());
  }
  return placed;
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

  // What the problem needs of the matrices that have been read, see Placed; all of them are to be read before.
  std::vector<Entry> Entries(const Matrix& matrix, Places rows = nullptr, Places columns = nullptr) const {
    std::vector<Entry> by_rows = Placed(matrix.entries, rows, columns, false);
    if (!matrix.is_ambiguous || triplets_ == FclibTriplets::kRowsFirst) return by_rows;
    std::vector<Entry> by_columns = Placed(matrix.entries, rows, columns, true);
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

// For every row of contacts that is read, and then every bilateral row, its row in the problem.
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
  int count = 0;                               // in the problem
  std::vector<int> of_contacts, of_bilateral;  // -1: a tangent that is not read
  std::vector<FrictionRow> friction;

  RowBounds Bounds() const {
    RowBounds bounds = RowBounds::WithBilateralRows(count, {of_bilateral.begin(), of_bilateral.end()});
    bounds.friction = friction;
    return bounds;
  }
  // Merges entries of contacts and those of bilateral rows, by the rows of the problem.
  Eigen::VectorXd Merge(const std::vector<double>& contacts, const std::vector<double>& bilateral) const {
    Eigen::VectorXd merged(count);
    for (size_t k = 0; k < of_contacts.size(); ++k) {
      if (of_contacts[k] >= 0) merged[of_contacts[k]] = contacts[k];
    }
    for (size_t k = 0; k < of_bilateral.size(); ++k) merged[of_bilateral[k]] = bilateral[k];
    return merged;
  }
};

// By the columns of two matrices: spacedim for every contact, one for every bilateral row.
// @param mu  the dataset of friction coefficients
Rows ReadRows(const File& file, TangentRows tangents, int dimension, const char* mu, const Matrix& of_contacts,
              const Matrix& of_bilateral) {
  if (of_contacts.columns % dimension != 0) {
    file.Reject(of_contacts.name, std::to_string(dimension) + " rows for every contact",
                std::to_string(of_contacts.columns));
  }
  ContactRows contacts =
      RowsOfContacts(dimension, file.Reals(mu, of_contacts.columns / dimension), tangents,
                     [&](const std::string& expected, const std::string& found) { file.Reject(mu, expected, found); });
  const int bilateral = of_bilateral.columns;
  if (bilateral > kMost - contacts.count) {
    file.Reject(of_bilateral.name, "at most " + std::to_string(kMost) + " rows", std::to_string(bilateral) + " more");
  }
  Rows rows;
  rows.count = contacts.count + bilateral;
  const std::vector<int> order = ReadRowOrder(file, rows.count);
  const auto place = [&](Index row) { return row < 0 ? -1 : order[static_cast<size_t>(row)]; };
  for (const int row : contacts.row) rows.of_contacts.push_back(place(row));
  rows.of_bilateral.assign(order.begin() + contacts.count, order.end());
  for (FrictionRow row : contacts.friction) {
    row.row = place(row.row);
    row.normal = place(row.normal);
    rows.friction.push_back(row);
  }
  return rows;
}

LcpProblem WithFactors(const File& file, const Rows& rows, Matrices* matrices, const std::string& id,
                       Eigen::VectorXd b) {
  const Index n = rows.count;
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
  Rows rows = ReadRows(file, options.tangents, dimension, kMu, W, R);
  Eigen::VectorXd b = rows.Merge(q, s);
  if (file.Has(kJ + m) || file.Has(kInverseMass)) {
    return {WithFactors(file, rows, &matrices, id, std::move(b)), std::move(rows)};
  }
  std::vector<Entry> entries;
  const auto add = [&](const std::vector<Entry>& part, bool mirrored) {
    for (const Entry& entry : part) {
      entries.push_back(entry);
      if (mirrored) entries.emplace_back(entry.col(), entry.row(), entry.value());
    }
  };
  add(matrices.Entries(W, &rows.of_contacts, &rows.of_contacts), false);
  add(matrices.Entries(V, &rows.of_contacts, &rows.of_bilateral), true);
  add(matrices.Entries(R, &rows.of_bilateral, &rows.of_bilateral), false);
  return {LcpProblem::FromSparse(id, ToSparse(rows.count, rows.count, entries), std::move(b), rows.Bounds()),
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
  Matrix G;
  std::vector<double> of_bilateral;
  if (file.Has(kG + std::string("/m"))) {
    G = matrices.Read(kG);
    RequireShape(file, kG, G, H.rows, G.columns);
    of_bilateral = file.Reals(kGlobalB, G.columns);
  }
  Rows rows = ReadRows(file, options.tangents, dimension, kGlobalMu, H, G);
  std::vector<Entry> entries;
  const auto add = [&](const std::vector<Entry>& part) {
    for (const Entry& entry : part) entries.emplace_back(entry.col(), entry.row(), entry.value());
  };
  add(matrices.Entries(H, nullptr, &rows.of_contacts));
  add(matrices.Entries(G, nullptr, &rows.of_bilateral));
  const SparseMatrix J = ToSparse(rows.count, H.rows, entries);
  Eigen::VectorXd inverse_mass = InverseOfDiagonal(file, M, matrices.Entries(M));
  const Eigen::VectorXd velocities = inverse_mass.cwiseProduct(Eigen::Map<const Eigen::VectorXd>(f.data(), H.rows));
  Eigen::VectorXd b = J * velocities + rows.Merge(w, of_bilateral);
  return {LcpProblem::FromFactors(id, J, std::move(inverse_mass), std::move(b), rows.Bounds()), std::move(rows)};
}

// None where the file has no normal forces, or lists that were created and never written.
std::optional<Eigen::VectorXd> ReadForces(const File& file, const Rows& rows) {
  const auto is_unwritten = [&](const char* name, size_t count) { return count > 0 && file.Reals(name).empty(); };
  const size_t normal = rows.of_contacts.size();
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

// @param place  of every row among those of contacts, or of bilateral ones
Blocks Divide(const LcpProblem& problem, const std::vector<int>& place, Index contact_rows) {
  const auto bilateral = static_cast<Index>(problem.bilateral_rows().size());
  const auto index_of = [&](Index row) { return place[static_cast<size_t>(row)]; };
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

// By row, the friction row of a contact; nullptr where there is none.
std::vector<const FrictionRow*> FrictionOfContacts(const LcpProblem& problem) {
  const auto refuse = [&](const std::string& what) {
    throw InputError(
        "problem '" + problem.id() + "' has " + what +
        ", which FCLib has no place for; expected JSON lines, or --without-friction, which drops friction");
  };
  if (!problem.bounded_rows().empty()) refuse("bounded rows");
  std::vector<const FrictionRow*> friction(static_cast<size_t>(problem.size()), nullptr);
  for (const FrictionRow& row : problem.friction_rows()) {
    if (row.slip != 0) refuse("sliding rows");
    if (row.mu == 0) refuse("friction rows of mu = 0");
    if (std::exchange(friction[static_cast<size_t>(row.normal)], &row) != nullptr) {
      refuse("several friction rows of a contact");
    }
  }
  return friction;
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
  const std::vector<const FrictionRow*> friction = FrictionOfContacts(problem);
  // Contacts first; and where a row stands among those of contacts, or of bilateral ones.
  std::vector<int> rows, place(static_cast<size_t>(n));
  std::vector<double> mu, q, s;
  for (Index row = 0; row < n; ++row) {
    if (problem.kind(row) != RowKind::kUnilateral) continue;
    const FrictionRow* const tangent = friction[static_cast<size_t>(row)];
    mu.push_back(tangent == nullptr ? 0.0 : tangent->mu);
    for (const Index of_contact : {row, tangent == nullptr ? Index{-1} : tangent->row}) {
      q.push_back(of_contact < 0 ? 0.0 : problem.b()[of_contact]);
      if (of_contact < 0) continue;
      place[static_cast<size_t>(of_contact)] = static_cast<int>(q.size() - 1);
      rows.push_back(static_cast<int>(of_contact));
    }
  }
  for (const Index row : problem.bilateral_rows()) {
    place[static_cast<size_t>(row)] = static_cast<int>(s.size());
    rows.push_back(static_cast<int>(row));
    s.push_back(problem.b()[row]);
  }
  const Blocks blocks = Divide(problem, place, static_cast<Index>(q.size()));

  Hdf5Datasets file{{kDimension, std::vector{kLeastDimension}}};
  AddMatrix(blocks.W, kW, &file);
  if (!s.empty()) {
    AddMatrix(blocks.V, kV, &file);
    AddMatrix(blocks.R, kR, &file);
    file.emplace_back(kS, std::move(s));
  }
  file.emplace_back(kMu, std::move(mu));
  file.emplace_back(kQ, std::move(q));
  file.emplace_back("/fclib_local/info/title", problem.id());
  file.emplace_back(
      "/fclib_local/info/description",
      std::string(problem.is_plain() ? "frictionless: a linear complementarity problem in the normal rows"
                                     : "Coulomb friction in the plane: a contact's normal, then its tangent"));
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
