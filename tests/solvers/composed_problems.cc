#include "tests/solvers/composed_problems.h"

#include <algorithm>
#include <numeric>
#include <random>
#include <utility>

namespace lcpbench {

LcpProblem Compose(const std::vector<LcpProblem>& parts, unsigned seed) {
  Index rows = 0;
  Index columns = 0;
  for (const LcpProblem& part : parts) {
    rows += part.size();
    columns += part.J().cols();
  }
  std::vector<Eigen::Triplet<double, int>> entries;
  Eigen::VectorXd inverse_mass(columns);
  Eigen::VectorXd b(rows);
  std::vector<Index> bilateral;
  Index row = 0;
  Index column = 0;
  for (const LcpProblem& part : parts) {
    for (Index i = 0; i < part.size(); ++i) {
      for (SparseMatrix::InnerIterator it(part.J(), i); it; ++it) {
        entries.emplace_back(static_cast<int>(row + i), static_cast<int>(column + it.col()), it.value());
      }
      if (part.is_bilateral(i)) bilateral.push_back(row + i);
    }
    b.segment(row, part.size()) = part.b();
    inverse_mass.segment(column, part.J().cols()) = part.inverse_mass();
    row += part.size();
    column += part.J().cols();
  }
  SparseMatrix J(rows, columns);
  J.setFromTriplets(entries.begin(), entries.end());
  const LcpProblem ordered = LcpProblem::FromFactors("composed-" + std::to_string(seed), std::move(J), inverse_mass, b,
                                                     RowBounds::WithBilateralRows(rows, bilateral));
  std::vector<Index> order(static_cast<size_t>(rows));
  std::iota(order.begin(), order.end(), 0);
  std::mt19937 random(seed);
  for (size_t k = order.size(); k > 1; --k) std::swap(order[k - 1], order[random() % k]);
  return PermuteRows(ordered, order);
}

}  // namespace lcpbench
