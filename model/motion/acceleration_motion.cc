#include "model/motion/acceleration_motion.h"

#include <algorithm>
#include <array>
#include <boost/math/tools/toms748_solve.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_fehlberg78.hpp>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "model/contact/assembly.h"
#include "model/contact/body.h"
#include "model/contact/contact_row.h"
#include "model/contact/loads.h"
#include "model/contact/path.h"
#include "model/contact/system.h"
#include "model/contact/world.h"
#include "model/detection/detection.h"
#include "model/detection/normal_span.h"
#include "model/motion/contact_finder.h"
#include "model/motion/motion.h"
#include "solvers/lcp/problem.h"
#include "solvers/lcp/solver.h"
#include "support/input_error.h"
#include "support/number_text.h"

// In order: ContactWatch (gaps between moving features), ConstrainedFlow (the equations between events),
// StepInterpolant and StepEvents (where a step ends), AccelerationMotion.

namespace lcpbench {
namespace {

// Where the two features of a unilateral constraint are closest, and how fast that changes. World frame.
struct TouchPoint {
  Vec2 n;   // unit normal from body 2 to body 1
  Vec2 R1;  // arms from the centres of mass to the closest points [m]
  Vec2 R2;
  double d = 0;      // gap [m]; of a rope, length - distance
  double d_dot = 0;  // [m/s]
};

// The search range: a part of the thinnest movable body, or at least so many contact tolerances.
constexpr double kThinnestPart = 0.25;
constexpr double kLeastTolerances = 10;
constexpr double kSamePlace = 1e-7;
constexpr double kApart = 1e-3;

// Whether two constraints stand for one contact: the same features of the same bodies, or closest points and normals
// that agree within kSamePlace (an edge and its neighbour at a smooth join). Curves can have several contacts with the
// same features, kApart of the arms from each other at least.
bool IsSameContact(const Constraint& a, const TouchPoint& at_a, const Constraint& b, const TouchPoint& at_b) {
  if (a.body1 != b.body1 || a.body2 != b.body2 || a.type != b.type) return false;
  const double arms = Norm(at_a.R1) + Norm(at_a.R2);
  const double apart = std::max(Norm(at_a.R1 - at_b.R1), Norm(at_a.R2 - at_b.R2));
  const bool same_features = a.feature1 == b.feature1 && a.feature2 == b.feature2;
  if (same_features) return (!a.s1 && !a.s2) || apart <= kApart * arms;
  return apart <= kSamePlace * arms && Norm(at_a.n - at_b.n) <= kSamePlace;
}

const Body& At(std::span<const Body> bodies, int index) { return bodies[static_cast<std::size_t>(index)]; }

TouchPoint EvaluateRope(const Constraint& rope, std::span<const Body> bodies) {
  const Body& body1 = At(bodies, rope.body1);
  const Body& body2 = At(bodies, rope.body2);
  const Vec2 vertex1 = std::get<Vertex>(rope.feature1).p;
  const Vec2 vertex2 = std::get<Vertex>(rope.feature2).p;
  const Rotation rotation1 = SinCos(body1.theta);
  const Rotation rotation2 = SinCos(body2.theta);
  if (HasNoDirection(rope, bodies)) {
    // From no distance at all the ends can only part, in the direction of their velocity.
    const Vec2 R1 = Rotate(rotation1, vertex1);
    const Vec2 R2 = Rotate(rotation2, vertex2);
    return {{}, R1, R2, rope.length, -Norm((body1.v - body2.v) + (body1.omega * Perp(R1) - body2.omega * Perp(R2)))};
  }
  const auto [points, row] = ComputeConnectorRow(vertex1, rotation1, body1, vertex2, rotation2, body2, rope.length);
  return {-points.n, points.R1, points.R2, rope.length - points.d, -row.d_dot};
}

// The unilateral constraints between moving bodies: contacts found from outlines, and ropes that may become taut.
// Features are meant locally (feature.h), so that a contact can be followed beyond the end of its edges: as a gap that
// is smooth in time. Whether the bodies really are closest there is another question, which LiesOn answers.
class ContactWatch {
 public:
  // @param world   its bodies' outlines are kept, positions are given later
  // @param finder  of that world; must outlive this
  ContactWatch(const World& world, const AccelerationOptions& options, const ContactFinder& finder)
      : finder_(finder), extents_(finder.extents()), thinnest_(finder.least_width()) {
    for (const Body& body : world.bodies) spans_.push_back(NormalSpans(OutlineOf(body), Rotation{}));
    range_ = options.search_range;
    // Without outlines there is nothing to find, but a rope.
    if (range_ == 0) {
      range_ = thinnest_ > 0 ? std::max(kThinnestPart * thinnest_, kLeastTolerances * options.contact_tolerance) : 1;
    }
    flush_angle_ = options.contact_tolerance / range_;
    const auto reach = [this](int body, const Feature& feature) {
      double& radius = extents_[static_cast<std::size_t>(body)].radius;
      if (const auto* end = std::get_if<Vertex>(&feature)) radius = std::max(radius, Norm(end->p));
    };
    for (const Constraint& joint : world.joints) {
      if (joint.type != ConstraintType::kRope) continue;
      ropes_.push_back(joint);
      reach(joint.body1, joint.feature1);
      reach(joint.body2, joint.feature2);
    }
  }

