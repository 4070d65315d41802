#include "model/contact/world.h"

#include "model/contact/contact_row.h"
#include "model/contact/path.h"
#include "support/input_error.h"

namespace lcpbench {
World WorldOf(const ContactSystem& system) {
  World world;
  world.name = system.name;
  world.bodies = system.bodies;
  for (const Constraint& constraint : system.constraints) {
    if (constraint.type != ConstraintType::kContact) world.joints.push_back(constraint);
  }
  for (std::size_t i = 0; i < world.bodies.size(); ++i) {
    const Body& body = world.bodies[i];
    if (body.fixed || (body.force.x == 0 && body.force.y == 0 && body.torque == 0)) continue;
    world.loads.wrenches.push_back({{static_cast<int>(i), {}}, body.force, body.torque});
  }
  return world;
}

ContactSystem InstantOf(const World& world, std::vector<Constraint> contacts) {
  ContactSystem system{world.name, world.bodies, world.joints};
  std::erase_if(system.constraints, [&world](const Constraint& joint) {
    return joint.type == ConstraintType::kRope && HasNoDirection(joint, world.bodies);
  });
  SetLoads(world.loads, system.bodies);
  system.constraints.insert(system.constraints.end(), std::make_move_iterator(contacts.begin()),
                            std::make_move_iterator(contacts.end()));
  return system;
}

void RequireValid(const World& world) {
  const std::string where = "world '" + world.name + "'";
  const int count = static_cast<int>(world.bodies.size());
  RequireValid(world.bodies, where + ", ");
  for (std::size_t k = 0; k < world.joints.size(); ++k) {
    const Constraint& joint = world.joints[k];
    const std::string name = where + ", joint " + std::to_string(k);
    if (joint.type == ConstraintType::kContact) throw InputError(name + ": contacts are found, not listed");
    const bool known = joint.body1 >= 0 && joint.body1 < count && joint.body2 >= 0 && joint.body2 < count;
    if (!known || joint.body1 == joint.body2) throw InputError(name + ": expected the indices of two different bodies");
    if (const std::string why = WhyInvalidPath(joint); !why.empty()) throw InputError(name + ": " + why);
  }
  // The loads check themselves, with their own names.
  std::vector<Body> bodies = world.bodies;
  SetLoads(world.loads, bodies);
}

}  // namespace lcpbench
