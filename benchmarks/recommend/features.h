#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <span>

#include "solvers/lcp/problem.h"

namespace lcpbench {

/// What can be said of a problem before it is solved, at the cost of forming A once; nothing where it is not known.
/// Which of it matters for the choice of a solver the reference results say (rules.h).
struct ProblemFeatures {
  std::optional<double> rows;
  std::optional<double> bilateral;        ///< share of the rows
  std::optional<double> couplings;        ///< stored entries of A per row
  std::optional<double> diagonal_spread;  ///< largest over smallest of the positive diagonal entries of A
  std::optional<double> islands;          ///< sets of rows without any coupling between them
  std::optional<double> largest_island;   ///< share of the rows
  /// Of the movable bodies that the rows touch: largest over smallest mass. Not known without the factors of A.
  std::optional<double> mass_spread;
  /// Share of the rows that depend on others for sure: in every island rows beyond the columns of J that can move and
  /// carry more than rounding. Not known without the factors of A, unless the problem says its rank.
  std::optional<double> redundancy;
};

/// O(entries of A), plus what forming A costs.
ProblemFeatures MeasureFeatures(const LcpProblem& problem);

/// A feature by its name, as the member is called.
struct NamedFeature {
  const char* name;
  std::optional<double> ProblemFeatures::*value;
};
std::span<const NamedFeature> AllFeatures();

/// A member per feature, null where it is not known.
nlohmann::ordered_json Describe(const ProblemFeatures& features);

}  // namespace lcpbench
