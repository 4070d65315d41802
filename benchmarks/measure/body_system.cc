#include "benchmarks/measure/body_system.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lcpbench {
namespace {

constexpr Index kPerBody = 3;
constexpr int kNone = -1;

using ColumnMatrix = BodySystem::ColumnMatrix;
using Triplets = std::vector<Eigen::Triplet<double, int>>;

std::size_t At(Index i) { return static_cast<std::size_t>(i); }

ColumnMatrix Matrix(Index rows, Index columns, const Triplets& entries) {
  ColumnMatrix matrix(rows, columns);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

}  // namespace

Eigen::VectorXi BodySystem::Expand(const Eigen::VectorXi& order_of_bodies) const {
  Eigen::VectorXi order(lower.cols());
  Index next = 0;
  for (const int body : order_of_bodies) {
    for (int k = first[At(body)]; k < first[At(body) + 1]; ++k) order[next++] = k;
  }
  return order;
}

BodySystem MakeBodySystem(const LcpProblem& problem, const std::vector<Index>& rows) {
  const Eigen::VectorXd& inverse_mass = problem.inverse_mass();
  const auto for_each_entry = [&](const auto& take) {
    for (std::size_t k = 0; k < rows.size(); ++k) {
      for (SparseMatrix::InnerIterator it(problem.J(), rows[k]); it; ++it) {
        if (it.value() != 0 && inverse_mass[it.col()] > 0) take(static_cast<int>(k), it.col(), it.value());
      }
    }
  };
  std::vector<bool> takes_part(At(inverse_mass.size() / kPerBody), false);
  for_each_entry([&](int, Index column, double) { takes_part[At(column / kPerBody)] = true; });

  BodySystem system;
  system.first = {0};
  Triplets masses;
  std::vector<int> unknown_of(At(inverse_mass.size()), kNone);
  std::vector<int> number_of(takes_part.size(), kNone);
  for (Index body = 0; body < static_cast<Index>(takes_part.size()); ++body) {
    if (!takes_part[At(body)]) continue;
    number_of[At(body)] = system.bodies();
    for (Index column = kPerBody * body; column < kPerBody * (body + 1); ++column) {
      if (inverse_mass[column] == 0) continue;
      const int unknown = unknown_of[At(column)] = static_cast<int>(system.column_of.size());
      system.column_of.push_back(static_cast<int>(column));
      masses.emplace_back(unknown, unknown, 1 / inverse_mass[column]);
    }
    system.first.push_back(static_cast<int>(system.column_of.size()));
  }

  Triplets weighted;  // W^1/2 J_F
  Triplets touches;   // rows x bodies
  for_each_entry([&](int k, Index column, double value) {
    const double diagonal = std::max(problem.DiagonalA()[rows[At(k)]], std::numeric_limits<double>::min());
    weighted.emplace_back(k, unknown_of[At(column)], std::sqrt(kStiffness / diagonal) * value);
    touches.emplace_back(k, number_of[At(column / kPerBody)], 1);
  });
  const auto count = static_cast<Index>(rows.size());
  const auto unknowns = static_cast<Index>(system.column_of.size());
  const ColumnMatrix root = Matrix(count, unknowns, weighted);
  const ColumnMatrix incidence = Matrix(count, system.bodies(), touches);
  const ColumnMatrix stiffness = root.transpose() * root;
  system.lower = ColumnMatrix(stiffness + Matrix(unknowns, unknowns, masses)).triangularView<Eigen::Lower>();
  system.graph = incidence.transpose() * incidence;
  return system;
}

}  // namespace lcpbench
