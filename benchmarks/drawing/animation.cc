#include "benchmarks/drawing/animation.h"

#include <cmath>
#include <utility>

#include "model/contact/loads.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

/// Listens to a motion between two frames.
class Listener {
 public:
  void operator()(const MotionProblem& problem) {
    if (problem.kind == MotionProblemKind::kImpact) {
      NoteImpact(problem);
    } else {
      FinishStep(problem.time);
      begun_ = true;
      begin_ = problem.time;
      forces_ = ForcesOf(problem.system, problem.rows, problem.result.f);
      impulses_ = problem.kind == MotionProblemKind::kTimeStep;
    }
  }

  /// The step that was noted last ended at `time`: its impulses are known as forces now.
  void FinishStep(double time) {
    if (!begun_) return;
    const double h = time - begin_;
    if (impulses_ && h > 0) {
      for (DrawnForce& force : forces_) force.force = (1 / h) * force.force;
    }
    if (!first_known_) first_ = forces_;
    first_known_ = true;
    impulses_ = false;
  }

  const std::vector<DrawnForce>& first() const { return first_; }
  const std::vector<DrawnForce>& last() const { return forces_; }
  std::vector<DrawnForce> TakeImpacts() { return std::exchange(impacts_, {}); }

 private:
  void NoteImpact(const MotionProblem& problem) {
    for (std::size_t i = 0; i < problem.rows.size(); ++i) {
      const double p = problem.result.f[static_cast<Index>(i)];
      if (!problem.rows[i].bilateral && std::isfinite(p) && p > 0) {
        impacts_.push_back({PlaceOf(problem.system, problem.rows[i]), p * problem.rows[i].n});
      }
    }
  }

  bool begun_ = false;
  double begin_ = 0;
  bool impulses_ = false;  // forces_ holds impulses still
  std::vector<DrawnForce> forces_;
  bool first_known_ = false;
  std::vector<DrawnForce> first_;
  std::vector<DrawnForce> impacts_;
};

double FrameCount(const AnimationOptions& options) { return std::ceil(options.duration * options.fps - 1e-9); }

AnimationFrame FrameOf(const Motion& motion) {
  AnimationFrame frame;
  frame.time = motion.time();
  const World& world = motion.world();
  frame.poses.reserve(world.bodies.size());
  for (const Body& body : world.bodies) frame.poses.push_back({body.x, body.theta});
  frame.kinetic = KineticEnergy(world.bodies);
  frame.potential = PotentialEnergy(world.loads, world.bodies);
  return frame;
}

}  // namespace

void RequireValid(const AnimationOptions& options) {
  if (!(options.duration > 0 && std::isfinite(options.duration))) throw InputError("--duration: expected seconds > 0");
  if (!(options.fps > 0 && std::isfinite(options.fps))) throw InputError("--fps: expected frames per second > 0");
  if (FrameCount(options) > kMaxFrames) throw InputError("--duration, --fps: expected at most 20000 frames");
}

Animation RecordAnimation(Motion* motion, const AnimationOptions& options,
                          const std::function<void(double)>& progress) {
  RequireValid(options);
  Animation animation;
  animation.world = motion->world();
  animation.fps = options.fps;
  Listener listener;
  motion->set_observer([&listener](const MotionProblem& problem) { listener(problem); });
  const double start = motion->time();
  animation.frames.push_back(FrameOf(*motion));
  const int frames = static_cast<int>(FrameCount(options));
  for (int k = 1; k <= frames && motion->status() == MotionStatus::kMoving; ++k) {
    // From the start, so that rounding does not add up.
    motion->Advance(start + k / options.fps - motion->time());
    listener.FinishStep(motion->time());
    AnimationFrame frame = FrameOf(*motion);
    frame.forces = listener.last();
    frame.impacts = listener.TakeImpacts();
    animation.frames.push_back(std::move(frame));
    if (progress) progress(static_cast<double>(k) / frames);
  }
  motion->set_observer({});
  animation.frames.front().forces = listener.first();
  animation.statistics = motion->statistics();
  if (motion->status() != MotionStatus::kMoving) animation.stopped = motion->detail();
  return animation;
}

}  // namespace lcpbench
