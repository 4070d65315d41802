#include "solvers/lcp/step_rows.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "solvers/lcp/number_range.h"

namespace lcpbench {
double DiagonalOf(const StepRows& rows, std::int64_t row) {
  const Index p = rows.columns_per_body;
  const auto j = [&](Index side, Index c) {
    const Index at = (2 * row + side) * p + c;
    return rows.J != nullptr ? rows.J[at] : static_cast<double>(rows.J_single[at]);
  };
  const std::int32_t first = rows.body[2 * row];
  const std::int32_t second = rows.body[2 * row + 1];
  double d = 0;
  for (Index c = 0; c < p && first >= 0; ++c) {
    const double sum = j(0, c) + (first == second ? j(1, c) : 0.0);
    d += rows.inverse_mass[first * p + c] * (sum * sum);
  }
  for (Index c = 0; c < p && second >= 0 && second != first; ++c) {
    d += rows.inverse_mass[second * p + c] * (j(1, c) * j(1, c));
  }
  return d;
}

bool HasDiagonalInRange(const StepRows& rows) {
  for (Index i = 0; i < rows.rows; ++i) {
    const double d = DiagonalOf(rows, i);
    if (!(d <= kEntryRange.most) || (d < kEntryRange.least && d > 0)) return false;
  }
  return true;
}

namespace {

// @param J  2 p numbers a row
template <int p, typename Number>
void Assemble(const StepRows& rows, const Number* J, double* A, Index stride) {
  for (Index i = 0; i < rows.rows; ++i) {
    double scaled[2][p] = {};  // of row i, by the inverse masses
    for (int side = 0; side < 2; ++side) {
      const std::int32_t body = rows.body[2 * i + side];
      for (int c = 0; c < p && body >= 0; ++c) {
        scaled[side][c] = rows.inverse_mass[body * p + c] * static_cast<double>(J[(2 * i + side) * p + c]);
      }
    }
    for (Index j = 0; j <= i; ++j) {
      double sum = 0;
      for (int side = 0; side < 2; ++side) {
        const std::int32_t body = rows.body[2 * i + side];
        for (int other = 0; other < 2; ++other) {
          if (body < 0 || rows.body[2 * j + other] != body) continue;
          const Number* const of = J + (2 * j + other) * p;
          for (int c = 0; c < p; ++c) sum += scaled[side][c] * static_cast<double>(of[c]);
        }
      }
      A[i * stride + j] = A[j * stride + i] = sum;
    }
    std::fill(A + i * stride + rows.rows, A + (i + 1) * stride, 0.0);
  }
}

}  // namespace

void AssembleDenseA(const StepRows& rows, double* A, Index stride) {
  WithNumbers(rows, [&](const auto* J, auto p) { Assemble<p>(rows, J, A, stride); });
}

StepRows PartOf(const StepRows& rows, std::int64_t first, std::int64_t last) {
  StepRows part = rows;
  const std::int64_t width = std::int64_t{2} * rows.columns_per_body;
  part.rows = last - first;
  part.body += 2 * first;
  if (part.J != nullptr) part.J += width * first;
  if (part.J_single != nullptr) part.J_single += width * first;
  part.b += first;
  if (part.bilateral != nullptr) part.bilateral += first;
  return part;
}

LcpProblem ProblemOf(const StepRows& rows) {
  const Index p = rows.columns_per_body;
  std::vector<Eigen::Triplet<double, int>> entries;
  for (Index k = 0; k < 2 * p * rows.rows; ++k) {
    const std::int32_t body = rows.body[k / p];
    const double entry = rows.J != nullptr ? rows.J[k] : static_cast<double>(rows.J_single[k]);
    if (body >= 0) entries.emplace_back(static_cast<int>(k / (2 * p)), static_cast<int>(body * p + k % p), entry);
  }
  SparseMatrix J(rows.rows, rows.bodies * p);
  J.setFromTriplets(entries.begin(), entries.end());
  RowBounds bounds;
  if (rows.bilateral != nullptr) bounds.bilateral.assign(rows.bilateral, rows.bilateral + rows.rows);
  bounds.friction.assign(rows.friction.begin(), rows.friction.end());
  bounds.bounded.assign(rows.bounded.begin(), rows.bounded.end());
  MatrixFacts facts;
  facts.columns_per_body = rows.columns_per_body;
  using Numbers = Eigen::Map<const Eigen::VectorXd>;
  return LcpProblem::FromFactors("step", J, Numbers(rows.inverse_mass, rows.bodies * p), Numbers(rows.b, rows.rows),
                                 std::move(bounds), facts);
}

}  // namespace lcpbench
