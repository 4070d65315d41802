#include "model/motion/acceleration_motion.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "model/contact/loads.h"
#include "model/motion/contact_finder.h"
#include "model/motion/projection.h"
#include "support/input_error.h"
#include "support/number_text.h"

namespace lcpbench {
namespace {

/// An impact is due this fraction of the contact tolerance below gap 0, so that it lies between two signs.
constexpr double kEventDepth = 1e-4;
/// Contacts that are found this many contact tolerances deep are contacts still; deeper overlaps that were not followed
/// from outside are errors of the start positions, or corners seen from the side.
constexpr double kDeepest = 10;
/// The part of the search range that surfaces may approach by in one step.
constexpr double kStride = 0.5;
constexpr double kThinnestPart = 0.25;
/// w above this fraction of the largest |b| is a contact that opens, beyond a solver's tolerance.
constexpr double kOpens = 1e-8;
/// Corrections go this far below the threshold that calls for them.
constexpr double kCorrectionGoal = 0.01;
constexpr double kShortestTrial = 1e-14;

AccelerationOptions Valid(AccelerationOptions options) {
  options.impact.velocity_tolerance = options.velocity_tolerance;
  RequireValid(options);
  return options;
}

LcpOptions LcpOptionsOf(const AccelerationOptions& options) {
  LcpOptions lcp;
  lcp.tolerance = options.lcp_tolerance;
  lcp.time_limit_s = options.lcp_time_limit_s;
  return lcp;
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
double ScaledError(const AccelerationOptions& options, const MotionState& state, const MotionState& error) {
  double worst = 0;
  for (std::size_t k = 0; k < state.size(); ++k) {
    const double scaled = std::abs(error[k]) / (options.absolute_error + options.relative_error * std::abs(state[k]));
    if (!std::isfinite(scaled) || !std::isfinite(state[k])) return std::numeric_limits<double>::infinity();
    worst = std::max(worst, scaled);
  }
  return worst;
}

double RangeOf(const AccelerationOptions& options, const World& world) {
  if (options.search_range > 0) return options.search_range;
  const double thinnest = ContactWatch(world, 0).ThinnestBody();
  // Without outlines there is nothing to find, but a rope.
  return thinnest > 0 ? std::max(kThinnestPart * thinnest, kDeepest * options.contact_tolerance) : 1;
}

}  // namespace

void RequireValid(const AccelerationOptions& options) {
  const std::pair<double, const char*> positive[] = {
      {options.contact_tolerance, "contact tolerance"}, {options.velocity_tolerance, "velocity tolerance"},
      {options.absolute_error, "absolute error"},       {options.relative_error, "relative error"},
      {options.largest_step, "largest step"},           {options.shortest_step, "shortest step"}};
  for (const auto& [value, name] : positive) {
    if (std::isfinite(value) && value > 0) continue;
    throw InputError(std::string("acceleration motion: the ") + name + " must be finite and > 0, found " +
                     NumberText(value));
  }
  const bool range = options.search_range == 0 || options.search_range > options.contact_tolerance;
  if (!range || !std::isfinite(options.search_range)) {
    throw InputError("acceleration motion: the search range must be 0 or above the contact tolerance");
  }
  const auto is_fraction = [](double value) { return value > 0 && value <= 1; };
  if (!is_fraction(options.position_threshold) || !is_fraction(options.velocity_threshold)) {
    throw InputError("acceleration motion: the thresholds of corrections must be in (0, 1]");
  }
  if (options.max_events < 1) throw InputError("acceleration motion: the limit of events must be at least 1");
  RequireValid(options.impact);
}

AccelerationMotion::AccelerationMotion(World world, const AccelerationOptions& options, LcpSolver& solver)
    : Motion(std::move(world), LcpOptionsOf(options), solver),
      options_(Valid(options)),
      range_(RangeOf(options, world_)),
      watch_(world_, options.contact_tolerance / range_),
      flow_(world_, &solver_),
      next_step_(options.largest_step) {
  FollowJoints();
  UpdateContacts({}, watch_.Find(world_.bodies, range_));
}

void AccelerationMotion::Move(double duration) {
  const double end = time_ + duration;
  while (status_ == MotionStatus::kMoving && time_ < end) Step(end);
}

void AccelerationMotion::FollowJoints() {
  FollowPathJoints(world_.bodies, world_.joints);
  bilateral_.clear();
  for (const Constraint& joint : world_.joints) {
    if (joint.type != ConstraintType::kRope) bilateral_.push_back(joint);
  }
}

void AccelerationMotion::UpdateContacts(const std::vector<Constraint>& known, const std::vector<Constraint>& found) {
  std::vector<Constraint> contacts;
  std::vector<TouchPoint> points;
  const auto add = [&](Constraint constraint, double deepest, bool must_lie_on) {
    try {
      const TouchPoint touch = ContactWatch::Evaluate(world_.bodies, &constraint);
      if (!(touch.d <= options_.contact_tolerance && touch.d >= -deepest)) return;
      if (must_lie_on && !watch_.LiesOn(world_.bodies, constraint, touch)) return;
      for (std::size_t k = 0; k < contacts.size(); ++k) {
        if (IsSameContact(constraint, touch, contacts[k], points[k])) return;
      }
      contacts.push_back(constraint);
      points.push_back(touch);
    } catch (const InputError&) {
      // A contact that was followed to where its edges do not meet any more is gone; what is there was found.
      if (!must_lie_on) throw;
    }
  };
  for (const Constraint& constraint : known) add(constraint, range_, true);
  for (const Constraint& constraint : found) {
    if (std::abs(constraint.nominal_gap) > kDeepest * options_.contact_tolerance &&
        constraint.type == ConstraintType::kContact) {
      continue;
    }
    add(constraint, kDeepest * options_.contact_tolerance, false);
  }
  contacts_ = std::move(contacts);
  watched_ = contacts_;
  watched_.insert(watched_.end(), found.begin(), found.end());
}

ContactSystem AccelerationMotion::SystemOf(const std::vector<Constraint>& contacts) const {
  ContactSystem system{world_.name, world_.bodies, bilateral_};
  system.constraints.insert(system.constraints.end(), contacts.begin(), contacts.end());
  SetLoads(world_.loads, system.bodies);
  return system;
}

ImpulseSolver AccelerationMotion::Impulses(bool observed) {
  return [this, observed](const ContactSystem& system, const std::vector<RowInfo>& rows, const LcpProblem& problem,
                          LcpResult* result) {
    solver_.Solve(problem, nullptr, result);
    RequireFinite(problem, *result);
    if (observed) Observe(MotionProblemKind::kImpact, system, rows, problem, *result);
  };
}

std::vector<Constraint> AccelerationMotion::LastingContacts() const {
  std::vector<Constraint> lasting;
  for (Constraint contact : contacts_) {
    const TouchPoint touch = ContactWatch::Evaluate(world_.bodies, &contact);
    if (std::abs(touch.d_dot) <= options_.velocity_tolerance) lasting.push_back(contact);
  }
  return lasting;
}

void AccelerationMotion::CorrectPositions() {
  const double threshold = options_.position_threshold * options_.contact_tolerance;
  ContactSystem system = SystemOf(contacts_);
  const AssembledLcp lcp = AssembleContactLcp(system);
  NoteGaps(lcp.rows);
  if (WorstViolation(lcp.rows) <= threshold) return;
  const auto solve = [this](const LcpProblem& problem, LcpResult* result) {
    solver_.Solve(problem, nullptr, result);
    RequireFinite(problem, *result);
  };
  ProjectPositions(kCorrectionGoal * threshold, solve, &system);
  for (std::size_t i = 0; i < world_.bodies.size(); ++i) {
    world_.bodies[i].x = system.bodies[i].x;
    world_.bodies[i].theta = system.bodies[i].theta;
  }
  FollowJoints();
  UpdateContacts(contacts_, watch_.Find(world_.bodies, range_));
}

void AccelerationMotion::CorrectVelocities() {
  const double threshold = options_.velocity_threshold * options_.velocity_tolerance;
  ContactSystem system = SystemOf(LastingContacts());
  if (system.constraints.empty() || WorstViolation(AssembleContactLcp(system).rows, &RowInfo::d_dot) <= threshold) {
    return;
  }
  StopApproach(options_.impact, Impulses(false), &system);
  CopyVelocities(system.bodies, world_.bodies);
}

bool AccelerationMotion::HoldTogether(const AnsweredLcp& answered, const std::vector<Constraint>& lasting) {
  const double threshold = options_.velocity_threshold * options_.velocity_tolerance;
  const std::vector<RowInfo>& rows = answered.lcp.rows;
  std::vector<Constraint> loaded;
  bool separates = false;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows[i].bilateral || answered.result.f[static_cast<Index>(i)] <= 0) continue;
    loaded.push_back(lasting[static_cast<std::size_t>(rows[i].constraint) - bilateral_.size()]);
    separates = separates || rows[i].d_dot > threshold;
  }
  if (!separates) return false;
  ContactSystem system = SystemOf(loaded);
  StopSeparation(options_.impact, Impulses(false), &system);
  CopyVelocities(system.bodies, world_.bodies);
  return true;
}

