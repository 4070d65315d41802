#pragma once

#include <span>
#include <utility>
#include <vector>

#include "model/contact/system.h"
#include "model/detection/outline_region.h"

namespace lcpbench {

/// A place where the material of two bodies overlaps.
struct BodyOverlap {
  int body1 = 0;
  int body2 = 0;
  int edge1 = 0;  ///< of Body::outline, from 0
  int edge2 = 0;
  double depth = 0;  ///< [m]
};

/// How deep bodies overlap: of the points that two bodies have in common, the greatest distance from either's outline.
/// Where one's outline dips into the other, that is the depth -d of the contact there; but it is asked of the outlines
/// alone, by samples of both, and so is known for every overlap, also of coincident bodies and of one within another,
/// where no contact may be found.
class OverlapFinder {
 public:
  /// @param outlines  in the bodies' frames, as DetectContacts; edges count through their loops
  /// @param fineness  overlaps deeper than this are found by samples [m], > 0; shallower ones at their contacts
  OverlapFinder(std::span<const Outline> outlines, double fineness);

  /// The deepest overlap of every pair of bodies that has one of more than `limit` [m], or of more than a quarter of
  /// the thinner one's mean thickness: nothing lies deeper in a thin body than half of that. What crosses an open chain
  /// overlaps it; what lies wholly beyond one does not, for nothing says on which side of it a body belongs.
  /// @param contacts  those known at the bodies' positions, d < 0 ones among them; shallow overlaps are sought there
  /// @param excluded  pairs (body1 < body2), sorted, that do not touch each other
  /// O(n log n) and O(samples log chords) for pairs whose boxes overlap by more than the limit.
  std::vector<BodyOverlap> Find(std::span<const Body> bodies, std::span<const Constraint> contacts,
                                std::span<const std::pair<int, int>> excluded, double limit) const;

  /// How deep a contact's points, p1 of body1 and p2 of body2, lie in the other body [m]: `most` = -d > 0, or less
  /// where another part of the outline is nearer, as beside a corner that is behind the face around the next one.
  double DepthAt(std::span<const Body> bodies, int body1, Vec2 p1, int body2, Vec2 p2, double most) const;

 private:
  std::vector<OutlineRegion> regions_;  // by body
  double fineness_;
};

}  // namespace lcpbench
