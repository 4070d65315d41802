#include "model/scenes/friction/friction_scene.h"

namespace lcpbench {

void FrictionScene::Push(int body, Vec2 point, Vec2 force) {
  Body& pushed = Get(body);
  pushed.force = pushed.force + force;
  pushed.torque += Cross(point - pushed.x, force);
}

ContactSystem FrictionScene::Finish(double mu, double slope, double gravity) {
  const Rotation turn = SinCos(-slope);
  for (Body& body : system_.bodies) {
    body.friction = mu;
    body.x = Rotate(turn, body.x);
    body.theta -= slope;
    body.v = Rotate(turn, body.v);
    if (!body.fixed) body.force = Rotate(turn, body.force) + Vec2{0, -body.mass * gravity};
  }
  for (Constraint& constraint : system_.constraints) {
    if (constraint.type == ConstraintType::kContact) constraint.friction = mu;
  }
  return std::move(system_);
}

}  // namespace lcpbench
