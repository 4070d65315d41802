#include "solvers/first_order/sweeps/factor_rows.h"

#include <algorithm>
#include <cmath>

#include "solvers/first_order/sweeps/projected_step.h"

namespace lcpbench {
namespace {

size_t At(Index i) { return static_cast<size_t>(i); }

}  // namespace

FactorRows::FactorRows(const LcpProblem& problem, const ScaledProblem& scaled)
    : scaled_(scaled), columns_(At(problem.J().cols())) {
  rows_.Clear(problem.J().nonZeros());
  for (Index k = 0; k < scaled.size; ++k) {
    for (SparseMatrix::InnerIterator it(problem.J(), scaled.Given(k)); it; ++it) {
      const double value = it.value() * std::sqrt(problem.inverse_mass()[it.col()]) * scaled.inverse_root[At(k)];
      if (value != 0) rows_.Push(it.col(), value);
    }
    rows_.EndRow();
  }
}

Index FactorRows::EntriesPerRow() const {
  return std::max<Index>(1, 2 * rows_.Entries() / std::max<Index>(1, rows_.Rows()));
}

double FactorRows::W(Index row, const Array& /*f*/, const Array& image) const {
  return scaled_.b[At(row)] + rows_.Dot(row, image.data());
}

void FactorRows::StartImage(Array* image) const { image->assign(columns_, 0.0); }

void FactorRows::AddToImage(Index begin, Index end, const Array& f, Array* image) const {
  for (Index k = begin; k < end; ++k) {
    if (f[At(k)] != 0) rows_.Add(k, f[At(k)], image->data());
  }
}

void FactorRows::AddRowToImage(Index row, double df, Array* image) const { rows_.Add(row, df, image->data()); }

void FactorRows::Sweep(Index begin, Index end, bool backward, double omega, Array* f, Array* image,
                       StepSums* sums) const {
  RunStep<false>(scaled_, omega, *f, f, sums, [&](auto* step) {
    const auto visit = [&](Index k) { rows_.Add(k, step->Take(k, W(k, *f, *image)), image->data()); };
    if (backward) {
      for (Index k = end; k-- > begin;) visit(k);
    } else {
      for (Index k = begin; k < end; ++k) visit(k);
    }
  });
}

void FactorRows::GradientStep(Index begin, Index end, double step, const Array& y, const Array& y_image, Array* next,
                              Array* next_image, StepSums* sums) const {
  RunStep<true>(scaled_, step, y, next, sums, [&](auto* projected) {
    for (Index k = begin; k < end; ++k) rows_.Add(k, projected->Take(k, W(k, y, y_image)), next_image->data());
  });
}

double FactorRows::ResidualSquares(Index begin, Index end, const Array& f, const Array& image) const {
  return RunResidual(scaled_, f, [&](auto* residual) {
    for (Index k = begin; k < end; ++k) residual->Take(k, W(k, f, image));
  });
}

}  // namespace lcpbench
