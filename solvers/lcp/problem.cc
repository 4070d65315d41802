#include "solvers/lcp/problem.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <mutex>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <utility>

#include "solvers/lcp/compressed_rows.h"
#include "solvers/lcp/memory_budget.h"
#include "solvers/lcp/number_range.h"
#include "support/input_error.h"
#include "support/number_text.h"

namespace lcpbench {
namespace {

using RowMajorMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

[[noreturn]] void Reject(const std::string& id, const std::string& what) {
  throw InputError(id.empty() ? what : "problem '" + id + "': " + what);
}

// Which ends of the range there are numbers beyond, zeros apart.
struct Beyond {
  bool least = false;
  bool most = false;
};

// @param side  of a dense matrix, by columns, whose entries are named by row and column; 0: an array of numbers
Beyond RequireFinite(const std::string& id, const char* name, const MagnitudeRange& range, const double* values,
                     Index count, Index side = 0) {
  NumberRange looked(range);
  looked.Look(values, count);
  if (!looked.has_large()) return {looked.has_small(), false};
  const double* found = std::find_if(values, values + count, [](double value) { return !std::isfinite(value); });
  if (found == values + count) return {looked.has_small(), true};
  const Index k = found - values;
  const std::string place = side == 0 ? "[" + std::to_string(k) + "]"
                                      : ": entry (" + std::to_string(k % side) + ", " + std::to_string(k / side) + ")";
  Reject(id, name + place + " is " + std::to_string(*found) + ", expected a finite number");
}

void RequireShape(const std::string& id, const char* name, Index rows, Index cols, Index want_rows, Index want_cols) {
  if (rows != want_rows || cols != want_cols) {
    Reject(id, std::string(name) + " must be " + std::to_string(want_rows) + " x " + std::to_string(want_cols) +
                   ", found " + std::to_string(rows) + " x " + std::to_string(cols));
  }
}

// Checks the matrix that arrays hold, in the two sparse forms.
void RequireCompressedRows(const ProblemArrays& arrays) {
  const auto count = static_cast<Index>(arrays.column.size());
  if (arrays.columns < 0 || (arrays.form == MatrixForm::kSparse && arrays.columns != arrays.rows)) {
    Reject(arrays.id, "columns must be " + std::string(arrays.form == MatrixForm::kSparse ? "rows" : ">= 0") +
                          ", found " + std::to_string(arrays.columns));
  }
  RequireShape(arrays.id, "row_start", static_cast<Index>(arrays.row_start.size()), 1, arrays.rows + 1, 1);
  RequireShape(arrays.id, "value", static_cast<Index>(arrays.value.size()), 1, count, 1);
  std::string why = WhyNotStarts(arrays.row_start, count, "row_start", "entries");
  if (why.empty()) why = WhyNotColumns(arrays.row_start, arrays.column, arrays.columns, "column");
  if (!why.empty()) Reject(arrays.id, why);
}

// Sorts friction and bounded rows, and requires that they are of one kind, and their numbers in range.
// @param n  the problem's rows
void RequireRowKinds(const std::string& id, Index n, RowBounds* bounds) {
  std::ranges::sort(bounds->friction, {}, &FrictionRow::row);
  std::ranges::sort(bounds->bounded, {}, &BoundedRow::row);
  std::vector<RowKind> kinds(static_cast<size_t>(n), RowKind::kUnilateral);
  for (size_t i = 0; i < bounds->bilateral.size(); ++i) {
    if (bounds->bilateral[i] != 0) kinds[i] = RowKind::kBilateral;
  }
  const auto take = [&](const char* what, Index row, RowKind kind) {
    const std::string place = std::string(what) + ": row " + std::to_string(row);
    if (row < 0 || row >= n) Reject(id, place + " is outside [0, " + std::to_string(n) + ")");
    const RowKind before = std::exchange(kinds[static_cast<size_t>(row)], kind);
    if (before == kind) Reject(id, place + " is listed twice");
    if (before != RowKind::kUnilateral) {
      Reject(id, place + " is a " + (before == RowKind::kBilateral ? "bilateral" : "friction") + " row already");
    }
  };
  for (const FrictionRow& row : bounds->friction) take("friction", row.row, RowKind::kFriction);
  for (const BoundedRow& row : bounds->bounded) take("bounded", row.row, RowKind::kBounded);
  for (const FrictionRow& row : bounds->friction) {
    const std::string place = "friction: row " + std::to_string(row.row) + ": ";
    if (row.normal < 0 || row.normal >= n || kinds[static_cast<size_t>(row.normal)] != RowKind::kUnilateral) {
      Reject(id, place + "normal is " + std::to_string(row.normal) + ", expected a unilateral row");
    }
    if (!std::isfinite(row.mu) || row.mu < 0) {
      Reject(id, place + "mu is " + NumberText(row.mu) + ", expected a finite number >= 0");
    }
    if (row.slip < -1 || row.slip > 1) {
      Reject(id, place + "slip is " + std::to_string(row.slip) + ", expected -1, 0 or 1");
    }
  }
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (const BoundedRow& row : bounds->bounded) {
    if (row.lower <= row.upper && row.lower < kInfinity && row.upper > -kInfinity) continue;
    Reject(id, "bounded: row " + std::to_string(row.row) + ": lower is " + NumberText(row.lower) + " and upper " +
                   NumberText(row.upper) + ", expected a number between them");
  }
}

// Whether a quarter of J's entries or more are stored: products of whole rows then cost less than lists do. Below 32
// rows lists stay in the caches.
constexpr Index kLeastDenseRows = 32;
constexpr Index kPartOfDense = 4;
bool HasDenseRows(const Eigen::Ref<const SparseMatrix>& J) {
  return J.rows() >= kLeastDenseRows && kPartOfDense * J.outerIndexPtr()[J.rows()] >= J.rows() * J.cols();
}

// The rows of J without the columns that cannot move, kTile rows side by side: column k of the rows from kTile t on
// begins at kTile (t columns + k); zeros where there is no row.
constexpr Index kTile = 8;
struct DenseRows {
  DenseRows(const Eigen::Ref<const SparseMatrix>& J, const double* inverse_mass) {
    std::vector<Index> place(static_cast<size_t>(J.cols()), -1);
    for (Index k = 0; k < J.cols(); ++k) {
      if (inverse_mass[k] == 0) continue;
      place[static_cast<size_t>(k)] = static_cast<Index>(mass.size());
      mass.push_back(inverse_mass[k]);
    }
    columns = static_cast<Index>(mass.size());
    J_by_tiles.assign(static_cast<size_t>((J.rows() + kTile - 1) / kTile * kTile * columns), 0.0);
    for (Index i = 0; i < J.rows(); ++i) {
      for (int e = J.outerIndexPtr()[i]; e < J.outerIndexPtr()[i + 1]; ++e) {
        const Index k = place[static_cast<size_t>(J.innerIndexPtr()[e])];
        if (k >= 0) J_by_tiles[static_cast<size_t>((i / kTile * columns + k) * kTile + i % kTile)] = J.valuePtr()[e];
      }
    }
  }
  const double* Tile(Index t) const { return J_by_tiles.data() + t * columns * kTile; }

