#include "model/motion/step_events.h"

#include <algorithm>
#include <array>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <cstdint>
#include <functional>
#include <utility>
#include <variant>

#include "model/contact/contact_row.h"
#include "model/contact/path.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

/// An impact is due this far below gap 0, so that it lies between two signs [m].
constexpr double kEventDepth = 1e-4 * kContactTolerance;
/// Events are located to this fraction of a step: its end lies behind them by no more.
constexpr double kTimeFraction = 1e-9;
/// Approaches are located more closely, to this fraction of the event depth below their level.
constexpr double kDepthFraction = 0.01;
/// Speeds of motors are met to this: what is left stays while they are held [rad/s].
constexpr double kStopDepth = 1e-4 * kHeldTurning;
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
  StepEvents(double velocity_tolerance, const ContactWatch& watch, const StepBegin& begin, ConstrainedFlow* flow)
      : velocity_tolerance_(velocity_tolerance), watch_(watch), begin_(begin), flow_(flow) {}

  std::optional<StepEnd> Cut(double step, MotionState state) {
    StepEnd end{step, std::move(state), {}, {}, false, {}};
    end.found = watch_.Find(BodiesAt(end.step, end.state));
    std::vector<Event> events;
    constexpr int kMostCuts = 8;
    for (int cut = 0; cut < kMostCuts; ++cut) {
      events.clear();
      if (AddApproaches(&end, &events) && AddPathEnds(&end, &events) && AddStops(&end, &events)) break;
    }
    if (closed_unseen_ && step > kShortestStep) return std::nullopt;
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
      cut.met = event.approaching ? event.approaching : event.ending;
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
    Value rate = {};  // the rate of what is to be met as closely as an approach
    std::optional<Constraint> approaching;
    std::optional<Constraint> ending;  // a contact that passes on or opens
    bool is_at_end = true;             // found there, not only at the beginning
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
  double Level(double begin_gap) const { return std::min(-kEventDepth, begin_gap - kLower * kEventDepth); }

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
      event.ending = held;
      events->push_back(std::move(event));
    }
  }

  // Pins that come to the speed of their motors. Cuts the end where one came to it and left it again.
  bool AddStops(StepEnd* end, std::vector<Event>* events) {
    for (const Constraint& joint : flow_->held()) {
      if (joint.slip == 0) continue;
      const auto ahead = [joint](std::span<const Body> bodies) { return joint.slip * TurningSlip(joint, bodies); };
      Event event;
      event.smooth = true;
      event.begin_value = ahead(begin_.bodies);
      // One that begins to turn is at that speed but for rounding, and must fall behind it.
      const double level = event.begin_value > kHeldTurning ? 0 : -2 * kHeldTurning;
      event.begin_value -= level;
      event.value = [this, ahead, level](double step, const MotionState& state) {
        return ahead(BodiesAt(step, state)) - level;
      };
      const auto rate = [joint](const std::vector<double>& accelerations) {
        const auto alpha = [&](int body) { return accelerations[3 * static_cast<std::size_t>(body) + 2]; };
        return joint.slip * (alpha(joint.body1) - alpha(joint.body2));
      };
      event.rate = [this, rate](double step, const MotionState& state) {
        return rate(flow_->Accelerations(flow_->Solve(state, begin_.time + step)));
      };
      const double last = event.value(end->step, end->state);
      if (last <= 0) {
        events->push_back(std::move(event));
      } else if (rate(begin_.accelerations) < 0) {
        double deepest = 0;
        const double time = DeepestTime(event.begin_value, rate(begin_.accelerations), last,
                                        event.rate(end->step, end->state), end->step, &deepest);
        if (deepest < 0 && CutsAt(time, event, end)) return false;
      }
    }
    return true;
  }

  // The force that a contact has to lose before it opens, and a torque to gain before its pin turns.
  double Spare(const AnsweredLcp& answered, Index i) const {
    const RowInfo& row = answered.lcp.rows[static_cast<std::size_t>(i)];
    const double f = answered.result.f[i];
    return row.axis == 'r' ? flow_->held()[static_cast<std::size_t>(row.constraint)].torque_limit - std::abs(f) : f;
  }

  // Accelerations by which contacts open and pins turn.
  static Eigen::VectorXd RatesOf(const AnsweredLcp& answered) {
    Eigen::VectorXd rates;
    answered.lcp.problem.ComputeW(answered.result.f, &rates);
    for (const BoundedRow& torque : answered.lcp.problem.bounded_rows())
      rates[torque.row] = std::abs(rates[torque.row]);
    return rates;
  }

  // False if a contact outside its set was held: the step is too long.
  bool AddReleases(const StepEnd& end, std::vector<Event>* events) const {
    if (begin_.held.empty() && begin_.answered.lcp.problem.is_plain()) return true;
    const AnsweredLcp last = flow_->Solve(end.state, begin_.time + end.step);
    const Eigen::VectorXd& diagonal = last.lcp.problem.DiagonalA();
    const Eigen::VectorXd w = RatesOf(last);
    const double scale = kNegligible * LargestOf(last.lcp.problem.b());
    for (Index i = 0; i < w.size(); ++i) {
      if (last.lcp.problem.is_bilateral(i)) continue;
      const double A = diagonal[i] > 0 ? diagonal[i] : 1;
      const RowInfo& row = last.lcp.rows[static_cast<std::size_t>(i)];
      // A contact that opened and was then held at its speed: it should have been left alone, and met again.
      const double first = A * Spare(begin_.answered, i);
      const double spare = A * Spare(last, i);
      const bool was_free =
          first <= scale && (row.axis == 'r' ? std::abs(row.d_dot) > kHeldTurning : row.d_dot > velocity_tolerance_);
      if (was_free && spare > scale && end.step > kShortestStep) return false;
      if (!(first > scale && w[i] > scale && spare <= scale)) continue;
      Event event;
      event.value = [this, i, A](double step, const MotionState& state) {
        const AnsweredLcp answered = flow_->Solve(state, begin_.time + step);
        return Spare(answered, i) * A - RatesOf(answered)[i];
      };
      event.begin_value = first;
      event.smooth = true;
      event.ending = flow_->held()[static_cast<std::size_t>(row.constraint)];
      events->push_back(std::move(event));
    }
    return true;
  }

  // Cuts the end where a gap closed and opened again.
  bool AddApproaches(StepEnd* end, std::vector<Event>* events) {
    const std::vector<Body> bodies = BodiesAt(end->step, end->state);
    std::vector<TouchingConstraint> held;
    for (Constraint constraint : begin_.held) {
      const TouchPoint touch = ContactWatch::Evaluate(bodies, &constraint);
      held.push_back({constraint, touch});
    }
    const std::vector<Constraint> candidates = Candidates(*end, bodies);
    for (std::size_t k = 0; k < candidates.size(); ++k) {
      const Constraint& found = candidates[k];
      const std::optional<TouchPoint> last = TryEvaluate(bodies, found);
      if (!last || IsKnown({found, *last}, held)) continue;
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
      if (deepest < 0 && time > 0 && CutsAt(time, *event, end)) return false;
    }
    return true;
  }

  // Ends the step at `time` if the event has happened there.
  bool CutsAt(double time, const Event& event, StepEnd* end) {
    StepEnd inner{time, StateAfter(time), {}, {}, false, {}};
    try {
      if (event.value(time, inner.state) > 0) return false;
    } catch (const InputError&) {
      if (!event.approaching) throw;
      return false;
    }
    inner.found = watch_.Find(BodiesAt(inner.step, inner.state));
    *end = std::move(inner);
    between_.reset();
    return true;
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
      if (CutsAt(time, event, end)) return false;
    }
    return true;
  }

  // What was or is near: found at the end, and found at the beginning only (its features then may have met first).
  std::vector<Constraint> Candidates(const StepEnd& end, const std::vector<Body>& bodies) const {
    std::vector<Constraint> candidates = end.found;
    std::vector<TouchingConstraint> known;
    for (const Constraint& found : end.found) {
      if (const std::optional<TouchPoint> touch = TryEvaluate(bodies, found)) known.push_back({found, *touch});
    }
    for (const Constraint& watched : begin_.watched) {
      const std::optional<TouchPoint> touch = TryEvaluate(bodies, watched);
      if (!touch || std::abs(touch->d) > watch_.range() || IsKnown({watched, *touch}, known)) continue;
      candidates.push_back(watched);
      known.push_back({watched, *touch});
    }
    return candidates;
  }

  const StepInterpolant& Between(const StepEnd& end) {
    if (!between_) {
      const std::vector<double> accelerations = flow_->Accelerations(flow_->Solve(end.state, begin_.time + end.step));
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
    const bool closes = last && last->d <= -kEventDepth;
    if (is_at_end && closes) {
      event.begin = InSightFrom(constraint, end);
      if (event.begin > 0) first = TryEvaluate(BodiesAt(event.begin, Between(end).At(event.begin)), constraint);
    }
    if (!first || first->d < -kContactTolerance) {
      closed_unseen_ = closed_unseen_ || (first && ClosedWithin(event.begin, constraint, *first));
      return std::nullopt;
    }
    const double level = Level(first->d);
    event.begin_value = first->d - level;
    event.value = [this, constraint, level](double step, const MotionState& state) {
      Constraint followed = constraint;
      return ContactWatch::Evaluate(BodiesAt(step, state), &followed).d - level;
    };
    return event;
  }

  // Whether two edges that overlap where they come into sight, at `time`, may have been apart at the beginning: at
  // twice their speed they get as deep.
  static bool ClosedWithin(double time, const Constraint& constraint, const TouchPoint& touch) {
    const bool is_corner =
        std::holds_alternative<Vertex>(constraint.feature1) || std::holds_alternative<Vertex>(constraint.feature2);
    return time > 0 && !is_corner && touch.d >= 2 * time * touch.d_dot;
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
    const double depth = event.rate ? kStopDepth : kDepthFraction * kEventDepth;
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
      } else if (event.rate) {
        next = step - (g + depth / 2) / event.rate(step, state);
      }
      if (g > 0) {
        before = step;
        width *= 2;
      } else {
        after.step = step;
        after.state = std::move(state);
        if (!(event.approaching || event.rate) || g >= -depth || after.step - before <= kShortestCut) break;
      }
      step = next;
    }
    after.at_event = true;
    *end = std::move(after);
  }

  bool IsThere(const Constraint& constraint, const StepEnd& end) const {
    const std::optional<TouchPoint> touch = TryInSight(watch_, BodiesAt(end.step, end.state), constraint);
    return touch && touch->d <= kContactTolerance;
  }

  double velocity_tolerance_;
  const ContactWatch& watch_;
  const StepBegin& begin_;
  ConstrainedFlow* flow_;
  std::optional<StepInterpolant> between_;
  // Edges came into sight behind a join as an overlap: those before the join met, which may have no gap any more at the
  // end of the step.
  bool closed_unseen_ = false;
};

}  // namespace

std::optional<StepEnd> CutAtFirstEvent(double velocity_tolerance, const ContactWatch& watch, const StepBegin& begin,
                                       double step, MotionState state, ConstrainedFlow* flow) {
  return StepEvents(velocity_tolerance, watch, begin, flow).Cut(step, std::move(state));
}

}  // namespace lcpbench