  // The closest points of a constraint's features; general curves from its start values, which are moved to the points
  // found.  @throws InputError where they are singular or not found
  static TouchPoint Evaluate(std::span<const Body> bodies, Constraint* constraint) {
    if (constraint->type == ConstraintType::kRope) return EvaluateRope(*constraint, bodies);
    const ClosestPoints closest = FindClosestPoints(*constraint, bodies);
    if (constraint->s1) constraint->s1 = closest.s1;
    if (constraint->s2) constraint->s2 = closest.s2;
    constraint->nominal_gap = closest.d;
    const ContactRow row = ComputeContactRow(closest, At(bodies, constraint->body1), At(bodies, constraint->body2));
    return {closest.n, closest.R1, closest.R2, closest.d, row.d_dot};
  }

  // Whether the closest points lie on the outlines: feet on their edges, normals in their corners' cones.
  bool LiesOn(std::span<const Body> bodies, const Constraint& constraint, const TouchPoint& touch) const {
    if (constraint.type == ConstraintType::kRope) return true;
    const auto on = [&](int index, const Feature& feature, Vec2 arm, Vec2 outward) {
      const Rotation forward = SinCos(At(bodies, index).theta);
      const Rotation back{forward.cos, -forward.sin};
      const Vec2 local_arm = Rotate(back, arm);
      const Vec2 local_normal = Rotate(back, outward);
      const std::vector<NormalSpan>& spans = spans_[static_cast<std::size_t>(index)];
      return std::any_of(spans.begin(), spans.end(), [&](const NormalSpan& span) {
        if (!(span.feature == feature)) return false;
        if (span.kind == NormalSpan::Kind::kVertex) return span.cone.Contains(local_normal, flush_angle_);
        return span.Holds(local_arm, local_normal);
      });
    };
    return on(constraint.body1, constraint.feature1, touch.R1, -touch.n) &&
           on(constraint.body2, constraint.feature2, touch.R2, touch.n);
  }

  // All contacts and ropes with -range() <= d <= range(), as DetectContacts.
  std::vector<Constraint> Find(std::span<const Body> bodies) const {
    std::vector<Constraint> found;
    if (thinnest_ > 0) found = finder_.Find(bodies, range_, range_);
    for (Constraint rope : ropes_) {
      if (std::abs(Evaluate(bodies, &rope).d) <= range_) found.push_back(rope);
    }
    return found;
  }

  // Gaps and overlaps that are looked for [m].
  double range() const { return range_; }

  // The longest step of at most `step` [s] in which no two bodies that can touch approach each other by more than
  // `stride` [m], or, where that is longer, by the distance between the circles around them. A body's surface moves by
  // at most (|v| + r |omega|) t + (|a| + r |alpha|) t^2 / 2.  O(bodies^2), a few operations a pair.
  // @param accelerations  three a body
  double LongestStep(std::span<const Body> bodies, std::span<const double> accelerations, double stride,
                     double step) const {
    const std::size_t count = bodies.size();
    std::vector<double> speed(count);
    std::vector<double> gain(count);
    for (std::size_t i = 0; i < count; ++i) {
      const double r = extents_[i].radius;
      speed[i] = Norm(bodies[i].v) + r * std::abs(bodies[i].omega);
      gain[i] = Norm({accelerations[3 * i], accelerations[3 * i + 1]}) + r * std::abs(accelerations[3 * i + 2]);
    }
    const auto shorten = [&](std::size_t i, std::size_t j, double room) {
      const double v = speed[i] + speed[j];
      const double a = gain[i] + gain[j];
      // The root of v t + a t^2 / 2 = room.
      if (v * step + a * step * step / 2 > room) step = 2 * room / (v + std::sqrt(v * v + 2 * a * room));
    };
    for (std::size_t i = 0; i < count; ++i) {
      if (spans_[i].empty()) continue;
      for (std::size_t j = i + 1; j < count; ++j) {
        if (spans_[j].empty() || (bodies[i].fixed && bodies[j].fixed)) continue;
        if (finder_.AreJoined(static_cast<int>(i), static_cast<int>(j))) continue;
        const double clearance = Norm(bodies[i].x - bodies[j].x) - extents_[i].radius - extents_[j].radius;
        shorten(i, j, std::max(stride, clearance));
      }
    }
    for (const Constraint& rope : ropes_) {
      shorten(static_cast<std::size_t>(rope.body1), static_cast<std::size_t>(rope.body2), stride);
    }
    return step;
  }

 private:
  const ContactFinder& finder_;
  std::vector<std::vector<NormalSpan>> spans_;  // of every body, body frame
  std::vector<Extent> extents_;                 // with the ends of ropes
  std::vector<Constraint> ropes_;
  double thinnest_ = 0;  // the movable bodies' least width [m]
  double range_ = 0;
  // How far a normal may leave a corner's cone [rad] before a contact at that corner ends: two straight edges that
  // lie flush within this keep both their contacts.
  double flush_angle_ = 0;
};

// Positions and velocities of the movable bodies, six a body in body order: x, y, theta, v_x, v_y, omega.
using MotionState = std::vector<double>;

// An acceleration-level LCP and its answer.
struct AnsweredLcp {
  AssembledLcp lcp;
  LcpResult result;
};

// A world's equations of motion between events: y' = (v, M^-1 (F + J^T f)), f from the contact LCP of a fixed set of
// constraints, whose closest points are searched anew at every evaluation. [docs/model.md section 8]
// Kinematic bodies are where their start and constant acceleration put them, x0 + v0 t + a t^2 / 2, at every time.
class ConstrainedFlow {
 public:
  // @param world   its bodies at time 0; must outlive this
  // @param solver  must outlive this
  ConstrainedFlow(const World& world, CountedSolver* solver)
      : start_(world.bodies), loads_(world.loads), solver_(solver), system_{world.name, world.bodies, {}} {}

