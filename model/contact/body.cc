#include "model/contact/body.h"

#include <cmath>

#include "support/input_error.h"

namespace lcpbench {
namespace {

// Why a body cannot be assembled; null where it can.
const char* WhyInvalid(const Body& body) {
  if (!(IsFinite(body.x) && std::isfinite(body.theta))) return "the position is not finite";
  if (!(IsFinite(body.v) && std::isfinite(body.omega))) return "the velocity is not finite";
  if (!(body.friction >= 0 && body.friction <= kMostFriction)) return "its friction must lie within 0..1e6";
  if (!(body.fixed ? std::isfinite(body.surface_speed) : body.surface_speed == 0)) {
    return "its surface speed must be finite, and 0 where it is movable";
  }
  if (body.fixed) {
    const bool finite = IsFinite(body.acceleration) && std::isfinite(body.alpha);
    return finite ? nullptr : "the prescribed acceleration is not finite";
  }
  if (!(IsFinite(body.force) && std::isfinite(body.torque))) return "the applied force or torque is not finite";
  const auto valid = [](double value) { return value > 0 && std::isfinite(value) && std::isfinite(1 / value); };
  if (!valid(body.mass)) return "the mass of a movable body must be finite and > 0";
  if (!valid(body.inertia)) return "the inertia of a movable body must be finite and > 0";
  return nullptr;
}

}  // namespace

std::string BodyText(std::span<const Body> bodies, std::size_t i) {
  const std::string& name = bodies[i].name;
  return "body " + std::to_string(i) + (name.empty() ? "" : " '" + name + "'");
}

void RequireValid(std::span<const Body> bodies, const std::string& where) {
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (const char* reason = WhyInvalid(bodies[i])) throw InputError(where + BodyText(bodies, i) + ": " + reason);
  }
}

}  // namespace lcpbench
