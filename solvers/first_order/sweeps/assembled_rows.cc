#include "solvers/first_order/sweeps/assembled_rows.h"

#include <algorithm>
#include <utility>

#include "solvers/first_order/sweeps/projected_step.h"

namespace lcpbench {
namespace {

size_t At(Index i) { return static_cast<size_t>(i); }

}  // namespace

AssembledRows::AssembledRows(const LcpProblem& problem, const ScaledProblem& scaled) : scaled_(scaled) {
  const SparseMatrix& A = problem.SparseA();
  std::vector<Index> position(At(scaled.size));
  for (Index k = 0; k < scaled.size; ++k) position[At(scaled.Given(k))] = k;
  rows_.Clear(A.nonZeros());
  diagonal_.assign(At(scaled.size), 0.0);
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

Index AssembledRows::EntriesPerRow() const { return 1 + rows_.Entries() / std::max<Index>(1, rows_.Rows()); }

void AssembledRows::StartImage(Array* image) const { image->assign(ImageSize(), 0.0); }

void AssembledRows::AddToImage(Index begin, Index end, const Array& f, Array* image) const {
  for (Index k = begin; k < end; ++k) (*image)[At(k)] = diagonal_[At(k)] * f[At(k)] + rows_.Dot(k, f.data());
}

void AssembledRows::AddRowToImage(Index row, double df, Array* image) const {
  (*image)[At(row)] += diagonal_[At(row)] * df;
  rows_.Add(row, df, image->data());
}

double AssembledRows::W(Index row, const Array& f, const Array& /*image*/) const {
  return (scaled_.b[At(row)] + diagonal_[At(row)] * f[At(row)]) + rows_.Dot(row, f.data());
}

void AssembledRows::Sweep(Index begin, Index end, bool backward, double omega, Array* f, Array* image,
                          StepSums* sums) const {
  RunStep<false>(scaled_, omega, *f, f, sums, [&](auto* step) {
    const auto visit = [&](Index k) { step->Take(k, W(k, *f, *image)); };
    if (backward) {
      for (Index k = end; k-- > begin;) visit(k);
    } else {
      for (Index k = begin; k < end; ++k) visit(k);
    }
  });
}

void AssembledRows::GradientStep(Index begin, Index end, double step, const Array& y, const Array& y_image, Array* next,
                                 Array* /*next_image*/, StepSums* sums) const {
  RunStep<true>(scaled_, step, y, next, sums, [&](auto* projected) {
    for (Index k = begin; k < end; ++k) projected->Take(k, scaled_.b[At(k)] + y_image[At(k)]);
  });
}

double AssembledRows::ResidualSquares(Index begin, Index end, const Array& f, const Array& image) const {
  return RunResidual(scaled_, f, [&](auto* residual) {
    for (Index k = begin; k < end; ++k) residual->Take(k, scaled_.b[At(k)] + image[At(k)]);
  });
}

}  // namespace lcpbench