  // Movable bodies' state.
  static MotionState StateOf(const std::vector<Body>& bodies) {
    MotionState state;
    for (const Body& body : bodies) {
      if (body.fixed) continue;
      for (const double value : {body.x.x, body.x.y, body.theta, body.v.x, body.v.y, body.omega})
        state.push_back(value);
    }
    return state;
  }
  // All bodies at `time`, movable ones by `state`; what does not move is left as it is.
  void Place(const MotionState& state, double time, std::vector<Body>* bodies) const {
    std::size_t k = 0;
    for (std::size_t i = 0; i < bodies->size(); ++i) {
      Body& body = (*bodies)[i];
      if (body.fixed) {
        const Body& start = start_[i];
        body.x = start.x + time * (start.v + (time / 2) * start.acceleration);
        body.theta = start.theta + time * (start.omega + time / 2 * start.alpha);
        body.v = start.v + time * start.acceleration;
        body.omega = start.omega + time * start.alpha;
        continue;
      }
      body.x = {state[k], state[k + 1]};
      body.theta = state[k + 2];
      body.v = {state[k + 3], state[k + 4]};
      body.omega = state[k + 5];
      k += 6;
    }
  }

  // The set that holds from now on: bilateral joints first, then contacts.
  // @param initial_f  warm start for its solves, empty for cold ones
  void Hold(std::vector<Constraint> constraints, Eigen::VectorXd initial_f) {
    system_.constraints = std::move(constraints);
    initial_f_ = std::move(initial_f);
  }

  const std::vector<Constraint>& held() const { return system_.constraints; }

  // The LCP at (state, time) under the held set.  @throws InputError for singular geometry, NoFinitePoint
  AnsweredLcp Solve(const MotionState& state, double time) {
    Place(state, time, &system_.bodies);
    SetLoads(loads_, system_.bodies);
    AnsweredLcp answered{AssembleContactLcp(system_), {}};
    if (answered.lcp.rows.empty()) {
      answered.result.status = LcpStatus::kSolved;
    } else {
      solver_->Solve(answered.lcp.problem, &initial_f_, &answered.result);
      RequireFinite(answered.lcp.problem, answered.result);
    }
    return answered;
  }

  // The system of the last Solve.
  const ContactSystem& system() const { return system_; }

  // Accelerations M^-1 (F + J^T f), three a body, of fixed bodies the prescribed ones.
  static std::vector<double> Accelerations(const ContactSystem& system, const AnsweredLcp& answered) {
    std::vector<double> accelerations;
    accelerations.reserve(3 * system.bodies.size());
    Eigen::VectorXd reactions = Eigen::VectorXd::Zero(static_cast<Index>(3 * system.bodies.size()));
    if (answered.lcp.problem.size() > 0) reactions = DisplacementOf(answered.lcp.problem, answered.result.f);
    Index k = 0;
    for (const Body& body : system.bodies) {
      if (body.fixed) {
        accelerations.insert(accelerations.end(), {body.acceleration.x, body.acceleration.y, body.alpha});
      } else {
        accelerations.push_back(body.force.x / body.mass + reactions[k]);
        accelerations.push_back(body.force.y / body.mass + reactions[k + 1]);
        accelerations.push_back(body.torque / body.inertia + reactions[k + 2]);
      }
      k += 3;
    }
    return accelerations;
  }

  // One step of the Fehlberg 7(8) pair [Fehlberg 1968; Boost.Odeint]; `error`, if not null, gets its estimate.
  // @throws as Solve
  void Step(const MotionState& from, double time, double step, MotionState* to, MotionState* error) {
    to->resize(from.size());
    MotionState estimate(from.size());
    const auto derivative = [this](const MotionState& state, MotionState& out, double at) {
      Derivative(state, at, &out);
    };
    boost::numeric::odeint::runge_kutta_fehlberg78<MotionState>().do_step(derivative, from, time, *to, step, estimate);
    if (error != nullptr) *error = std::move(estimate);
  }

 private:
  void Derivative(const MotionState& state, double time, MotionState* derivative) {
    const AnsweredLcp answered = Solve(state, time);
    const std::vector<double> accelerations = Accelerations(system_, answered);
    std::size_t k = 0;
    for (std::size_t i = 0; i < system_.bodies.size(); ++i) {
      if (system_.bodies[i].fixed) continue;
      for (std::size_t j = 0; j < 3; ++j) {
        (*derivative)[k + j] = state[k + 3 + j];
        (*derivative)[k + 3 + j] = accelerations[3 * i + j];
      }
      k += 6;
    }
  }

