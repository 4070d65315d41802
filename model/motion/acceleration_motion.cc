#include "model/motion/acceleration_motion.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "model/contact/contact_row.h"
#include "model/contact/loads.h"
#include "model/motion/step_events.h"
#include "support/input_error.h"
#include "support/number_text.h"
#include "support/process_watch.h"

namespace lcpbench {
namespace {

/// The part of the search range that surfaces may approach by in one step.
constexpr double kStride = 0.5;
/// w above this fraction of the largest |b| is a contact that opens, beyond a solver's tolerance.
constexpr double kOpens = 1e-8;
/// Steps are at most this long [s].
constexpr double kLargestStep = 0.05;
/// Error of a step in any position or velocity: at most kStepError (1 + |value|).
constexpr double kStepError = 1e-11;
/// Positions and velocities are corrected where contacts and joints violate more than these fractions of
/// kContactTolerance and of eps_v.
constexpr double kPositionThreshold = 0.1;
constexpr double kVelocityThreshold = 1e-3;
/// Corrections go this far below the threshold that calls for them.
constexpr double kCorrectionGoal = 0.01;
constexpr double kShortestTrial = 1e-14;
/// Where the same two bodies have met or parted more often than this within kShortestStep ...
constexpr int kManyMeetings = 100;
/// ... a motion stalls after this processor time [s].
constexpr double kLongestStall = 1;

// @throws InputError naming the option and its range
const AccelerationOptions& Valid(const AccelerationOptions& options) {
  if (options.max_events < 1) throw InputError("acceleration motion: the limit of events must be at least 1");
  RequireValid(options.impact);
  return options;
}

World WithoutFriction(World world) {
  if (HasFriction(world)) {
    throw InputError("scene '" + world.name + "' has friction, which motions at the velocity level take only");
  }
  return world;
}

// The next step's length over this one's, for a local error of order 8: error^(-1/8), by correctly rounded roots.
double StepFactor(double error) {
  constexpr double kSafety = 0.9;
  constexpr double kLeast = 0.2;
  constexpr double kMost = 4;
  const double root = std::sqrt(std::sqrt(std::sqrt(error)));
  return std::clamp(root > 0 ? kSafety / root : kMost, kLeast, kMost);
}

// The largest error in units of what is allowed; not finite where the step is not.
double ScaledError(const MotionState& state, const MotionState& error) {
  double worst = 0;
  for (std::size_t k = 0; k < state.size(); ++k) {
    const double scaled = std::abs(error[k]) / (kStepError + kStepError * std::abs(state[k]));
    if (!std::isfinite(scaled) || !std::isfinite(state[k])) return std::numeric_limits<double>::infinity();
    worst = std::max(worst, scaled);
  }
  return worst;
}

class AccelerationMotion final : public Motion {
 public:
  AccelerationMotion(World world, const AccelerationOptions& options, LcpSolver& solver)
      : Motion(WithoutFriction(std::move(world)), options.lcp, solver),
        options_(Valid(options)),
        watch_(world_, finder_),
        flow_(world_, &solver_),
        next_step_(kLargestStep) {
    if (finder_.least_width() > 0) treated_ = TreatedDepth(MotionLevel::kAcceleration, finder_.least_width());
    finder_.RequireShallow(world_, ToString(MotionLevel::kAcceleration), treated_);
    FollowJoints();
    UpdateContacts({}, watch_.Find(world_.bodies));
    try {
      CorrectPositions();
    } catch (const NoFinitePoint&) {
      // The first step meets it again, and ends the motion.
    }
  }

 private:
  void Move(double duration) override {
    if (!CanAdvance(duration, kLargestStep)) return;
    // What was done in between is not the motion's, and the thread may be another.
    recent_.begin_processor = ThreadTime();
    const double end = time_ + duration;
    while (status_ == MotionStatus::kMoving && time_ < end) Step(end);
  }

  // The joints of the present positions.
  void FollowJoints() {
    FollowPathJoints(world_.bodies, world_.joints);
    bilateral_.clear();
    for (const Constraint& joint : world_.joints) {
      if (joint.type != ConstraintType::kRope) bilateral_.push_back(joint);
    }
  }

