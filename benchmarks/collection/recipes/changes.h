#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "model/contact/assembly.h"
#include "model/contact/system.h"
#include "solvers/lcp/problem.h"

namespace lcpbench {

/// A problem on its way from a scene to the collection: the bodies, and rows that have a geometry each. Rows that were
/// added by a change stand last and have that of the row they were made from.
struct Instance {
  ContactSystem system;
  std::vector<RowInfo> rows;
  LcpProblem problem;
};

/// @throws InputError as AssembleContactLcp
Instance InstanceOf(ContactSystem system);

/// The same problem, given by factors, under another name.
LcpProblem WithId(const LcpProblem& given, std::string id);

/// ratio^u for ratio > 0 and u in [0, 1], by the leading 53 binary digits of u and repeated square roots: IEEE + * and
/// sqrt only, and so the same bits on every machine, which std::pow does not promise. Relative error below 1e-14.
double PortablePower(double ratio, double u);

// ----- how edges are curved at the contacts of a system

// Changes of how edges are curved at the contacts of a system. Every edge is scaled about its own contact point: point,
// normal, gap, J and A stay (but for rounding), and b changes by the velocity-product terms alone.

/// Radii of curvature of the convex edges at contacts are multiplied by contrast^-u, u uniform in [0, 1]: convex edges
/// get smaller, so that they still fit where they lie in concave ones.
/// @param contrast  >= 1
/// @throws InputError for another contrast, and as AssembleContactLcp
void ContrastCurvature(ContactSystem* system, double contrast, std::uint64_t seed);

/// Every convex arc that lies in a concave one gets the radius (1 - clearance) R of that one: the contact is nearly
/// conformal, and gamma grows as 1 / clearance.
/// @param clearance  in (0, 1)
/// @throws InputError for another clearance, where no such pair is there, and as AssembleContactLcp
void MakeConformal(ContactSystem* system, double clearance);

// ----- one property of an assembled problem

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

/// The same contacts between bodies of very different masses: mass and inertia of every body that can move are
/// multiplied by ratio^u, u uniform in [0, 1] and stretched so that the least factor is 1 and the largest is `ratio`
/// where two bodies can move.
///
/// b stays: b = J M^-1 F + gamma holds for the new masses under loads that grow with them, as gravity does. J and b
/// stay, so a solvable problem stays solvable (J^T y = 0 and b.y are the same), and deterministic by seed.
/// @param given  by factors, columns of J in blocks of three per body
/// @param ratio  >= 1
/// @throws InputError for ratio < 1 or not finite
LcpProblem SpreadMasses(const LcpProblem& given, double ratio, std::uint64_t seed);

/// Another right-hand side for the same matrix, as the next step of a driver with constant geometry has it:
///     b' = b - A d,   d_i = 0.1 |D^-1/2 b|_inf D_ii^-1/2 u_i,   D = diag A,
/// u_i uniform in [0, 1) on unilateral rows and in [-1, 1) on bilateral ones, 0 where A_ii = 0. Where f is feasible for
/// b, f + d is for b', so that the problem stays solvable (but for roundings where rows depend on each other).
/// Deterministic by seed.  O(entries of the given form)
Eigen::VectorXd AnotherB(const LcpProblem& problem, std::uint64_t seed);

}  // namespace lcpbench
