#pragma once

#include <vector>

#include "solvers/first_order/sweeps/compressed_rows.h"
#include "solvers/first_order/sweeps/row_kernel.h"
#include "solvers/first_order/sweeps/scaled_problem.h"

/// Internal to solvers/.
namespace lcpbench {

/// The rows of D^-1/2 A D^-1/2 without the diagonal, which is 1 (or 0). 12 bytes and one multiply-add per entry.
class AssembledRows final : public RowKernel {
 public:
  /// @param scaled  not owned
  AssembledRows(const LcpProblem& problem, const ScaledProblem& scaled);

  std::size_t ImageSize() const override { return static_cast<std::size_t>(scaled_.size); }
  bool ImageIsRoot() const override { return false; }
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
  Array diagonal_;
};

}  // namespace lcpbench
