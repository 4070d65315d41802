#pragma once

#include <limits>
#include <optional>
#include <vector>

#include "model/motion/acceleration_contacts.h"
#include "model/motion/acceleration_events.h"
#include "model/motion/acceleration_flow.h"
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
  /// Errors do not make steps shorter than this [s], > 0: the forces of a solver that is not exact are rough, and rough
  /// equations would be followed in ever smaller steps. Events do.
  double shortest_step = 1e-4;
  /// Bodies that are nearer than this are watched [m]; 0 for a quarter of the thinnest movable body's bounding box. No
  /// surface moves by more than half of it towards another in one step.
  double search_range = 0;
  /// Positions are corrected where contacts and joints violate more than this fraction of contact_tolerance, in (0, 1].
  /// A correction x changes the energy by f x: it should be rare.
  double position_threshold = 0.1;
  /// Velocities are corrected beyond this fraction of velocity_tolerance, in (0, 1]. A correction u changes the energy
  /// by m u^2 / 2, which is nothing, and stops drift where it begins.
  double velocity_threshold = 1e-3;
  /// Requested of the solver, as LcpOptions::tolerance.
  double lcp_tolerance = 1e-9;
  /// Wall clock of one solve [s], > 0: LcpOptions::time_limit_s.
  double lcp_time_limit_s = std::numeric_limits<double>::infinity();
  /// Solves within a step start from the forces at its beginning.
  bool warm_start = true;
  /// More events than this within one shortest_step end the motion as kStalled.
  int max_events = 10'000;
};

/// @throws InputError naming the option and its range
void RequireValid(const AccelerationOptions& options);

/// Motion at the acceleration level: between events, Fehlberg 7(8) steps on accelerations from the contact LCP at every
/// evaluation; events located; impacts simultaneous. [MODEL.md sections 8, 9]
///
/// A step. Contacts are found from outlines (d <= eps_d); those with |d'| <= eps_v make the LCP that observers see.
/// Rows with w > 0 leave, and the rest is held for one step, its closest points searched anew at every evaluation, so
/// that the equations are smooth within it. It ends early at the first of these events:
///   approach   a gap outside the held set falls to 0 (less 1e-4 eps_d)
///   release    a held contact's f falls to 0
///   passage    a held contact's foot leaves its edge (so a new step begins on the next one, with its curvature)
/// Each is a sign change over the step, found on an interpolant of degree 5 (TOMS 748 [Alefeld, Potra, Shi 1995],
/// bisection for passages) and then met by steps from the same beginning, safeguarded Newton for approaches. A gap
/// between features that come into sight behind a join is followed from that moment.
///
/// No tunnelling: a step is so short that no two bodies approach by more than half of search_range, or the distance
/// between the circles around them where that is longer (by their speeds, spins and present accelerations). Gaps and
/// overlaps within search_range are looked for at its end; an overlap counts if its gap was open at the beginning, and
/// a gap that closed and opened again is looked into. What can go unseen is a corner that clips another corner by less
/// than half of search_range and is out again.
///
/// Impacts: when a touching row (d <= 0) approaches faster than eps_v, repeated until none does.
///
/// Drift: where an accepted step leaves violations above position_threshold or velocity_threshold, positions or
/// velocities are moved onto the constraints by the smallest change in the kinetic metric (projection.h, impact.h),
/// with the same solver; not part of b. Contacts that carry a force and separate, by errors, are pulled back likewise.
///
/// A solver that fails is asked for its best point, with which the motion goes on; forces that are not finite end it as
/// kSolverFailed. Observers are called where there is an LCP: not for steps without any row.
/// + - * / sqrt and correctly rounded functions only, so with a solver of that kind the same bits on every machine.
class AccelerationMotion final : public Motion {
 public:
  /// @param solver  must outlive this
  /// @throws InputError for an invalid world or options
  AccelerationMotion(World world, const AccelerationOptions& options, LcpSolver& solver);

 private:
  void Move(double duration) override;
  void Step(double end);
  // The contacts of the present positions: known ones that are still there, and those found.
  void UpdateContacts(const std::vector<Constraint>& known, const std::vector<Constraint>& found);
  // The joints of the present positions.
  void FollowJoints();
  ContactSystem SystemOf(const std::vector<Constraint>& contacts) const;
  // Everything that happens in an instant: corrections and impacts.
  void Settle();
  void CorrectPositions();
  void CorrectVelocities();
  // Stops contacts that separate although they carry a force; true if there was one.
  bool HoldTogether(const AnsweredLcp& answered, const std::vector<Constraint>& lasting);
  bool ResolveDueImpact();
  void CountEvent(const char* what);
  std::vector<Constraint> LastingContacts() const;
  // The held set of the next step: without rows that open; the LCP before is observed.
  StepBegin Begin();
  double LongestStep(const StepBegin& begin, double end) const;
  ImpulseSolver Impulses(bool observed);

  AccelerationOptions options_;
  double range_;
  ContactWatch watch_;
  ConstrainedFlow flow_;
  std::vector<Constraint> bilateral_;
  std::vector<Constraint> contacts_;  // d <= eps_d, at the present positions
  std::vector<Constraint> watched_;   // within the range there
  Eigen::VectorXd last_f_;
  double next_step_;
  int events_ = 0;  // since events_begin_
  double events_begin_ = 0;
};

}  // namespace lcpbench
