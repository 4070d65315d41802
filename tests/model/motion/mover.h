#pragma once

#include "model/contact/world.h"
#include "model/motion/make_motion.h"
#include "model/scenes/parts.h"
#include "model/shape/shapes.h"
#include "solvers/lcp/solver.h"
#include "tests/support/refusal.h"

namespace lcpbench {

// Worlds of a few bodies, and motion in them, for its tests.

inline constexpr double kG = 9.81;

Body Movable(const Outline& outline, Vec2 x, double theta = 0, Vec2 v = {}, double omega = 0);
Body Fixed(const Outline& outline, Vec2 x = {}, double theta = 0);

/// A line from right to left, so that the material is below it.
Body Floor(double half_width = 100);

/// A fixed body without an outline.
Body Anchor();

/// The inside of a circle.
Body Track(double radius);

/// Two points that a joint, rod or rope holds together.
Constraint Joint(ConstraintType type, int body1, Vec2 p1, int body2, Vec2 p2, double length = 0);

World WorldWith(std::string name, std::vector<Body> bodies, Vec2 gravity = {0, -kG});

double Energy(const World& world);

AccelerationOptions WithRestitution(double e);

inline constexpr MotionLevel kBothLevels[] = {MotionLevel::kAcceleration, MotionLevel::kVelocity};

/// A solver and a motion under it.
class Mover {
 public:
  Mover(MotionLevel level, const World& world, const MotionOptions& options = {}, std::string_view solver = "dantzig");
  explicit Mover(const World& world, const AccelerationOptions& options = {}, std::string_view solver = "dantzig");
  Mover(const World& world, const VelocityOptions& options, std::string_view solver = "dantzig");
  Motion* operator->() const { return motion_.get(); }
  const Body& body(std::size_t i) const { return motion_->world().bodies[i]; }
  /// Advances a motion that does not end by it.
  void KeepMoving(double seconds) const;

 private:
  std::unique_ptr<LcpSolver> solver_;
  std::unique_ptr<Motion> motion_;
};

/// Moves on for `seconds`, observing at frames; energy relative to `scale` must stay within 1e-6 and penetration within
/// the contact tolerance.
void ExpectConserved(Mover* mover, double scale, double seconds = 10);

/// Steps of a motion at the velocity level change the energy by T+ - T(v^) = -|v+ - v^|_M^2 / 2 + sum f_t w_t - f.c
/// less the work on driven bodies, and friction takes energy only.
/// @return how many of them had rows
int ExpectEnergyLaw(const Mover& driven, double step, int count);

}  // namespace lcpbench
