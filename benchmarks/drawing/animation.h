#pragma once

#include <functional>
#include <string>
#include <vector>

#include "benchmarks/drawing/drawn_scene.h"
#include "model/contact/world.h"
#include "model/motion/motion.h"

namespace lcpbench {

struct BodyPose {
  Vec2 x;            ///< centre of mass [m]
  double theta = 0;  ///< [rad]
};

/// What the page shows at one time.
struct AnimationFrame {
  double time = 0;                  ///< [s]
  std::vector<BodyPose> poses;      ///< in the order of World::bodies
  std::vector<DrawnForce> forces;   ///< of the last step before `time`
  std::vector<DrawnForce> impacts;  ///< contact impulses since the frame before [N s]
  double kinetic = 0;               ///< [J]
  double potential = 0;             ///< [J]
};

/// A recorded motion.
struct Animation {
  World world;          ///< as it started
  std::string caption;  ///< solver, level: what the motion was made with
  double fps = 60;      ///< frames per second of the motion's time
  std::vector<AnimationFrame> frames;
  MotionStatistics statistics;
  /// Why the motion stopped before its time; "" where it did not.
  std::string stopped;
};

struct AnimationOptions {
  double duration = 5;  ///< [s] > 0
  double fps = 60;      ///< > 0; at most kMaxFrames frames in all
};
inline constexpr double kMaxFrames = 20000;
/// @throws InputError naming the command's option
void RequireValid(const AnimationOptions& options);

/// Moves on and takes a picture at the start and after every 1 / fps, until the duration is reached or the motion stops
/// by itself. Takes over the motion's observer. Impulses of time steps are divided by their step, so that both levels
/// of motion show forces. O(frames (bodies + forces)) memory.
/// @param progress  called after every frame with the share that is done
/// @throws InputError for options outside their ranges, and as Motion::Advance
Animation RecordAnimation(Motion* motion, const AnimationOptions& options,
                          const std::function<void(double)>& progress = {});

}  // namespace lcpbench
