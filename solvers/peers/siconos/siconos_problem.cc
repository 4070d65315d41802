#include "solvers/peers/siconos/siconos_problem.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <map>

#include "solvers/peers/given_matrix.h"

namespace lcpbench {
namespace {

// What the arrays of this class hold is not Siconos's to free.
void FreeShell(NumericsMatrix* matrix) {
  matrix->matrix0 = nullptr;
  matrix->matrix1 = nullptr;
  NM_clear(matrix);
  std::free(matrix);  // NOLINT(cppcoreguidelines-no-malloc): from NM_new
}

// The movable bodies that a row joins; the same pair for rows between the same bodies.
using Bodies = std::array<Index, 2>;
Bodies BodiesOf(const LcpProblem& problem, Index row) {
  constexpr Index kPerBody = 3;
  Bodies bodies{-1, -1};
  for (SparseMatrix::InnerIterator entry(problem.J(), row); entry; ++entry) {
    if (problem.inverse_mass()[entry.col()] == 0) continue;
    const Index body = entry.col() / kPerBody;
    if (body == bodies[0] || body == bodies[1]) continue;
    bodies[bodies[0] < 0 ? 0 : 1] = body;
  }
  return bodies;
}

}  // namespace

SiconosProblem::SiconosProblem(const LcpProblem& problem, Storage storage, std::size_t largest_block)
    : matrix_(NM_new(), &FreeShell) {
  const bool dense = storage == Storage::kDense;
  if (dense) {
    OrderByRows(problem);
    FillDense(problem);
  } else {
    OrderByBlocks(problem, largest_block);
    FillBlocks(problem);
  }
  q_.resize(variables_.size());
  const auto n = static_cast<int>(variables_.size());
  void* data = dense ? static_cast<void*>(values_.data()) : static_cast<void*>(&sparse_);
  NM_fill(matrix_.get(), dense ? NM_DENSE : NM_SPARSE_BLOCK, n, n, data);
  problem_.size = n;
  problem_.M = matrix_.get();
  problem_.q = q_.data();
}

SiconosProblem::~SiconosProblem() {
  std::free(sparse_.diagonal_blocks);  // NOLINT(cppcoreguidelines-no-malloc): Siconos notes them there on first use
}

void SiconosProblem::SetB(const Eigen::VectorXd& b) {
  for (std::size_t i = 0; i < q_.size(); ++i) q_[i] = variables_[i].sign * b[variables_[i].row];
}

Eigen::VectorXd SiconosProblem::VariablesOf(const Eigen::VectorXd& f) const {
  Eigen::VectorXd z(size());
  for (Index i = 0; i < size(); ++i) {
    const Variable& variable = variables_[static_cast<std::size_t>(i)];
    z[i] = std::max(0.0, variable.sign * f[variable.row]);
  }
  return z;
}

void SiconosProblem::SetForces(const Eigen::VectorXd& z, Eigen::VectorXd* f) const {
  f->setZero();
  for (Index i = 0; i < size(); ++i) {
    const Variable& variable = variables_[static_cast<std::size_t>(i)];
    (*f)[variable.row] += variable.sign * z[i];
  }
}

void SiconosProblem::OrderByRows(const LcpProblem& problem) {
  for (Index row = 0; row < problem.size(); ++row) variables_.push_back({row, 1});
  for (const Index row : problem.bilateral_rows()) variables_.push_back({row, -1});
}

void SiconosProblem::OrderByBlocks(const LcpProblem& problem, std::size_t largest_block) {
  std::vector<std::vector<Index>> groups;
  std::map<Bodies, std::size_t> group_of;
  for (Index row = 0; row < problem.size(); ++row) {
    std::size_t group = groups.size();
    if (problem.has_two_body_rows()) {
      auto [found, is_new] = group_of.try_emplace(BodiesOf(problem, row), group);
      if (!is_new && groups[found->second].size() >= largest_block) found->second = group;
      group = found->second;
    }
    if (group == groups.size()) groups.emplace_back();
    groups[group].push_back(row);
  }
  for (const std::vector<Index>& group : groups) {
    for (const Index row : group) {
      variables_.push_back({row, 1});
      if (problem.is_bilateral(row)) variables_.push_back({row, -1});
    }
    ends_.push_back(static_cast<unsigned int>(variables_.size()));
  }
}

void SiconosProblem::FillDense(const LcpProblem& problem) {
  const auto n = static_cast<std::size_t>(problem.size());
  const std::size_t size = variables_.size();
  values_.resize(size * size);
  WriteDenseColumns(problem, static_cast<Index>(size), values_.data());
  // The mirrored rows, then the mirrored columns.
  for (std::size_t mirror = n; mirror < size; ++mirror) {
    const auto row = static_cast<std::size_t>(variables_[mirror].row);
    for (std::size_t column = 0; column < n; ++column) {
      values_[column * size + mirror] = -values_[column * size + row];
    }
  }
  for (std::size_t mirror = n; mirror < size; ++mirror) {
    const auto column = static_cast<std::size_t>(variables_[mirror].row);
    for (std::size_t i = 0; i < size; ++i) values_[mirror * size + i] = -values_[column * size + i];
  }
}

void SiconosProblem::FillBlocks(const LcpProblem& problem) {
  const SparseMatrix& A = problem.SparseA();
  // Where each row of the problem stands: its block, and the positions of it and of its mirror.
  struct Place {
    std::size_t block = 0;
    std::size_t first = 0;
    std::size_t count = 0;
  };
  std::vector<Place> places(static_cast<std::size_t>(problem.size()));
  const auto begin_of = [&](std::size_t block) { return block == 0 ? 0 : static_cast<std::size_t>(ends_[block - 1]); };
  for (std::size_t block = 0; block < ends_.size(); ++block) {
    for (std::size_t i = begin_of(block); i < ends_[block]; ++i) {
      Place& place = places[static_cast<std::size_t>(variables_[i].row)];
      if (place.count++ == 0) place = {block, i, 1};
    }
  }
  // The pattern first, since values_ must not move once blocks point into it.
  std::vector<std::size_t> offsets;
  std::size_t total = 0;
  row_starts_.push_back(0);
  for (std::size_t block = 0; block < ends_.size(); ++block) {
    std::vector<std::size_t> neighbours{block};
    for (std::size_t i = begin_of(block); i < ends_[block]; ++i) {
      for (SparseMatrix::InnerIterator entry(A, variables_[i].row); entry; ++entry) {
        neighbours.push_back(places[static_cast<std::size_t>(entry.col())].block);
      }
    }
    std::sort(neighbours.begin(), neighbours.end());
    neighbours.erase(std::unique(neighbours.begin(), neighbours.end()), neighbours.end());
    for (const std::size_t neighbour : neighbours) {
      columns_.push_back(neighbour);
      offsets.push_back(total);
      total += (ends_[block] - begin_of(block)) * (ends_[neighbour] - begin_of(neighbour));
    }
    row_starts_.push_back(columns_.size());
  }
  values_.assign(total, 0);
  for (const std::size_t offset : offsets) blocks_.push_back(values_.data() + offset);
  for (std::size_t block = 0; block < ends_.size(); ++block) {
    const std::size_t height = ends_[block] - begin_of(block);
    const auto first = columns_.begin() + static_cast<std::ptrdiff_t>(row_starts_[block]);
    const auto last = columns_.begin() + static_cast<std::ptrdiff_t>(row_starts_[block + 1]);
    for (std::size_t i = begin_of(block); i < ends_[block]; ++i) {
      for (SparseMatrix::InnerIterator entry(A, variables_[i].row); entry; ++entry) {
        const Place& place = places[static_cast<std::size_t>(entry.col())];
        const auto column = std::lower_bound(first, last, place.block);
        double* values = blocks_[static_cast<std::size_t>(column - columns_.begin())];
        for (std::size_t j = place.first; j < place.first + place.count; ++j) {
          values[(i - begin_of(block)) + (j - begin_of(place.block)) * height] =
              variables_[i].sign * variables_[j].sign * entry.value();
        }
      }
    }
  }
  SBM_null(&sparse_);
  sparse_.nbblocks = static_cast<unsigned int>(blocks_.size());
  sparse_.block = blocks_.data();
  sparse_.blocknumber0 = sparse_.blocknumber1 = static_cast<unsigned int>(ends_.size());
  sparse_.blocksize0 = sparse_.blocksize1 = ends_.data();
  sparse_.filled1 = row_starts_.size();
  sparse_.filled2 = columns_.size();
  sparse_.index1_data = row_starts_.data();
  sparse_.index2_data = columns_.data();
}

}  // namespace lcpbench