  std::vector<Body> start_;  // kinematic bodies' law
  const Loads& loads_;
  CountedSolver* solver_;
  ContactSystem system_;
  Eigen::VectorXd initial_f_;
};

// Where a step starts: the instant, the held contacts (a part of the flow's held set, after its bilateral rows) and
// their LCP.
struct StepBegin {
  double time = 0;  // [s]
  MotionState state;
  std::vector<Body> bodies;
  std::vector<Constraint> held;
  std::vector<Constraint> watched;  // contacts and ropes within the range, held or not
  AnsweredLcp answered;             // rows in the order of the flow's held set
  std::vector<double> accelerations;
};

// The end of a step, perhaps at an event.
struct StepEnd {
  double step = 0;  // [s]
  MotionState state;
  std::vector<Constraint> found;     // contacts and ropes within the range at the end
  std::vector<Constraint> touching;  // those whose approach ended the step
  bool at_event = false;
};

/// An impact is due this fraction of the contact tolerance below gap 0, so that it lies between two signs.
constexpr double kEventDepth = 1e-4;
/// Events are located to this fraction of a step: its end lies behind them by no more.
constexpr double kTimeFraction = 1e-9;
/// Approaches are located more closely, to this fraction of the event depth below their level.
constexpr double kDepthFraction = 0.01;
/// Shorter steps are not given up for a gap that cannot be followed [s].
constexpr double kShortestCut = 1e-13;
/// Gaps that start below the event depth are met this fraction of it deeper.
constexpr double kLower = 1e-3;
/// Rates of what is known by values only are differences over this fraction of a step.
constexpr double kRateFraction = 1e-5;
/// Forces and accelerations below this fraction of the largest are zero to a solver.
constexpr double kNegligible = 1e-8;

double LargestOf(const Eigen::VectorXd& values) { return values.size() == 0 ? 0 : values.lpNorm<Eigen::Infinity>(); }

// The gap and its rate of a constraint followed from its start values; nothing where it is singular.
std::optional<TouchPoint> TryEvaluate(const std::vector<Body>& bodies, Constraint constraint) {
  try {
    return ContactWatch::Evaluate(bodies, &constraint);
  } catch (const InputError&) {
    return std::nullopt;
  }
}

// The same where the features are closest to each other there.
std::optional<TouchPoint> TryInSight(const ContactWatch& watch, const std::vector<Body>& bodies,
                                     const Constraint& constraint) {
  const std::optional<TouchPoint> touch = TryEvaluate(bodies, constraint);
  return touch && watch.LiesOn(bodies, constraint, *touch) ? touch : std::nullopt;
}

// The end of before..after, bisected down to `width`, at which has_happened holds; it does at `after`.
template <class HasHappened>
double Bisect(double before, double after, double width, const HasHappened& has_happened) {
  while (after - before > width) {
    const double middle = before + (after - before) / 2;
    if (!(middle > before && middle < after)) break;
    (has_happened(middle) ? after : before) = middle;
  }
  return after;
}

// The time of the smallest value of the cubic with these values and slopes at 0 and `step`, by samples.
double DeepestTime(double d0, double v0, double d1, double v1, double step, double* deepest) {
  constexpr int kSamples = 16;
  double time = 0;
  *deepest = d0;
  for (int k = 1; k < kSamples; ++k) {
    const double u = static_cast<double>(k) / kSamples;
    const double d = (1 + 2 * u) * (1 - u) * (1 - u) * d0 + u * (1 - u) * (1 - u) * step * v0 +
                     u * u * (3 - 2 * u) * d1 - u * u * (1 - u) * step * v1;
    if (d < *deepest) {
      *deepest = d;
      time = u * step;
    }
  }
  return time;
}

// A step between its ends: positions by the polynomial of degree 5 with the positions, velocities and accelerations of
// both ends (error of order 6 in the step), velocities by its derivative. For first estimates of events.
class StepInterpolant {
 public:
  // @param bodies  tell which are movable
  // @param begin_accelerations, end_accelerations  three a body
  StepInterpolant(const std::vector<Body>& bodies, double step, const MotionState& begin,
                  const std::vector<double>& begin_accelerations, const MotionState& end,
                  const std::vector<double>& end_accelerations)
      : step_(step) {
    std::size_t k = 0;
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      if (bodies[i].fixed) continue;
      for (std::size_t j = 0; j < 3; ++j) {
        const double q0 = begin[k + j];
        const double v0 = begin[k + 3 + j] * step;
        const double a0 = begin_accelerations[3 * i + j] * step * step / 2;
        // What the first three terms lack at the end: position, velocity, half the acceleration.
        const double dq = end[k + j] - q0 - v0 - a0;
        const double dv = end[k + 3 + j] * step - v0 - 2 * a0;
        const double da = end_accelerations[3 * i + j] * step * step / 2 - a0;
        coordinates_.push_back({q0, v0, a0, 10 * dq - 4 * dv + da, -15 * dq + 7 * dv - 2 * da, 6 * dq - 3 * dv + da});
      }
      k += 6;
    }
  }

  // @param time  0 to step [s]
  MotionState At(double time) const {
    const double u = time / step_;
    MotionState state(2 * coordinates_.size());
    for (std::size_t c = 0; c < coordinates_.size(); ++c) {
      const Quintic& q = coordinates_[c];
      const std::size_t k = 6 * (c / 3) + c % 3;
      state[k] = q[0] + u * (q[1] + u * (q[2] + u * (q[3] + u * (q[4] + u * q[5]))));
      state[k + 3] = (q[1] + u * (2 * q[2] + u * (3 * q[3] + u * (4 * q[4] + u * (5 * q[5]))))) / step_;
    }
    return state;
  }

 private:
  using Quintic = std::array<double, 6>;  // q(u) = sum of c_k u^k, u = time / step
  double step_;
  std::vector<Quintic> coordinates_;  // three a movable body
};

// Finds the first event of a step.
class StepEvents {
 public:
  StepEvents(const AccelerationOptions& options, const ContactWatch& watch, const StepBegin& begin,
             ConstrainedFlow* flow)
      : options_(options),
        event_depth_(kEventDepth * options.contact_tolerance),
        watch_(watch),
        begin_(begin),
        flow_(flow) {}

