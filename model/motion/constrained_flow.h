#pragma once

#include <Eigen/Core>
#include <vector>

#include "model/contact/assembly.h"
#include "model/contact/world.h"
#include "model/motion/motion.h"

namespace lcpbench {

/// Positions and velocities of the movable bodies, six a body in body order: x, y, theta, v_x, v_y, omega.
using MotionState = std::vector<double>;

/// An acceleration-level LCP and its answer.
struct AnsweredLcp {
  AssembledLcp lcp;
  LcpResult result;
};

/// A world's equations of motion between events: y' = (v, M^-1 (F + J^T f)), f from the contact LCP of a fixed set of
/// constraints, whose closest points are searched anew at every evaluation. [docs/model.md section 8]
/// Kinematic bodies are where their start and constant acceleration put them, x0 + v0 t + a t^2 / 2, at every time.
class ConstrainedFlow {
 public:
  /// @param world   its bodies at time 0; must outlive this
  /// @param solver  must outlive this
  ConstrainedFlow(const World& world, CountedSolver* solver)
      : start_(world.bodies), loads_(world.loads), solver_(solver), system_{world.name, world.bodies, {}} {}

  /// Movable bodies' state.
  static MotionState StateOf(const std::vector<Body>& bodies);
  /// All bodies at `time`, movable ones by `state`; what does not move is left as it is.
  void Place(const MotionState& state, double time, std::vector<Body>* bodies) const;

  /// The set that holds from now on: bilateral joints first, then contacts.
  /// @param initial_f  warm start for its solves, empty for cold ones
  void Hold(std::vector<Constraint> constraints, Eigen::VectorXd initial_f);
  const std::vector<Constraint>& held() const { return system_.constraints; }

  /// The LCP at (state, time) under the held set.  @throws InputError for singular geometry, NoFinitePoint
  AnsweredLcp Solve(const MotionState& state, double time);
  /// The system of the last Solve.
  const ContactSystem& system() const { return system_; }
  /// Its accelerations M^-1 (F + J^T f), three a body, of fixed bodies the prescribed ones.
  std::vector<double> Accelerations(const AnsweredLcp& answered) const;

  /// One step of the Fehlberg 7(8) pair [Fehlberg 1968; Boost.Odeint]; `error`, if not null, gets its estimate.
  /// @throws as Solve
  void Step(const MotionState& from, double time, double step, MotionState* to, MotionState* error);

 private:
  void Derivative(const MotionState& state, double time, MotionState* derivative);

  std::vector<Body> start_;  // kinematic bodies' law
  const Loads& loads_;
  CountedSolver* solver_;
  ContactSystem system_;
  Eigen::VectorXd initial_f_;
};

}  // namespace lcpbench