  // The contacts of the present positions: known ones that are still there, and those found.
  void UpdateContacts(const std::vector<Constraint>& known, const std::vector<Constraint>& found) {
    std::vector<TouchingConstraint> contacts;
    const auto add = [&](Constraint constraint, double deepest, bool must_lie_on) {
      try {
        const TouchPoint touch = ContactWatch::Evaluate(world_.bodies, &constraint);
        if (!(touch.d <= kContactTolerance && touch.d >= -deepest)) return;
        if (constraint.type == ConstraintType::kRope && HasNoDirection(constraint, world_.bodies)) return;
        if (must_lie_on && !watch_.LiesOn(world_.bodies, constraint, touch)) return;
        if (!IsKnown({constraint, touch}, contacts)) contacts.push_back({constraint, touch});
      } catch (const InputError&) {
        // A contact that was followed to where its edges do not meet any more is gone; what is there was found.
        if (!must_lie_on) throw;
      }
    };
    for (const Constraint& constraint : known) add(constraint, watch_.range(), true);
    for (const Constraint& constraint : found) {
      if (std::abs(constraint.nominal_gap) > treated_ && constraint.type == ConstraintType::kContact) {
        continue;
      }
      add(constraint, treated_, false);
    }
    contacts_.clear();
    for (const TouchingConstraint& contact : contacts) contacts_.push_back(contact.constraint);
    EndAtUnfollowed(found, contacts);
    watched_ = contacts_;
    watched_.insert(watched_.end(), found.begin(), found.end());
  }

  // Ends the motion where bodies overlap at a contact that is not followed, deeper than at those that are.
  void EndAtUnfollowed(const std::vector<Constraint>& found, const std::vector<TouchingConstraint>& followed) {
    for (Constraint constraint : found) {
      if (constraint.type != ConstraintType::kContact || constraint.nominal_gap >= -treated_) continue;
      double known = treated_;
      for (const auto& [contact, touch] : followed) {
        const bool same_bodies = contact.body1 == constraint.body1 && contact.body2 == constraint.body2;
        if (same_bodies) known = std::max(known, -touch.d);
      }
      // The depths of one overlap differ by rounding.
      constexpr double kRounding = 1e-3;
      const TouchPoint touch = ContactWatch::Evaluate(world_.bodies, &constraint);
      const Vec2 p1 = world_.bodies[static_cast<std::size_t>(constraint.body1)].x + touch.R1;
      const Vec2 p2 = world_.bodies[static_cast<std::size_t>(constraint.body2)].x + touch.R2;
      const double depth = finder_.DepthAt(world_.bodies, constraint, p1, p2, touch.d);
      if (depth <= (1 + kRounding) * known) continue;
      for (const BodyOverlap& overlap : finder_.FindOverlaps(world_.bodies, {&constraint, 1}, known)) {
        if (overlap.body1 == constraint.body1 && overlap.body2 == constraint.body2) return End(overlap);
      }
    }
  }

  std::vector<Constraint> WithJoints(const std::vector<Constraint>& contacts) const {
    std::vector<Constraint> constraints = bilateral_;
    constraints.insert(constraints.end(), contacts.begin(), contacts.end());
    return constraints;
  }
  // The contact that a row of a system WithJoints stands for.
  const Constraint& ContactOf(const RowInfo& row, const std::vector<Constraint>& contacts) const {
    return contacts[static_cast<std::size_t>(row.constraint) - bilateral_.size()];
  }

  ContactSystem SystemOf(const std::vector<Constraint>& contacts) const {
    ContactSystem system{world_.name, world_.bodies, WithJoints(contacts)};
    SetLoads(world_.loads, system.bodies);
    return system;
  }

  std::vector<Constraint> LastingContacts() const {
    std::vector<Constraint> lasting;
    for (Constraint contact : contacts_) {
      const TouchPoint touch = ContactWatch::Evaluate(world_.bodies, &contact);
      if (std::abs(touch.d_dot) <= options_.impact.velocity_tolerance) lasting.push_back(contact);
    }
    return lasting;
  }

  void CorrectPositions() {
    const double threshold = kPositionThreshold * kContactTolerance;
    ContactSystem system = SystemOf(contacts_);
    const AssembledLcp lcp = AssembleContactLcp(system);
    NoteGaps(system, lcp.rows);
    if (WorstViolation(lcp.rows) <= threshold) return;
    ProjectPositions(kCorrectionGoal * threshold, Impulses(false), &system);
    for (std::size_t i = 0; i < world_.bodies.size(); ++i) {
      world_.bodies[i].x = system.bodies[i].x;
      world_.bodies[i].theta = system.bodies[i].theta;
    }
    FollowJoints();
    UpdateContacts(contacts_, watch_.Find(world_.bodies));
  }

  void CorrectVelocities() {
    const double threshold = kVelocityThreshold * options_.impact.velocity_tolerance;
    ContactSystem system = SystemOf(LastingContacts());
    if (system.constraints.empty() || WorstViolation(AssembleContactLcp(system).rows, &RowInfo::d_dot) <= threshold) {
      return;
    }
    StopApproach(options_.impact, Impulses(false), &system);
    CopyVelocities(system.bodies, world_.bodies);
  }

