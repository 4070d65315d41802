#pragma once

#include <memory>

#include "model/motion/impact.h"
#include "model/motion/motion.h"

namespace lcpbench {

/// Lengths and speeds are in the world's units; the defaults suit bodies of 0.01 to 10 m.
struct AccelerationOptions {
  /// Its velocity_tolerance is eps_v: slower contacts rest or slide; faster ones approach (an impact is due once d <=
  /// 0) or separate.
  ImpactOptions impact;
  /// Tolerance and limits of every solve; initial_f is not read. Solves within a step start from the forces at its
  /// beginning.
  LcpOptions lcp;
  /// More events and steps than this within 1e-4 s end the motion as kStalled; so do more than 100 meetings of the same
  /// two bodies there, once they have taken a second of processor time.
  int max_events = 10'000;
};

/// Motion at the acceleration level: between events, Fehlberg 7(8) steps on accelerations from the contact LCP at every
/// evaluation; events located; impacts simultaneous. [docs/model.md sections 8, 9]
///
/// A step ends early at the first event: the approach of a gap outside the held set to 0 (less 1e-4 kContactTolerance),
/// the release of a held contact whose f falls to 0 or of a pin whose torque reaches its limit, a pin that comes to its
/// motor's speed, or the passage of a contact's foot, or of a point on a path, from its edge to the next. An impact is
/// due when a touching row (d <= 0) approaches faster than eps_v. docs/motion.md: how events are found and drift is
/// corrected, and why nothing tunnels.
///
/// Bodies that overlap by more than TreatedDepth, other than by a contact that was followed from outside, end the
/// motion as kOverlap. Less is projected out at the start.
///
/// A solver that fails is asked for its best point, with which the motion goes on; forces that are not finite end it as
/// kSolverFailed. Observers are called where there is an LCP: not for steps without any row.
/// + - * / sqrt and correctly rounded functions only, so with a solver of that kind the same bits on every machine.
/// @param solver  must outlive the motion
/// @throws InputError for an invalid world or one whose contacts have friction, options outside their ranges, or bodies
///         that overlap by more than TreatedDepth, naming them
std::unique_ptr<Motion> MakeAccelerationMotion(World world, const AccelerationOptions& options, LcpSolver& solver);

}  // namespace lcpbench
