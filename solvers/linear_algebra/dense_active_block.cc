#include "solvers/linear_algebra/dense_active_block.h"

#include <algorithm>
#include <cmath>

#include "solvers/lcp/factor_clock.h"
#include "solvers/linear_algebra/cost_model.h"

namespace lcpbench {
namespace {

Index WholeBlocks(Index rows, Index block) { return (rows + block - 1) / block * block; }

}  // namespace

double DenseActiveBlock::FactorTime(Index rows) {
  const auto n = static_cast<double>(WholeBlocks(rows, kRows));
  return CostModel::kDenseMultiplyAdd * n * n * n / 6 + CostModel::kDenseEntry * n * n + CostModel::kDenseOverhead;
}

void DenseActiveBlock::Analyze(const LcpProblem& problem) {
  n_ = problem.DenseA().rows();
  A_.resize(n_, n_);
  const Index most = WholeBlocks(n_, kRows);
  factor_.resize(most * most);
  panel_.resize(most * kPanel);
  for (Eigen::VectorXd* v : {&inverse_, &floor_, &x_, &sums_}) v->resize(most);
  rows_.reserve(static_cast<size_t>(n_));
}

void DenseActiveBlock::Load(const LcpProblem& problem, const Eigen::VectorXd& scale) {
  const Eigen::MatrixXd& given = problem.DenseA();
  for (Index j = 0; j < n_; ++j) A_.col(j) = (given.col(j) * scale[j]).cwiseProduct(scale.head(n_));
}

void DenseActiveBlock::Gather(double shift) {
  const auto m = static_cast<Index>(rows_.size());
  for (Index k = 0; k < m; ++k) {
    const Index row = rows_[static_cast<size_t>(k)];
    const double* from = A_.data() + row * n_;
    for (Index block = k / kRows; block * kRows < padded_; ++block) {
      double* to = strip(block, k);
      const Index count = std::min(kRows, m - block * kRows);
      const Index* rows = rows_.data() + block * kRows;
      for (Index r = 0; r < count; ++r) to[r] = from[rows[r]];
      for (Index r = std::max(count, Index{0}); r < kRows; ++r) to[r] = 0;
    }
    strip(k / kRows, k)[k % kRows] = from[row] * (1 + shift);
    floor_[k] = from[row] * shift;
  }
  for (Index k = m; k < padded_; ++k) {
    double* to = strip(k / kRows, k);
    std::fill(to, to + kRows, 0.0);
    to[k % kRows] = 1;
    floor_[k] = 1;
  }
}

// Subtracts the product with the columns before `begin` from the panel.
void DenseActiveBlock::UpdatePanel(Index begin) {
  using Lanes = Eigen::Array<double, kRows / 2, 1>;
  const double* panel_rows = strip(begin / kRows, 0) + begin % kRows;
  for (Index k = 0; k < begin; ++k) {
    for (Index c = 0; c < kPanel; ++c) panel_[k * kPanel + c] = panel_rows[k * kRows + c] * inverse_[k];
  }
  for (Index block = begin / kRows; block * kRows < padded_; ++block) {
    Lanes sum0[kPanel];
    Lanes sum1[kPanel];
    for (Index c = 0; c < kPanel; ++c) {
      sum0[c].setZero();
      sum1[c].setZero();
    }
    const double* l = strip(block, 0);
    const double* s = panel_.data();
    for (Index k = 0; k < begin; ++k, l += kRows, s += kPanel) {
      const Lanes l0 = Eigen::Map<const Lanes>(l);
      const Lanes l1 = Eigen::Map<const Lanes>(l + kRows / 2);
      for (Index c = 0; c < kPanel; ++c) {
        sum0[c] += l0 * s[c];
        sum1[c] += l1 * s[c];
      }
    }
    for (Index c = 0; c < kPanel; ++c) {
      double* to = strip(block, begin + c);
      Eigen::Map<Lanes>{to} -= sum0[c];
      Eigen::Map<Lanes>{to + kRows / 2} -= sum1[c];
    }
  }
}

void DenseActiveBlock::FactorPanel(Index begin) {
  for (Index d = begin; d < begin + kPanel; ++d) {
    const Index own = d / kRows;
    for (Index k = begin; k < d; ++k) {
      const double s = strip(own, k)[d % kRows] * inverse_[k];
      for (Index block = own; block * kRows < padded_; ++block) Strip(strip(block, d)) -= Strip(strip(block, k)) * s;
    }
    inverse_[d] = 1 / std::max(strip(own, d)[d % kRows], floor_[d]);
  }
}

bool DenseActiveBlock::Factor(const std::vector<char>& active, double shift, const Deadline* deadline) {
  const FactorClock::Scope clock;
  rows_.clear();
  for (Index i = 0; i < n_; ++i) {
    if (active[static_cast<size_t>(i)] != 0) rows_.push_back(i);
  }
  padded_ = WholeBlocks(static_cast<Index>(rows_.size()), kRows);
  Gather(shift);
  for (Index begin = 0; begin < padded_; begin += kPanel) {
    UpdatePanel(begin);
    FactorPanel(begin);
    // One panel of a thousand rows takes some 100 us.
    if (deadline != nullptr && deadline->Expired()) return false;
  }
  return true;
}

Index DenseActiveBlock::CountDependentRows() const {
  Index count = 0;
  for (Index k = 0; k < static_cast<Index>(rows_.size()); ++k) {
    if (1 <= kDependentPivot * floor_[k] * inverse_[k]) ++count;
  }
  return count;
}

void DenseActiveBlock::Solve(double* x) {
  const auto m = static_cast<Index>(rows_.size());
  double* y = x_.data();
  for (Index k = 0; k < m; ++k) y[k] = x[rows_[static_cast<size_t>(k)]];
  std::fill(y + m, y + padded_, 0.0);
  for (Index block = 0; block * kRows < padded_; ++block) {  // y := D^-1 L^-1 y
    const Index first = block * kRows;
    Eigen::Array<double, kRows, 1> rest = Strip(y + first);
    for (Index k = 0; k < first; ++k) rest -= Strip(strip(block, k)) * y[k];
    for (Index k = 0; k < kRows; ++k) {
      rest[k] *= inverse_[first + k];
      const double* l = strip(block, first + k);
      for (Index r = k + 1; r < kRows; ++r) rest[r] -= l[r] * rest[k];
    }
    Strip(y + first) = rest;
  }
  sums_.head(padded_).setZero();  // of column k of L D with the entries of y that are known
  for (Index block = padded_ / kRows - 1; block >= 0; --block) {
    const Index first = block * kRows;
    for (Index k = kRows - 1; k >= 0; --k) {
      const double* l = strip(block, first + k);
      for (Index r = k + 1; r < kRows; ++r) sums_[first + k] += l[r] * y[first + r];
      y[first + k] -= inverse_[first + k] * sums_[first + k];
    }
    const Eigen::Array<double, kRows, 1> here = Strip(y + first);
    for (Index k = 0; k < first; ++k) sums_[k] += (Strip(strip(block, k)) * here).sum();
  }
  std::fill(x, x + n_, 0.0);
  for (Index k = 0; k < m; ++k) x[rows_[static_cast<size_t>(k)]] = y[k];
}

void DenseActiveBlock::Multiply(const double* x, double* y) const {
  std::fill(y, y + n_, 0.0);
  for (Index j = 0; j < n_; ++j) {
    const double xj = x[j];
    if (xj == 0) continue;
    const double* __restrict a = A_.data() + j * n_;
    double* __restrict out = y;
    for (Index i = 0; i < n_; ++i) out[i] += a[i] * xj;
  }
}

}  // namespace lcpbench
