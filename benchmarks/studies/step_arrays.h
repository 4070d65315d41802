#pragma once

#include <cstdint>
#include <vector>

#include "solvers/lcp/problem.h"
#include "solvers/lcp/step_rows.h"

namespace lcpbench {

/// An engine's arrays, for tests and studies of what reads them.
struct StepArrays {
  int columns_per_body = 3;
  std::vector<std::int32_t> body;
  std::vector<double> J;
  std::vector<float> J_single;  ///< J, rounded by Round()
  std::vector<double> b;
  std::vector<unsigned char> bilateral;
  std::vector<double> inverse_mass;
  std::vector<FrictionRow> friction;
  std::vector<BoundedRow> bounded;

  /// Those of a problem with two-body rows.
  static StepArrays Of(const LcpProblem& problem);
  /// One row more, on bodies that may be the same or -1.
  /// @param numbers  2 p
  void Add(std::int32_t first, std::int32_t second, const std::vector<double>& numbers, double b_of_row,
           bool is_bilateral = false);
  /// The rows of others with their bodies, counted on from those that are there.
  void Append(const StepArrays& others);
  /// Gives J in single precision, too.
  void Round();

  Index rows() const { return static_cast<Index>(b.size()); }
  Index bodies() const { return static_cast<Index>(inverse_mass.size()) / columns_per_body; }
  /// A view of these arrays, which must outlive it.
  StepRows View(bool single = false) const;
  /// The same problem, by factors, with J in double or rounded.
  LcpProblem Problem(bool single = false) const;
};

}  // namespace lcpbench
