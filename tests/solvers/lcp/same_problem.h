#pragma once

#include <string>
#include <vector>

#include "solvers/io/same_bits.h"
#include "solvers/lcp/problem.h"

namespace lcpbench {

inline bool SameBits(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  return a.size() == b.size() && SameBits(a.data(), b.data(), a.size());
}

/// Not symmetric, with the ends of the range of doubles and zeros of both signs.
inline LcpProblem EndsOfTheRange(const std::vector<Index>& bilateral = {}) {
  const Eigen::MatrixXd A = (Eigen::MatrixXd(2, 2) << 1, -0.0, 5e-324, -1.7976931348623157e308).finished();
  return LcpProblem::FromDense("an id\nof two lines", A, Eigen::Vector2d(-0.0, 0.1),
                               RowBounds::WithBilateralRows(2, bilateral));
}

/// What differs between A, b and the kinds of rows; "" for nothing.
inline std::string DifferenceOfRows(const LcpProblem& a, const LcpProblem& b) {
  if (!SameBits(a.b(), b.b())) return "another b";
  if (a.bilateral_rows() != b.bilateral_rows()) return "other bilateral rows";
  if (a.friction_rows() != b.friction_rows()) return "other friction rows";
  if (a.bounded_rows() != b.bounded_rows()) return "other bounded rows";
  return SameBits(a.SparseA(), b.SparseA()) ? "" : "another A";
}

/// The same, and the factors where there are any.
inline std::string DifferenceOfProblems(const LcpProblem& a, const LcpProblem& b) {
  if (a.has_factors() != b.has_factors()) return "another form";
  if (a.has_factors() && !(SameBits(a.J(), b.J()) && SameBits(a.inverse_mass(), b.inverse_mass()))) {
    return "other factors";
  }
  return DifferenceOfRows(a, b);
}

}  // namespace lcpbench
