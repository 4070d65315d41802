#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "solvers/c/guard.h"
#include "solvers/c/handles.h"
#include "solvers/c/lcpbench.h"
#include "solvers/lcp/memory_budget.h"

namespace lcpbench {
namespace {

constexpr std::int64_t kLargestSize = std::numeric_limits<std::int32_t>::max();

void RequireSize(std::int64_t size, const char* name) {
  if (size < 0 || size > kLargestSize) {
    throw InputError(std::string(name) + " is " + std::to_string(size) + ", expected 0 <= " + name + " < 2^31");
  }
}

std::string Place(const char* array, std::int64_t i) { return std::string(array) + "[" + std::to_string(i) + "]"; }

void RequireLayout(lcpbench_layout layout) {
  if (layout != LCPBENCH_COLUMN_MAJOR && layout != LCPBENCH_ROW_MAJOR) {
    throw InputError("layout is " + std::to_string(layout) +
                     ", expected LCPBENCH_COLUMN_MAJOR (0) or LCPBENCH_ROW_MAJOR (1)");
  }
}

Eigen::VectorXd ReadVector(const double* values, std::int64_t size, const char* name) {
  if (size > 0) RequireNotNull(values, name, "an array of numbers");
  for (std::int64_t i = 0; i < size; ++i) {
    if (!std::isfinite(values[i])) {
      throw InputError(Place(name, i) + " is " + std::to_string(values[i]) + ", expected a finite number");
    }
  }
  return size == 0 ? Eigen::VectorXd() : Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(values, size));
}

RowBounds ReadKinds(const std::uint8_t* kinds, std::int64_t n) {
  std::vector<Index> bilateral;
  if (kinds == nullptr) return {};
  for (std::int64_t i = 0; i < n; ++i) {
    if (kinds[i] == LCPBENCH_BILATERAL) {
      bilateral.push_back(i);
    } else if (kinds[i] != LCPBENCH_UNILATERAL) {
      throw InputError(Place("kinds", i) + " is " + std::to_string(kinds[i]) +
                       ", expected LCPBENCH_UNILATERAL (0) or LCPBENCH_BILATERAL (1)");
    }
  }
  return RowBounds::WithBilateralRows(n, bilateral);
}

MatrixFacts ReadFacts(std::uint32_t facts) {
  constexpr std::uint32_t kKnown = LCPBENCH_SYMMETRIC | LCPBENCH_POSITIVE_SEMIDEFINITE;
  if ((facts & ~kKnown) != 0) {
    throw InputError("facts is " + std::to_string(facts) +
                     ", expected 0 or bits of LCPBENCH_SYMMETRIC (1) and LCPBENCH_POSITIVE_SEMIDEFINITE (2)");
  }
  MatrixFacts read;
  read.symmetric = (facts & LCPBENCH_SYMMETRIC) != 0;
  read.positive_semidefinite = (facts & LCPBENCH_POSITIVE_SEMIDEFINITE) != 0;
  return read;
}

void RequireStatedSymmetry(const LcpProblem& problem) {
  if (problem.facts().symmetric && !problem.IsNumericallySymmetric()) {
    char asymmetry[32];
    std::snprintf(asymmetry, sizeof asymmetry, "%.3g", problem.Asymmetry());
    throw InputError(std::string("facts has LCPBENCH_SYMMETRIC, but A is not symmetric: entries (i, j) and (j, i) ") +
                     "differ by up to " + asymmetry + " of their diagonal entries");
  }
}

void RequireNoEntryTwice(const SparseMatrix& matrix, const char* name) {
  for (Index i = 0; i < matrix.outerSize(); ++i) {
    Index last = -1;
    for (SparseMatrix::InnerIterator it(matrix, i); it; ++it) {
      if (it.col() == last) {
        throw InputError("indices: entry (" + std::to_string(i) + ", " + std::to_string(last) + ") of " + name +
                         " is stored twice");
      }
      last = it.col();
    }
  }
}

// The compressed arrays of `name`, checked. Going through the other order sorts the entries, in O(rows + columns +
// entries).
SparseMatrix ReadCompressed(const char* name, std::int64_t rows, std::int64_t columns, lcpbench_layout layout,
                            const std::int32_t* starts, const std::int32_t* indices, const double* values,
                            std::int64_t entries) {
  using ByColumns = Eigen::SparseMatrix<double, Eigen::ColMajor, int>;
  RequireLayout(layout);
  RequireSize(entries, "entries");
  const bool by_columns = layout == LCPBENCH_COLUMN_MAJOR;
  const std::int64_t outer = by_columns ? columns : rows;
  const std::int64_t inner = by_columns ? rows : columns;
  SparseMatrix matrix(rows, columns);
  if (outer == 0 && entries == 0) return matrix;
  RequireNotNull(starts, "starts", "one number for every column (or row) and one more");
  if (starts[0] != 0) throw InputError("starts[0] is " + std::to_string(starts[0]) + ", expected 0");
  for (std::int64_t k = 0; k < outer; ++k) {
    if (starts[k + 1] < starts[k]) {
      throw InputError(Place("starts", k + 1) + " is " + std::to_string(starts[k + 1]) + ", less than the " +
                       std::to_string(starts[k]) + " before it");
    }
  }
  if (starts[outer] != entries) {
    throw InputError(Place("starts", outer) + " is " + std::to_string(starts[outer]) +
                     ", expected entries = " + std::to_string(entries));
  }
  if (entries == 0) return matrix;
  RequireNotNull(indices, "indices", "an array of indices");
  RequireNotNull(values, "values", "an array of numbers");
  for (std::int64_t k = 0; k < entries; ++k) {
    if (indices[k] < 0 || indices[k] >= inner) {
      throw InputError(Place("indices", k) + " is " + std::to_string(indices[k]) + ", expected a " +
                       (by_columns ? "row" : "column") + " of " + name + " in [0, " + std::to_string(inner) + ")");
    }
    if (!std::isfinite(values[k])) {
      throw InputError(Place("values", k) + " is " + std::to_string(values[k]) + ", expected a finite number");
    }
  }
  if (by_columns) {
    matrix = Eigen::Map<const ByColumns>(rows, columns, entries, starts, indices, values);
  } else {
    const ByColumns sorted = Eigen::Map<const SparseMatrix>(rows, columns, entries, starts, indices, values);
    matrix = sorted;
  }
  RequireNoEntryTwice(matrix, name);
  return matrix;
}

Eigen::MatrixXd ReadDense(const double* A, std::int64_t n, lcpbench_layout layout) {
  RequireLayout(layout);
  if (n == 0) return {};
  RequireNotNull(A, "A", "n x n numbers");
  const double numbers = static_cast<double>(n) * static_cast<double>(n);
  RequireMemory(numbers * sizeof(double), "a copy of A");
  for (std::int64_t k = 0; k < n * n; ++k) {
    if (!std::isfinite(A[k])) {
      const bool by_columns = layout == LCPBENCH_COLUMN_MAJOR;
      throw InputError("A: entry (" + std::to_string(by_columns ? k % n : k / n) + ", " +
                       std::to_string(by_columns ? k / n : k % n) + ") is " + std::to_string(A[k]) +
                       ", expected a finite number");
    }
  }
  const Eigen::Map<const Eigen::MatrixXd> by_columns(A, n, n);
  if (layout == LCPBENCH_COLUMN_MAJOR) return by_columns;
  return by_columns.transpose();
}

}  // namespace
}  // namespace lcpbench

