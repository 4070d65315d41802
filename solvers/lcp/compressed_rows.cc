#include "solvers/lcp/compressed_rows.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "support/input_error.h"

namespace lcpbench {
namespace {

using SparseMatrix = Eigen::SparseMatrix<double, Eigen::RowMajor, int>;

std::string Found(const char* name, std::size_t k, int found, const std::string& expected) {
  return std::string(name) + "[" + std::to_string(k) + "] is " + std::to_string(found) + ", " + expected;
}

// What is wrong with the entries where their order is free; "" where nothing is.
std::string WhyNotEntries(const CompressedArrays& arrays, const char* name) {
  const Eigen::Index inner = arrays.by_columns ? arrays.rows : arrays.columns;
  for (std::size_t k = 0; k < arrays.indices.size(); ++k) {
    if (arrays.indices[k] < 0 || arrays.indices[k] >= inner) {
      return Found("indices", k, arrays.indices[k],
                   std::string("expected ") + (arrays.by_columns ? "a row" : "a column") + " of " + name + " in [0, " +
                       std::to_string(inner) + ")");
    }
    if (!std::isfinite(arrays.values[k])) {
      return "values[" + std::to_string(k) + "] is " + std::to_string(arrays.values[k]) + ", expected a finite number";
    }
  }
  return {};
}

// The columns of each row must be sorted.
std::string WhyStoredTwice(const SparseMatrix& matrix, const char* name) {
  for (Eigen::Index i = 0; i < matrix.outerSize(); ++i) {
    Eigen::Index last = -1;
    for (SparseMatrix::InnerIterator it(matrix, i); it; ++it) {
      if (it.col() == last) {
        return "indices: entry (" + std::to_string(i) + ", " + std::to_string(last) + ") of " + name +
               " is stored twice";
      }
      last = it.col();
    }
  }
  return {};
}

// Adds entries of the same row and column. The columns of each row must be sorted.
void AddParts(SparseMatrix* matrix, const char* name) {
  int* const starts = matrix->outerIndexPtr();
  int* const columns = matrix->innerIndexPtr();
  double* const values = matrix->valuePtr();
  int kept = 0;
  for (Eigen::Index i = 0, k = 0; i < matrix->outerSize(); ++i) {
    starts[i] = kept;
    for (; k < starts[i + 1]; ++k) {
      const bool is_part = kept > starts[i] && columns[kept - 1] == columns[k];
      if (!is_part) columns[kept++] = columns[k];
      values[kept - 1] = is_part ? values[kept - 1] + values[k] : values[k];
      if (std::isfinite(values[kept - 1])) continue;
      throw InputError("values: the parts of entry (" + std::to_string(i) + ", " + std::to_string(columns[k]) +
                       ") of " + name + " add up to no finite number");
    }
  }
  starts[matrix->outerSize()] = kept;
  matrix->resizeNonZeros(kept);
}

// Throws what was found to be wrong.
void RequireNothing(const std::string& wrong) {
  if (!wrong.empty()) throw InputError(wrong);
}

}  // namespace

std::string WhyNotStarts(std::span<const int> starts, std::int64_t end, const char* name, const char* end_name) {
  if (starts.front() != 0) return Found(name, 0, starts.front(), "expected 0");
  for (std::size_t i = 1; i < starts.size(); ++i) {
    if (starts[i] >= starts[i - 1]) continue;
    return Found(name, i, starts[i], "less than the " + std::to_string(starts[i - 1]) + " before it");
  }
  if (starts.back() == end) return {};
  return Found(name, starts.size() - 1, starts.back(),
               std::string("expected ") + end_name + " = " + std::to_string(end));
}

std::string WhyNotColumns(std::span<const int> starts, std::span<const int> indices, std::int64_t columns,
                          const char* name) {
  // Signs of differences tell whether any is wrong, without a branch; which one, is asked only then.
  std::int64_t signs = 0;
  for (std::size_t i = 0; i + 1 < starts.size(); ++i) {
    std::int64_t last = -1;
    for (auto k = static_cast<std::size_t>(starts[i]); k < static_cast<std::size_t>(starts[i + 1]); ++k) {
      signs |= (indices[k] - last - 1) | (columns - 1 - indices[k]);
      last = indices[k];
    }
  }
  if (signs >= 0) return {};
  for (std::size_t i = 0; i + 1 < starts.size(); ++i) {
    int last = -1;
    for (auto k = static_cast<std::size_t>(starts[i]); k < static_cast<std::size_t>(starts[i + 1]); ++k) {
      if (indices[k] < 0 || indices[k] >= columns) {
        return Found(name, k, indices[k], "expected a column in [0, " + std::to_string(columns) + ")");
      }
      if (indices[k] <= last) {
        return Found(name, k, indices[k],
                     "not above the " + std::to_string(last) + " before it in row " + std::to_string(i));
      }
      last = indices[k];
    }
  }
  return {};
}

namespace {

template <std::int64_t p>
bool FindBodies(std::span<const int> starts, const int* column, std::span<const double> inverse_mass,
                std::int32_t* body) {
  for (std::size_t i = 0; i + 1 < starts.size(); ++i, column += 2 * p, body += 2) {
    if (starts[i] != static_cast<std::int64_t>(i) * 2 * p) return false;
    if (!FindTwoBodiesOfRow<p>(column, std::ssize(inverse_mass), inverse_mass.data(), body)) return false;
  }
  return true;
}

}  // namespace

bool FindTwoBodies(std::span<const int> starts, std::span<const int> indices, std::span<const double> inverse_mass,
                   int p, std::int32_t* body) {
  if ((p != 3 && p != 6) || std::ssize(inverse_mass) % p != 0) return false;
  const std::size_t entries = 2 * static_cast<std::size_t>(p) * (starts.size() - 1);
  if (indices.size() != entries || static_cast<std::size_t>(starts.back()) != entries) return false;
  return p == 3 ? FindBodies<3>(starts, indices.data(), inverse_mass, body)
                : FindBodies<6>(starts, indices.data(), inverse_mass, body);
}

void CopyRows(const Eigen::Ref<const SparseMatrix>& from, SparseMatrix* to) {
  to->resize(from.rows(), from.cols());
  to->resizeNonZeros(from.nonZeros());
  std::copy_n(from.outerIndexPtr(), from.rows() + 1, to->outerIndexPtr());
  std::copy_n(from.innerIndexPtr(), from.nonZeros(), to->innerIndexPtr());
  std::copy_n(from.valuePtr(), from.nonZeros(), to->valuePtr());
}

SparseMatrix ToSparseMatrix(const CompressedArrays& arrays, const char* name) {
  using ByColumns = Eigen::SparseMatrix<double, Eigen::ColMajor, int>;
  const auto entries = static_cast<Eigen::Index>(arrays.indices.size());
  RequireNothing(WhyNotStarts(arrays.starts, entries, "starts", "entries"));
  RequireNothing(WhyNotEntries(arrays, name));
  const auto as = [&]<typename Order>(const Order&) {
    return Eigen::Map<const Order>(arrays.rows, arrays.columns, entries, arrays.starts.data(), arrays.indices.data(),
                                   arrays.values.data());
  };
  SparseMatrix matrix;
  if (arrays.by_columns) {
    matrix = as(ByColumns());
  } else if (WhyNotColumns(arrays.starts, arrays.indices, arrays.columns, "indices").empty()) {
    CopyRows(as(SparseMatrix()), &matrix);
    return matrix;
  } else {
    const ByColumns sorted = as(SparseMatrix());  // going through the other order sorts the entries
    matrix = sorted;
  }
  if (arrays.adds_parts) {
    AddParts(&matrix, name);
  } else {
    RequireNothing(WhyStoredTwice(matrix, name));
  }
  return matrix;
}

}  // namespace lcpbench
