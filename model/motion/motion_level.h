#pragma once

namespace lcpbench {

/// The mechanics that a world moves by.
enum class MotionLevel {
  kAcceleration,  ///< forces from the contact LCP at every evaluation, events located, impacts simultaneous
  kVelocity,      ///< time stepping: one LCP of impulses a step, no events [Anitescu, Potra 1997]
};

}  // namespace lcpbench