using lcpbench::Guard;
using lcpbench::InputError;
using lcpbench::LcpProblem;

lcpbench_error lcpbench_problem_from_dense(int64_t n, const double* A, lcpbench_layout layout, const double* b,
                                           const uint8_t* kinds, uint32_t facts, lcpbench_problem** problem) {
  return Guard(__func__, [&] {
    lcpbench::RequireNotNull(problem, "problem", "the address of a pointer");
    lcpbench::RequireSize(n, "n");
    LcpProblem made = LcpProblem::FromDense("", lcpbench::ReadDense(A, n, layout), lcpbench::ReadVector(b, n, "b"),
                                            lcpbench::ReadKinds(kinds, n), lcpbench::ReadFacts(facts));
    lcpbench::RequireStatedSymmetry(made);
    *problem = new lcpbench_problem{std::move(made)};
  });
}

lcpbench_error lcpbench_problem_from_sparse(int64_t n, lcpbench_layout layout, const int32_t* starts,
                                            const int32_t* indices, const double* values, int64_t entries,
                                            const double* b, const uint8_t* kinds, uint32_t facts,
                                            lcpbench_problem** problem) {
  return Guard(__func__, [&] {
    lcpbench::RequireNotNull(problem, "problem", "the address of a pointer");
    lcpbench::RequireSize(n, "n");
    LcpProblem made = LcpProblem::FromSparse(
        "", lcpbench::ReadCompressed("A", n, n, layout, starts, indices, values, entries),
        lcpbench::ReadVector(b, n, "b"), lcpbench::ReadKinds(kinds, n), lcpbench::ReadFacts(facts));
    lcpbench::RequireStatedSymmetry(made);
    *problem = new lcpbench_problem{std::move(made)};
  });
}

lcpbench_error lcpbench_problem_from_factors(int64_t n, int64_t columns, lcpbench_layout layout, const int32_t* starts,
                                             const int32_t* indices, const double* values, int64_t entries,
                                             const double* inverse_mass, const double* b, const uint8_t* kinds,
                                             lcpbench_problem** problem) {
  return Guard(__func__, [&] {
    lcpbench::RequireNotNull(problem, "problem", "the address of a pointer");
    lcpbench::RequireSize(n, "n");
    lcpbench::RequireSize(columns, "columns");
    Eigen::VectorXd masses = lcpbench::ReadVector(inverse_mass, columns, "inverse_mass");
    for (int64_t k = 0; k < columns; ++k) {
      if (masses[k] < 0) {
        throw InputError(lcpbench::Place("inverse_mass", k) + " is " + std::to_string(masses[k]) +
                         ", expected a number >= 0");
      }
    }
    *problem = new lcpbench_problem{
        LcpProblem::FromFactors("", lcpbench::ReadCompressed("J", n, columns, layout, starts, indices, values, entries),
                                std::move(masses), lcpbench::ReadVector(b, n, "b"), lcpbench::ReadKinds(kinds, n))};
  });
}

lcpbench_error lcpbench_problem_size(const lcpbench_problem* problem, int64_t* n) {
  return Guard(__func__, [&] {
    lcpbench::RequireNotNull(problem, "problem", "a problem");
    lcpbench::RequireNotNull(n, "n", "where to write");
    *n = problem->problem.size();
  });
}

void lcpbench_problem_free(lcpbench_problem* problem) { delete problem; }