  std::optional<StepEnd> Cut(double step, MotionState state) {
    between_.reset();
    StepEnd end{step, std::move(state), {}, {}, false};
    end.found = watch_.Find(BodiesAt(end.step, end.state));
    std::vector<Event> events;
    constexpr int kMostCuts = 8;
    for (int cut = 0; cut < kMostCuts; ++cut) {
      events.clear();
      if (AddApproaches(&end, &events) && AddPathEnds(&end, &events)) break;
    }
    AddPassages(end, &events);
    if (!AddReleases(end, &events)) return std::nullopt;

    if (events.empty()) return end;
    const StepInterpolant between = Between(end);
    std::vector<const Event*> missed;
    for (const Event& event : events) {
      if (event.value(end.step, end.state) > 0) continue;  // later than another
      StepEnd cut = end;
      Narrow(event, between, &cut);
      if (event.approaching && !IsThere(*event.approaching, cut)) {
        if (event.is_at_end) missed.push_back(&event);
        continue;
      }
      if (event.approaching) cut.touching.push_back(*event.approaching);
      end = std::move(cut);
    }
    // A gap that closed where its features are not the closest ones, and an overlap at the end: shorter steps show
    // which features met.
    for (const Event* event : missed) {
      if (end.step <= kShortestCut || event->value(end.step, end.state) > 0) continue;
      if (TryInSight(watch_, BodiesAt(end.step, end.state), *event->approaching)) return std::nullopt;
    }
    if (end.at_event) end.found = watch_.Find(BodiesAt(end.step, end.state));
    return end;
  }

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

  std::vector<Body> BodiesAt(double step, const MotionState& state) const {
    std::vector<Body> bodies = begin_.bodies;
    flow_->Place(state, begin_.time + step, &bodies);
    return bodies;
  }

  MotionState StateAfter(double step) const {
    MotionState state;
    flow_->Step(begin_.state, begin_.time, step, &state, nullptr);
    return state;
  }

  // A contact that bounced at its level must fall below it again, but hardly deeper: a bounce that falls further than
  // it rose gains speed, and would never come to rest.
  double Level(double begin_gap) const { return std::min(-event_depth_, begin_gap - kLower * event_depth_); }

  void AddPassages(const StepEnd& end, std::vector<Event>* events) const {
    const std::vector<Body> bodies = BodiesAt(end.step, end.state);
    const auto lies_on = [this](const std::vector<Body>& at, Constraint constraint) {
      const TouchPoint touch = ContactWatch::Evaluate(at, &constraint);
      return watch_.LiesOn(at, constraint, touch);
    };
    for (const Constraint& held : begin_.held) {
      if (lies_on(bodies, held) || !lies_on(begin_.bodies, held)) continue;
      Event event;
      event.value = [this, lies_on, held](double step, const MotionState& state) {
        return lies_on(BodiesAt(step, state), held) ? 1.0 : -1.0;
      };
      event.begin_value = 1;
      events->push_back(std::move(event));
    }
  }

  // False if a contact outside its set was held: the step is too long.
  bool AddReleases(const StepEnd& end, std::vector<Event>* events) const {
    if (begin_.held.empty()) return true;
    const AnsweredLcp last = flow_->Solve(end.state, begin_.time + end.step);
    const Eigen::VectorXd& begin_f = begin_.answered.result.f;
    const Eigen::VectorXd& f = last.result.f;
    const Eigen::VectorXd& diagonal = last.lcp.problem.DiagonalA();
    Eigen::VectorXd w;
    last.lcp.problem.ComputeW(f, &w);
    const double scale = kNegligible * LargestOf(last.lcp.problem.b());
    for (Index i = 0; i < f.size(); ++i) {
      if (last.lcp.problem.is_bilateral(i)) continue;
      const double A = diagonal[i] > 0 ? diagonal[i] : 1;
      const RowInfo& row = last.lcp.rows[static_cast<std::size_t>(i)];
      // A contact that opened and was then held at its speed: it should have been left alone, and met again.
      const bool was_free = begin_f[i] * A <= scale && row.d_dot > options_.velocity_tolerance;
      if (was_free && f[i] * A > scale && end.step > options_.shortest_step) return false;
      if (!(begin_f[i] * A > scale && w[i] > scale && f[i] * A <= scale)) continue;
      Event event;
      event.value = [this, i, A](double step, const MotionState& state) {
        const AnsweredLcp answered = flow_->Solve(state, begin_.time + step);
        Eigen::VectorXd rates;
        answered.lcp.problem.ComputeW(answered.result.f, &rates);
        return answered.result.f[i] * A - rates[i];
      };
      event.begin_value = begin_f[i] * A;
      event.smooth = true;
      events->push_back(std::move(event));
    }
    return true;
  }

