#include "model/motion/path_joints.h"

#include "model/contact/closest_points.h"
#include "model/geometry/trig.h"

namespace lcpbench {
void FollowPathJoints(std::span<const Body> bodies, std::span<Constraint> constraints) {
  for (Constraint& joint : constraints) {
    if (joint.type != ConstraintType::kPathJoint) continue;
    const bool curve1 = IsSearched(joint.feature1);
    const bool curve2 = IsSearched(joint.feature2);
    if (!curve1 && !curve2) continue;
    const Body& body1 = bodies[static_cast<std::size_t>(joint.body1)];
    const Body& body2 = bodies[static_cast<std::size_t>(joint.body2)];
    const ClosestPoints closest = FindClosestPoints({joint.feature1, body1.x, SinCos(body1.theta), body1.theta},
                                                    {joint.feature2, body2.x, SinCos(body2.theta), body2.theta},
                                                    {joint.s1, joint.s2, joint.nominal_gap}, Regularity::kNonzeroD);
    if (curve1) joint.s1 = closest.s1;
    if (curve2) joint.s2 = closest.s2;
  }
}

}  // namespace lcpbench
