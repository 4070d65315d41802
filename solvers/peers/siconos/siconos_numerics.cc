#include "solvers/peers/siconos/siconos_numerics.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <sstream>

namespace lcpbench {

// What the arrays of the class hold is not Siconos's to free.
void SiconosMatrix::FreeShell(NumericsMatrix* matrix) {
  matrix->matrix0 = nullptr;
  matrix->matrix1 = nullptr;
  NM_clear(matrix);
  std::free(matrix);  // NOLINT(cppcoreguidelines-no-malloc): from NM_new
}

void SiconosMatrix::SetB(const Eigen::VectorXd& b, double scale) {
  for (std::size_t i = 0; i < q_.size(); ++i) q_[i] = scale * variables_[i].factor * b[variables_[i].row];
}

void SiconosMatrix::SetForces(const Eigen::VectorXd& z, Eigen::VectorXd* f, double scale) const {
  f->setZero();
  for (Index i = 0; i < size(); ++i) {
    const Variable& variable = variables_[static_cast<std::size_t>(i)];
    (*f)[variable.row] += scale * variable.factor * z[i];
  }
}

void SiconosMatrix::Clear() {
  matrix_.reset();
  std::free(sparse_.diagonal_blocks);  // NOLINT(cppcoreguidelines-no-malloc): Siconos notes them there on first use
  sparse_ = {};
  variables_.clear();
  ends_.clear();
  row_starts_.clear();
  columns_.clear();
  blocks_.clear();
}

void SiconosMatrix::Finish(Storage storage) {
  const bool dense = storage == Storage::kDense;
  const auto n = static_cast<int>(variables_.size());
  q_.resize(variables_.size());
  matrix_.reset(NM_new());  // the library keeps factors of the one before in it
  void* data = dense ? static_cast<void*>(values_.data()) : static_cast<void*>(&sparse_);
  NM_fill(matrix_.get(), dense ? NM_DENSE : NM_SPARSE_BLOCK, n, n, data);
}

void SiconosMatrix::FillBlocks(const SparseMatrix& A) {
  // Where each row of the problem stands: its block, and the first of its variables.
  struct Place {
    std::size_t block = 0;
    std::size_t first = 0;
  };
  std::vector<Place> places(static_cast<std::size_t>(A.rows()));
  const auto begin_of = [&](std::size_t block) { return block == 0 ? 0 : static_cast<std::size_t>(ends_[block - 1]); };
  const auto is_first = [&](std::size_t i) { return i == 0 || variables_[i].row != variables_[i - 1].row; };
  for (std::size_t block = 0; block < ends_.size(); ++block) {
    for (std::size_t i = begin_of(block); i < ends_[block]; ++i) {
      if (is_first(i)) places[static_cast<std::size_t>(variables_[i].row)] = {block, i};
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
        for (std::size_t j = place.first; j < ends_[place.block] && variables_[j].row == entry.col(); ++j) {
          const bool is_dummy = i == j && variables_[i].factor == 0;
          values[(i - begin_of(block)) + (j - begin_of(place.block)) * height] =
              is_dummy ? variables_[i].dummy : variables_[i].factor * variables_[j].factor * entry.value();
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

SolverOptions* SiconosOptions::Fresh(int solver) {
  SolverOptions* own = own_.get();
  const bool is_kept = own != nullptr && own->numberOfInternalSolvers == 0 && own->dWork == nullptr &&
                       own->iWork == nullptr && own->solverData == nullptr;
  if (is_kept) {
    std::copy(integers_.begin(), integers_.end(), own->iparam);
    std::copy(reals_.begin(), reals_.end(), own->dparam);
  } else {
    own_.reset(solver_options_create(solver));
    own = own_.get();
    integers_.assign(own->iparam, own->iparam + own->iSize);
    reals_.assign(own->dparam, own->dparam + own->dSize);
  }
  return own;
}

std::int64_t FirstPortion(const SiconosMatrix& matrix, int cost_power) {
  constexpr double kPortion = 2e7;  // products
  constexpr double kPerRow = 500;   // products that take as long as a row's solve without them
  const auto n = static_cast<double>(matrix.size());
  const double products = (static_cast<double>(matrix.entries()) + kPerRow * n) * std::pow(n, cost_power - 2);
  return std::max<std::int64_t>(1, static_cast<std::int64_t>(kPortion / products));
}

void SolveInPortions(const SiconosPortions& portions, const Deadline& deadline, const std::function<int()>& call,
                     SolverOptions* own, Eigen::VectorXd* z, LcpResult* result) {
  constexpr double kPortionTime = 0.02;  // s: short beside any time limit, long beside what a call costs of itself
  constexpr double kRest = 0.9;          // of the time left: no call that begins anew follows one that ends later
  std::int64_t portion = portions.first;
  Eigen::VectorXd before;
  result->iterations = 0;
  for (;;) {
    const std::int64_t left = portions.most - (portions.continues ? result->iterations : 0);
    const int asked = static_cast<int>(std::min(portion, left));
    own->iparam[SICONOS_IPARAM_MAX_ITER] = asked;
    own->iparam[SICONOS_IPARAM_ITER_DONE] = 0;
    before = *z;
    const double start = SteadyNow();
    const int info = call();
    const double taken = std::max(SteadyNow() - start, 1e-9);
    const int done = portions.counts ? std::min(own->iparam[SICONOS_IPARAM_ITER_DONE], asked) : asked;
    result->iterations = (portions.continues ? result->iterations : 0) + done;
    if (info == 0) {
      result->status = LcpStatus::kSolved;
      return;
    }
    if (done == asked && asked == left) {
      result->status = LcpStatus::kIterationLimit;
      return;
    }
    if (done < asked || (portions.continues && *z == before)) {
      std::ostringstream detail;
      detail << "Siconos: gave up, its residual " << own->dparam[SICONOS_DPARAM_RESIDU];
      result->detail = detail.str();
      return;
    }
    // Portions never shrink: where other processes run, the clock tells more than the work.
    const double factor =
        portions.continues ? std::max(1.0, kPortionTime / taken) : kRest * deadline.Remaining() / taken;
    // Where no other call would follow this one, it gets all that is left.
    const bool is_last = !portions.continues && factor < portions.growth * portions.growth;
    const double next =
        std::min(asked * (is_last ? factor : std::min(portions.growth, factor)), static_cast<double>(portions.most));
    if (deadline.Expired() || (!portions.continues && next <= asked)) {
      result->status = LcpStatus::kTimeLimit;
      return;
    }
    portion = static_cast<std::int64_t>(next);
  }
}

}  // namespace lcpbench
