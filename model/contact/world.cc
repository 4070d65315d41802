#include "model/contact/world.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <span>
#include <utility>

#include "model/contact/contact_row.h"
#include "model/contact/path.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

// mu of two bodies, by their surfaces.
double MuOf(std::span<const Body> bodies, int body1, int body2) {
  return std::sqrt(bodies[static_cast<std::size_t>(body1)].friction * bodies[static_cast<std::size_t>(body2)].friction);
}

using PairFrictions = std::map<std::pair<int, int>, double>;

}  // namespace

World WorldOf(const ContactSystem& system) {
  World world;
  world.name = system.name;
  world.bodies = system.bodies;
  PairFrictions pairs;
  for (const Constraint& constraint : system.constraints) {
    if (constraint.type != ConstraintType::kContact) {
      world.joints.push_back(constraint);
    } else if (constraint.friction != MuOf(system.bodies, constraint.body1, constraint.body2)) {
      pairs[std::minmax(constraint.body1, constraint.body2)] = constraint.friction;
    }
  }
  for (const auto& [pair, mu] : pairs) world.friction.push_back({pair.first, pair.second, mu});
  for (std::size_t i = 0; i < world.bodies.size(); ++i) {
    const Body& body = world.bodies[i];
    if (body.fixed || (body.force.x == 0 && body.force.y == 0 && body.torque == 0)) continue;
    world.loads.wrenches.push_back({{static_cast<int>(i), {}}, body.force, body.torque});
  }
  return world;
}

bool HasFriction(const World& world) {
  return std::ranges::any_of(world.bodies, [](const Body& body) { return body.friction != 0; }) ||
         std::ranges::any_of(world.friction, [](const PairFriction& pair) { return pair.mu != 0; });
}

ContactSystem InstantOf(const World& world, std::vector<Constraint> contacts) {
  ContactSystem system{world.name, world.bodies, world.joints};
  std::erase_if(system.constraints, [&world](const Constraint& joint) {
    return joint.type == ConstraintType::kRope && HasNoDirection(joint, world.bodies);
  });
  SetLoads(world.loads, system.bodies);
  PairFrictions pairs;
  for (const PairFriction& pair : world.friction) pairs[std::minmax(pair.body1, pair.body2)] = pair.mu;
  for (Constraint& contact : contacts) {
    const auto found = pairs.find(std::minmax(contact.body1, contact.body2));
    contact.friction = found != pairs.end() ? found->second : MuOf(world.bodies, contact.body1, contact.body2);
  }
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
    const bool turns = joint.torque_limit != 0 || joint.speed != 0;
    if (turns && joint.type != ConstraintType::kPin) throw InputError(name + ": only a pin has a torque limit");
    if (!(joint.torque_limit >= 0 && std::isfinite(joint.torque_limit) && std::isfinite(joint.speed))) {
      throw InputError(name + ": expected a torque limit >= 0 and a speed, both finite");
    }
    if (const std::string why = WhyInvalidPath(joint); !why.empty()) throw InputError(name + ": " + why);
  }
  PairFrictions pairs;
  for (const PairFriction& pair : world.friction) {
    const bool known = pair.body1 >= 0 && pair.body1 < count && pair.body2 >= 0 && pair.body2 < count;
    const std::string name =
        where + ", friction of bodies " + std::to_string(pair.body1) + " and " + std::to_string(pair.body2);
    if (!known || pair.body1 == pair.body2) throw InputError(name + ": expected the indices of two different bodies");
    if (!(pair.mu >= 0 && pair.mu <= kMostFriction)) throw InputError(name + ": expected a number in 0..1e6");
    if (!pairs.emplace(std::minmax(pair.body1, pair.body2), pair.mu).second) throw InputError(name + ": given twice");
  }
  // The loads check themselves, with their own names.
  std::vector<Body> bodies = world.bodies;
  SetLoads(world.loads, bodies);
}

}  // namespace lcpbench
