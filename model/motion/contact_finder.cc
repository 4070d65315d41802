#include "model/motion/contact_finder.h"

#include <algorithm>

#include "model/contact/contact_row.h"

namespace lcpbench {

ContactFinder::ContactFinder(const World& world) {
  for (const Body& body : world.bodies) outlines_.push_back(OutlineOf(body));
  for (const Constraint& joint : world.joints) joined_.push_back(std::minmax(joint.body1, joint.body2));
  std::sort(joined_.begin(), joined_.end());
}

std::vector<Constraint> ContactFinder::Find(std::span<const Body> bodies, double tolerance, double penetration) const {
  return DetectContacts(bodies, outlines_, {tolerance, penetration, joined_});
}

bool ContactFinder::AreJoined(int i, int j) const {
  return std::binary_search(joined_.begin(), joined_.end(), std::pair(i, j));
}

Extent ExtentOf(std::span<const NormalSpan> spans) {
  if (spans.empty()) return {};
  BoundingBox all = spans[0].Bounds();
  for (const NormalSpan& span : spans) all = Union(all, span.Bounds());
  const Vec2 far{std::max(-all.lower.x, all.upper.x), std::max(-all.lower.y, all.upper.y)};
  return {Norm(far), std::min(all.upper.x - all.lower.x, all.upper.y - all.lower.y)};
}

double LeastWidth(const World& world, std::span<const Extent> extents) {
  double least = 0;
  for (std::size_t i = 0; i < extents.size(); ++i) {
    const double width = extents[i].width;
    if (!world.bodies[i].fixed && width > 0 && (least == 0 || width < least)) least = width;
  }
  return least;
}

void FollowPathJoints(std::span<const Body> bodies, std::span<Constraint> constraints) {
  for (Constraint& joint : constraints) {
    if (joint.type != ConstraintType::kPathJoint) continue;
    const bool curve1 = IsSearched(joint.feature1);
    const bool curve2 = IsSearched(joint.feature2);
    if (!curve1 && !curve2) continue;
    const ClosestPoints closest = FindClosestPoints(joint, bodies, Regularity::kNonzeroD);
    if (curve1) joint.s1 = closest.s1;
    if (curve2) joint.s2 = closest.s2;
  }
}

}  // namespace lcpbench
