#pragma once

#include <array>
#include <span>
#include <string_view>

namespace lcpbench {

/// What one solver is given for its own stopping options, by requested tier.
///
/// The rule for tuned keys is the same effort for every library; docs/peers.md states it, and how many problems passed.
/// Limits of iterations are so high that the time limit decides. Keys that end in "-default" have no rows here, being
/// the library's own options untouched, nor have solvers without a tolerance (pivoting codes, exact arithmetic).
struct TierSettings {
  std::string_view key;
  std::array<double, 3> tolerances;  ///< for the tiers 1e-3, 1e-6, 1e-9
  double most_iterations;            ///< or sweeps; 0: the library's own limit
  std::string_view measure;          ///< what the tolerance bounds
};

std::span<const TierSettings> TierTable();

/// The tolerance for the loosest tier that is not looser than `tolerance`; that of 1e-9 for stricter ones.
/// @throws std::logic_error where the table has no such key, here and below
double TierTolerance(std::string_view key, double tolerance);
double TierIterations(std::string_view key);

}  // namespace lcpbench
