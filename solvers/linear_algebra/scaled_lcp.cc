#include "solvers/linear_algebra/scaled_lcp.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "solvers/lcp/law.h"
#include "support/array_index.h"

namespace lcpbench {
namespace {

// Entries between two looks at the clock, some 10 us.
constexpr Index kWorkPerClockRead = 1 << 14;

}  // namespace

void ScaledVectors::Reset(Eigen::Index rows) {
  for (Eigen::VectorXd* v : {&scale, &diagonal, &b, &b_unit}) v->setZero(rows);
  for (std::vector<char>* v : {&can_act, &bilateral}) v->assign(At(rows), 0);
}

void ScaledVectors::Reset(const LcpProblem& problem) {
  Reset(problem.size());
  for (const Eigen::Index i : problem.bilateral_rows()) bilateral[static_cast<size_t>(i)] = 1;
}

double ScaledVectors::Rho(const Eigen::VectorXd& f, const Eigen::VectorXd& w) const {
  LawSums<double> sums;
  for (Eigen::Index i = 0; i < f.size(); ++i) sums.Add(diagonal[i], 0, b_unit[i] * w[i], b_unit[i] * f[i], is_joint(i));
  return sums.norm() / b_norm;
}

void ScaledVectors::Clip(const Eigen::VectorXd& given, Eigen::VectorXd* f) const {
  for (Eigen::Index i = 0; i < given.size(); ++i) {
    const double force = ScaledForce(i, given[i]);
    (*f)[i] = !acts(i) ? 0.0 : is_joint(i) ? force : std::max(force, 0.0);
  }
}

bool ScaledVectors::Load(const Eigen::VectorXd& d, const Eigen::VectorXd& given) {
  double largest = 0;
  double squared = 0;
  for (Eigen::Index i = 0; i < d.size(); ++i) {
    if (d[i] < 0) return false;
    const bool acts = d[i] > 0;
    can_act[static_cast<size_t>(i)] = acts ? 1 : 0;
    scale[i] = acts ? ScaleOfDiagonal(d[i]) : 1.0;
    diagonal[i] = acts ? (d[i] * scale[i]) * scale[i] : 1.0;
    b[i] = acts ? given[i] * scale[i] : 0.0;
    largest = std::max(largest, std::abs(b[i]));
    squared += acts ? given[i] * (given[i] / d[i]) : given[i] * given[i];
  }
  b_norm = squared == 0 ? 1.0 : std::sqrt(squared);
  const double b_scale = ScaleOfLargest(largest);
  b *= b_scale;
  b_unit.setConstant(1 / b_scale);
  return true;
}

void AddColumns(const double* A, Index stride, Index begin, Index end, Index columns, const double* __restrict x,
                double* __restrict out) {
  Index j = 0;
  // Four columns together, so that `out` is loaded and stored once for all of them.
  for (; j + 4 <= columns; j += 4) {
    const double x0 = x[j];
    const double x1 = x[j + 1];
    const double x2 = x[j + 2];
    const double x3 = x[j + 3];
    if (x0 == 0 && x1 == 0 && x2 == 0 && x3 == 0) continue;
    const double* __restrict a0 = A + j * stride;
    const double* __restrict a1 = a0 + stride;
    const double* __restrict a2 = a1 + stride;
    const double* __restrict a3 = a2 + stride;
    for (Index p = begin; p < end; ++p) out[p] += (a0[p] * x0 + a1[p] * x1) + (a2[p] * x2 + a3[p] * x3);
  }
  for (; j < columns; ++j) {
    const double xj = x[j];
    if (xj == 0) continue;
    const double* __restrict a = A + j * stride;
    for (Index p = begin; p < end; ++p) out[p] += a[p] * xj;
  }
}

void PermutedLcp::Reserve(Index max_rows) {
  if (max_rows <= f.size()) return;
  A.resize(PaddedStride(max_rows) * max_rows);
  for (Eigen::VectorXd* v : {&diagonal, &b, &f, &w, &scale}) v->setZero(max_rows);
  row.resize(At(max_rows));
  kind_.resize(At(max_rows));
  moved_.reserve(At(max_rows));
}

// Fills row, bilateral, guessed and moved_. Rows that may stay where they are do.
void PermutedLcp::Order(const LcpProblem& problem, const Guess& guess) {
  const Eigen::VectorXd& d = problem.DiagonalA();
  const std::vector<Index>& joints = problem.bilateral_rows();
  // A_ii f_i^2 of contacts, where positive; nothing but powers of two comes between for problems that differ by such.
  double* size = f.data();
  double least = 0;
  if (guess.forces == nullptr) {
    const double* given_b = problem.b().data();
    for (Index i = 0; i < n; ++i) size[i] = guess.negative_b ? -given_b[i] : 0.0;
  } else {
    double largest = 0;
    for (Index i = 0; i < n; ++i) {
      const double scaled = std::max((*guess.forces)[i], 0.0) / scale[i];
      size[i] = scaled * scaled * (d[i] * scale[i] * scale[i]);
    }
    for (const Index i : joints) size[i] = 0;
    for (Index i = 0; i < n; ++i) largest = std::max(largest, size[i]);
    least = kGuessThreshold * kGuessThreshold * largest;
  }
  // Kinds of rows in their order, and where the places of each begin.
  enum Kind : unsigned char { kJoint, kGuessed, kOther, kZero, kKinds };
  Index count[kKinds] = {};
  for (Index i = 0; i < n; ++i) kind_[At(i)] = d[i] == 0 ? kZero : size[i] > least ? kGuessed : kOther;
  for (const Index i : joints) {
    if (d[i] != 0) kind_[At(i)] = kJoint;
  }
  for (Index i = 0; i < n; ++i) ++count[static_cast<size_t>(kind_[At(i)])];
  bilateral = count[kJoint];
  guessed = count[kGuessed];
  Index begin[kKinds + 1] = {};
  for (size_t k = 0; k < kKinds; ++k) begin[k + 1] = begin[k] + count[k];
  moved_.clear();
  Index next[kKinds] = {begin[0], begin[1], begin[2], begin[3]};
  for (Index i = 0; i < n; ++i) {
    const auto k = static_cast<size_t>(kind_[At(i)]);
    if (i >= begin[k] && i < begin[k + 1]) {
      row[At(i)] = i;
      continue;
    }
    // The next place of its kind whose own row is of another kind.
    while (static_cast<size_t>(kind_[At(next[k])]) == k) ++next[k];
    moved_.push_back(next[k]);
    row[At(next[k]++)] = i;
  }
}

PermutedLcp::Loaded PermutedLcp::Load(const LcpProblem& problem, const Guess& guess, const Deadline* deadline) {
  const Eigen::MatrixXd& given = problem.DenseA();
  const Eigen::VectorXd& given_b = problem.b();
  n = problem.size();
  stride = PaddedStride(n);
  nonzero = n;
  double largest_b = 0;
  double b_squared = 0;
  for (Index i = 0; i < n; ++i) {
    const double d = given(i, i);
    if (d < 0) return Loaded::kNegativeDiagonal;
    if (d == 0) {
      --nonzero;
      scale[i] = 1;
      b_squared += given_b[i] * given_b[i];
      continue;
    }
    scale[i] = ScaleOfDiagonal(d);
    largest_b = std::max(largest_b, std::abs(given_b[i] * scale[i]));
    b_squared += given_b[i] * (given_b[i] / d);
  }
  b_norm = b_squared == 0 ? 1.0 : std::sqrt(b_squared);
  b_scale = ScaleOfLargest(largest_b);

  if (nonzero == n && problem.bilateral_rows().empty() && guess.forces == nullptr && !guess.negative_b) {
    bilateral = 0;
    guessed = 0;
    moved_.clear();
    for (Index i = 0; i < n; ++i) row[At(i)] = i;
  } else {
    Order(problem, guess);
  }
  const double* __restrict factor = scale.data();
  Index work = 0;
  for (Index q = 0; q < nonzero; ++q) {
    work += n;
    if (deadline != nullptr && work > kWorkPerClockRead) {
      work = 0;
      if (deadline->Expired()) return Loaded::kOutOfTime;
    }
    const Index source = row[At(q)];
    const double* __restrict from = given.data() + source * n;
    double* __restrict to = column(q);
    const double s = scale[source];
    for (Index i = 0; i < nonzero; ++i) to[i] = (from[i] * s) * factor[i];
    for (const Index p : moved_) to[p] = (from[row[At(p)]] * s) * factor[row[At(p)]];
    diagonal[q] = to[q];
    b[q] = given_b[source] * s * b_scale;
    w[q] = b[q];
  }
  f.head(nonzero).setZero();
  return Loaded::kDone;
}

void PermutedLcp::Swap(Index p, Index q) {
  if (p == q) return;
  std::swap_ranges(column(p), column(p) + nonzero, column(q));
  double* row_p = A.data() + p;
  double* row_q = A.data() + q;
  for (Index j = 0; j < nonzero; ++j) std::swap(row_p[j * stride], row_q[j * stride]);
  for (Eigen::VectorXd* v : {&diagonal, &b, &f, &w}) std::swap((*v)[p], (*v)[q]);
  std::swap(row[At(p)], row[At(q)]);
}

PermutedLcp::Sum PermutedLcp::FreshW(Index p, Index columns) const {
  constexpr Index kLanes = 4;  // independent sums hide the latency of additions
  const double* a = column(p);
  double value[kLanes] = {b[p]};
  double magnitude[kLanes] = {std::abs(b[p])};
  Index j = 0;
  for (; j + kLanes <= columns; j += kLanes) {
    for (Index l = 0; l < kLanes; ++l) {
      const double term = a[j + l] * f[j + l];
      value[l] += term;
      magnitude[l] += std::abs(term);
    }
  }
  for (; j < columns; ++j) {
    const double term = a[j] * f[j];
    value[0] += term;
    magnitude[0] += std::abs(term);
  }
  return {(value[0] + value[1]) + (value[2] + value[3]), (magnitude[0] + magnitude[1]) + (magnitude[2] + magnitude[3])};
}

double PermutedLcp::ResidualShare(Index p, double w_p) const {
  return std::abs(w_p) / (b_scale * std::sqrt(diagonal[p]) * b_norm);
}

}  // namespace lcpbench
