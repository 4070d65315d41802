#include "model/motion/constrained_flow.h"

#include <boost/numeric/odeint/stepper/runge_kutta_fehlberg78.hpp>
#include <utility>

#include "model/contact/loads.h"
#include "model/motion/impact.h"

namespace lcpbench {

MotionState ConstrainedFlow::StateOf(const std::vector<Body>& bodies) {
  MotionState state;
  for (const Body& body : bodies) {
    if (body.fixed) continue;
    for (const double value : {body.x.x, body.x.y, body.theta, body.v.x, body.v.y, body.omega}) state.push_back(value);
  }
  return state;
}

void ConstrainedFlow::Place(const MotionState& state, double time, std::vector<Body>* bodies) const {
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

void ConstrainedFlow::Hold(std::vector<Constraint> constraints, Eigen::VectorXd initial_f) {
  system_.constraints = std::move(constraints);
  initial_f_ = std::move(initial_f);
}

AnsweredLcp ConstrainedFlow::Solve(const MotionState& state, double time) {
  Place(state, time, &system_.bodies);
  SetLoads(loads_, system_.bodies);
  AnsweredLcp answered{AssembleContactLcp(system_, Friction::kRows), {}};
  if (answered.lcp.rows.empty()) {
    answered.result.status = LcpStatus::kSolved;
  } else {
    solver_->Solve(answered.lcp.problem, &initial_f_, &answered.result);
    RequireFinite(answered.lcp.problem, answered.result);
  }
  return answered;
}

std::vector<double> ConstrainedFlow::Accelerations(const AnsweredLcp& answered) const {
  std::vector<double> accelerations;
  accelerations.reserve(3 * system_.bodies.size());
  Eigen::VectorXd reactions = Eigen::VectorXd::Zero(static_cast<Index>(3 * system_.bodies.size()));
  if (answered.lcp.problem.size() > 0) reactions = DisplacementOf(answered.lcp.problem, answered.result.f);
  Index k = 0;
  for (const Body& body : system_.bodies) {
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

void ConstrainedFlow::Step(const MotionState& from, double time, double step, MotionState* to, MotionState* error) {
  to->resize(from.size());
  MotionState estimate(from.size());
  const auto derivative = [this](const MotionState& state, MotionState& out, double at) {
    Derivative(state, at, &out);
  };
  boost::numeric::odeint::runge_kutta_fehlberg78<MotionState>().do_step(derivative, from, time, *to, step, estimate);
  if (error != nullptr) *error = std::move(estimate);
}

void ConstrainedFlow::Derivative(const MotionState& state, double time, MotionState* derivative) {
  const AnsweredLcp answered = Solve(state, time);
  const std::vector<double> accelerations = Accelerations(answered);
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

}  // namespace lcpbench