  // Cuts the end where a gap closed and opened again.
  bool AddApproaches(StepEnd* end, std::vector<Event>* events) {
    const std::vector<Body> bodies = BodiesAt(end->step, end->state);
    std::vector<TouchPoint> held_points;
    for (Constraint held : begin_.held) held_points.push_back(ContactWatch::Evaluate(bodies, &held));
    const auto is_held = [&](const Constraint& constraint, const TouchPoint& touch) {
      for (std::size_t k = 0; k < held_points.size(); ++k) {
        if (IsSameContact(constraint, touch, begin_.held[k], held_points[k])) return true;
      }
      return false;
    };
    const std::vector<Constraint> candidates = Candidates(*end, bodies);
    for (std::size_t k = 0; k < candidates.size(); ++k) {
      const Constraint& found = candidates[k];
      const std::optional<TouchPoint> last = TryEvaluate(bodies, found);
      if (!last || is_held(found, *last)) continue;
      const std::optional<Event> event = ApproachOf(found, *end, k < end->found.size());
      if (!event) continue;
      if (event->value(end->step, end->state) <= 0) {
        events->push_back(*event);
        continue;
      }
      // Open at both ends: it may have closed and opened again.
      if (event->begin > 0 || last->d_dot <= 0) continue;
      const std::optional<TouchPoint> first = TryEvaluate(begin_.bodies, found);
      if (!first || first->d_dot >= 0) continue;
      double deepest = 0;
      const double time = DeepestTime(first->d, first->d_dot, last->d, last->d_dot, end->step, &deepest);
      if (!(deepest < 0) || !(time > 0)) continue;
      StepEnd inner{time, StateAfter(time), {}, {}, false};
      try {
        if (event->value(time, inner.state) > 0) continue;
      } catch (const InputError&) {
        continue;
      }
      CutAt(std::move(inner), end);
      return false;
    }
    return true;
  }

  void CutAt(StepEnd inner, StepEnd* end) {
    inner.found = watch_.Find(BodiesAt(inner.step, inner.state));
    *end = std::move(inner);
    between_.reset();
  }

  // Points that pass the ends of pieces of their paths. Cuts the end where one left its piece and came back.
  bool AddPathEnds(StepEnd* end, std::vector<Event>* events) {
    for (const Constraint& joint : flow_->held()) {
      if (joint.path.empty()) continue;
      const auto left = [joint](std::span<const Body> bodies) { return LeftOnPiece(FindPlaceOnPiece(joint, bodies)); };
      Event event;
      event.smooth = true;
      event.begin_value = left(begin_.bodies);
      if (event.begin_value <= 0) continue;
      event.value = [this, left](double step, const MotionState& state) { return left(BodiesAt(step, state)); };
      const std::vector<Body> bodies = BodiesAt(end->step, end->state);
      if (left(bodies) <= 0) {
        events->push_back(std::move(event));
        continue;
      }
      // Whether it moves away from both ends of its piece, by the bodies' velocities.
      const auto returns = [left, h = kRateFraction * end->step](std::vector<Body> at) {
        const double before = left(at);
        for (Body& body : at) {
          body.x = body.x + h * body.v;
          body.theta += h * body.omega;
        }
        return left(at) > before;
      };
      if (returns(begin_.bodies) || !returns(bodies)) continue;
      const StepInterpolant& between = Between(*end);
      const double time = Bisect(0, end->step, kRateFraction * end->step,
                                 [&](double step) { return returns(BodiesAt(step, between.At(step))); });
      StepEnd inner{time, StateAfter(time), {}, {}, false};
      if (event.value(time, inner.state) > 0) continue;
      CutAt(std::move(inner), end);
      return false;
    }
    return true;
  }

  // What was or is near: found at the end, and found at the beginning only (its features then may have met first).
  std::vector<Constraint> Candidates(const StepEnd& end, const std::vector<Body>& bodies) const {
    std::vector<Constraint> candidates = end.found;
    std::vector<std::optional<TouchPoint>> points;
    for (const Constraint& found : end.found) points.push_back(TryEvaluate(bodies, found));
    for (const Constraint& watched : begin_.watched) {
      const std::optional<TouchPoint> touch = TryEvaluate(bodies, watched);
      if (!touch || std::abs(touch->d) > watch_.range()) continue;
      bool known = false;
      for (std::size_t k = 0; k < points.size() && !known; ++k) {
        known = points[k] && IsSameContact(candidates[k], *points[k], watched, *touch);
      }
      if (known) continue;
      candidates.push_back(watched);
      points.push_back(touch);
    }
    return candidates;
  }

  const StepInterpolant& Between(const StepEnd& end) {
    if (!between_) {
      const std::vector<double> accelerations =
          ConstrainedFlow::Accelerations(flow_->system(), flow_->Solve(end.state, begin_.time + end.step));
      between_.emplace(begin_.bodies, end.step, begin_.state, begin_.accelerations, end.state, accelerations);
    }
    return *between_;
  }

  // When the contact's points come onto the outlines for good; 0 if they are there at the beginning.
  double InSightFrom(const Constraint& constraint, const StepEnd& end) {
    if (TryInSight(watch_, begin_.bodies, constraint)) return 0;
    const StepInterpolant& between = Between(end);
    return Bisect(0, end.step, kTimeFraction * end.step, [&](double step) {
      return TryInSight(watch_, BodiesAt(step, between.At(step)), constraint).has_value();
    });
  }

  // The approach of features that are closest to each other from some time on, with the gap that they have then.
  // Nothing if that is an overlap: it was there before, or a corner came into sight between two edges.
  std::optional<Event> ApproachOf(const Constraint& constraint, const StepEnd& end, bool is_at_end) {
    Event event;
    event.smooth = true;
    event.approaching = constraint;
    event.is_at_end = is_at_end;
    std::optional<TouchPoint> first = TryEvaluate(begin_.bodies, constraint);
    const std::optional<TouchPoint> last = TryEvaluate(BodiesAt(end.step, end.state), constraint);
    const bool closes = last && last->d <= -event_depth_;
    if (is_at_end && closes) {
      event.begin = InSightFrom(constraint, end);
      if (event.begin > 0) first = TryEvaluate(BodiesAt(event.begin, Between(end).At(event.begin)), constraint);
    }
    if (!first || first->d < -options_.contact_tolerance) return std::nullopt;
    const double level = Level(first->d);
    event.begin_value = first->d - level;
    event.value = [this, constraint, level](double step, const MotionState& state) {
      Constraint followed = constraint;
      return ContactWatch::Evaluate(BodiesAt(step, state), &followed).d - level;
    };
    return event;
  }

