#include "model/motion/contact_finder.h"

#include <algorithm>

namespace lcpbench {

ContactFinder::ContactFinder(const World& world) {
  outlines_.reserve(world.bodies.size());
  for (const Body& body : world.bodies) outlines_.push_back(OutlineOf(body));
  pointers_.reserve(outlines_.size());
  for (const Outline& outline : outlines_) pointers_.push_back(outline.loops.empty() ? nullptr : &outline);
  for (const Constraint& joint : world.joints) joined_.push_back(std::minmax(joint.body1, joint.body2));
  std::sort(joined_.begin(), joined_.end());
}

std::vector<Constraint> ContactFinder::Find(std::span<const Body> bodies, double tolerance, double penetration) const {
  return DetectContacts(bodies, pointers_, {tolerance, penetration, joined_});
}

}  // namespace lcpbench
