#include "tests/solvers/stacked_problems.h"

#include <cmath>
#include <random>
#include <string>
#include <vector>

namespace lcpbench {
namespace {

using Triplets = std::vector<Eigen::Triplet<double, int>>;

double Uniform(std::mt19937_64* random, double low, double high) {
  return low + (high - low) * static_cast<double>((*random)() >> 11) * 0x1p-53;
}

}  // namespace

LcpProblem Column(Index n, unsigned seed) {
  std::mt19937_64 random(seed);
  Triplets entries;
  Eigen::VectorXd acceleration(3 * n);
  for (int k = 0; k < n; ++k) {
    entries.emplace_back(k, 3 * k + 1, 1.0);
    if (k > 0) entries.emplace_back(k, 3 * (k - 1) + 1, -1.0);
    acceleration.segment<3>(Index{3} * k) << 0.0, -10.0 + Uniform(&random, -8.0, 8.0), 0.0;
  }
  SparseMatrix J(n, 3 * n);
  J.setFromTriplets(entries.begin(), entries.end());
  return LcpProblem::FromFactors("column-" + std::to_string(n), J, Eigen::VectorXd::Ones(3 * n), J * acceleration);
}

LcpProblem DiscPile(Index n, unsigned seed) {
  constexpr int kWidth = 10;
  const double half = 0.5;
  const double height = std::sqrt(0.75);
  std::mt19937_64 random(seed);
  Triplets entries;
  int row = 0;
  int disc = 0;
  for (; row < n; ++disc) {
    const int below = disc - kWidth;
    for (const double side : {-half, half}) {
      if (row >= n) break;
      entries.emplace_back(row, 3 * disc, -side);
      entries.emplace_back(row, 3 * disc + 1, height);
      const int neighbour = below + (side > 0 ? 1 : 0);
      if (neighbour >= 0 && neighbour < disc) {
        entries.emplace_back(row, 3 * neighbour, side);
        entries.emplace_back(row, 3 * neighbour + 1, -height);
      }
      ++row;
    }
  }
  Eigen::VectorXd acceleration = Eigen::VectorXd::Zero(Index{3} * disc);
  for (Index k = 0; k < disc; ++k) {
    acceleration[3 * k] = Uniform(&random, -3.0, 3.0);
    acceleration[3 * k + 1] = -10.0;
  }
  SparseMatrix J(n, Index{3} * disc);
  J.setFromTriplets(entries.begin(), entries.end());
  return LcpProblem::FromFactors("pile-" + std::to_string(n), J, Eigen::VectorXd::Ones(Index{3} * disc),
                                 J * acceleration);
}

LcpProblem JammedColumn(Index n, unsigned seed) {
  const LcpProblem column = Column(n, seed);
  Triplets entries;
  for (Index i = 0; i < n; ++i) {
    for (SparseMatrix::InnerIterator it(column.J(), i); it; ++it) {
      entries.emplace_back(static_cast<int>(i), static_cast<int>(it.col()), it.value());
    }
  }
  const int top = 3 * static_cast<int>(n - 1);
  entries.emplace_back(static_cast<int>(n), top, 1.0);
  entries.emplace_back(static_cast<int>(n + 1), top, -1.0);
  SparseMatrix J(n + 2, column.J().cols());
  J.setFromTriplets(entries.begin(), entries.end());
  Eigen::VectorXd b(n + 2);
  b << column.b(), -1.0, 0.5;
  return LcpProblem::FromFactors("jam", J, column.inverse_mass(), b);
}

}  // namespace lcpbench
