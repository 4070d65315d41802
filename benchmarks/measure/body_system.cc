#include "benchmarks/measure/body_system.h"

#include <algorithm>
#include <limits>

namespace lcpbench {
namespace {

constexpr int kPerBody = 3;
constexpr int kNone = -1;

using Triplets = std::vector<Eigen::Triplet<double, int>>;

std::size_t At(Index i) { return static_cast<std::size_t>(i); }

// Of every column of J: its unknown; kNone where it cannot move or its body takes no part.
std::vector<int> NumberUnknowns(const LcpProblem& problem, const std::vector<Index>& rows, BodySystem* system) {
  const Eigen::VectorXd& inverse_mass = problem.inverse_mass();
  std::vector<bool> takes_part(At(inverse_mass.size() / kPerBody), false);
  for (const Index row : rows) {
    for (SparseMatrix::InnerIterator it(problem.J(), row); it; ++it) {
      if (it.value() != 0 && inverse_mass[it.col()] > 0) takes_part[At(it.col() / kPerBody)] = true;
    }
  }
  std::vector<int> unknown_of(At(inverse_mass.size()), kNone);
  system->first = {0};
  for (Index body = 0; body < inverse_mass.size() / kPerBody; ++body) {
    if (!takes_part[At(body)]) continue;
    for (Index column = kPerBody * body; column < kPerBody * (body + 1); ++column) {
      if (inverse_mass[column] == 0) continue;
      unknown_of[At(column)] = static_cast<int>(system->column_of.size());
      system->column_of.push_back(static_cast<int>(column));
    }
    system->first.push_back(static_cast<int>(system->column_of.size()));
  }
  return unknown_of;
}

BodySystem::ColumnMatrix Matrix(Index size, const Triplets& entries) {
  BodySystem::ColumnMatrix matrix(size, size);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

// One entry per pair of bodies with a block of `lower` between them.
BodySystem::ColumnMatrix Graph(const BodySystem& system) {
  std::vector<int> body_of(system.column_of.size());
  for (int body = 0; body < system.bodies(); ++body) {
    for (int k = system.first[At(body)]; k < system.first[At(body + 1)]; ++k) body_of[At(k)] = body;
  }
  Triplets edges;
  std::vector<int> seen_from(At(system.bodies()), kNone);
  for (int body = 0; body < system.bodies(); ++body) {
    for (int k = system.first[At(body)]; k < system.first[At(body + 1)]; ++k) {
      for (BodySystem::ColumnMatrix::InnerIterator it(system.lower, k); it; ++it) {
        const int other = body_of[At(it.row())];
        if (other == body || seen_from[At(other)] == body) continue;
        seen_from[At(other)] = body;
        edges.emplace_back(other, body, 1);
        edges.emplace_back(body, other, 1);
      }
    }
  }
  return Matrix(system.bodies(), edges);
}

}  // namespace

BodySystem MakeBodySystem(const LcpProblem& problem, const std::vector<Index>& rows) {
  BodySystem system;
  const std::vector<int> unknown_of = NumberUnknowns(problem, rows, &system);
  const auto unknowns = static_cast<int>(system.column_of.size());
  Triplets entries;
  for (int k = 0; k < unknowns; ++k) {
    entries.emplace_back(k, k, 1 / problem.inverse_mass()[system.column_of[At(k)]]);
  }
  for (const Index row : rows) {
    const double stiffness = kStiffness / std::max(problem.DiagonalA()[row], std::numeric_limits<double>::min());
    for (SparseMatrix::InnerIterator p(problem.J(), row); p; ++p) {
      const int i = unknown_of[At(p.col())];
      if (i == kNone) continue;
      for (SparseMatrix::InnerIterator q(problem.J(), row); q; ++q) {
        const int j = unknown_of[At(q.col())];
        if (j != kNone && j <= i) entries.emplace_back(i, j, stiffness * p.value() * q.value());
      }
    }
  }
  system.lower = Matrix(unknowns, entries);
  system.graph = Graph(system);
  return system;
}

}  // namespace lcpbench
