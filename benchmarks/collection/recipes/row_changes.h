#pragma once

#include <cstdint>

#include "benchmarks/collection/recipes/instance.h"

namespace lcpbench {

// Changes of an assembled problem that leave it what it was but for one property. Shares are of the unilateral rows,
// rounded to whole rows, chosen at random by the seed; what is added stands after all given rows. With + - * / and sqrt
// only: the same bits on every machine. All throw InputError where `share` is not in [0, 1], or a number not as said.

/// Redundancy: rows of `share` once more, bit for bit, as where two features report one contact. Solvable if it was;
/// the rank of A stays, f is not unique any more, w is as it was.
void DuplicateRows(Instance* instance, double share, std::uint64_t seed);

/// Condition: `share` of the contacts get a neighbour at `distance` along the tangent, in units of the radius of
/// gyration of the body that turns more easily, as where a curve is given by polygons. J changes in the two spins, b by
/// the spins' acceleration without contacts. The smallest eigenvalue of A falls as distance^2.
/// @param distance  > 0
void CrowdContacts(Instance* instance, double share, double distance, std::uint64_t seed);

/// Share of active rows: `slack` sqrt(A_ii) s is added to b of every contact, s the root mean square of
/// A_ii^-1/2 b_i, as by gaps in a time step. Solvable if it was, for slack >= 0; below 0 for nonsingular A.
void AddSlack(Instance* instance, double slack);

/// Units: row i of J and b is multiplied by 2^k, k integer and uniform in [-binades, binades]. f_i is divided by it and
/// w_i multiplied, exactly: whatever is relative to A_ii stays.
/// @param binades  integer in [0, 100]
void ScaleRows(Instance* instance, double binades, std::uint64_t seed);

/// Opposed rows: `share` of the rows again with J and b negated. The two leave w_i = 0 as the only way, by forces of
/// either sign: bilateral rows in disguise. Always solvable for nonsingular A.
void OpposeRows(Instance* instance, double share, std::uint64_t seed);

/// Masses: SpreadMasses (mass_spread.h).
void ChangeMasses(Instance* instance, double ratio, std::uint64_t seed);

}  // namespace lcpbench