  Index columns = 0;
  std::vector<double> mass, J_by_tiles;
};

// sum[kTile r + c] = sum over k of mass_k (first_rk second_ck). The widest instructions of the machine give the same
// bits as any others: products and sums are not fused.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
__attribute__((target_clones("avx512f", "avx2", "default")))
#endif
void MultiplyTiles(const double* first, const double* second, const double* mass, Index columns, double* sum) {
  using Tile [[gnu::vector_size(kTile * sizeof(double)), gnu::aligned(alignof(double)), gnu::may_alias]] = double;
  Tile rows[kTile] = {};
  for (Index k = 0; k < columns; ++k) {
    const Tile other = *reinterpret_cast<const Tile*>(second + k * kTile);
    for (int r = 0; r < kTile; ++r) rows[r] += mass[k] * (first[k * kTile + r] * other);
  }
  for (int r = 0; r < kTile; ++r) *reinterpret_cast<Tile*>(sum + r * kTile) = rows[r];
}

// As Assemble: every entry is the same sum in the same order, so that it has the same bits.
void AssembleOfDenseRows(const Eigen::Ref<const SparseMatrix>& J, const double* inverse_mass, double* A, Index stride) {
  const DenseRows full(J, inverse_mass);
  const Index n = J.rows();
  for (Index i = 0; i < n; ++i) std::fill(A + i * stride + n, A + (i + 1) * stride, 0.0);
  double sum[kTile * kTile];
  for (Index i = 0; i < n; i += kTile) {
    for (Index j = 0; j <= i; j += kTile) {
      MultiplyTiles(full.Tile(i / kTile), full.Tile(j / kTile), full.mass.data(), full.columns, sum);
      for (Index r = 0; r < std::min(kTile, n - i); ++r) {
        for (Index c = 0; c < std::min(kTile, n - j); ++c) {
          A[(i + r) * stride + j + c] = A[(j + c) * stride + i + r] = sum[r * kTile + c];
        }
      }
    }
  }
}

// Rows enter their columns' lists one after the other; row i meets those above it in every one of its columns, in the
// order of the columns.
void Assemble(const Eigen::Ref<const SparseMatrix>& J, const double* inverse_mass, double* A, Index stride) {
  // An entry of J in the list of its column; next: the one above it, -1 where it is the first.
  struct ColumnEntry {
    int next;
    int row;
    double value;
  };
  if (HasDenseRows(J)) return AssembleOfDenseRows(J, inverse_mass, A, stride);
  std::fill_n(A, J.rows() * stride, 0.0);
  std::vector<int> last(static_cast<size_t>(J.cols()), -1);
  const int* const start = J.outerIndexPtr();
  const auto entries =
      std::make_unique_for_overwrite<ColumnEntry[]>(static_cast<size_t>(J.rows() > 0 ? start[J.rows()] : 0));
  for (Index i = 0; i < J.rows(); ++i) {
    double* row = A + i * stride;
    for (int e = start[i]; e < start[i + 1]; ++e) {
      const int k = J.innerIndexPtr()[e];
      const double m = inverse_mass[k];
      if (m == 0) continue;
      const double value = J.valuePtr()[e];
      entries[static_cast<size_t>(e)] = {last[static_cast<size_t>(k)], static_cast<int>(i), value};
      last[static_cast<size_t>(k)] = e;
      for (int other = e; other >= 0;) {
        const ColumnEntry& entry = entries[static_cast<size_t>(other)];
        row[entry.row] += m * (value * entry.value);
        A[entry.row * stride + i] = row[entry.row];
        other = entry.next;
      }
    }
  }
}

// A derived form is made on the first request. std::call_once calls the kernel each time it has run something, which
// takes longer than a form of a few rows; a lock that nobody waits for does not.
class Once {
 public:
  template <typename Make>
  void Call(const Make& make) {
    if (is_done_.load(std::memory_order_acquire)) return;
    const std::scoped_lock lock(mutex_);
    if (is_done_.load(std::memory_order_relaxed)) return;
    make();
    is_done_.store(true, std::memory_order_release);
  }

