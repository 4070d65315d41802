#include "solvers/lcp/problem.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
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
using SparseRows = Eigen::Map<const SparseMatrix>;

SparseRows RowsOf(const ProblemView& given) {
  return {given.rows,          given.columns,     std::ssize(given.value), given.row_start.data(),
          given.column.data(), given.value.data()};
}

[[noreturn]] void Reject(std::string_view id, const std::string& what) {
  throw InputError(id.empty() ? what : "problem '" + std::string(id) + "': " + what);
}

// Which ends of the range there are numbers beyond, zeros apart.
struct Beyond {
  bool least = false;
  bool most = false;
};

// @param side  of a dense matrix, by rows, whose entries are named by row and column; 0: an array of numbers
Beyond RequireFinite(std::string_view id, const char* name, const MagnitudeRange& range, const double* values,
                     Index count, Index side = 0) {
  NumberRange looked(range);
  looked.Look(values, count);
  if (!looked.has_large()) return {looked.has_small(), false};
  const double* found = std::find_if(values, values + count, [](double value) { return !std::isfinite(value); });
  if (found == values + count) return {looked.has_small(), true};
  const Index k = found - values;
  const std::string place = side == 0 ? "[" + std::to_string(k) + "]"
                                      : ": entry (" + std::to_string(k / side) + ", " + std::to_string(k % side) + ")";
  Reject(id, name + place + " is " + std::to_string(*found) + ", expected a finite number");
}

[[noreturn]] void RejectShape(std::string_view id, const char* name, Index rows, Index cols, Index want_rows,
                              Index want_cols) {
  Reject(id, std::string(name) + " must be " + std::to_string(want_rows) + " x " + std::to_string(want_cols) +
                 ", found " + std::to_string(rows) + " x " + std::to_string(cols));
}

void RequireShape(std::string_view id, const char* name, Index rows, Index cols, Index want_rows, Index want_cols) {
  if (rows != want_rows || cols != want_cols) RejectShape(id, name, rows, cols, want_rows, want_cols);
}

// Checks the sizes of arrays in the two sparse forms.
void RequireCompressedRows(const ProblemView& arrays) {
  const auto count = static_cast<Index>(arrays.column.size());
  if (arrays.columns < 0 || (arrays.form == MatrixForm::kSparse && arrays.columns != arrays.rows)) {
    Reject(arrays.id, "columns must be " + std::string(arrays.form == MatrixForm::kSparse ? "rows" : ">= 0") +
                          ", found " + std::to_string(arrays.columns));
  }
  RequireShape(arrays.id, "row_start", static_cast<Index>(arrays.row_start.size()), 1, arrays.rows + 1, 1);
  RequireShape(arrays.id, "value", static_cast<Index>(arrays.value.size()), 1, count, 1);
}

void RequireColumns(const ProblemView& arrays) {
  std::string why = WhyNotStarts(arrays.row_start, std::ssize(arrays.column), "row_start", "entries");
  if (why.empty()) why = WhyNotColumns(arrays.row_start, arrays.column, arrays.columns, "column");
  if (!why.empty()) Reject(arrays.id, why);
}

