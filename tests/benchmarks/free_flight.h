#pragma once

#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "model/contact/loads.h"
#include "model/contact/world.h"
#include "model/motion/motion.h"
#include "model/scenes/parts.h"
#include "solvers/registry.h"

namespace lcpbench {

/// The motion of a world without contacts under gravity alone, in closed form: what tests of pages need.
class FreeFlight final : public Motion {
 public:
  /// Before the end of every Advance, [s]: when the step began that the observer is told of.
  static constexpr double kStep = 1e-3;

  explicit FreeFlight(World world) : Motion(std::move(world), {}, Unused()) {}

  /// What the observer is told in every step, besides the time.
  ContactSystem system;
  std::vector<RowInfo> rows;
  LcpResult result;
  MotionProblemKind kind = MotionProblemKind::kAcceleration;
  void Stop(std::string why) {
    status_ = MotionStatus::kStalled;
    detail_ = std::move(why);
  }

 private:
  // Nothing touches anything.
  static LcpSolver& Unused() {
    static const std::unique_ptr<LcpSolver> solver = MakeSolver("dantzig");
    return *solver;
  }

  void Move(double duration) override {
    const Vec2 g = world_.loads.gravity;
    for (Body& body : world_.bodies) {
      const Vec2 a = body.fixed ? Vec2{} : g;
      body.x = body.x + duration * body.v + (duration * duration / 2) * a;
      body.v = body.v + duration * a;
      body.theta += duration * body.omega;
    }
    time_ += duration;
    ++statistics_.steps;
    if (observer_) Report();
  }

  void Report() { observer_({kind, time_ - kStep, system, rows, problem_, result}); }

  LcpProblem problem_ = LcpProblem::FromDense("none", Eigen::MatrixXd::Identity(1, 1), Eigen::VectorXd::Zero(1));
};

/// `count` discs thrown up from a line, spinning, above a fixed floor.
inline World ThrownDiscs(int count) {
  World world;
  world.name = "thrown-discs";
  world.loads.gravity = {0, -kGravity};
  Body floor = MakeFixed("floor");
  floor.outline = {WholeEdge({count + 1.0, 0}, {-1, 0})};
  world.bodies.push_back(floor);
  for (int i = 0; i < count; ++i) {
    Body disc = MakeDisc({static_cast<double>(i), 1}, 0.3, 1);
    disc.name = "disc " + std::to_string(i);
    disc.v = {0.1 * i, 5};
    disc.omega = 1 + i;
    world.bodies.push_back(disc);
  }
  return world;
}

}  // namespace lcpbench
