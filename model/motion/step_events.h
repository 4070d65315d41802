#pragma once

#include <optional>
#include <vector>

#include "model/motion/constrained_flow.h"
#include "model/motion/contact_watch.h"

namespace lcpbench {

/// Errors do not make steps shorter than this [s]; events do.
inline constexpr double kShortestStep = 1e-4;

/// Pins with a torque limit that turn this near to their motor's speed hold it, while the torque suffices [rad/s].
inline constexpr double kHeldTurning = 1e-6;

/// Where a step starts: the instant, the held contacts (a part of the flow's held set, after its bilateral rows) and
/// their LCP.
struct StepBegin {
  double time = 0;  ///< [s]
  MotionState state;
  std::vector<Body> bodies;
  std::vector<Constraint> held;
  std::vector<Constraint> watched;  ///< contacts and ropes within the range, held or not
  AnsweredLcp answered;             ///< rows in the order of the flow's held set
  std::vector<double> accelerations;
};

/// The end of a step, perhaps at an event.
struct StepEnd {
  double step = 0;  ///< [s]
  MotionState state;
  std::vector<Constraint> found;     ///< contacts and ropes within the range at the end
  std::vector<Constraint> touching;  ///< those whose approach ended the step
  bool at_event = false;
  std::optional<Constraint> met;  ///< what the event is of; none for ends of paths
};

/// Ends a step at its first event: an approach, a release (of a pin's torque: that its limit is reached), a pin that
/// comes to the speed of its motor, a passage to another edge or to another piece of a path.
/// docs/motion.md says how events are found.
/// @param velocity_tolerance  slower contacts rest or slide [m/s]
/// @param step, state  of the whole step, `state` as the flow's Step gives it
/// @return nothing where the step is too long to tell what happened first
/// @throws as ConstrainedFlow::Solve
std::optional<StepEnd> CutAtFirstEvent(double velocity_tolerance, const ContactWatch& watch, const StepBegin& begin,
                                       double step, MotionState state, ConstrainedFlow* flow);

}  // namespace lcpbench
