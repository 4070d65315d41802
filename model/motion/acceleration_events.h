#pragma once

#include <array>
#include <functional>
#include <optional>
#include <vector>

#include "model/motion/acceleration_contacts.h"
#include "model/motion/acceleration_flow.h"

namespace lcpbench {

/// A step between its ends: positions by the polynomial of degree 5 with the positions, velocities and accelerations of
/// both ends (error of order 6 in the step), velocities by its derivative. For first estimates of events.
class StepInterpolant {
 public:
  /// @param bodies  tell which are movable
  /// @param begin_accelerations, end_accelerations  three a body
  StepInterpolant(const std::vector<Body>& bodies, double step, const MotionState& begin,
                  const std::vector<double>& begin_accelerations, const MotionState& end,
                  const std::vector<double>& end_accelerations);

  double step() const { return step_; }
  /// @param time  0 to step [s]
  MotionState At(double time) const;

 private:
  // q(u) = sum of c_k u^k, u = time / step.
  using Quintic = std::array<double, 6>;
  double step_;
  std::vector<Quintic> coordinates_;  // three a movable body
};

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

/// Tolerances of StepEvents; AccelerationMotion sets them.
struct EventOptions {
  double contact_tolerance = 0;  ///< [m]
  double velocity_tolerance = 0;
  double range = 0;          ///< gaps and overlaps that are looked for [m]
  double event_depth = 0;    ///< how far below 0 a gap is when its impact is due [m], > 0
  double shortest_step = 0;  ///< below this no step is given up for what cannot be resolved [s]
};

/// The end of a step, perhaps at an event.
struct StepEnd {
  double step = 0;  ///< [s]
  MotionState state;
  std::vector<Constraint> found;     ///< contacts and ropes within the range at the end
  std::vector<Constraint> touching;  ///< those whose approach ended the step
  bool at_event = false;
};

/// Finds the first event of a step. See AccelerationMotion for what events are.
class StepEvents {
 public:
  /// All must outlive this; `flow` holds the contacts of `begin`.
  StepEvents(const EventOptions& options, const ContactWatch& watch, const StepBegin& begin, ConstrainedFlow* flow);

  /// Looks at a whole step to `state` and cuts it at the first event.
  /// @return nothing if the step should be tried again with half its length
  /// @throws InputError, NoFinitePoint as ConstrainedFlow
  std::optional<StepEnd> Cut(double step, MotionState state);

 private:
  // Positive before an event, negative or zero after.
  using Value = std::function<double(double step, const MotionState& state)>;
  struct Event {
    Value value;
    double begin = 0;  // of the time in which the event can be [s], and the value there
    double begin_value = 0;
    bool smooth = false;
    std::optional<Constraint> approaching;
    bool is_at_end = true;  // found there, not only at the beginning
  };

  std::vector<Body> BodiesAt(double step, const MotionState& state) const;
  MotionState StateAfter(double step) const;
  void AddPassages(const StepEnd& end, std::vector<Event>* events) const;
  // False if a contact outside its set was held: the step is too long.
  bool AddReleases(const StepEnd& end, std::vector<Event>* events) const;
  // Cuts the end where a gap closed and opened again.
  bool AddApproaches(StepEnd* end, std::vector<Event>* events);
  double Level(double begin_gap) const;
  // What was or is near: found at the end, and found at the beginning only (its features then may have met first).
  std::vector<Constraint> Candidates(const StepEnd& end, const std::vector<Body>& bodies) const;
  // The approach of features that are closest to each other from some time on, with the gap that they have then.
  // Nothing if that is an overlap: it was there before, or a corner came into sight between two edges.
  std::optional<Event> ApproachOf(const Constraint& constraint, const StepEnd& end, bool is_at_end);
  const StepInterpolant& Between(const StepEnd& end);
  // When the contact's points come onto the outlines for good; 0 if they are there at the beginning.
  double InSightFrom(const Constraint& constraint, const StepEnd& end);
  // The time on the interpolant at which the event has just happened.
  double Estimate(const Event& event, const StepInterpolant& between, double latest) const;
  void Narrow(const Event& event, const StepInterpolant& between, StepEnd* end) const;
  bool IsThere(const Constraint& constraint, const StepEnd& end) const;

  EventOptions options_;
  const ContactWatch& watch_;
  const StepBegin& begin_;
  ConstrainedFlow* flow_;
  std::optional<StepInterpolant> between_;
};

}  // namespace lcpbench
