#include "model/motion/motion.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <variant>

#include "model/contact/path.h"
#include "support/clock.h"
#include "support/input_error.h"
#include "support/number_text.h"

namespace lcpbench {

double TreatedDepth(MotionLevel level, double width) {
  constexpr double kThinnestPart = 0.25;
  constexpr double kTolerances = 10;
  if (level == MotionLevel::kVelocity) return kThinnestPart * width;
  return std::min(kTolerances * kContactTolerance, kThinnestPart * width);
}

void RequireFinite(const LcpProblem& problem, const LcpResult& result) {
  const bool is_refused = result.status == LcpStatus::kUnsupported;
  if (!is_refused && result.f.size() == problem.size() && result.f.allFinite()) return;
  const std::string what = is_refused ? "does not take" : "gave no finite forces or impulses for";
  std::string detail =
      "the solver " + what + " problem '" + problem.id() + "' (" + std::string(ToString(result.status)) + ")";
  if (!result.detail.empty()) detail += ": " + result.detail;
  throw NoFinitePoint{detail};
}

void CountedSolver::Solve(const LcpProblem& problem, const Eigen::VectorXd* initial_f, LcpResult* result) {
  check_();
  options_.initial_f = initial_f != nullptr && initial_f->size() == problem.size() ? initial_f : nullptr;
  const double begin = SteadyNow();
  solver_.Prepare(problem);
  solver_.Solve(problem, options_, result);
  statistics_->solve_time_s += result->own_fresh_s >= 0 ? result->own_fresh_s : SteadyNow() - begin;
  ++statistics_->solves;
  if (result->status != LcpStatus::kSolved) ++statistics_->failed_solves;
}

namespace {

World Valid(World world) {
  RequireValid(world);
  for (Constraint& joint : world.joints) {
    if (joint.type != ConstraintType::kPathJoint || !joint.path.empty()) continue;
    for (const Feature& feature : {joint.feature1, joint.feature2}) {
      // The one curve with ends of its own.
      if (const auto* bezier = std::get_if<BezierEdge>(&feature)) joint.path = {{*bezier, 0, 1}};
    }
  }
  return world;
}

}  // namespace

Motion::Motion(World world, const LcpOptions& lcp, LcpSolver& solver)
    : world_(Valid(std::move(world))), solver_(solver, lcp, &statistics_, check_), finder_(world_, &check_) {}

void Motion::Advance(double duration) {
  if (!(std::isfinite(duration) && duration > 0)) {
    throw InputError("motion: the duration must be finite and > 0, found " + NumberText(duration));
  }
  try {
    Move(duration);
  } catch (const NoFinitePoint& failure) {
    status_ = MotionStatus::kSolverFailed;
    detail_ = failure.detail;
  } catch (const PathEnd& end) {
    status_ = MotionStatus::kPathEnd;
    detail_ = end.what();
  }
}

ImpulseSolver Motion::Impulses(bool observed) {
  return [this, observed](const ContactSystem& system, const std::vector<RowInfo>& rows, const LcpProblem& problem,
                          LcpResult* result) {
    solver_.Solve(problem, nullptr, result);
    RequireFinite(problem, *result);
    if (observed) Observe(MotionProblemKind::kImpact, system, rows, problem, *result);
  };
}

void Motion::NoteGaps(const ContactSystem& system, const std::vector<RowInfo>& rows) {
  double& worst = statistics_.worst_penetration;
  const auto constraint = [&](const RowInfo* row) -> const Constraint& {
    return system.constraints[static_cast<std::size_t>(row->constraint)];
  };
  std::vector<const RowInfo*> deep;
  for (const RowInfo& row : rows) {
    if (row.bilateral) {
      statistics_.worst_joint_error = std::max(statistics_.worst_joint_error, std::abs(row.d));
    } else if (constraint(&row).type != ConstraintType::kContact) {
      worst = std::max(worst, -row.d);
    } else if (-row.d > worst) {
      deep.push_back(&row);
    }
  }
  // The deepest first, which mostly is what its gap says, so that no other needs a look.
  std::sort(deep.begin(), deep.end(), [](const RowInfo* a, const RowInfo* b) { return a->d < b->d; });
  for (const RowInfo* row : deep) {
    if (-row->d <= worst) break;
    worst = std::max(worst, finder_.DepthAt(system.bodies, constraint(row), row->p1, row->p2, row->d));
  }
}

void Motion::End(const BodyOverlap& overlap) {
  statistics_.worst_penetration = std::max(statistics_.worst_penetration, overlap.depth);
  status_ = MotionStatus::kOverlap;
  detail_ = OverlapText(world_, overlap) + " at t = " + NumberText(time_) +
            " s, too deep or not met from outside: the motion cannot undo that";
}

void Motion::EndIfUntreatable(double step, double treated) {
  constexpr double kPart = 0.5;
  double fastest = 0;
  for (std::size_t i = 0; i < world_.bodies.size(); ++i) {
    const Body& body = world_.bodies[i];
    const double radius = finder_.extents()[i].radius;
    if (radius > 0) fastest = std::max(fastest, Norm(body.v) + std::abs(body.omega) * radius);
  }
  approached_ += 2 * step * fastest;
  if (status_ != MotionStatus::kMoving || approached_ < kPart * treated) return;
  approached_ = 0;
  for (const BodyOverlap& overlap : finder_.FindUntreatable(world_.bodies, treated, treated)) End(overlap);
}

void Motion::Stall(const std::string& why) {
  status_ = MotionStatus::kStalled;
  detail_ = why;
}

bool Motion::CanAdvance(double duration, double step) {
  const double end = time_ + duration;
  if (end - step < end) return true;
  Stall("steps of " + NumberText(step) + " s do not advance the time t = " + NumberText(end) + " s");
  return false;
}

void Motion::RequireAdvance(std::span<const Body> before, double step, double least) {
  for (std::size_t i = 0; i < before.size(); ++i) {
    const Body& from = before[i];
    const Body& body = world_.bodies[i];
    const auto is_lost = [&](double place, double moved, double v_before, double v) {
      return place == moved && v_before * v > 0 && std::min(std::abs(v_before), std::abs(v)) * step > least;
    };
    if (body.fixed ||
        !(is_lost(from.x.x, body.x.x, from.v.x, body.v.x) || is_lost(from.x.y, body.x.y, from.v.y, body.v.y))) {
      continue;
    }
    return Stall("body '" + body.name + "' cannot advance: its way in a step of " + NumberText(step) +
                 " s is below the spacing of doubles at its place, (" + NumberText(body.x.x) + ", " +
                 NumberText(body.x.y) + ") m");
  }
}

std::string_view ToString(MotionLevel level) {
  return level == MotionLevel::kAcceleration ? "acceleration" : "velocity";
}

MotionLevel MotionLevelFromString(std::string_view key) {
  for (const MotionLevel level : {MotionLevel::kAcceleration, MotionLevel::kVelocity}) {
    if (key == ToString(level)) return level;
  }
  throw InputError("unknown level '" + std::string(key) + "', expected acceleration or velocity");
}

std::string_view ToString(MotionProblemKind kind) {
  switch (kind) {
    case MotionProblemKind::kAcceleration:
      return "acceleration";
    case MotionProblemKind::kImpact:
      return "impact";
    case MotionProblemKind::kTimeStep:
      break;
  }
  return "time_step";
}

}  // namespace lcpbench
