#include "solvers/rows/two_body_copy.h"

#include <bit>

#include "solvers/lcp/number_range.h"
#include "support/array_index.h"

namespace lcpbench {
// Columns that do not ascend or are out of range end it as a third body does: LcpProblem finds the words for them.
template <Index p>
bool TwoBodyCopy::TakeRows(const Factors& factors) {
  const Index n = factors.rows;
  if (body_.size() < At(2 * n)) body_.resize(At(2 * n));
  if (J_.size() < At(2 * p * n)) J_.resize(At(2 * p * n));
  const int* const start = factors.start;
  const int* const column = factors.column;
  const double* const value = factors.value;
  if (moves_.size() < At(factors.columns / p)) moves_.resize(At(factors.columns / p));
  unsigned char* const moves = moves_.data();
  for (Index k = 0; k < factors.columns / p; ++k) {
    double sum = 0;
    for (int c = 0; c < p; ++c) sum += factors.mass[k * p + c];
    moves[k] = sum > 0 ? 1 : 0;
  }
  const auto columns = static_cast<int>(factors.columns);
  const auto entries = static_cast<int>(factors.entries);
  double* J = J_.data();
  std::int32_t* body = body_.data();
  for (Index i = 0; i < n; ++i, J += 2 * p, body += 2) {
    const int end = start[i + 1];
    if (end < start[i] || end > entries) return false;
    const int* const from = column + start[i];
    // Both bodies' entries in full, as scenes have them.
    bool is_full = end - start[i] == 2 * p && from[0] >= 0 && from[p] > from[0] && from[p] + p <= columns;
    if (is_full) {
      int differences = from[0] % p | from[p] % p;
      for (int c = 1; c < p; ++c) differences |= (from[c] - from[0] - c) | (from[p + c] - from[p] - c);
      is_full = differences == 0;
    }
    if (is_full) {
      const double* const numbers = value + start[i];
      const std::int32_t first = from[0] / p;
      const std::int32_t second = from[p] / p;
      for (int c = 0; c < 2 * p; ++c) J[c] = numbers[c];
      body[0] = moves[first] != 0 ? first : -1;
      body[1] = moves[second] != 0 ? second : -1;
      continue;
    }
    for (int c = 0; c < 2 * p; ++c) J[c] = 0;
    body[0] = body[1] = -1;
    int side = -1;
    std::int32_t current = -1;
    int last = -1;
    for (int e = start[i]; e < end; ++e) {
      if (column[e] <= last || column[e] >= columns) return false;
      last = column[e];
      const std::int32_t k = last / p;
      if (moves[k] == 0) continue;
      side += k != current ? 1 : 0;
      if (side > 1) return false;
      current = body[side] = k;
      J[side * p + last - k * p] = value[e];
    }
  }
  return true;
}

bool TwoBodyCopy::TakeFactors(const Factors& factors, int columns_per_body) {
  NumberRange range(kFactorRange);
  range.Look(factors.value, factors.entries);
  range.Look(factors.mass, factors.columns);
  if (range.has_large()) return false;
  // -0.0 is 0, and seldom: it goes the long way.
  std::uint64_t signs = 0;
  for (Index k = 0; k < factors.columns; ++k) signs |= std::bit_cast<std::uint64_t>(factors.mass[k]);
  if (signs >> 63U != 0 || !(columns_per_body == 3 ? TakeRows<3>(factors) : TakeRows<6>(factors))) return false;
  rows_.columns_per_body = columns_per_body;
  rows_.rows = factors.rows;
  rows_.bodies = factors.columns / columns_per_body;
  rows_.body = body_.data();
  rows_.J = J_.data();
  rows_.inverse_mass = factors.mass;
  return !range.has_small() || HasDiagonalInRange(rows_);
}

bool TwoBodyCopy::Take(const ProblemArrays& arrays) {
  const int p = arrays.facts.columns_per_body;
  const auto count = static_cast<Index>(arrays.value.size());
  const bool fits = arrays.form == MatrixForm::kFactors && (p == 3 || p == 6) && arrays.columns % p == 0 &&
                    At(arrays.rows) == arrays.b.size() && At(arrays.rows) + 1 == arrays.row_start.size() &&
                    arrays.column.size() == arrays.value.size() && At(arrays.columns) == arrays.inverse_mass.size() &&
                    (arrays.bilateral.empty() || arrays.bilateral.size() == arrays.b.size()) &&
                    arrays.row_start.front() == 0 && arrays.row_start.back() == count;
  if (!fits) return false;
  NumberRange of_loads(kLoadRange);
  of_loads.Look(arrays.b.data(), arrays.rows);
  if (!of_loads.is_within()) return false;
  rows_.b = arrays.b.data();
  rows_.bilateral = arrays.bilateral.empty() ? nullptr : arrays.bilateral.data();
  rows_.friction = arrays.friction;
  rows_.bounded = arrays.bounded;
  return TakeFactors({arrays.rows, arrays.columns, count, arrays.row_start.data(), arrays.column.data(),
                      arrays.value.data(), arrays.inverse_mass.data()},
                     p);
}

bool TwoBodyCopy::Take(const LcpProblem& problem) {
  const SparseMatrix& J = problem.J();
  if (J.cols() % problem.columns_per_body() != 0) return false;
  rows_.b = nullptr;
  const std::vector<unsigned char>& bilateral = problem.bounds().bilateral;
  rows_.bilateral = bilateral.empty() ? nullptr : bilateral.data();
  rows_.friction = problem.friction_rows();
  rows_.bounded = problem.bounded_rows();
  return TakeFactors({problem.size(), J.cols(), J.nonZeros(), J.outerIndexPtr(), J.innerIndexPtr(), J.valuePtr(),
                      problem.inverse_mass().data()},
                     problem.columns_per_body());
}

}  // namespace lcpbench
