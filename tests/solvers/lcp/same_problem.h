#pragma once

#include <string>

#include "solvers/io/same_bits.h"
#include "solvers/lcp/problem.h"

namespace lcpbench {

inline bool SameBits(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  return a.size() == b.size() && SameBits(a.data(), b.data(), a.size());
}

/// What differs between A, b and the kinds of rows; "" for nothing.
inline std::string DifferenceOfRows(const LcpProblem& a, const LcpProblem& b) {
  if (!SameBits(a.b(), b.b())) return "another b";
  if (a.bilateral_rows() != b.bilateral_rows()) return "other bilateral rows";
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