  // Contacts that separate although they carry a force: stops them, or, where that would press others together, drops
  // all that separate from `lasting`. True if there was one.
  bool HoldTogether(const AnsweredLcp& answered, std::vector<Constraint>* lasting) {
    const double threshold = kVelocityThreshold * options_.impact.velocity_tolerance;
    const std::vector<RowInfo>& rows = answered.lcp.rows;
    std::vector<Constraint> loaded;
    std::vector<Constraint> meeting;
    bool separates = false;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      if (rows[i].bilateral || !rows[i].has_gap()) continue;
      if (rows[i].d_dot <= threshold) meeting.push_back(ContactOf(rows[i], *lasting));
      if (answered.result.f[static_cast<Index>(i)] <= 0) continue;
      loaded.push_back(ContactOf(rows[i], *lasting));
      separates = separates || rows[i].d_dot > threshold;
    }
    if (!separates) return false;
    ContactSystem system = SystemOf(loaded);
    StopSeparation(options_.impact, Impulses(false), &system);
    ContactSystem others = SystemOf(meeting);
    CopyVelocities(system.bodies, others.bodies);
    if (WorstViolation(AssembleContactLcp(others).rows, &RowInfo::d_dot) > threshold) {
      *lasting = std::move(meeting);
      flow_.Hold(WithJoints(*lasting), Eigen::VectorXd());
    } else {
      CopyVelocities(system.bodies, world_.bodies);
    }
    return true;
  }

  bool ResolveDueImpact() {
    bool due = false;
    for (Constraint contact : contacts_) {
      const TouchPoint touch = ContactWatch::Evaluate(world_.bodies, &contact);
      due = due || (touch.d <= 0 && touch.d_dot < -options_.impact.velocity_tolerance);
    }
    if (!due) return false;
    ++statistics_.impacts;
    ContactSystem system = SystemOf(contacts_);
    ResolveImpact(options_.impact, Impulses(true), &system);
    CopyVelocities(system.bodies, world_.bodies);
    return true;
  }

  void CountEvent(const char* what, const std::optional<Constraint>& met = {}) {
    if (time_ - recent_.begin > kShortestStep) recent_ = {time_, ThreadTime(), 0, {}, {}};
    ++recent_.events;
    bool lingers = false;
    if (met) {
      recent_.met = met;
      const int meetings = ++recent_.meetings[{met->body1, met->body2}];
      lingers = meetings > kManyMeetings && ThreadTime() - recent_.begin_processor > kLongestStall;
    }
    if (recent_.events <= options_.max_events && !lingers) return;
    std::string text = "more than " + std::to_string(recent_.events - 1) + " events or steps within " +
                       NumberText(kShortestStep) + " s" +
                       (lingers ? " and " + NumberText(kLongestStall) + " s of processor time" : "") +
                       " at t = " + NumberText(time_) + " s, the last of them " + what;
    if (recent_.met) {
      const Constraint& last = *recent_.met;
      text += "; the last to meet or part: " + EdgeText(last.body1, last.feature1) + " and " +
              EdgeText(last.body2, last.feature2);
    }
    Stall(text);
  }

  std::string EdgeText(int index, const Feature& feature) const {
    const Body& body = world_.bodies[static_cast<std::size_t>(index)];
    const auto edge = std::find_if(body.outline.begin(), body.outline.end(),
                                   [&](const OutlineEdge& piece) { return ToFeature(piece.edge) == feature; });
    return "'" + body.name + "' (" +
           (edge == body.outline.end() ? Describe(feature) : "edge " + std::to_string(edge - body.outline.begin())) +
           ")";
  }

  // Everything that happens in an instant: corrections and impacts.
  void Settle() {
    CorrectPositions();
    while (status_ == MotionStatus::kMoving && ResolveDueImpact()) CountEvent("an impact");
    CorrectVelocities();
  }

  // Pins that do not turn at the speed of their motors: their torque is known.
  void NoteSlips() {
    for (Constraint& joint : bilateral_) {
      const double slip = TurningSlip(joint, world_.bodies);
      const bool holds = joint.torque_limit == 0 || std::abs(slip) <= kHeldTurning;
      joint.slip = static_cast<signed char>(holds ? 0 : slip > 0 ? 1 : -1);
    }
  }

