#include "model/motion/acceleration_events.h"

#include <algorithm>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <cstdint>
#include <utility>

#include "solvers/lcp/input_error.h"

namespace lcpbench {
namespace {

/// Impacts are located to this fraction of a step, other events, where forces are continuous, to that one.
constexpr double kImpactFraction = 1e-13;
constexpr double kSmoothFraction = 1e-9;
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

}  // namespace

StepEvents::StepEvents(const EventOptions& options, const ContactWatch& watch, const StepBegin& begin,
                       ConstrainedFlow* flow)
    : options_(options), watch_(watch), begin_(begin), flow_(flow) {}

std::vector<Body> StepEvents::BodiesAt(double step, const MotionState& state) const {
  std::vector<Body> bodies = begin_.bodies;
  flow_->Place(state, begin_.time + step, &bodies);
  return bodies;
}

MotionState StepEvents::StateAfter(double step) const {
  MotionState state;
  flow_->Step(begin_.state, begin_.time, step, &state, nullptr);
  return state;
}

double StepEvents::Level(double begin_gap) const { return std::min(0.0, begin_gap) - options_.event_depth; }

void StepEvents::AddPassages(const StepEnd& end, std::vector<Event>* events) const {
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
    event.tolerance = kSmoothFraction * end.step;
    events->push_back(std::move(event));
  }
}

bool StepEvents::AddReleases(const StepEnd& end, std::vector<Event>* events) const {
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
    event.tolerance = kSmoothFraction * end.step;
    event.smooth = true;
    events->push_back(std::move(event));
  }
  return true;
}

bool StepEvents::AddApproaches(StepEnd* end, std::vector<Event>* events) const {
  std::vector<Body> bodies = BodiesAt(end->step, end->state);
  const std::vector<TouchPoint> held_points = [&] {
    std::vector<TouchPoint> points;
    for (Constraint held : begin_.held) points.push_back(ContactWatch::Evaluate(bodies, &held));
    return points;
  }();
  const auto is_held = [&](const Constraint& constraint, const TouchPoint& touch) {
    for (std::size_t k = 0; k < held_points.size(); ++k) {
      if (IsSameContact(constraint, touch, begin_.held[k], held_points[k])) return true;
    }
    return false;
  };
  for (const Constraint& found : end->found) {
    const std::optional<TouchPoint> last = TryEvaluate(bodies, found);
    if (!last || is_held(found, *last)) continue;
    const std::optional<TouchPoint> first = TryEvaluate(begin_.bodies, found);
    // An overlap that deep was there before, or a corner came into sight between two edges: not a gap that closed.
    if (!first || first->d < -options_.contact_tolerance) continue;
    const double level = Level(first->d);
    if (last->d > level) {
      if (!(first->d_dot < 0 && last->d_dot > 0)) continue;
      double deepest = 0;
      const double time = DeepestTime(first->d, first->d_dot, last->d, last->d_dot, end->step, &deepest);
      if (!(deepest < level) || !(time > 0)) continue;
      StepEnd inner{time, StateAfter(time), {}, {}, false};
      const std::optional<TouchPoint> between = TryEvaluate(BodiesAt(time, inner.state), found);
      if (!between || between->d > level) continue;
      inner.found = watch_.Find(BodiesAt(time, inner.state), options_.range);
      *end = std::move(inner);
      return false;
    }
    Event event;
    event.value = [this, found, level](double step, const MotionState& state) {
      Constraint constraint = found;
      return ContactWatch::Evaluate(BodiesAt(step, state), &constraint).d - level;
    };
    event.begin_value = first->d - level;
    event.tolerance = kImpactFraction * end->step;
    event.smooth = true;
    event.approaching = found;
    events->push_back(std::move(event));
  }
  return true;
}

void StepEvents::Narrow(const Event& event, StepEnd* end) const {
  StepEnd after = *end;
  const auto value = [&](double step) {
    MotionState state = StateAfter(step);
    const double g = event.value(step, state);
    if (g <= 0 && step <= after.step) {
      after.step = step;
      after.state = std::move(state);
    }
    return g;
  };
  const double end_value = event.value(end->step, end->state);
  if (event.smooth) {
    constexpr std::uintmax_t kMostEvaluations = 60;
    std::uintmax_t evaluations = kMostEvaluations;
    const double tolerance = event.tolerance;
    const auto close = [tolerance](double a, double b) { return std::abs(b - a) <= tolerance; };
    if (end_value < 0) {
      boost::math::tools::toms748_solve(value, 0.0, end->step, event.begin_value, end_value, close, evaluations);
    }
  } else {
    double before = 0;
    while (after.step - before > event.tolerance) {
      const double middle = before + (after.step - before) / 2;
      if (!(middle > before && middle < after.step)) break;
      if (value(middle) > 0) before = middle;
    }
  }
  after.at_event = true;
  *end = std::move(after);
}

bool StepEvents::IsThere(const Constraint& constraint, const StepEnd& end) const {
  const std::vector<Body> bodies = BodiesAt(end.step, end.state);
  const std::optional<TouchPoint> touch = TryEvaluate(bodies, constraint);
  return touch && touch->d <= options_.contact_tolerance && watch_.LiesOn(bodies, constraint, *touch);
}

std::optional<StepEnd> StepEvents::Cut(double step, MotionState state) {
  StepEnd end{step, std::move(state), {}, {}, false};
  end.found = watch_.Find(BodiesAt(end.step, end.state), options_.range);
  std::vector<Event> events;
  constexpr int kMostCuts = 8;
  for (int cut = 0; cut < kMostCuts; ++cut) {
    events.clear();
    if (AddApproaches(&end, &events)) break;
  }
  AddPassages(end, &events);
  if (!AddReleases(end, &events)) return std::nullopt;

  bool missed = false;
  std::vector<const Event*> met;
  for (const Event& event : events) {
    if (event.value(end.step, end.state) > 0) continue;  // later than another
    StepEnd cut = end;
    Narrow(event, &cut);
    if (event.approaching && !IsThere(*event.approaching, cut)) {
      missed = true;
      continue;
    }
    end = std::move(cut);
    met.push_back(&event);
  }
  const bool touched = std::any_of(met.begin(), met.end(), [](const Event* event) { return event->approaching; });
  if (missed && !touched && step > options_.shortest_step * kSmoothFraction) return std::nullopt;
  for (const Event* event : met) {
    if (event->approaching) end.touching.push_back(*event->approaching);
  }
  if (end.at_event) end.found = watch_.Find(BodiesAt(end.step, end.state), options_.range);
  return end;
}

}  // namespace lcpbench
