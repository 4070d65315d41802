#pragma once

#include <algorithm>
#include <memory>

#include "model/motion/impact.h"
#include "model/motion/motion.h"

namespace lcpbench {

/// Lengths and speeds are in the world's units; the defaults suit bodies of 0.01 to 10 m.
struct AccelerationOptions {
  /// eps_d: gaps up to this are contacts [m], > 0. What is nearer than this touches, and takes part in impacts.
  double contact_tolerance = 1e-6;
  /// eps_v: contacts with |d'| up to this rest or slide [m/s], > 0; faster ones approach (an impact is due once d <= 0)
  /// or separate.
  double velocity_tolerance = 1e-6;
  /// impact.velocity_tolerance is not read: it is the one above.
  ImpactOptions impact;
  /// Error of a step in any position or velocity: at most absolute_error + relative_error |value|, both > 0.
  double absolute_error = 1e-11;
  double relative_error = 1e-11;
  /// Steps are at most this long [s], > 0.
  double largest_step = 0.05;
  /// Errors do not make steps shorter than this [s], > 0; events do.
  double shortest_step = 1e-4;
  /// Bodies that are nearer than this are watched [m]; 0 for a quarter of the thinnest movable body's bounding box.
  double search_range = 0;
  /// Positions and velocities are corrected where contacts and joints violate more than these fractions of
  /// contact_tolerance and velocity_tolerance, in (0, 1].
  double position_threshold = 0.1;
  double velocity_threshold = 1e-3;
  /// Tolerance and limits of every solve; initial_f is not read. Solves within a step start from the forces at its
  /// beginning.
  LcpOptions lcp;
  /// More events and steps than this within one shortest_step end the motion as kStalled.
  int max_events = 10'000;
};

/// The deepest overlap that a motion takes [m]: it is projected out before the motion begins. Contacts found this deep
/// are contacts still; what is deeper, and was not followed there from outside, is an error of the positions.
/// @param width  the least of a movable body [m]
inline double TreatedDepth(const AccelerationOptions& options, double width) {
  constexpr double kTolerances = 10;
  constexpr double kThinnestPart = 0.25;
  return std::min(kTolerances * options.contact_tolerance, kThinnestPart * width);
}

/// Motion at the acceleration level: between events, Fehlberg 7(8) steps on accelerations from the contact LCP at every
/// evaluation; events located; impacts simultaneous. [docs/model.md sections 8, 9]
///
/// A step ends early at the first event: the approach of a gap outside the held set to 0 (less 1e-4 eps_d), the release
/// of a held contact whose f falls to 0, or the passage of a contact's foot, or of a point on a path, from its edge to
/// the next. An impact is due when a touching row (d <= 0) approaches faster than eps_v. docs/motion.md: how events
/// are found and drift is corrected, and why nothing tunnels.
///
/// Bodies that overlap by more than TreatedDepth, other than by a contact that was followed from outside, end the
/// motion as kOverlap. Less is projected out at the start.
///
/// A solver that fails is asked for its best point, with which the motion goes on; forces that are not finite end it as
/// kSolverFailed. Observers are called where there is an LCP: not for steps without any row.
/// + - * / sqrt and correctly rounded functions only, so with a solver of that kind the same bits on every machine.
/// @param solver  must outlive the motion
/// @throws InputError for an invalid world, options outside their ranges, or bodies that overlap by more than
///         TreatedDepth, naming them
std::unique_ptr<Motion> MakeAccelerationMotion(World world, const AccelerationOptions& options, LcpSolver& solver);

}  // namespace lcpbench