 private:
  std::atomic<bool> is_done_ = false;
  std::mutex mutex_;
};

}  // namespace

// All but b, and what has been derived of it: shared by problems that differ in b only.
struct LcpProblem::Matrix {
  std::string id;
  MatrixForm form = MatrixForm::kDense;
  Index rows = 0;
  MatrixFacts facts;

  Eigen::MatrixXd dense;  // A of kDense
  // A of kSparse, J of kFactors. Eigen's sparse matrices allocate even where they are empty.
  std::optional<SparseMatrix> given_sparse;
  Eigen::VectorXd inverse_mass;
  RowBounds bounds;
  std::vector<Index> bilateral;
  Beyond beyond;  // of the numbers given
  bool has_extremes = false;

  // Derived on request, once, also where several threads ask.
  Once dense_once, sparse_once, diagonal_once, asymmetry_once, two_body_once;
  Eigen::MatrixXd derived_dense;
  std::optional<SparseMatrix> derived_sparse;
  Eigen::VectorXd diagonal;
  double asymmetry = 0;
  bool two_body_rows = false;

  const SparseMatrix& sparse() const { return *given_sparse; }

  void RequireFiniteValues(const char* name, const double* values, Index count, Index side = 0) {
    beyond = RequireFinite(id, name, form == MatrixForm::kFactors ? kFactorRange : kEntryRange, values, count, side);
  }

  void RequireColumnsPerBody() const {
    if (facts.columns_per_body == 3 || facts.columns_per_body == 6) return;
    Reject(id, "columns_per_body is " + std::to_string(facts.columns_per_body) +
                   ", expected 3 (bodies in the plane) or 6 (in space)");
  }

  // Swapped out of its place: Eigen's sparse matrices cannot be moved.
  void TakeSparse(SparseMatrix* matrix, const char* name, Index columns) {
    RequireShape(id, name, matrix->rows(), matrix->cols(), rows, columns);
    matrix->makeCompressed();
    RequireFiniteValues(name, matrix->valuePtr(), matrix->nonZeros());
    given_sparse.emplace().swap(*matrix);
  }

  void TakeMasses(Eigen::VectorXd masses) {
    RequireColumnsPerBody();
    const Beyond of_masses = RequireFinite(id, "inverse_mass", kFactorRange, masses.data(), masses.size());
    beyond.least |= of_masses.least;
    beyond.most |= of_masses.most;
    for (Index k = 0; k < masses.size(); ++k) {
      if (masses[k] >= 0) continue;
      Reject(id,
             "inverse_mass[" + std::to_string(k) + "] is " + std::to_string(masses[k]) + ", expected a number >= 0");
    }
    inverse_mass = std::move(masses);
    facts.symmetric = facts.positive_semidefinite = true;
  }

  // Once all arrays are in their places. Small numbers do no harm beside others of their row, and the largest entries
  // of A = J M^-1 J^T stand on its diagonal.
  void LookForExtremes() {
    has_extremes = beyond.most;
    if (!beyond.least && !beyond.most) return;
    for (Index i = 0; i < rows; ++i) {
      long double of_row = 0;
      if (form == MatrixForm::kFactors) {
        for (SparseMatrix::InnerIterator it(sparse(), i); it; ++it) {
          of_row += static_cast<long double>(it.value()) * it.value() * inverse_mass[it.col()];
        }
      } else {
        of_row = std::abs(form == MatrixForm::kDense ? dense(i, i) : sparse().coeff(i, i));
      }
      if (of_row > std::numeric_limits<double>::max()) {
        Reject(id, "J M^-1 J^T must be finite, the diagonal entry of row " + std::to_string(i) + " is beyond doubles");
      }
      if (of_row > kEntryRange.most || (of_row < kEntryRange.least && of_row > 0)) has_extremes = true;
    }
  }

