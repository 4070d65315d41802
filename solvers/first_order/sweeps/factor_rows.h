#pragma once

#include "solvers/first_order/sweeps/compressed_rows.h"
#include "solvers/first_order/sweeps/row_kernel.h"
#include "solvers/first_order/sweeps/scaled_problem.h"

/// Internal to solvers/.
namespace lcpbench {

/// Matrix-free rows on any number of bodies: S = D^-1/2 J M^-1/2, so that A = S S^T and one copy of S serves the
/// product and the update. Image: S^T f.
class FactorRows final : public RowKernel {
 public:
  /// @param scaled  not owned
  FactorRows(const LcpProblem& problem, const ScaledProblem& scaled);

  std::size_t ImageSize() const override { return columns_; }
  bool ImageIsRoot() const override { return true; }
  Index EntriesPerRow() const override;
  void StartImage(Array* image) const override;
  void AddToImage(Index begin, Index end, const Array& f, Array* image) const override;
  void AddRowToImage(Index row, double df, Array* image) const override;
  double W(Index row, const Array& f, const Array& image) const override;
  void Sweep(Index begin, Index end, bool backward, double omega, Array* f, Array* image,
             StepSums* sums) const override;
  void GradientStep(Index begin, Index end, double step, const Array& y, const Array& y_image, Array* next,
                    Array* next_image, StepSums* sums) const override;
  double ResidualSquares(Index begin, Index end, const Array& f, const Array& image) const override;

 private:
  const ScaledProblem& scaled_;
  CompressedRows rows_;
  std::size_t columns_;
};

}  // namespace lcpbench