  // The time on the interpolant at which the event has just happened.
  double Estimate(const Event& event, const StepInterpolant& between, double latest) const {
    const auto value = [&](double step) { return event.value(step, between.At(step)); };
    const double tolerance = (event.approaching ? kDepthFraction : 1) * kTimeFraction * latest;
    const double last = value(latest);
    if (!(last < 0) || !(latest > event.begin)) return latest;
    if (!event.smooth) return Bisect(event.begin, latest, tolerance, [&](double step) { return !(value(step) > 0); });
    std::uintmax_t evaluations = 60;
    const auto close = [tolerance](double a, double b) { return std::abs(b - a) <= tolerance; };
    return boost::math::tools::toms748_solve(value, event.begin, latest, event.begin_value, last, close, evaluations)
        .second;
  }

  void Narrow(const Event& event, const StepInterpolant& between, StepEnd* end) const {
    const double depth = kDepthFraction * event_depth_;
    StepEnd after = *end;
    double before = event.begin;
    double step = Estimate(event, between, end->step);
    double width = kTimeFraction * end->step;
    constexpr int kMostSteps = 60;
    for (int k = 0; k < kMostSteps; ++k) {
      if (!(step > before && step < after.step)) step = before + (after.step - before) / 2;
      if (!(step > before && step < after.step)) break;
      MotionState state = StateAfter(step);
      const double g = event.value(step, state);
      double next = step + width;
      if (event.approaching) {
        Constraint followed = *event.approaching;
        const double rate = ContactWatch::Evaluate(BodiesAt(step, state), &followed).d_dot;
        next = step - (g + depth / 2) / rate;
      }
      if (g > 0) {
        before = step;
        width *= 2;
      } else {
        after.step = step;
        after.state = std::move(state);
        if (!event.approaching || g >= -depth || after.step - before <= kShortestCut) break;
      }
      step = next;
    }
    after.at_event = true;
    *end = std::move(after);
  }

  bool IsThere(const Constraint& constraint, const StepEnd& end) const {
    const std::optional<TouchPoint> touch = TryInSight(watch_, BodiesAt(end.step, end.state), constraint);
    return touch && touch->d <= options_.contact_tolerance;
  }