  bool HasTwoBodyRows() const {
    if (inverse_mass.size() % facts.columns_per_body != 0) return false;
    for (Index i = 0; i < rows; ++i) {
      Index first = -1;
      Index second = -1;
      for (SparseMatrix::InnerIterator it(sparse(), i); it; ++it) {
        const Index block = it.col() / facts.columns_per_body;
        if (inverse_mass[it.col()] == 0 || it.value() == 0 || block == first || block == second) continue;
        if (second >= 0) return false;
        second = std::exchange(first, block);
      }
    }
    return true;
  }

  // Whether every row of J has more than half of the columns that can move; at most 2^31 - 1 pairs.
  bool EveryPairSharesAColumn() const {
    if (!HasDenseRows(sparse()) || rows * rows > std::numeric_limits<int>::max()) return false;
    const auto movable = static_cast<Index>((inverse_mass.array() != 0).count());
    for (Index i = 0; i < rows; ++i) {
      Index count = 0;
      for (SparseMatrix::InnerIterator it(sparse(), i); it; ++it) count += inverse_mass[it.col()] != 0 ? 1 : 0;
      if (2 * count <= movable) return false;
    }
    return true;
  }

  // Every entry of a symmetric matrix, zeros too.
  void FormSparseWithAll(const Eigen::MatrixXd& symmetric) {
    const Index n = symmetric.rows();
    RequireSparseMatrices(n, static_cast<double>(n) * static_cast<double>(n), 1);
    SparseMatrix& all = derived_sparse.emplace(n, n);
    all.resizeNonZeros(n * n);
    for (Index i = 0; i <= n; ++i) all.outerIndexPtr()[i] = static_cast<int>(i * n);
    for (Index i = 0; i < n; ++i) std::iota(all.innerIndexPtr() + i * n, all.innerIndexPtr() + (i + 1) * n, 0);
    std::copy_n(symmetric.data(), n * n, all.valuePtr());
  }

  // A = J M^-1 J^T row by row. Every entry sums m_k (J_ik J_jk) over ascending k, so (i, j) and (j, i) round alike.
  void FormSparseFromFactors() {
    const SparseMatrix& J = sparse();
    const Index n = rows;
    const Eigen::SparseMatrix<double, Eigen::ColMajor, int> columns = J;
    // An entry is a pair of rows that share a body, which has several columns.
    double pairs = 0;
    for (Index k = 0; k < columns.cols(); ++k) {
      const double count = inverse_mass[k] == 0 ? 0 : columns.outerIndexPtr()[k + 1] - columns.outerIndexPtr()[k];
      pairs += count * count;
    }
    RequireSparseMatrices(n, std::min(pairs / facts.columns_per_body, static_cast<double>(n) * static_cast<double>(n)),
                          2);
    std::vector<double> sums(static_cast<size_t>(n), 0.0);
    std::vector<Index> last_row(static_cast<size_t>(n), -1);
    std::vector<int> pattern;
    std::vector<int> outer(static_cast<size_t>(n) + 1, 0);
    std::vector<int> inner;
    std::vector<double> values;
    for (Index i = 0; i < n; ++i) {
      pattern.assign(1, static_cast<int>(i));
      last_row[static_cast<size_t>(i)] = i;
      for (SparseMatrix::InnerIterator it(J, i); it; ++it) {
        const double m = inverse_mass[it.col()];
        if (m == 0) continue;
        for (decltype(columns)::InnerIterator jt(columns, it.col()); jt; ++jt) {
          const auto j = static_cast<size_t>(jt.row());
          if (last_row[j] != i) {
            last_row[j] = i;
            pattern.push_back(static_cast<int>(j));
          }
          sums[j] += m * (it.value() * jt.value());
        }
      }
      std::sort(pattern.begin(), pattern.end());
      if (inner.size() + pattern.size() > static_cast<size_t>(std::numeric_limits<int>::max())) {
        throw std::length_error("A has more than 2^31 - 1 stored entries");
      }
      for (const int j : pattern) {
        inner.push_back(j);
        values.push_back(sums[static_cast<size_t>(j)]);
        sums[static_cast<size_t>(j)] = 0;
      }
      outer[static_cast<size_t>(i) + 1] = static_cast<int>(inner.size());
    }
    derived_sparse = Eigen::Map<const SparseMatrix>(n, n, static_cast<Index>(inner.size()), outer.data(), inner.data(),
                                                    values.data());
  }

