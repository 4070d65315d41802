#include "solvers/linear_algebra/active_block.h"

#include <Eigen/OrderingMethods>
#include <algorithm>
#include <cmath>

#include "solvers/lcp/factor_clock.h"
#include "solvers/lcp/in_sequence.h"
#include "solvers/lcp/memory_budget.h"
#include "solvers/linear_algebra/cost_model.h"
#include "solvers/linear_algebra/scaled_lcp.h"
#include "support/array_index.h"

namespace lcpbench {
namespace {

Index WholeLanes(Index rows) { return (rows + DenseLdlt::kLanes - 1) / DenseLdlt::kLanes * DenseLdlt::kLanes; }

constexpr int kNone = -1;
constexpr int kLongestChain = 4;
// Fuller matrices of more rows than this are not analysed as sparse ones at all.
constexpr double kSparseFill = 0.4;
constexpr Index kAnalysedRows = 48;

}  // namespace

double DenseActiveBlock::FactorTime(Index rows) {
  const auto n = static_cast<double>(WholeLanes(rows));
  return CostModel::kDenseMultiplyAdd * n * n * n / 6 + CostModel::kDenseEntry * n * n + CostModel::kDenseOverhead;
}

void DenseActiveBlock::Analyze(const LcpProblem& problem) { Reserve(problem.DenseA().rows()); }

void DenseActiveBlock::Reserve(Index n) {
  n_ = n;
  RequireDenseMatrices(n_, 2);
  A_.setZero(WholeLanes(n_ + 1), n_);
  factor_.Reserve(n_);
  x_.resize(n_);
  rows_.reserve(static_cast<size_t>(WholeLanes(n_)));
}

void DenseActiveBlock::Load(const LcpProblem& problem, const Eigen::VectorXd& scale) {
  const Eigen::MatrixXd& given = problem.DenseA();
  for (Index j = 0; j < n_; ++j) A_.col(j).head(n_) = (given.col(j) * scale[j]).cwiseProduct(scale.head(n_));
}

void DenseActiveBlock::Assemble(const StepRows& rows) {
  AssembleDenseA(rows, A_.data(), A_.rows());
  A_.rightCols(n_ - rows.rows).setZero();
}

void DenseActiveBlock::Scale(const Eigen::VectorXd& scale) {
  for (Index j = 0; j < n_; ++j) A_.col(j).head(n_).array() *= scale.array() * scale[j];
}

bool DenseActiveBlock::Factor(const std::vector<char>& active, double shift, const Deadline* deadline) {
  shift_ = shift;
  rows_.clear();
  for (Index i = 0; i < n_; ++i) {
    if (active[static_cast<size_t>(i)] != 0) rows_.push_back(static_cast<std::int32_t>(i));
  }
  const Index m = std::ssize(rows_);
  rows_.resize(static_cast<size_t>(WholeLanes(m)), static_cast<std::int32_t>(n_));
  factor_.Reset(m);
  for (Index k = 0; k < m; ++k) {
    const double* from = A_.data() + rows_[static_cast<size_t>(k)] * A_.rows();
    double* to = factor_.column(k);
    for (Index i = k / DenseLdlt::kLanes * DenseLdlt::kLanes; i < std::ssize(rows_); i += DenseLdlt::kLanes) {
      const std::int32_t* rows = rows_.data() + i;
      for (Index lane = 0; lane < DenseLdlt::kLanes; ++lane) to[i + lane] = from[rows[lane]];
    }
    to[k] *= 1 + shift;
  }
  return factor_.Factor(m, shift / (1 + shift), nullptr, deadline);
}

Index DenseActiveBlock::CountDependentRows() const {
  Index count = 0;
  for (Index k = 0; k < factor_.size(); ++k) {
    const Index row = rows_[static_cast<size_t>(k)];
    if (factor_.pivot(k) <= kDependentPivot * shift_ * A_(row, row)) ++count;
  }
  return count;
}

void DenseActiveBlock::Solve(double* x) {
  for (Index k = 0; k < factor_.size(); ++k) x_[k] = x[rows_[static_cast<size_t>(k)]];
  factor_.Solve(x_.data());
  std::fill(x, x + n_, 0.0);
  for (Index k = 0; k < factor_.size(); ++k) x[rows_[static_cast<size_t>(k)]] = x_[k];
}

void DenseActiveBlock::Multiply(const double* x, double* y) const {
  std::fill(y, y + n_, 0.0);
  AddColumns(A_.data(), A_.rows(), 0, n_, n_, x, y);
}

bool SparseActiveBlock::HasPattern(const SparseMatrix& A) const {
  const int* outer = A.outerIndexPtr();
  const int* inner = A.innerIndexPtr();
  return std::equal(outer, outer + A.rows() + 1, outer_.begin(), outer_.end()) &&
         std::equal(inner, inner + outer[A.rows()], inner_.begin(), inner_.end());
}

void SparseActiveBlock::Analyze(const LcpProblem& problem) {
  const SparseMatrix& A = problem.SparseA();
  if (InSequence::on() && HasPattern(A)) return;
  outer_.clear();  // until the analysis has succeeded
  n_ = static_cast<int>(A.rows());
  Order(A);
  Permute(A);
  FindPatterns();
  values_.assign(column_.size(), 0);
  lower_.assign(rows_.size(), 0);
  for (std::vector<double>* v : {&diagonal_, &pivots_, &y_, &in_, &out_}) v->assign(At(n_), 0);
  active_.assign(At(n_), 0);
  dirty_.assign(At(n_), 0);
  outer_.assign(A.outerIndexPtr(), A.outerIndexPtr() + n_ + 1);
  inner_.assign(A.innerIndexPtr(), A.innerIndexPtr() + outer_.back());
}

void SparseActiveBlock::Order(const SparseMatrix& A) {
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> permutation;
  const Eigen::SparseMatrix<double, Eigen::ColMajor, int> columns = A;
  Eigen::AMDOrdering<int>()(columns, permutation);
  order_.assign(permutation.indices().data(), permutation.indices().data() + n_);
}

void SparseActiveBlock::Permute(const SparseMatrix& A) {
  std::vector<int> place(At(n_));
  for (int k = 0; k < n_; ++k) place[At(order_[At(k)])] = k;
  start_.assign(1, 0);
  column_.clear();
  source_.clear();
  diagonal_source_.assign(At(n_), 0);
  for (int r = 0; r < n_; ++r) {
    const int i = order_[At(r)];
    for (int s = A.outerIndexPtr()[i]; s < A.outerIndexPtr()[i + 1]; ++s) {
      const int c = place[At(A.innerIndexPtr()[s])];
      if (c == r) diagonal_source_[At(r)] = s;
      if (c >= r) continue;
      column_.push_back(c);
      source_.push_back(s);
    }
    start_.push_back(static_cast<int>(column_.size()));
  }
}

// The elimination tree [Liu 1986], then the pattern of each row of L: the nodes met on the way from its entries in A up
// the tree to the row itself.
void SparseActiveBlock::FindPatterns() {
  ++WorkCounts::OfThread().analyses;
  parent_.assign(At(n_), kNone);
  std::vector<int> ancestor(At(n_), kNone);
  std::vector<int> seen(At(n_), kNone);
  std::vector<int> count(At(n_), 0);
  row_start_.assign(1, 0);
  row_columns_.clear();
  for (int r = 0; r < n_; ++r) {
    for (int s = start_[At(r)]; s < start_[At(r + 1)]; ++s) {
      for (int k = column_[At(s)]; k != kNone && k < r;) {
        const int next = ancestor[At(k)];
        ancestor[At(k)] = r;
        if (next == kNone) parent_[At(k)] = r;
        k = next;
      }
    }
    seen[At(r)] = r;
    const size_t begin = row_columns_.size();
    for (int s = start_[At(r)]; s < start_[At(r + 1)]; ++s) {
      for (int k = column_[At(s)]; seen[At(k)] != r; k = parent_[At(k)]) {
        seen[At(k)] = r;
        row_columns_.push_back(k);
        ++count[At(k)];
      }
    }
    std::sort(row_columns_.begin() + static_cast<std::ptrdiff_t>(begin), row_columns_.end());
    row_start_.push_back(static_cast<int>(row_columns_.size()));
  }
  column_start_.assign(1, 0);
  factor_work_ = 0;
  for (int k = 0; k < n_; ++k) {
    column_start_.push_back(column_start_.back() + count[At(k)]);
    factor_work_ += 0.5 * count[At(k)] * (count[At(k)] + 1.0);
  }
  RequireMemory(static_cast<double>(row_columns_.size()) * (sizeof(double) + 3 * sizeof(int)), "the factor");
  rows_.assign(row_columns_.size(), 0);
  row_places_.assign(row_columns_.size(), 0);
  std::vector<int> next(column_start_.begin(), column_start_.end() - 1);
  for (int r = 0; r < n_; ++r) {
    for (int t = row_start_[At(r)]; t < row_start_[At(r + 1)]; ++t) {
      const int place = next[At(row_columns_[At(t)])]++;
      row_places_[At(t)] = place;
      rows_[At(place)] = r;
    }
  }
  // Column k + 1 continues k if it is its parent and one shorter: the rest of the two structures is the same.
  chain_.assign(At(n_), 1);
  for (int k = n_ - 2; k >= 0; --k) {
    if (parent_[At(k)] == k + 1 && count[At(k)] == count[At(k + 1)] + 1) {
      chain_[At(k)] = std::min(chain_[At(k + 1)] + 1, kLongestChain);
    }
  }
}

double SparseActiveBlock::factor_time() const { return CostModel::kSparseMultiplyAdd * factor_work_; }

Index SparseActiveBlock::CountDependentRows() const {
  Index count = 0;
  for (int r = 0; r < n_; ++r) {
    if (active_[At(r)] != 0 && pivots_[At(r)] <= kDependentPivot * shift_ * diagonal_[At(r)]) ++count;
  }
  return count;
}

void SparseActiveBlock::Load(const LcpProblem& problem, const Eigen::VectorXd& scale) {
  const double* given = problem.SparseA().valuePtr();
  for (int r = 0; r < n_; ++r) {
    const double s = scale[order_[At(r)]];
    diagonal_[At(r)] = (given[diagonal_source_[At(r)]] * s) * s;
    for (int t = start_[At(r)]; t < start_[At(r + 1)]; ++t) {
      values_[At(t)] = (given[source_[At(t)]] * s) * scale[order_[At(column_[At(t)])]];
    }
  }
  shift_ = 0;
}

void SparseActiveBlock::ComputeRow(int r) {
  const int begin = row_start_[At(r)];
  const int end = row_start_[At(r + 1)];
  if (active_[At(r)] == 0) {
    for (int t = begin; t < end; ++t) lower_[At(row_places_[At(t)])] = 0;
    return;
  }
  double* __restrict y = y_.data();  // zero outside this call
  const double* __restrict L = lower_.data();
  const int* __restrict rows = rows_.data();
  for (int s = start_[At(r)]; s < start_[At(r + 1)]; ++s) {
    const int c = column_[At(s)];
    if (active_[At(c)] != 0) y[c] = values_[At(s)];
  }
  double pivot = diagonal_[At(r)] * (1 + shift_);
  const auto finish = [&](int t, double value) {
    const double l = value / pivots_[At(row_columns_[At(t)])];
    lower_[At(row_places_[At(t)])] = l;
    pivot -= l * value;
  };
  for (int t = begin; t < end;) {
    const int k = row_columns_[At(t)];
    const int place = row_places_[At(t)];
    const int first = column_start_[At(k)];
    const double y0 = y[k];
    y[k] = 0;
    // A chain in the pattern of row r is there to its end: the columns between are ancestors of the first.
    const int length = std::min(chain_[At(k)], end - t);
    if (length < kLongestChain) {
      lower_[At(place)] = 0;
      if (y0 != 0) {
        for (int p = first; p < place; ++p) y[rows[p]] -= L[p] * y0;
        finish(t, y0);
      }
      ++t;
      continue;
    }
    const int first1 = column_start_[At(k + 1)];
    const int first2 = column_start_[At(k + 2)];
    const int first3 = column_start_[At(k + 3)];
    const double y1 = y[k + 1] - L[first] * y0;
    const double y2 = y[k + 2] - L[first + 1] * y0 - L[first1] * y1;
    const double y3 = y[k + 3] - L[first + 2] * y0 - L[first1 + 1] * y1 - L[first2] * y2;
    y[k + 1] = y[k + 2] = y[k + 3] = 0;
    const int shared = place - (first + 3);
    const double* __restrict l0 = L + first + 3;
    const double* __restrict l1 = L + first1 + 2;
    const double* __restrict l2 = L + first2 + 1;
    const double* __restrict l3 = L + first3;
    const int* __restrict target = rows + first3;
    if (y0 != 0 || y1 != 0 || y2 != 0 || y3 != 0) {
      for (int p = 0; p < shared; ++p) y[target[p]] -= (l0[p] * y0 + l1[p] * y1) + (l2[p] * y2 + l3[p] * y3);
    }
    finish(t, y0);
    finish(t + 1, y1);
    finish(t + 2, y2);
    finish(t + 3, y3);
    t += kLongestChain;
  }
  pivots_[At(r)] = std::max(pivot, shift_ * diagonal_[At(r)]);
}

bool SparseActiveBlock::Factor(const std::vector<char>& active, double shift, const Deadline* deadline) {
  const FactorClock::Scope clock;
  const bool all = shift != shift_;
  shift_ = shift;
  std::fill(dirty_.begin(), dirty_.end(), 0);
  double work = 0;
  for (int r = 0; r < n_; ++r) {
    const char now = active[At(order_[At(r)])];
    const bool changed = now != active_[At(r)];
    if (!all && !changed && dirty_[At(r)] == 0) continue;
    if (parent_[At(r)] != kNone) dirty_[At(parent_[At(r)])] = 1;
    const bool was_zero = active_[At(r)] == 0;
    active_[At(r)] = now;
    if (now == 0) pivots_[At(r)] = 1;
    if (now == 0 && was_zero && !all) continue;
    ComputeRow(r);
    if (deadline == nullptr) continue;
    const double entries = row_start_[At(r + 1)] - row_start_[At(r)];
    work += 0.5 * entries * entries + 1;
    if (work < kWorkPerClockRead) continue;
    work = 0;
    if (deadline->Expired()) {
      shift_ = 0;
      return false;
    }
  }
  return true;
}

void SparseActiveBlock::Solve(double* x) {
  double* __restrict y = in_.data();
  const double* __restrict L = lower_.data();
  const int* __restrict rows = rows_.data();
  for (int r = 0; r < n_; ++r) y[r] = active_[At(r)] != 0 ? x[order_[At(r)]] : 0.0;
  for (int k = 0; k < n_; ++k) {
    const double yk = y[k];
    if (yk == 0) continue;
    const int end = column_start_[At(k + 1)];
    for (int p = column_start_[At(k)]; p < end; ++p) y[rows[p]] -= L[p] * yk;
  }
  for (int k = n_ - 1; k >= 0; --k) {
    if (active_[At(k)] == 0) {
      x[order_[At(k)]] = 0;
      continue;
    }
    double sum = y[k] / pivots_[At(k)];
    const int end = column_start_[At(k + 1)];
    for (int p = column_start_[At(k)]; p < end; ++p) sum -= L[p] * y[rows[p]];
    y[k] = sum;
    x[order_[At(k)]] = sum;
  }
}

void SparseActiveBlock::Multiply(const double* x, double* y) const {
  for (int r = 0; r < n_; ++r) {
    in_[At(r)] = x[order_[At(r)]];
    out_[At(r)] = diagonal_[At(r)] * in_[At(r)];
  }
  for (int r = 0; r < n_; ++r) {
    double sum = 0;
    const double xr = in_[At(r)];
    for (int s = start_[At(r)]; s < start_[At(r + 1)]; ++s) {
      const int c = column_[At(s)];
      sum += values_[At(s)] * in_[At(c)];
      out_[At(c)] += values_[At(s)] * xr;
    }
    out_[At(r)] += sum;
  }
  for (int r = 0; r < n_; ++r) y[order_[At(r)]] = out_[At(r)];
}

double ActiveBlockChoice::StepTime(const ActiveBlock* chosen, Index rows) const {
  if (is_dense(chosen)) return CostModel::kDenseStep * chosen->factor_time();
  return CostModel::kSparseStep * chosen->factor_time() + CostModel::kSparseStepRow * static_cast<double>(rows);
}

ActiveBlock* ActiveBlockChoice::Analyze(const LcpProblem& problem, Allowed allowed) {
  const Index n = problem.size();
  if (allowed.sparse && allowed.dense && n > kAnalysedRows) {
    const auto entries = static_cast<double>(n) * static_cast<double>(n);
    allowed.sparse = static_cast<double>(problem.SparseA().nonZeros()) <= kSparseFill * entries;
  }
  if (allowed.sparse) {
    sparse_.Analyze(problem);
    if (!allowed.dense || sparse_.factor_time() <= DenseActiveBlock::FactorTime(n)) return &sparse_;
  }
  dense_.Analyze(problem);
  return &dense_;
}

}  // namespace lcpbench