bool AccelerationMotion::ResolveDueImpact() {
  bool due = false;
  for (Constraint contact : contacts_) {
    const TouchPoint touch = ContactWatch::Evaluate(world_.bodies, &contact);
    due = due || (touch.d <= 0 && touch.d_dot < -options_.velocity_tolerance);
  }
  if (!due) return false;
  ++statistics_.impacts;
  ContactSystem system = SystemOf(contacts_);
  ResolveImpact(options_.impact, Impulses(true), &system);
  CopyVelocities(system.bodies, world_.bodies);
  return true;
}

void AccelerationMotion::CountEvent(const char* what) {
  if (time_ - events_begin_ > options_.shortest_step) {
    events_ = 0;
    events_begin_ = time_;
  }
  if (++events_ <= options_.max_events) return;
  status_ = MotionStatus::kStalled;
  detail_ = "more than " + std::to_string(options_.max_events) + " events within " +
            NumberText(options_.shortest_step) + " s at t = " + NumberText(time_) + " s, the last of them " + what;
}

void AccelerationMotion::Settle() {
  CorrectPositions();
  while (status_ == MotionStatus::kMoving && ResolveDueImpact()) CountEvent("an impact");
  CorrectVelocities();
}

StepBegin AccelerationMotion::Begin() {
  std::vector<Constraint> lasting = LastingContacts();
  std::vector<Constraint> rows = bilateral_;
  rows.insert(rows.end(), lasting.begin(), lasting.end());
  flow_.Hold(rows, options_.warm_start ? last_f_ : Eigen::VectorXd());
  MotionState state = ConstrainedFlow::StateOf(world_.bodies);
  AnsweredLcp answered = flow_.Solve(state, time_);
  if (HoldTogether(answered, lasting)) {
    state = ConstrainedFlow::StateOf(world_.bodies);
    answered = flow_.Solve(state, time_);
  }
  StepBegin begin{time_, std::move(state), world_.bodies, {}, watched_, std::move(answered), {}};
  const LcpProblem problem = begin.answered.lcp.problem;
  if (problem.size() > 0) {
    Observe(MotionProblemKind::kAcceleration, flow_.system(), begin.answered.lcp.rows, problem, begin.answered.result);
  }
  begin.accelerations = ConstrainedFlow::Accelerations(flow_.system(), begin.answered);

  const Eigen::VectorXd f = begin.answered.result.f;
  Eigen::VectorXd w;
  if (f.size() > 0) problem.ComputeW(f, &w);
  const double opens = f.size() > 0 ? kOpens * problem.b().lpNorm<Eigen::Infinity>() : 0;
  std::vector<Constraint> held;
  for (const RowInfo& row : begin.answered.lcp.rows) {
    const auto i = static_cast<Index>(&row - begin.answered.lcp.rows.data());
    if (row.bilateral || (f[i] <= 0 && w[i] > opens)) continue;
    held.push_back(lasting[static_cast<std::size_t>(row.constraint) - bilateral_.size()]);
  }
  if (held.size() < lasting.size()) {
    rows.resize(bilateral_.size());
    rows.insert(rows.end(), held.begin(), held.end());
    flow_.Hold(rows, Eigen::VectorXd());
    begin.answered = flow_.Solve(begin.state, time_);
  }
  last_f_ = begin.answered.result.f;
  if (options_.warm_start) flow_.Hold(std::move(rows), last_f_);
  begin.held = std::move(held);
  return begin;
}

