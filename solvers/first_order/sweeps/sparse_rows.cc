#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "solvers/first_order/sweeps/projected_step.h"
#include "solvers/first_order/sweeps/row_kernel.h"

namespace lcpbench {
namespace {

size_t At(Index i) { return static_cast<size_t>(i); }

// A sparse matrix by rows, made one entry after the other.
class CompressedRows {
 public:
  void Reserve(Index entries) {
    column_.reserve(At(entries));
    value_.reserve(At(entries));
  }
  void Push(Index column, double value) {
    column_.push_back(static_cast<int>(column));
    value_.push_back(value);
  }
  void EndRow() { start_.push_back(static_cast<Index>(value_.size())); }
  Index Rows() const { return static_cast<Index>(start_.size()) - 1; }
  Index Entries() const { return start_.back(); }

  // Four sums: one alone would wait for its own addition at every entry.
  double Dot(Index row, const double* x) const {
    const double* value = value_.data();
    const int* column = column_.data();
    Index k = start_[At(row)];
    const Index end = start_[At(row) + 1];
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
  void Add(Index row, double factor, double* x) const {
    for (Index k = start_[At(row)]; k < start_[At(row) + 1]; ++k) x[column_[At(k)]] += value_[At(k)] * factor;
  }

 private:
  std::vector<Index> start_ = {0};
  std::vector<int> column_;
  std::vector<double> value_;
};

// Calls visit(k) for the rows of a range, forward or backward.
template <typename Visit>
void ForRows(Index begin, Index end, bool backward, const Visit& visit) {
  if (backward) {
    for (Index k = end; k-- > begin;) visit(k);
  } else {
    for (Index k = begin; k < end; ++k) visit(k);
  }
}

// The rows of D^-1/2 A D^-1/2 without the diagonal, which is 1 (or 0).
class AssembledRows final : public RowKernel {
 public:
  AssembledRows(const LcpProblem& problem, const ScaledProblem& scaled)
      : scaled_(scaled), diagonal_(At(scaled.size), 0.0) {
    const SparseMatrix& A = problem.SparseA();
    std::vector<Index> position(At(scaled.size));
    for (Index k = 0; k < scaled.size; ++k) position[At(scaled.Given(k))] = k;
    rows_.Reserve(A.nonZeros());
    std::vector<std::pair<Index, double>> entries;
    for (Index k = 0; k < scaled.size; ++k) {
      entries.clear();
      for (SparseMatrix::InnerIterator it(A, scaled.Given(k)); it; ++it) {
        const Index column = position[At(it.col())];
        if (column == k) {
          diagonal_[At(k)] = it.value() == 0 ? 0.0 : 1.0;
        } else {
          entries.emplace_back(column, it.value() * scaled.inverse_root[At(k)] * scaled.inverse_root[At(column)]);
        }
      }
      if (!scaled.order.empty()) std::sort(entries.begin(), entries.end());
      for (const auto& [column, value] : entries) {
        if (value != 0) rows_.Push(column, value);
      }
      rows_.EndRow();
    }
  }

  std::size_t ImageSize() const override { return At(scaled_.size); }
  bool ImageIsRoot() const override { return false; }
  Index EntriesPerRow() const override { return 1 + rows_.Entries() / std::max<Index>(1, rows_.Rows()); }
  void StartImage(Array* image) const override { image->assign(ImageSize(), 0.0); }
  void AddToImage(Index begin, Index end, const Array& f, Array* image) const override {
    for (Index k = begin; k < end; ++k) (*image)[At(k)] = diagonal_[At(k)] * f[At(k)] + rows_.Dot(k, f.data());
  }
  void AddRowToImage(Index row, double df, Array* image) const override {
    (*image)[At(row)] += diagonal_[At(row)] * df;
    rows_.Add(row, df, image->data());
  }
  double W(Index row, const Array& f, const Array& /*image*/) const override {
    return (scaled_.b[At(row)] + diagonal_[At(row)] * f[At(row)]) + rows_.Dot(row, f.data());
  }
  void Sweep(Index begin, Index end, bool backward, double omega, Array* f, Array* image,
             StepSums* sums) const override {
    RunStep<false>(scaled_, omega, *f, f, sums, [&](auto* step) {
      ForRows(begin, end, backward, [&](Index k) { step->Take(k, W(k, *f, *image)); });
    });
  }
  void GradientStep(Index begin, Index end, double step, const Array& y, const Array& y_image, Array* next,
                    Array* /*next_image*/, StepSums* sums) const override {
    RunStep<true>(scaled_, step, y, next, sums, [&](auto* projected) {
      for (Index k = begin; k < end; ++k) projected->Take(k, scaled_.b[At(k)] + y_image[At(k)]);
    });
  }
  double ResidualSquares(Index begin, Index end, const Array& f, const Array& image) const override {
    return RunResidual(scaled_, f, [&](auto* residual) {
      for (Index k = begin; k < end; ++k) residual->Take(k, scaled_.b[At(k)] + image[At(k)]);
    });
  }

