#pragma once

#include "model/contact/loads.h"
#include "model/contact/world.h"
#include "model/motion/motion.h"
#include "model/scenes/parts.h"
#include "model/shape/shapes.h"
#include "solvers/registry.h"
#include "tests/support/test.h"

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
    if (observer_) observer_({kind, time_ - kStep, system, rows, problem_, result});
  }

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

/// One of everything that pictures and pages draw.
inline World Exhibition() {
  World world = ThrownDiscs(3);
  int place = 0;
  for (const Outline& outline : {Ring(0.5, 0.3), Gear({}), Superellipse(0.5, 0.3, 6), Ellipse(0.5, 0.3)}) {
    Body body = MakeBody(outline, 1);
    body.x = {1.5 * place++, 3};
    body.omega = 2;
    world.bodies.push_back(body);
  }
  Body drum = MakeFixed("drum");
  drum.outline = AllPieces(Ring(1, 0.9));
  drum.x = {6, 3};
  drum.omega = 1;
  world.bodies.push_back(drum);
  Body point;
  point.name = "point";
  point.x = {-1, 2};
  world.bodies.push_back(point);
  Body leaf;
  leaf.name = "leaf";
  leaf.x = {8, 3};
  leaf.outline = {{BezierEdge{{{{0, 0}, {1, -1}, {2, -1}, {3, 0}}}}, 0, 1},
                  {BezierEdge{{{{3, 0}, {2, 1}, {1, 1}, {0, 0}}}}, 0, 1}};
  world.bodies.push_back(leaf);
  const Vertex p{{0.1, 0}};
  const Vertex q{{0, 0.1}};
  world.joints = {{ConstraintType::kPin, 1, 2, p, q, {}, {}, 0, 3},
                  {ConstraintType::kPathJoint, 4, 0, p, EllipseEdge{{}, 2, 1, 0.3, Side::kConvex}, {}, {}, 0, 3},
                  {ConstraintType::kRod, 2, 3, p, q, {}, {}, 0, 3},
                  {ConstraintType::kRope, 5, 6, p, q, {}, {}, 0, 3}};
  world.loads.springs.push_back({{6, {}}, {7, {}}, 1, 1});
  world.loads.dampers.push_back({{6, {}}, {8, {}}, 1});
  return world;
}

}  // namespace lcpbench
