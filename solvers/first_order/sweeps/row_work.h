#pragma once

#include <memory>
#include <string>

#include "solvers/first_order/sweeps/first_order_options.h"
#include "solvers/first_order/sweeps/row_kernel.h"

/// Internal to solvers/.
namespace lcpbench {

/// What every first-order solver works on: the scaled problem, its rows in one layout, and the iterate.
struct RowWork {
  ScaledProblem scaled;
  std::unique_ptr<RowKernel> rows;
  Point x;

  /// All but b.
  /// @param coloured  order the rows by ColouredOrder
  void Prepare(const LcpProblem& problem, RowForm form, bool coloured);
  /// A solve of `problem`, which shares its matrix with the prepared one: f as ScaledProblem::Start, without its image.
  void Start(const LcpProblem& problem, const Eigen::VectorXd* initial_f);
};

/// "" if the rows can be laid out in this form, else the reason in words.
std::string WhyNoRows(const LcpProblem& problem, RowForm form);

}  // namespace lcpbench
