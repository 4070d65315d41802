#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "solvers/first_order/sweeps/projected_step.h"
#include "solvers/first_order/sweeps/row_kernel.h"

namespace lcpbench {
namespace {

// Row `row` of A times x, in four sums: one alone would wait for its own addition at every entry.
double Product(const SparseMatrix& A, Index row, const double* x) {
  const double* value = A.valuePtr();
  const int* column = A.innerIndexPtr();
  Index k = A.outerIndexPtr()[row];
  const Index end = A.outerIndexPtr()[row + 1];
  double s0 = 0;
  double s1 = 0;
  double s2 = 0;
  double s3 = 0;
  for (; k + 4 <= end; k += 4) {
    s0 += value[k] * x[column[k]];
    s1 += value[k + 1] * x[column[k + 1]];
    s2 += value[k + 2] * x[column[k + 2]];
    s3 += value[k + 3] * x[column[k + 3]];
  }
  for (; k < end; ++k) s0 += value[k] * x[column[k]];
  return (s0 + s1) + (s2 + s3);
}

// x += factor times row `row` of A.
void AddRow(const SparseMatrix& A, Index row, double factor, Array* x) {
  for (SparseMatrix::InnerIterator it(A, row); it; ++it) (*x)[it.col()] += it.value() * factor;
}

Index MeanEntries(const SparseMatrix& A) { return A.nonZeros() / std::max<Index>(1, A.rows()); }

template <typename Visit>
void ForRows(Index begin, Index end, bool backward, const Visit& visit) {
  if (backward) {
    for (Index k = end; k-- > begin;) visit(k);
  } else {
    for (Index k = begin; k < end; ++k) visit(k);
  }
}

// The rows of D^-1/2 A D^-1/2 without the diagonal, which is 1 (or 0). Image: A f.
class AssembledRows final : public LaidOutRows<AssembledRows, true> {
 public:
  AssembledRows(const LcpProblem& problem, const ScaledProblem& scaled)
      : LaidOutRows(scaled), rows_(scaled.size, scaled.size), diagonal_(Array::Zero(scaled.size)) {
    const SparseMatrix& A = problem.SparseA();
    std::vector<int> position(static_cast<size_t>(scaled.size));
    for (Index k = 0; k < scaled.size; ++k) position[static_cast<size_t>(scaled.Given(k))] = static_cast<int>(k);
    rows_.reserve(A.nonZeros());
    std::vector<std::pair<int, double>> entries;
    for (Index k = 0; k < scaled.size; ++k) {
      entries.clear();
      for (SparseMatrix::InnerIterator it(A, scaled.Given(k)); it; ++it) {
        const int column = position[static_cast<size_t>(it.col())];
        const double value = it.value() * scaled.inverse_root[k] * scaled.inverse_root[column];
        if (column == k) {
          diagonal_[k] = it.value() == 0 ? 0.0 : 1.0;
        } else if (value != 0) {
          entries.emplace_back(column, value);
        }
      }
      if (!scaled.order.empty()) std::sort(entries.begin(), entries.end());
      rows_.startVec(k);
      for (const auto& [column, value] : entries) rows_.insertBack(k, column) = value;
    }
    rows_.finalize();
  }

  bool ImageIsRoot() const override { return false; }
  Index EntriesPerRow() const override { return 1 + MeanEntries(rows_); }
  Index ImageSize() const override { return scaled_.size; }
  void StartImage(Array* image) const override { image->setZero(); }
  void AddToImage(Index begin, Index end, Point* x) const override {
    for (Index k = begin; k < end; ++k) x->image[k] = diagonal_[k] * x->f[k] + Product(rows_, k, x->f.data());
  }
  void AddRowToImage(Index row, double df, Array* image) const override {
    (*image)[row] += diagonal_[row] * df;
    AddRow(rows_, row, df, image);
  }
  double W(Index row, const Point& x) const override {
    return (scaled_.b[row] + diagonal_[row] * x.f[row]) + Product(rows_, row, x.f.data());
  }
  template <typename Step>
  void Visit(Index begin, Index end, bool backward, const Point& from, Array* /*image*/, Step* step) const {
    ForRows(begin, end, backward, [&](Index k) {
      step->Take(k, Step::kKind == StepKind::kSweep ? W(k, from) : scaled_.b[k] + from.image[k]);
    });
  }

 private:
  SparseMatrix rows_;
  Array diagonal_;
};

// S = D^-1/2 J M^-1/2 by rows on any number of bodies. Image: S^T f.
class FactorRows final : public LaidOutRows<FactorRows, true> {
 public:
  FactorRows(const LcpProblem& problem, const ScaledProblem& scaled)
      : LaidOutRows(scaled), S_(scaled.size, problem.J().cols()) {
    S_.reserve(problem.J().nonZeros());
    for (Index k = 0; k < scaled.size; ++k) {
      S_.startVec(k);
      for (SparseMatrix::InnerIterator it(problem.J(), scaled.Given(k)); it; ++it) {
        const double value = it.value() * std::sqrt(problem.inverse_mass()[it.col()]) * scaled.inverse_root[k];
        if (value != 0) S_.insertBack(k, it.col()) = value;
      }
    }
    S_.finalize();
  }

  bool ImageIsRoot() const override { return true; }
  Index EntriesPerRow() const override { return std::max<Index>(1, 2 * MeanEntries(S_)); }
  Index ImageSize() const override { return S_.cols(); }
  void StartImage(Array* image) const override { image->setZero(); }
  void AddToImage(Index begin, Index end, Point* x) const override {
    for (Index k = begin; k < end; ++k) AddRow(S_, k, x->f[k], &x->image);
  }
  void AddRowToImage(Index row, double df, Array* image) const override { AddRow(S_, row, df, image); }
  double W(Index row, const Point& x) const override { return scaled_.b[row] + Product(S_, row, x.image.data()); }
  template <typename Step>
  void Visit(Index begin, Index end, bool backward, const Point& from, Array* image, Step* step) const {
    ForRows(begin, end, backward, [&](Index k) {
      const double value = step->Take(k, W(k, from));
      if (image != nullptr) AddRow(S_, k, value, image);
    });
  }

 private:
  SparseMatrix S_;
};

}  // namespace

std::unique_ptr<RowKernel> MakeAssembledRows(const LcpProblem& problem, const ScaledProblem& scaled) {
  return std::make_unique<AssembledRows>(problem, scaled);
}
std::unique_ptr<RowKernel> MakeFactorRows(const LcpProblem& problem, const ScaledProblem& scaled) {
  return std::make_unique<FactorRows>(problem, scaled);
}

}  // namespace lcpbench
