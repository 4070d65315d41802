#pragma once

#include <array>
#include <span>
#include <string_view>

namespace lcpbench {

/// What one solver is given for its own stopping options, by requested tier.
///
/// The rule for tuned keys, the same effort for every library: the option that decides when the solver stops is set,
/// per tier, to the loosest value of a ladder by decades (the tier's own figure times 1, 1e-1, ... 1e-4) with which the
/// answers to at least 95 % of the tuning problems pass that tier; where no value reaches 95 %, to the one with the
/// most passes, and among equals to the loosest. Tuning problems are those that the solver takes of the 118 generated
/// ones of the peer contract test (n <= 60, every rank) and of 45 scenes (discs-in-v, disc-pile, disc-track,
/// boxes-and-discs, rockers; n = 10, 30 and 100; seeds 1 to 3), all solvable, with 2 s each. Limits of iterations are
/// so high that the time limit decides. Everything else stays as the library has it. Keys that end in "-default" have
/// no rows here, being the library's own options untouched, nor have solvers without a tolerance (pivoting codes, exact
/// arithmetic). docs/peers.md says how many problems passed.
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