  const AccelerationOptions& options_;
  double event_depth_;  // how far below 0 a gap is when its impact is due [m]
  const ContactWatch& watch_;
  const StepBegin& begin_;
  ConstrainedFlow* flow_;
  std::optional<StepInterpolant> between_;
};

/// The part of the search range that surfaces may approach by in one step.
constexpr double kStride = 0.5;
/// w above this fraction of the largest |b| is a contact that opens, beyond a solver's tolerance.
constexpr double kOpens = 1e-8;
/// Corrections go this far below the threshold that calls for them.
constexpr double kCorrectionGoal = 0.01;
constexpr double kShortestTrial = 1e-14;

// @throws InputError naming the option and its range
AccelerationOptions Valid(AccelerationOptions options) {
  options.impact.velocity_tolerance = options.velocity_tolerance;
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
  return options;
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

class AccelerationMotion final : public Motion {
 public:
  AccelerationMotion(World world, const AccelerationOptions& options, LcpSolver& solver)
      : Motion(std::move(world), options.lcp, solver),
        options_(Valid(options)),
        watch_(world_, options, finder_),
        flow_(world_, &solver_),
        next_step_(options.largest_step) {
    if (finder_.least_width() > 0) treated_ = TreatedDepth(options_, finder_.least_width());
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
    if (!CanAdvance(duration, options_.largest_step)) return;
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
    std::vector<Constraint> contacts;
    std::vector<TouchPoint> points;
    const auto add = [&](Constraint constraint, double deepest, bool must_lie_on) {
      try {
        const TouchPoint touch = ContactWatch::Evaluate(world_.bodies, &constraint);
        if (!(touch.d <= options_.contact_tolerance && touch.d >= -deepest)) return;
        if (constraint.type == ConstraintType::kRope && HasNoDirection(constraint, world_.bodies)) return;
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
    for (const Constraint& constraint : known) add(constraint, watch_.range(), true);
    for (const Constraint& constraint : found) {
      if (std::abs(constraint.nominal_gap) > treated_ && constraint.type == ConstraintType::kContact) {
        continue;
      }
      add(constraint, treated_, false);
    }
    contacts_ = std::move(contacts);
    EndAtUnfollowed(found, points);
    watched_ = contacts_;
    watched_.insert(watched_.end(), found.begin(), found.end());
  }

  // Ends the motion where bodies overlap at a contact that is not followed, deeper than at those that are.
  // @param points  of contacts_
  void EndAtUnfollowed(const std::vector<Constraint>& found, const std::vector<TouchPoint>& points) {
    for (Constraint constraint : found) {
      if (constraint.type != ConstraintType::kContact || constraint.nominal_gap >= -treated_) continue;
      double known = treated_;
      for (std::size_t k = 0; k < contacts_.size(); ++k) {
        const bool same_bodies = contacts_[k].body1 == constraint.body1 && contacts_[k].body2 == constraint.body2;
        if (same_bodies) known = std::max(known, -points[k].d);
      }
      // The depths of one overlap differ by rounding.
      constexpr double kRounding = 1e-3;
      const TouchPoint touch = ContactWatch::Evaluate(world_.bodies, &constraint);
      const Vec2 p1 = At(world_.bodies, constraint.body1).x + touch.R1;
      const Vec2 p2 = At(world_.bodies, constraint.body2).x + touch.R2;
      const double depth = finder_.DepthAt(world_.bodies, constraint, p1, p2, touch.d);
      if (depth <= (1 + kRounding) * known) continue;
      for (const BodyOverlap& overlap : finder_.FindOverlaps(world_.bodies, {&constraint, 1}, known)) {
        if (overlap.body1 == constraint.body1 && overlap.body2 == constraint.body2) return End(overlap);
      }
    }
  }

  ContactSystem SystemOf(const std::vector<Constraint>& contacts) const {
    ContactSystem system{world_.name, world_.bodies, bilateral_};
    system.constraints.insert(system.constraints.end(), contacts.begin(), contacts.end());
    SetLoads(world_.loads, system.bodies);
    return system;
  }

  ImpulseSolver Impulses(bool observed) {
    return [this, observed](const ContactSystem& system, const std::vector<RowInfo>& rows, const LcpProblem& problem,
                            LcpResult* result) {
      solver_.Solve(problem, nullptr, result);
      RequireFinite(problem, *result);
      if (observed) Observe(MotionProblemKind::kImpact, system, rows, problem, *result);
    };
  }

  std::vector<Constraint> LastingContacts() const {
    std::vector<Constraint> lasting;
    for (Constraint contact : contacts_) {
      const TouchPoint touch = ContactWatch::Evaluate(world_.bodies, &contact);
      if (std::abs(touch.d_dot) <= options_.velocity_tolerance) lasting.push_back(contact);
    }
    return lasting;
  }

  void CorrectPositions() {
    const double threshold = options_.position_threshold * options_.contact_tolerance;
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
    const double threshold = options_.velocity_threshold * options_.velocity_tolerance;
    ContactSystem system = SystemOf(LastingContacts());
    if (system.constraints.empty() || WorstViolation(AssembleContactLcp(system).rows, &RowInfo::d_dot) <= threshold) {
      return;
    }
    StopApproach(options_.impact, Impulses(false), &system);
    CopyVelocities(system.bodies, world_.bodies);
  }

  // Stops contacts that separate although they carry a force; true if there was one.
  bool HoldTogether(const AnsweredLcp& answered, const std::vector<Constraint>& lasting) {
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

  bool ResolveDueImpact() {
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

  void CountEvent(const char* what) {
    if (time_ - events_begin_ > options_.shortest_step) {
      events_ = 0;
      events_begin_ = time_;
    }
    if (++events_ <= options_.max_events) return;
    Stall("more than " + std::to_string(options_.max_events) + " events or steps within " +
          NumberText(options_.shortest_step) + " s at t = " + NumberText(time_) + " s, the last of them " + what);
  }

  // Everything that happens in an instant: corrections and impacts.
  void Settle() {
    CorrectPositions();
    while (status_ == MotionStatus::kMoving && ResolveDueImpact()) CountEvent("an impact");
    CorrectVelocities();
  }

  // The held set of the next step: without rows that open; the LCP before is observed.
  StepBegin Begin() {
    std::vector<Constraint> lasting = LastingContacts();
    std::vector<Constraint> rows = bilateral_;
    rows.insert(rows.end(), lasting.begin(), lasting.end());
    flow_.Hold(rows, last_f_);
    MotionState state = ConstrainedFlow::StateOf(world_.bodies);
    AnsweredLcp answered = flow_.Solve(state, time_);
    if (HoldTogether(answered, lasting)) {
      state = ConstrainedFlow::StateOf(world_.bodies);
      answered = flow_.Solve(state, time_);
    }
    StepBegin begin{time_, std::move(state), world_.bodies, {}, watched_, std::move(answered), {}};
    const LcpProblem problem = begin.answered.lcp.problem;
    if (problem.size() > 0) {
      Observe(MotionProblemKind::kAcceleration, flow_.system(), begin.answered.lcp.rows, problem,
              begin.answered.result);
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
    flow_.Hold(std::move(rows), last_f_);
    begin.held = std::move(held);
    return begin;
  }

  void Step(double end) {
    Settle();
    if (status_ != MotionStatus::kMoving) return;
    const StepBegin begin = Begin();
    StepEvents events(options_, watch_, begin, &flow_);
    double step = watch_.LongestStep(begin.bodies, begin.accelerations, kStride * watch_.range(),
                                     std::min({next_step_, options_.largest_step, end - time_}));
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
    CountEvent(reached->at_event ? "a contact that opens, closes or passes on to another edge"
                                 : "a step that speeds or errors shorten");
    if (!reached->at_event) RequireAdvance(begin.bodies, reached->step, options_.contact_tolerance);
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
  int events_ = 0;  // since events_begin_
  double events_begin_ = 0;
};

}  // namespace

std::unique_ptr<Motion> MakeAccelerationMotion(World world, const AccelerationOptions& options, LcpSolver& solver) {
  return std::make_unique<AccelerationMotion>(std::move(world), options, solver);
}

}  // namespace lcpbench