 private:
  const ScaledProblem& scaled_;
  CompressedRows rows_;
  Array diagonal_;
};

// S = D^-1/2 J M^-1/2 by rows on any number of bodies. Image: S^T f.
class FactorRows final : public RowKernel {
 public:
  FactorRows(const LcpProblem& problem, const ScaledProblem& scaled)
      : scaled_(scaled), columns_(At(problem.J().cols())) {
    rows_.Reserve(problem.J().nonZeros());
    for (Index k = 0; k < scaled.size; ++k) {
      for (SparseMatrix::InnerIterator it(problem.J(), scaled.Given(k)); it; ++it) {
        const double value = it.value() * std::sqrt(problem.inverse_mass()[it.col()]) * scaled.inverse_root[At(k)];
        if (value != 0) rows_.Push(it.col(), value);
      }
      rows_.EndRow();
    }
  }

  std::size_t ImageSize() const override { return columns_; }
  bool ImageIsRoot() const override { return true; }
  Index EntriesPerRow() const override {
    return std::max<Index>(1, 2 * rows_.Entries() / std::max<Index>(1, rows_.Rows()));
  }
  void StartImage(Array* image) const override { image->assign(columns_, 0.0); }
  void AddToImage(Index begin, Index end, const Array& f, Array* image) const override {
    for (Index k = begin; k < end; ++k) {
      if (f[At(k)] != 0) AddRowToImage(k, f[At(k)], image);
    }
  }
  void AddRowToImage(Index row, double df, Array* image) const override { rows_.Add(row, df, image->data()); }
  double W(Index row, const Array& /*f*/, const Array& image) const override {
    return scaled_.b[At(row)] + rows_.Dot(row, image.data());
  }
  void Sweep(Index begin, Index end, bool backward, double omega, Array* f, Array* image,
             StepSums* sums) const override {
    RunStep<false>(scaled_, omega, *f, f, sums, [&](auto* step) {
      ForRows(begin, end, backward, [&](Index k) { rows_.Add(k, step->Take(k, W(k, *f, *image)), image->data()); });
    });
  }
  void GradientStep(Index begin, Index end, double step, const Array& y, const Array& y_image, Array* next,
                    Array* next_image, StepSums* sums) const override {
    RunStep<true>(scaled_, step, y, next, sums, [&](auto* projected) {
      for (Index k = begin; k < end; ++k) rows_.Add(k, projected->Take(k, W(k, y, y_image)), next_image->data());
    });
  }
  double ResidualSquares(Index begin, Index end, const Array& f, const Array& image) const override {
    return RunResidual(scaled_, f, [&](auto* residual) {
      for (Index k = begin; k < end; ++k) residual->Take(k, W(k, f, image));
    });
  }

 private:
  const ScaledProblem& scaled_;
  CompressedRows rows_;
  std::size_t columns_;
};

}  // namespace

std::unique_ptr<RowKernel> MakeAssembledRows(const LcpProblem& problem, const ScaledProblem& scaled) {
  return std::make_unique<AssembledRows>(problem, scaled);
}
std::unique_ptr<RowKernel> MakeFactorRows(const LcpProblem& problem, const ScaledProblem& scaled) {
  return std::make_unique<FactorRows>(problem, scaled);
}

}  // namespace lcpbench
