#pragma once

#include <span>
#include <utility>
#include <vector>

#include "model/contact/system.h"
#include "model/detection/narrow_phase.h"
#include "model/shape/outline.h"

namespace lcpbench {

/// What counts as a contact.
struct DetectionOptions {
  /// Largest gap that is a contact [m], > 0; what bodies' positions are known to, small against their size. In units of
  /// the system's lengths: there is no default that fits all.
  double tolerance = 0;
  /// Deepest penetration that is a contact [m], >= 0. Deeper overlaps are left out: they are errors of the positions.
  double penetration = 0;
  /// Pairs (body1 < body2), sorted, that have no contacts with each other, such as bodies that a joint holds together.
  std::span<const std::pair<int, int>> excluded = {};
  /// Called for every body and every pair that is near, and within long outlines; not owned.
  const StopCheck* check = nullptr;
};

/// The contacts of bodies with outlines: every local minimum of the gap between two bodies' outlines within
/// -penetration <= d <= tolerance, as kContact constraints with the features of the two edges (or edge and vertex), and
/// start values s1, s2 on general curves. Pairs of fixed bodies have no contacts, and excluded pairs none. Of convex
/// corners the vertices are features; vertex against vertex is not reported [docs/model.md section 2]. At joins of
/// edges a contact is reported for one of the two, of flush straight edges one at both ends of their overlap
/// (docs/geometry.md). O(n log n) for bodies of similar size; contacts come in lexicographic order of (body1 < body2,
/// features along the outlines).
/// @param outlines  outlines[i] is that of bodies[i], in its body frame (origin at the centre of mass); no loops for
/// none.
///                  Pieces valid as RequireValidPiece demands, which is checked; loops may be open chains
/// @throws InputError for invalid options or pieces, and for a curvature match, naming the bodies and both features
std::vector<Constraint> DetectContacts(std::span<const Body> bodies, std::span<const Outline> outlines,
                                       const DetectionOptions& options);

/// The outline that Body::outline draws, its edges chained into loops where each begins at the end of the one before.
Outline OutlineOf(const Body& body);

}  // namespace lcpbench