// That friction and bounded rows are of one kind, and their numbers in range.
void RequireRowKinds(const ProblemView& given) {
  const std::string_view id = given.id;
  const Index n = given.rows;
  std::vector<RowKind> kinds(static_cast<size_t>(n), RowKind::kUnilateral);
  for (size_t i = 0; i < given.bilateral.size(); ++i) {
    if (given.bilateral[i] != 0) kinds[i] = RowKind::kBilateral;
  }
  const auto take = [&](const char* what, Index row, RowKind kind) {
    const auto place = [&] { return std::string(what) + ": row " + std::to_string(row); };
    if (row < 0 || row >= n) Reject(id, place() + " is outside [0, " + std::to_string(n) + ")");
    const RowKind before = std::exchange(kinds[static_cast<size_t>(row)], kind);
    if (before == kind) Reject(id, place() + " is listed twice");
    if (before != RowKind::kUnilateral) {
      Reject(id, place() + " is a " + (before == RowKind::kBilateral ? "bilateral" : "friction") + " row already");
    }
  };
  for (const FrictionRow& row : given.friction) take("friction", row.row, RowKind::kFriction);
  for (const BoundedRow& row : given.bounded) take("bounded", row.row, RowKind::kBounded);
  for (const FrictionRow& row : given.friction) {
    const auto place = [&] { return "friction: row " + std::to_string(row.row) + ": "; };
    if (row.normal < 0 || row.normal >= n || kinds[static_cast<size_t>(row.normal)] != RowKind::kUnilateral) {
      Reject(id, place() + "normal is " + std::to_string(row.normal) + ", expected a unilateral row");
    }
    if (!std::isfinite(row.mu) || row.mu < 0) {
      Reject(id, place() + "mu is " + NumberText(row.mu) + ", expected a finite number >= 0");
    }
    if (row.slip < -1 || row.slip > 1) {
      Reject(id, place() + "slip is " + std::to_string(row.slip) + ", expected -1, 0 or 1");
    }
  }
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (const BoundedRow& row : given.bounded) {
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
void MultiplyTiles(const double* first, const double* second, const double* mass, Index columns,
                                   double* sum) {
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

std::span<const double> NumbersOf(const Eigen::VectorXd& vector) {
  return {vector.data(), static_cast<size_t>(vector.size())};
}

// Room for so many bytes more behind what is allocated; *room is where they begin.
template <typename T>
struct AllocatorWithRoom {
  using value_type = T;
  AllocatorWithRoom(size_t more, std::byte** begin) : bytes(more), room(begin) {}
  template <typename Other>
  explicit AllocatorWithRoom(const AllocatorWithRoom<Other>& other) : bytes(other.bytes), room(other.room) {}
  T* allocate(size_t count) {
    auto* const at = static_cast<std::byte*>(::operator new(count * sizeof(T) + bytes));
    *room = at + count * sizeof(T);
    return reinterpret_cast<T*>(at);
  }
  void deallocate(T* at, size_t /*count*/) { ::operator delete(at); }
  size_t bytes;
  std::byte** room;
};

// J and inverse_mass of kFactors, which lie one behind the other, where the other arrays fit.
Beyond RequireFactors(const ProblemView& given) {
  RequireShape(given.id, "inverse_mass", std::ssize(given.inverse_mass), 1, given.columns, 1);
  if (given.facts.columns_per_body != 3 && given.facts.columns_per_body != 6) {
    Reject(given.id, "columns_per_body is " + std::to_string(given.facts.columns_per_body) +
                         ", expected 3 (bodies in the plane) or 6 (in space)");
  }
  const double* const masses = given.inverse_mass.data();
  const auto entries = std::ssize(given.value);
  NumberRange looked(kFactorRange);
  looked.Look(given.value.data(), entries + given.columns);
  if (looked.has_large()) {  // which, and whether finite
    RequireFinite(given.id, "J", kFactorRange, given.value.data(), entries);
    RequireFinite(given.id, "inverse_mass", kFactorRange, masses, given.columns);
  }
  const Beyond beyond{looked.has_small(), looked.has_large()};
  if (!HasSign(masses, given.columns)) return beyond;
  const double* const wrong = std::find_if(masses, masses + given.columns, [](double mass) { return mass < 0; });
  if (wrong == masses + given.columns) return beyond;
  Reject(given.id, "inverse_mass[" + std::to_string(wrong - masses) + "] is " + std::to_string(*wrong) +
                       ", expected a number >= 0");
}

template <typename Form>
struct OnRequest {
  std::atomic<bool> is_made = false;
  Form form{};
};

}  // namespace

// Forms that are made on the first request, under one lock, which is seldom waited for. (std::call_once calls the
// kernel each time it has run something, which takes longer than a form of a few rows.)
struct LcpProblem::Derived {
  std::recursive_mutex lock;  // forms are made of others
  // Eigen's sparse matrices allocate even where they are empty.
  OnRequest<std::optional<SparseMatrix>> J, sparse;
  OnRequest<Eigen::MatrixXd> dense;
  OnRequest<Eigen::VectorXd> inverse_mass, b, diagonal;
  OnRequest<std::string> id;
  OnRequest<RowBounds> bounds;
  OnRequest<std::vector<Index>> bilateral;
  OnRequest<double> asymmetry;
  OnRequest<bool> two_body_rows;
};

// What was given, in the memory behind this, and what has been derived of it: shared by problems that differ in b only.
struct LcpProblem::Matrix {
  ProblemView given;
  bool has_extremes = false;
  mutable std::atomic<Derived*> derived = nullptr;

  explicit Matrix(const ProblemView& view) : given(view) {}
  Matrix(const Matrix&) = delete;
  Matrix& operator=(const Matrix&) = delete;
  ~Matrix() { delete derived.load(std::memory_order_relaxed); }

  // make(&form) where it is not made yet, also where several threads ask.
  template <typename Form, typename MakeForm>
  const Form& Get(OnRequest<Form> Derived::*member, const MakeForm& make) const {
    Derived* all = derived.load(std::memory_order_acquire);
    if (all == nullptr) {
      auto made = std::make_unique<Derived>();
      if (derived.compare_exchange_strong(all, made.get())) all = made.release();
    }
    OnRequest<Form>& wanted = all->*member;
    if (wanted.is_made.load(std::memory_order_acquire)) return wanted.form;
    const std::scoped_lock held(all->lock);
    if (!wanted.is_made.load(std::memory_order_relaxed)) {
      make(&wanted.form);
      wanted.is_made.store(true, std::memory_order_release);
    }
    return wanted.form;
  }

  bool is_plain() const { return given.friction.empty() && given.bounded.empty(); }
  // A of kSparse, J of kFactors.
  SparseRows sparse() const { return RowsOf(given); }
  Eigen::Map<const Eigen::VectorXd> inverse_mass() const { return {given.inverse_mass.data(), given.columns}; }
  Eigen::Map<const RowMajorMatrix> dense() const { return {given.value.data(), given.rows, given.rows}; }

  double DiagonalOf(Index i) const {
    if (given.form == MatrixForm::kDense) return dense()(i, i);
    if (given.form == MatrixForm::kSparse) return sparse().coeff(i, i);
    double sum = 0;
    for (SparseRows::InnerIterator it(sparse(), i); it; ++it) {
      sum += given.inverse_mass[static_cast<size_t>(it.col())] * (it.value() * it.value());
    }
    return sum;
  }

  // Once all arrays are in their places. Small numbers do no harm beside others of their row, and the largest entries
  // of A = J M^-1 J^T stand on its diagonal.
  void LookForExtremes(const Beyond& beyond) {
    has_extremes = beyond.most;
    if (!beyond.least && !beyond.most) return;
    for (Index i = 0; i < given.rows; ++i) {
      long double of_row = 0;
      if (given.form == MatrixForm::kFactors) {
        for (SparseRows::InnerIterator it(sparse(), i); it; ++it) {
          of_row += static_cast<long double>(it.value()) * it.value() * inverse_mass()[it.col()];
        }
      } else {
        of_row = std::abs(DiagonalOf(i));
      }
      if (of_row > std::numeric_limits<double>::max()) {
        Reject(given.id,
               "J M^-1 J^T must be finite, the diagonal entry of row " + std::to_string(i) + " is beyond doubles");
      }
      if (of_row > kEntryRange.most || (of_row < kEntryRange.least && of_row > 0)) has_extremes = true;
    }
  }

  bool HasTwoBodyRows() const {
    if (!given.body.empty()) return true;
    const Index width = given.facts.columns_per_body;
    if (given.columns % width != 0) return false;
    for (Index i = 0; i < given.rows; ++i) {
      Index first = -1;
      Index second = -1;
      for (SparseRows::InnerIterator it(sparse(), i); it; ++it) {
        const Index block = it.col() / width;
        if (inverse_mass()[it.col()] == 0 || it.value() == 0 || block == first || block == second) continue;
        if (second >= 0) return false;
        second = std::exchange(first, block);
      }
    }
    return true;
  }

  // Whether every row of J has more than half of the columns that can move; at most 2^31 - 1 pairs.
  bool EveryPairSharesAColumn() const {
    const Index n = given.rows;
    if (!HasDenseRows(sparse()) || n * n > std::numeric_limits<int>::max()) return false;
    const auto movable = static_cast<Index>((inverse_mass().array() != 0).count());
    for (Index i = 0; i < n; ++i) {
      Index count = 0;
      for (SparseRows::InnerIterator it(sparse(), i); it; ++it) count += inverse_mass()[it.col()] != 0 ? 1 : 0;
      if (2 * count <= movable) return false;
    }
    return true;
  }

  // Every entry of a symmetric matrix, zeros too.
  static void FormSparseWithAll(const Eigen::MatrixXd& symmetric, std::optional<SparseMatrix>* form) {
    const Index n = symmetric.rows();
    RequireSparseMatrices(n, static_cast<double>(n) * static_cast<double>(n), 1);
    SparseMatrix& all = form->emplace(n, n);
    all.resizeNonZeros(n * n);
    for (Index i = 0; i <= n; ++i) all.outerIndexPtr()[i] = static_cast<int>(i * n);
    for (Index i = 0; i < n; ++i) std::iota(all.innerIndexPtr() + i * n, all.innerIndexPtr() + (i + 1) * n, 0);
    std::copy_n(symmetric.data(), n * n, all.valuePtr());
  }

  // A = J M^-1 J^T row by row. Every entry sums m_k (J_ik J_jk) over ascending k, so (i, j) and (j, i) round alike.
  void FormSparseFromFactors(std::optional<SparseMatrix>* form) const {
    const SparseRows J = sparse();
    const auto masses = inverse_mass();
    const Index n = given.rows;
    const Eigen::SparseMatrix<double, Eigen::ColMajor, int> columns = J;
    // An entry is a pair of rows that share a body, which has several columns.
    double pairs = 0;
    for (Index k = 0; k < columns.cols(); ++k) {
      const double count = masses[k] == 0 ? 0 : columns.outerIndexPtr()[k + 1] - columns.outerIndexPtr()[k];
      pairs += count * count;
    }
    RequireSparseMatrices(
        n, std::min(pairs / given.facts.columns_per_body, static_cast<double>(n) * static_cast<double>(n)), 2);
    std::vector<double> sums(static_cast<size_t>(n), 0.0);
    std::vector<Index> last_row(static_cast<size_t>(n), -1);
    std::vector<int> pattern;
    std::vector<int> outer(static_cast<size_t>(n) + 1, 0);
    std::vector<int> inner;
    std::vector<double> values;
    for (Index i = 0; i < n; ++i) {
      pattern.assign(1, static_cast<int>(i));
      last_row[static_cast<size_t>(i)] = i;
      for (SparseRows::InnerIterator it(J, i); it; ++it) {
        const double m = masses[it.col()];
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
    *form = SparseRows(n, n, static_cast<Index>(inner.size()), outer.data(), inner.data(), values.data());
  }

  static bool HasSortedRowsWithDiagonal(const Eigen::Ref<const SparseMatrix>& source) {
    for (Index i = 0; i < source.rows(); ++i) {
      int last = -1;
      bool has_diagonal = false;
      for (Eigen::Ref<const SparseMatrix>::InnerIterator it(source, i); it; ++it) {
        if (it.col() <= last) return false;
        last = static_cast<int>(it.col());
        has_diagonal = has_diagonal || last == i;
      }
      if (!has_diagonal) return false;
    }
    return true;
  }

  // Copies `source` with every diagonal entry stored.
  static void FormSparseWithDiagonal(const Eigen::Ref<const SparseMatrix>& source, std::optional<SparseMatrix>* form) {
    const Index n = source.rows();
    if (HasSortedRowsWithDiagonal(source)) {
      return CopyRows(source, &form->emplace());
    }
    std::vector<Eigen::Triplet<double, int>> entries;
    entries.reserve(static_cast<size_t>(source.nonZeros() + n));
    for (Index i = 0; i < n; ++i) {
      entries.emplace_back(static_cast<int>(i), static_cast<int>(i), 0.0);
      for (Eigen::Ref<const SparseMatrix>::InnerIterator it(source, i); it; ++it) {
        entries.emplace_back(static_cast<int>(i), static_cast<int>(it.col()), it.value());
      }
    }
    form->emplace(n, n).setFromTriplets(entries.begin(), entries.end());
  }
};

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

// Each array is copied once, to its place: engines make a problem per step, and the clock runs.
LcpProblem LcpProblem::Make(const ProblemView& from, bool has_checked_columns) {
  const Beyond of_b = RequireFinite(from.id, "b", kLoadRange, from.b.data(), from.rows);
  const auto kinds = std::ssize(from.bilateral);
  if (kinds > 0) RequireShape(from.id, "bilateral", kinds, 1, from.rows, 1);
  const bool has_factors = from.form == MatrixForm::kFactors;
  const bool has_starts = from.form != MatrixForm::kDense;
  const bool has_joints = std::ranges::any_of(from.bilateral, [](unsigned char kind) { return kind != 0; });
  const size_t masses = has_factors ? from.inverse_mass.size() : 0;
  const size_t starts = has_starts ? from.row_start.size() : 0;
  const size_t columns = has_starts ? from.column.size() : 0;
  const size_t joints = has_joints ? from.bilateral.size() : 0;
  const size_t bodies = has_factors ? 2 * from.b.size() : 0;
  const size_t bytes = (from.value.size() + masses + from.b.size()) * sizeof(double) + from.friction.size_bytes() +
                       from.bounded.size_bytes() + (starts + columns + bodies) * sizeof(int) + joints + from.id.size();
  std::byte* room = nullptr;
  auto matrix = std::allocate_shared<Matrix>(AllocatorWithRoom<Matrix>(bytes, &room), from);
  const auto copy = [&room]<typename Number>(const Number* numbers, size_t count) {
    const std::span<Number> copied(reinterpret_cast<Number*>(room), count);
    std::copy_n(numbers, count, copied.begin());
    room += count * sizeof(Number);
    return copied;
  };
  ProblemView& given = matrix->given;
  given.value = copy(from.value.data(), from.value.size());  // numbers of eight bytes come before those of four
  given.inverse_mass = copy(from.inverse_mass.data(), masses);
  given.b = copy(from.b.data(), from.b.size());
  const std::span<FrictionRow> friction = copy(from.friction.data(), from.friction.size());
  const std::span<BoundedRow> bounded = copy(from.bounded.data(), from.bounded.size());
  given.friction = friction;
  given.bounded = bounded;
  given.row_start = copy(from.row_start.data(), starts);
  given.column = copy(from.column.data(), columns);
  const std::span<std::int32_t> body(reinterpret_cast<std::int32_t*>(room), bodies);
  room += body.size_bytes();
  given.bilateral = copy(from.bilateral.data(), joints);
  given.id = {copy(from.id.data(), from.id.size()).data(), from.id.size()};
  if (!matrix->is_plain()) {
    std::ranges::sort(friction, {}, &FrictionRow::row);
    std::ranges::sort(bounded, {}, &BoundedRow::row);
    RequireRowKinds(given);
  }
  const bool is_dense = from.form == MatrixForm::kDense;
  const auto entries = std::ssize(given.value);
  const Beyond of_A =
      has_factors ? RequireFactors(given)
                  : RequireFinite(given.id, "A", kEntryRange, given.value.data(), entries, is_dense ? given.rows : 0);
  const bool has_two_bodies = has_factors && FindTwoBodies(given.row_start, given.column, given.inverse_mass,
                                                           given.facts.columns_per_body, body.data());
  given.body = has_two_bodies ? body : std::span<std::int32_t>();
  if (!has_two_bodies && !has_checked_columns) RequireColumns(given);
  if (has_factors) given.facts.symmetric = given.facts.positive_semidefinite = true;
  matrix->LookForExtremes(of_A);
  given.is_checked = true;
  return LcpProblem(std::move(matrix), of_b.least || of_b.most);
}

namespace {

ProblemView ViewOf(const std::string& id, MatrixForm form, const Eigen::VectorXd& b, const RowBounds& bounds,
                   const MatrixFacts& facts) {
  const Index n = b.size();
  return {id, form, n, n, {}, {}, {}, {}, NumbersOf(b), bounds.bilateral, bounds.friction, bounds.bounded, facts};
}

// The compressed rows of J or A, whose shape is that of the view.
void SetRows(const char* name, SparseMatrix* matrix, ProblemView* view) {
  RequireShape(view->id, name, matrix->rows(), matrix->cols(), view->rows, view->columns);
  matrix->makeCompressed();
  const auto entries = static_cast<size_t>(matrix->nonZeros());
  view->row_start = {matrix->outerIndexPtr(), static_cast<size_t>(view->rows) + 1};
  view->column = {matrix->innerIndexPtr(), entries};
  view->value = {matrix->valuePtr(), entries};
}

}  // namespace

// Callers hand over what they need no longer; all is copied to one place.
// NOLINTBEGIN(performance-unnecessary-value-param)
LcpProblem LcpProblem::FromDense(std::string id, Eigen::MatrixXd A, Eigen::VectorXd b, RowBounds bounds,
                                 MatrixFacts facts) {
  ProblemView view = ViewOf(id, MatrixForm::kDense, b, bounds, facts);
  RequireShape(id, "A", A.rows(), A.cols(), view.rows, view.rows);
  A.transposeInPlace();
  view.value = {A.data(), static_cast<size_t>(A.size())};
  return Make(view);
}

LcpProblem LcpProblem::FromSparse(std::string id, SparseMatrix A, Eigen::VectorXd b, RowBounds bounds,
                                  MatrixFacts facts) {
  ProblemView view = ViewOf(id, MatrixForm::kSparse, b, bounds, facts);
  SetRows("A", &A, &view);
  return Make(view);
}

LcpProblem LcpProblem::FromFactors(std::string id, SparseMatrix J, Eigen::VectorXd inverse_mass, Eigen::VectorXd b,
                                   RowBounds bounds, MatrixFacts facts) {
  ProblemView view = ViewOf(id, MatrixForm::kFactors, b, bounds, facts);
  view.columns = inverse_mass.size();
  view.inverse_mass = NumbersOf(inverse_mass);
  SetRows("J", &J, &view);
  return Make(view);
}
// NOLINTEND(performance-unnecessary-value-param)

LcpProblem LcpProblem::FromArrays(const ProblemView& arrays) {
  if (arrays.is_checked) return Make(arrays);
  const Index n = arrays.rows;
  RequireShape(arrays.id, "b", std::ssize(arrays.b), 1, n, 1);
  const Index count = std::ssize(arrays.value);
  if (arrays.form != MatrixForm::kDense) {
    RequireCompressedRows(arrays);
  } else if (n > 0 ? count % n != 0 || count / n != n : count != 0) {
    Reject(arrays.id, "A must have " + std::to_string(n) + "^2 values, found " + std::to_string(count));
  }
  return Make(arrays, arrays.form == MatrixForm::kDense);
}

ProblemView LcpProblem::view() const {
  ProblemView view = matrix_->given;
  view.b = loads();
  return view;
}

ProblemArrays ProblemArrays::Of(const LcpProblem& problem) {
  const ProblemView view = problem.view();
  const auto copy = [](const auto& numbers) { return std::vector(numbers.begin(), numbers.end()); };
  return {std::string(view.id),
          view.form,
          view.rows,
          view.columns,
          copy(view.row_start),
          copy(view.column),
          copy(view.value),
          copy(view.inverse_mass),
          copy(view.b),
          copy(view.bilateral),
          copy(view.friction),
          copy(view.bounded),
          view.facts};
}

LcpProblem LcpProblem::WithB(Eigen::VectorXd b) const {
  RequireShape(matrix_->given.id, "b", b.size(), 1, size(), 1);
  const Beyond beyond = RequireFinite(matrix_->given.id, "b", kLoadRange, b.data(), b.size());
  LcpProblem other(matrix_, beyond.least || beyond.most);
  other.b_ = std::make_shared<const Eigen::VectorXd>(std::move(b));
  return other;
}

LcpProblem LcpProblem::CopyOfGivenForm() const { return Make(view()); }

LcpProblem LcpProblem::WithBounds(RowBounds bounds) const {
  ProblemView view = this->view();
  view.bilateral = bounds.bilateral;
  view.friction = bounds.friction;
  view.bounded = bounds.bounded;
  return Make(view);
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

const std::string& LcpProblem::id() const {
  return matrix_->Get(&Derived::id, [this](std::string* id) { *id = matrix_->given.id; });
}
Index LcpProblem::size() const { return matrix_->given.rows; }
MatrixForm LcpProblem::given_form() const { return matrix_->given.form; }
const MatrixFacts& LcpProblem::facts() const { return matrix_->given.facts; }
bool LcpProblem::has_extreme_matrix() const { return matrix_->has_extremes; }
bool LcpProblem::is_plain() const { return matrix_->is_plain(); }

const Eigen::VectorXd& LcpProblem::b() const {
  if (b_ != nullptr) return *b_;
  return matrix_->Get(&Derived::b, [this](Eigen::VectorXd* b) {
    *b = Eigen::Map<const Eigen::VectorXd>(matrix_->given.b.data(), size());
  });
}

std::span<const double> LcpProblem::loads() const { return b_ != nullptr ? NumbersOf(*b_) : matrix_->given.b; }

bool LcpProblem::has_two_body_rows() const {
  return has_factors() &&
         matrix_->Get(&Derived::two_body_rows, [this](bool* holds) { *holds = matrix_->HasTwoBodyRows(); });
}

const SparseMatrix& LcpProblem::J() const {
  if (!has_factors()) throw std::logic_error("LcpProblem::J: the problem has no factors");
  return *matrix_->Get(&Derived::J,
                       [this](std::optional<SparseMatrix>* J) { CopyRows(matrix_->sparse(), &J->emplace()); });
}

const Eigen::VectorXd& LcpProblem::inverse_mass() const {
  if (!has_factors()) throw std::logic_error("LcpProblem::inverse_mass: the problem has no factors");
  return matrix_->Get(&Derived::inverse_mass, [this](Eigen::VectorXd* masses) { *masses = matrix_->inverse_mass(); });
}

const Eigen::MatrixXd& LcpProblem::DenseA() const {
  return matrix_->Get(&Derived::dense, [this](Eigen::MatrixXd* A) {
    const Matrix& s = *matrix_;
    const auto n = static_cast<double>(size());
    if (s.given.form != MatrixForm::kDense) RequireMemory(n * n * sizeof(double), "the dense A");
    if (s.given.form == MatrixForm::kDense) {
      *A = s.dense();
    } else if (s.given.form == MatrixForm::kSparse) {
      *A = s.sparse();
    } else {
      A->resize(size(), size());
      Assemble(s.sparse(), s.given.inverse_mass.data(), A->data(), size());
    }
  });
}

const SparseMatrix& LcpProblem::SparseA() const {
  return *matrix_->Get(&Derived::sparse, [this](std::optional<SparseMatrix>* A) {
    const Matrix& s = *matrix_;
    if (s.given.form == MatrixForm::kSparse) return Matrix::FormSparseWithDiagonal(s.sparse(), A);
    if (s.given.form == MatrixForm::kDense) {
      const SparseMatrix entries = s.dense().sparseView(1.0, 0.0);
      return Matrix::FormSparseWithDiagonal(entries, A);
    }
    if (s.EveryPairSharesAColumn()) return Matrix::FormSparseWithAll(DenseA(), A);
    s.FormSparseFromFactors(A);
  });
}

const Eigen::VectorXd& LcpProblem::DiagonalA() const {
  return matrix_->Get(&Derived::diagonal, [this](Eigen::VectorXd* diagonal) {
    const Matrix& s = *matrix_;
    diagonal->resize(size());
    for (Index i = 0; i < size(); ++i) (*diagonal)[i] = s.DiagonalOf(i);
  });
}

double LcpProblem::Asymmetry() const {
  if (has_factors()) return 0;
  return matrix_->Get(&Derived::asymmetry, [this](double* asymmetry) {
    const Matrix& s = *matrix_;
    const Eigen::VectorXd& d = DiagonalA();
    const auto relative = [&](Index i, Index j, double difference) {
      const double scale = std::sqrt(std::abs(d[i])) * std::sqrt(std::abs(d[j]));
      return std::abs(difference) / (scale > 0 ? scale : 1.0);
    };
    double worst = 0;
    if (s.given.form == MatrixForm::kDense) {
      for (Index j = 0; j < size(); ++j) {
        for (Index i = j + 1; i < size(); ++i) {
          worst = std::max(worst, relative(i, j, s.dense()(i, j) - s.dense()(j, i)));
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
    *asymmetry = worst;
  });
}

void LcpProblem::ComputeW(const Eigen::VectorXd& f, Eigen::VectorXd* w) const {
  const Matrix& s = *matrix_;
  *w = b();
  switch (s.given.form) {
    case MatrixForm::kDense:
      w->noalias() += DenseA() * f;
      break;
    case MatrixForm::kSparse:
      w->noalias() += s.sparse() * f;
      break;
    case MatrixForm::kFactors: {
      const Eigen::VectorXd body = s.inverse_mass().cwiseProduct(s.sparse().transpose() * f);
      w->noalias() += s.sparse() * body;
      break;
    }
  }
}

bool LcpProblem::is_bilateral(Index row) const {
  const std::span<const unsigned char> kinds = matrix_->given.bilateral;
  return !kinds.empty() && kinds[static_cast<size_t>(row)] != 0;
}

RowKind LcpProblem::kind(Index row) const {
  if (is_bilateral(row)) return RowKind::kBilateral;
  const ProblemView& given = matrix_->given;
  if (std::ranges::binary_search(given.friction, row, {}, &FrictionRow::row)) return RowKind::kFriction;
  if (std::ranges::binary_search(given.bounded, row, {}, &BoundedRow::row)) return RowKind::kBounded;
  return RowKind::kUnilateral;
}

const std::vector<Index>& LcpProblem::bilateral_rows() const {
  return matrix_->Get(&Derived::bilateral, [this](std::vector<Index>* rows) {
    for (Index i = 0; i < size(); ++i) {
      if (is_bilateral(i)) rows->push_back(i);
    }
  });
}

// Who asks for lists of a problem that has none does not wait for them.
const RowBounds& LcpProblem::bounds() const {
  static const RowBounds kNone;
  const ProblemView& given = matrix_->given;
  if (is_plain() && given.bilateral.empty()) return kNone;
  return matrix_->Get(&Derived::bounds, [&given](RowBounds* bounds) {
    bounds->bilateral.assign(given.bilateral.begin(), given.bilateral.end());
    bounds->friction.assign(given.friction.begin(), given.friction.end());
    bounds->bounded.assign(given.bounded.begin(), given.bounded.end());
  });
}

const std::vector<FrictionRow>& LcpProblem::friction_rows() const {
  static const std::vector<FrictionRow> kNone;
  return matrix_->given.friction.empty() ? kNone : bounds().friction;
}

const std::vector<BoundedRow>& LcpProblem::bounded_rows() const {
  static const std::vector<BoundedRow> kNone;
  return matrix_->given.bounded.empty() ? kNone : bounds().bounded;
}

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

void AssembleDenseA(const ProblemView& arrays, double* A, Index stride) {
  const Index n = arrays.rows;
  switch (arrays.form) {
    case MatrixForm::kFactors:
      return Assemble(RowsOf(arrays), arrays.inverse_mass.data(), A, stride);
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