  // The held set of the next step: without rows that open; the LCP before is observed.
  StepBegin Begin() {
    std::vector<Constraint> lasting = LastingContacts();
    NoteSlips();
    flow_.Hold(WithJoints(lasting), last_f_);
    MotionState state = ConstrainedFlow::StateOf(world_.bodies);
    AnsweredLcp answered = flow_.Solve(state, time_);
    if (HoldTogether(answered, &lasting)) {
      state = ConstrainedFlow::StateOf(world_.bodies);
      answered = flow_.Solve(state, time_);
    }
    StepBegin begin{time_, std::move(state), world_.bodies, {}, watched_, std::move(answered), {}};
    const LcpProblem problem = begin.answered.lcp.problem;
    if (problem.size() > 0) {
      Observe(MotionProblemKind::kAcceleration, flow_.system(), begin.answered.lcp.rows, problem,
              begin.answered.result);
    }
    begin.accelerations = flow_.Accelerations(begin.answered);

    const Eigen::VectorXd f = begin.answered.result.f;
    Eigen::VectorXd w;
    if (f.size() > 0) problem.ComputeW(f, &w);
    const double opens = f.size() > 0 ? kOpens * problem.b().lpNorm<Eigen::Infinity>() : 0;
    std::vector<Constraint> held;
    for (const RowInfo& row : begin.answered.lcp.rows) {
      const auto i = static_cast<Index>(&row - begin.answered.lcp.rows.data());
      if (row.axis == 'r') {
        Constraint& joint = bilateral_[static_cast<std::size_t>(row.constraint)];
        const bool yields = std::abs(f[i]) >= joint.torque_limit && std::abs(w[i]) > opens;
        if (joint.slip == 0 && yields) joint.slip = w[i] > 0 ? 1 : -1;
        continue;
      }
      if (row.bilateral || (f[i] <= 0 && w[i] > opens)) continue;
      held.push_back(ContactOf(row, lasting));
    }
    if (held.size() < lasting.size()) {
      flow_.Hold(WithJoints(held), Eigen::VectorXd());
      begin.answered = flow_.Solve(begin.state, time_);
    }
    last_f_ = begin.answered.result.f;
    flow_.Hold(WithJoints(held), last_f_);
    begin.held = std::move(held);
    return begin;
  }

  void Step(double end) {
    Settle();
    if (status_ != MotionStatus::kMoving) return;
    const StepBegin begin = Begin();
    double step = watch_.LongestStep(begin.bodies, begin.accelerations, kStride * watch_.range(),
                                     std::min({next_step_, kLargestStep, end - time_}));
    const bool short_of_error = step < next_step_;
    bool rejected = false;
    std::optional<StepEnd> reached;
    double suggested = next_step_;
    while (!reached) {
      try {
        MotionState state;
        MotionState error;
        flow_.Step(begin.state, time_, step, &state, &error);
        const double scaled = ScaledError(state, error);
        const double factor = StepFactor(scaled);
        if (scaled > 1 && step > kShortestStep) {
          step = std::max(step * factor, kShortestStep);
          rejected = true;
          continue;
        }
        if (!std::isfinite(scaled)) throw InputError("acceleration motion: the bodies' positions are not finite");
        // A step that was cut short by its surroundings says little about how long the next one may be.
        const bool unknown = short_of_error && !rejected && factor >= 1;
        suggested = unknown ? std::max(next_step_, factor * step) : factor * step;
        reached = CutAtFirstEvent(options_.impact.velocity_tolerance, watch_, begin, step, std::move(state), &flow_);
        if (!reached) step /= 2;
      } catch (const InputError&) {
        // Geometry can be singular at a step's trial points: only what stays so for short steps is the motion's own.
        if (step < kShortestTrial) throw;
        step /= 2;
      }
    }
    next_step_ = std::clamp(suggested, kShortestStep, kLargestStep);
    const bool whole = !reached->at_event && reached->step == end - begin.time;
    time_ = whole ? end : begin.time + reached->step;
    flow_.Place(reached->state, time_, &world_.bodies);
    ++statistics_.steps;
    FollowJoints();
    std::vector<Constraint> known = contacts_;
    known.insert(known.end(), reached->touching.begin(), reached->touching.end());
    UpdateContacts(known, reached->found);
    CountEvent(reached->at_event ? "a contact that opens, closes or passes on to another edge"
                                 : "a step that speeds or errors shorten",
               reached->met);
    if (!reached->at_event) RequireAdvance(begin.bodies, reached->step, kContactTolerance);
    EndIfUntreatable(reached->step, std::max(watch_.range(), treated_));
  }

  AccelerationOptions options_;
  ContactWatch watch_;
  ConstrainedFlow flow_;
  double treated_ = 0;  // the depth of overlaps that are contacts [m]
  std::vector<Constraint> bilateral_;
  std::vector<Constraint> contacts_;  // d <= eps_d, at the present positions
  std::vector<Constraint> watched_;   // within the range there
  Eigen::VectorXd last_f_;
  double next_step_;
  // What happened within kShortestStep.
  struct Recent {
    double begin = 0;            // [s]
    double begin_processor = 0;  // processor time then [s]
    int events = 0;
    std::map<std::pair<int, int>, int> meetings;  // events of contacts, by bodies
    std::optional<Constraint> met;                // the last of them
  };
  Recent recent_;
};

}  // namespace

std::unique_ptr<Motion> MakeAccelerationMotion(World world, const AccelerationOptions& options, LcpSolver& solver) {
  return std::make_unique<AccelerationMotion>(std::move(world), options, solver);
}

}  // namespace lcpbench