  static bool HasSortedRowsWithDiagonal(const SparseMatrix& source) {
    for (Index i = 0; i < source.rows(); ++i) {
      int last = -1;
      bool has_diagonal = false;
      for (SparseMatrix::InnerIterator it(source, i); it; ++it) {
        if (it.col() <= last) return false;
        last = static_cast<int>(it.col());
        has_diagonal = has_diagonal || last == i;
      }
      if (!has_diagonal) return false;
    }
    return true;
  }

  // Copies `source` with every diagonal entry stored.
  void FormSparseWithDiagonal(const SparseMatrix& source) {
    const Index n = source.rows();
    if (HasSortedRowsWithDiagonal(source)) {
      derived_sparse = source;
      return;
    }
    std::vector<Eigen::Triplet<double, int>> entries;
    entries.reserve(static_cast<size_t>(source.nonZeros() + n));
    for (Index i = 0; i < n; ++i) {
      entries.emplace_back(static_cast<int>(i), static_cast<int>(i), 0.0);
      for (SparseMatrix::InnerIterator it(source, i); it; ++it) {
        entries.emplace_back(static_cast<int>(i), static_cast<int>(it.col()), it.value());
      }
    }
    derived_sparse.emplace(n, n).setFromTriplets(entries.begin(), entries.end());
  }
};

// A new problem's storage in one piece.
struct LcpProblem::Storage {
  Matrix matrix;
  Eigen::VectorXd b;
  bool has_extreme_b = false;
};

LcpProblem::LcpProblem(const std::shared_ptr<Storage>& storage)
    : matrix_(storage, &storage->matrix),
      b_(storage, &storage->b),
      has_extreme_matrix_(storage->matrix.has_extremes),
      has_extreme_b_(storage->has_extreme_b) {}

RowBounds RowBounds::WithBilateralRows(Index n, const std::vector<Index>& bilateral) {
  RowBounds bounds;
  if (!bilateral.empty()) bounds.bilateral.assign(static_cast<size_t>(n), 0);
  for (const Index row : bilateral) {
    const std::string what = "bilateral: row index " + std::to_string(row);
    if (row < 0 || row >= n) throw InputError(what + " is outside [0, " + std::to_string(n) + ")");
    if (std::exchange(bounds.bilateral[static_cast<size_t>(row)], 1) != 0) throw InputError(what + " is listed twice");
  }
  return bounds;
}

std::shared_ptr<LcpProblem::Storage> LcpProblem::MakeStorage(std::string id, MatrixForm form, Eigen::VectorXd b,
                                                             RowBounds bounds, MatrixFacts facts) {
  const Beyond beyond = RequireFinite(id, "b", kLoadRange, b.data(), b.size());
  const auto kinds = static_cast<Index>(bounds.bilateral.size());
  if (kinds > 0) RequireShape(id, "bilateral", kinds, 1, b.size(), 1);
  auto storage = std::make_shared<Storage>();
  Matrix& matrix = storage->matrix;
  matrix.id = std::move(id);
  matrix.form = form;
  matrix.rows = b.size();
  matrix.facts = facts;
  for (Index i = 0; i < kinds; ++i) {
    if (bounds.bilateral[static_cast<size_t>(i)] != 0) matrix.bilateral.push_back(i);
  }
  if (!bounds.is_plain()) RequireRowKinds(matrix.id, matrix.rows, &bounds);
  if (matrix.bilateral.empty()) bounds.bilateral.clear();
  matrix.bounds = std::move(bounds);
  storage->b = std::move(b);
  storage->has_extreme_b = beyond.least || beyond.most;
  return storage;
}

LcpProblem LcpProblem::FromDense(std::string id, Eigen::MatrixXd A, Eigen::VectorXd b, RowBounds bounds,
                                 MatrixFacts facts) {
  const auto storage = MakeStorage(std::move(id), MatrixForm::kDense, std::move(b), std::move(bounds), facts);
  Matrix& matrix = storage->matrix;
  RequireShape(matrix.id, "A", A.rows(), A.cols(), matrix.rows, matrix.rows);
  matrix.RequireFiniteValues("A", A.data(), A.size(), matrix.rows);
  matrix.dense = std::move(A);
  matrix.LookForExtremes();
  return LcpProblem(storage);
}

LcpProblem LcpProblem::FromSparse(std::string id, SparseMatrix A, Eigen::VectorXd b, RowBounds bounds,
                                  MatrixFacts facts) {
  const auto storage = MakeStorage(std::move(id), MatrixForm::kSparse, std::move(b), std::move(bounds), facts);
  storage->matrix.TakeSparse(&A, "A", storage->matrix.rows);
  storage->matrix.LookForExtremes();
  return LcpProblem(storage);
}

LcpProblem LcpProblem::FromFactors(std::string id, SparseMatrix J, Eigen::VectorXd inverse_mass, Eigen::VectorXd b,
                                   RowBounds bounds, MatrixFacts facts) {
  const auto storage = MakeStorage(std::move(id), MatrixForm::kFactors, std::move(b), std::move(bounds), facts);
  storage->matrix.TakeSparse(&J, "J", inverse_mass.size());
  storage->matrix.TakeMasses(std::move(inverse_mass));
  storage->matrix.LookForExtremes();
  return LcpProblem(storage);
}

ProblemArrays ProblemArrays::Of(const LcpProblem& problem) {
  ProblemArrays arrays;
  arrays.id = problem.id();
  arrays.form = problem.given_form();
  arrays.rows = arrays.columns = problem.size();
  const LcpProblem::Matrix& matrix = *problem.matrix_;
  if (arrays.form == MatrixForm::kDense) {
    for (Index i = 0; i < arrays.rows; ++i) {
      const auto row = matrix.dense.row(i);
      arrays.value.insert(arrays.value.end(), row.begin(), row.end());
    }
  } else {
    const SparseMatrix& given = matrix.sparse();
    arrays.columns = given.cols();
    arrays.row_start.assign(given.outerIndexPtr(), given.outerIndexPtr() + given.rows() + 1);
    arrays.column.assign(given.innerIndexPtr(), given.innerIndexPtr() + given.nonZeros());
    arrays.value.assign(given.valuePtr(), given.valuePtr() + given.nonZeros());
    arrays.inverse_mass.assign(matrix.inverse_mass.begin(), matrix.inverse_mass.end());
  }
  arrays.b.assign(problem.b().begin(), problem.b().end());
  arrays.bilateral = matrix.bounds.bilateral;
  arrays.friction = matrix.bounds.friction;
  arrays.bounded = matrix.bounds.bounded;
  arrays.facts = problem.facts();
  return arrays;
}

// Each array is copied once, to its place: engines make a problem per step, and the clock runs.
LcpProblem LcpProblem::FromArrays(const ProblemArrays& arrays) {
  const Index n = arrays.rows;
  RequireShape(arrays.id, "b", static_cast<Index>(arrays.b.size()), 1, n, 1);
  const auto count = static_cast<Index>(arrays.value.size());
  if (arrays.form != MatrixForm::kDense) {
    RequireCompressedRows(arrays);
  } else if (n > 0 ? count % n != 0 || count / n != n : count != 0) {
    Reject(arrays.id, "A must have " + std::to_string(n) + "^2 values, found " + std::to_string(count));
  }
  const auto storage = MakeStorage(arrays.id, arrays.form, Eigen::Map<const Eigen::VectorXd>(arrays.b.data(), n),
                                   {arrays.bilateral, arrays.friction, arrays.bounded}, arrays.facts);
  Matrix& matrix = storage->matrix;
  const bool has_factors = arrays.form == MatrixForm::kFactors;
  matrix.RequireFiniteValues(has_factors ? "J" : "A", arrays.value.data(), count);
  if (arrays.form == MatrixForm::kDense) {
    matrix.dense = Eigen::Map<const RowMajorMatrix>(arrays.value.data(), n, n);
    matrix.LookForExtremes();
    return LcpProblem(storage);
  }
  SparseMatrix& sparse = matrix.given_sparse.emplace(n, arrays.columns);
  sparse.resizeNonZeros(count);
  std::copy(arrays.row_start.begin(), arrays.row_start.end(), sparse.outerIndexPtr());
  std::copy(arrays.column.begin(), arrays.column.end(), sparse.innerIndexPtr());
  std::copy(arrays.value.begin(), arrays.value.end(), sparse.valuePtr());
  if (has_factors) {
    RequireShape(arrays.id, "inverse_mass", static_cast<Index>(arrays.inverse_mass.size()), 1, arrays.columns, 1);
    matrix.TakeMasses(Eigen::Map<const Eigen::VectorXd>(arrays.inverse_mass.data(), arrays.columns));
  }
  matrix.LookForExtremes();
  return LcpProblem(storage);
}

LcpProblem LcpProblem::WithB(Eigen::VectorXd b) const {
  RequireShape(id(), "b", b.size(), 1, size(), 1);
  const Beyond beyond = RequireFinite(id(), "b", kLoadRange, b.data(), b.size());
  LcpProblem other = *this;
  other.has_extreme_b_ = beyond.least || beyond.most;
  other.b_ = std::make_shared<const Eigen::VectorXd>(std::move(b));
  return other;
}

LcpProblem LcpProblem::CopyOfGivenForm() const { return WithBounds(bounds()); }

LcpProblem LcpProblem::WithBounds(RowBounds bounds) const {
  const Matrix& given = *matrix_;
  const auto storage = MakeStorage(given.id, given.form, b(), std::move(bounds), given.facts);
  storage->matrix.dense = given.dense;
  storage->matrix.given_sparse = given.given_sparse;
  storage->matrix.inverse_mass = given.inverse_mass;
  storage->matrix.has_extremes = given.has_extremes;
  return LcpProblem(storage);
}

LcpProblem LcpProblem::WithRows(const SparseMatrix& P, Eigen::VectorXd b, RowBounds bounds) const {
  MatrixFacts facts = this->facts();
  facts.rank.reset();
  facts.f_unique.reset();
  const SparseMatrix columns = P.transpose();
  switch (given_form()) {
    case MatrixForm::kFactors:
      return FromFactors(id(), P * J(), inverse_mass(), std::move(b), std::move(bounds), facts);
    case MatrixForm::kDense:
      return FromDense(id(), (P * DenseA()) * columns, std::move(b), std::move(bounds), facts);
    default:
      return FromSparse(id(), (P * SparseA()) * columns, std::move(b), std::move(bounds), facts);
  }
}

const std::string& LcpProblem::id() const { return matrix_->id; }
Index LcpProblem::size() const { return matrix_->rows; }
MatrixForm LcpProblem::given_form() const { return matrix_->form; }
const MatrixFacts& LcpProblem::facts() const { return matrix_->facts; }
const Eigen::VectorXd& LcpProblem::b() const { return *b_; }

bool LcpProblem::has_two_body_rows() const {
  Matrix& s = *matrix_;
  if (s.form != MatrixForm::kFactors) return false;
  s.two_body_once.Call([&] { s.two_body_rows = s.HasTwoBodyRows(); });
  return s.two_body_rows;
}

const SparseMatrix& LcpProblem::J() const {
  if (!has_factors()) throw std::logic_error("LcpProblem::J: the problem has no factors");
  return matrix_->sparse();
}

const Eigen::VectorXd& LcpProblem::inverse_mass() const {
  if (!has_factors()) throw std::logic_error("LcpProblem::inverse_mass: the problem has no factors");
  return matrix_->inverse_mass;
}

const Eigen::MatrixXd& LcpProblem::DenseA() const {
  Matrix& s = *matrix_;
  if (s.form == MatrixForm::kDense) return s.dense;
  s.dense_once.Call([&] {
    const auto n = static_cast<double>(size());
    RequireMemory(n * n * sizeof(double), "the dense A");
    if (s.form == MatrixForm::kSparse) {
      s.derived_dense = Eigen::MatrixXd(s.sparse());
      return;
    }
    s.derived_dense.resize(size(), size());
    Assemble(s.sparse(), s.inverse_mass.data(), s.derived_dense.data(), size());
  });
  return s.derived_dense;
}

const SparseMatrix& LcpProblem::SparseA() const {
  Matrix& s = *matrix_;
  s.sparse_once.Call([&] {
    switch (s.form) {
      case MatrixForm::kFactors:
        if (s.EveryPairSharesAColumn()) {
          s.FormSparseWithAll(DenseA());
        } else {
          s.FormSparseFromFactors();
        }
        break;
      case MatrixForm::kSparse:
        s.FormSparseWithDiagonal(s.sparse());
        break;
      case MatrixForm::kDense:
        s.FormSparseWithDiagonal(s.dense.sparseView(1.0, 0.0));
        break;
    }
  });
  return *s.derived_sparse;
}

const Eigen::VectorXd& LcpProblem::DiagonalA() const {
  Matrix& s = *matrix_;
  s.diagonal_once.Call([&] {
    switch (s.form) {
      case MatrixForm::kFactors:
        s.diagonal = Eigen::VectorXd::Zero(size());
        for (Index i = 0; i < size(); ++i) {
          double sum = 0;
          for (SparseMatrix::InnerIterator it(s.sparse(), i); it; ++it) {
            sum += s.inverse_mass[it.col()] * (it.value() * it.value());
          }
          s.diagonal[i] = sum;
        }
        break;
      case MatrixForm::kSparse:
        s.diagonal = s.sparse().diagonal();
        break;
      case MatrixForm::kDense:
        s.diagonal = s.dense.diagonal();
        break;
    }
  });
  return s.diagonal;
}

double LcpProblem::Asymmetry() const {
  Matrix& s = *matrix_;
  if (s.form == MatrixForm::kFactors) return 0;
  s.asymmetry_once.Call([&] {
    const Eigen::VectorXd& d = DiagonalA();
    const auto relative = [&](Index i, Index j, double difference) {
      const double scale = std::sqrt(std::abs(d[i])) * std::sqrt(std::abs(d[j]));
      return std::abs(difference) / (scale > 0 ? scale : 1.0);
    };
    double worst = 0;
    if (s.form == MatrixForm::kDense) {
      for (Index j = 0; j < size(); ++j) {
        for (Index i = j + 1; i < size(); ++i) {
          worst = std::max(worst, relative(i, j, s.dense(i, j) - s.dense(j, i)));
        }
      }
    } else {
      const SparseMatrix transpose = s.sparse().transpose();
      const SparseMatrix difference = s.sparse() - transpose;
      for (Index i = 0; i < difference.outerSize(); ++i) {
        for (SparseMatrix::InnerIterator it(difference, i); it; ++it) {
          worst = std::max(worst, relative(i, it.col(), it.value()));
        }
      }
    }
    s.asymmetry = worst;
  });
  return s.asymmetry;
}

void LcpProblem::ComputeW(const Eigen::VectorXd& f, Eigen::VectorXd* w) const {
  const Matrix& s = *matrix_;
  *w = b();
  switch (s.form) {
    case MatrixForm::kDense:
      w->noalias() += s.dense * f;
      break;
    case MatrixForm::kSparse:
      w->noalias() += s.sparse() * f;
      break;
    case MatrixForm::kFactors: {
      const Eigen::VectorXd body = s.inverse_mass.cwiseProduct(s.sparse().transpose() * f);
      w->noalias() += s.sparse() * body;
      break;
    }
  }
}

bool LcpProblem::is_bilateral(Index row) const {
  const std::vector<unsigned char>& kinds = matrix_->bounds.bilateral;
  return !kinds.empty() && kinds[static_cast<size_t>(row)] != 0;
}

RowKind LcpProblem::kind(Index row) const {
  if (is_bilateral(row)) return RowKind::kBilateral;
  const RowBounds& bounds = matrix_->bounds;
  if (std::ranges::binary_search(bounds.friction, row, {}, &FrictionRow::row)) return RowKind::kFriction;
  if (std::ranges::binary_search(bounds.bounded, row, {}, &BoundedRow::row)) return RowKind::kBounded;
  return RowKind::kUnilateral;
}

const std::vector<Index>& LcpProblem::bilateral_rows() const { return matrix_->bilateral; }
const RowBounds& LcpProblem::bounds() const { return matrix_->bounds; }

LcpProblem InForm(const LcpProblem& problem, MatrixForm form) {
  if (form == MatrixForm::kDense) {
    return LcpProblem::FromDense(problem.id(), problem.DenseA(), problem.b(), problem.bounds(), problem.facts());
  }
  return LcpProblem::FromSparse(problem.id(), problem.SparseA(), problem.b(), problem.bounds(), problem.facts());
}

LcpProblem Symmetrized(const LcpProblem& problem, MatrixFacts facts) {
  facts.symmetric = true;
  // Halves first, so that nothing overflows.
  switch (problem.given_form()) {
    case MatrixForm::kDense: {
      const Eigen::MatrixXd& A = problem.DenseA();
      return LcpProblem::FromDense(problem.id(), 0.5 * A + 0.5 * A.transpose(), problem.b(), problem.bounds(), facts);
    }
    case MatrixForm::kSparse: {
      const SparseMatrix& A = problem.SparseA();
      const SparseMatrix turned = A.transpose();
      return LcpProblem::FromSparse(problem.id(), 0.5 * A + 0.5 * turned, problem.b(), problem.bounds(), facts);
    }
    default:
      return problem;
  }
}

void AssembleDenseA(const LcpProblem& problem, double* A, Index stride) {
  if (problem.has_factors()) return Assemble(problem.J(), problem.inverse_mass().data(), A, stride);
  const Index n = problem.size();
  Eigen::Map<RowMajorMatrix> rows(A, n, stride);
  rows.leftCols(n) = problem.DenseA();
  rows.rightCols(stride - n).setZero();
}

void AssembleDenseA(const ProblemArrays& arrays, double* A, Index stride) {
  const Index n = arrays.rows;
  switch (arrays.form) {
    case MatrixForm::kFactors:
      return Assemble(
          Eigen::Map<const SparseMatrix>(n, arrays.columns, static_cast<Index>(arrays.value.size()),
                                         arrays.row_start.data(), arrays.column.data(), arrays.value.data()),
          arrays.inverse_mass.data(), A, stride);
    case MatrixForm::kSparse:
      std::fill_n(A, n * stride, 0.0);
      for (Index i = 0; i < n; ++i) {
        const auto end = static_cast<size_t>(arrays.row_start[static_cast<size_t>(i) + 1]);
        for (auto e = static_cast<size_t>(arrays.row_start[static_cast<size_t>(i)]); e < end; ++e) {
          A[i * stride + arrays.column[e]] = arrays.value[e];
        }
      }
      return;
    case MatrixForm::kDense:
      for (Index i = 0; i < n; ++i) {
        double* const padding = std::copy_n(arrays.value.data() + i * n, n, A + i * stride);
        std::fill_n(padding, stride - n, 0.0);
      }
      return;
  }
}

Index BoundEntriesOfA(const LcpProblem& problem) {
  const SparseMatrix& J = problem.J();
  const Index width = problem.columns_per_body();
  std::vector<Index> rows_on(static_cast<size_t>((J.cols() + width - 1) / width), 0);
  for (Index i = 0; i < J.rows(); ++i) {
    Index last = -1;
    for (SparseMatrix::InnerIterator it(J, i); it; ++it) {
      if (it.col() / width == last || problem.inverse_mass()[it.col()] == 0) continue;
      last = it.col() / width;
      ++rows_on[static_cast<size_t>(last)];
    }
  }
  Index entries = 0;
  for (const Index count : rows_on) entries += count * count;
  return entries;
}

}  // namespace lcpbench