double AccelerationMotion::LongestStep(const StepBegin& begin, double end) const {
  const double step = std::min({next_step_, options_.largest_step, end - time_});
  return watch_.LongestStep(begin.bodies, begin.accelerations, kStride * range_, step);
}

void AccelerationMotion::Step(double end) {
  Settle();
  if (status_ != MotionStatus::kMoving) return;
  const StepBegin begin = Begin();
  StepEvents events({options_.contact_tolerance, options_.velocity_tolerance, range_,
                     kEventDepth * options_.contact_tolerance, options_.shortest_step},
                    watch_, begin, &flow_);
  double step = LongestStep(begin, end);
  const bool short_of_error = step < next_step_;
  bool rejected = false;
  std::optional<StepEnd> reached;
  double suggested = next_step_;
  while (!reached) {
    try {
      MotionState state;
      MotionState error;
      flow_.Step(begin.state, time_, step, &state, &error);
      const double scaled = ScaledError(options_, state, error);
      const double factor = StepFactor(scaled);
      if (scaled > 1 && step > options_.shortest_step) {
        step = std::max(step * factor, options_.shortest_step);
        rejected = true;
        continue;
      }
      if (!std::isfinite(scaled)) throw InputError("acceleration motion: the bodies' positions are not finite");
      // A step that was cut short by its surroundings says little about how long the next one may be.
      const bool unknown = short_of_error && !rejected && factor >= 1;
      suggested = unknown ? std::max(next_step_, factor * step) : factor * step;
      reached = events.Cut(step, std::move(state));
      if (!reached) step /= 2;
    } catch (const InputError&) {
      // Geometry can be singular at a step's trial points: only what stays so for short steps is the motion's own.
      if (step < kShortestTrial) throw;
      step /= 2;
    }
  }
  next_step_ = std::clamp(suggested, options_.shortest_step, options_.largest_step);
  const bool whole = !reached->at_event && reached->step == end - begin.time;
  time_ = whole ? end : begin.time + reached->step;
  flow_.Place(reached->state, time_, &world_.bodies);
  ++statistics_.steps;
  FollowJoints();
  std::vector<Constraint> known = contacts_;
  known.insert(known.end(), reached->touching.begin(), reached->touching.end());
  UpdateContacts(known, reached->found);
  if (reached->at_event) CountEvent("a contact that opens, closes or passes on to another edge");
}

}  // namespace lcpbench
