#pragma once

#include <functional>
#include <string>
#include <vector>

#include "model/contact/world.h"
#include "model/geometry/vec2.h"
#include "model/motion/motion.h"

namespace lcpbench {

/// The force of one constraint on its body 1, or on body 2 where body 1 is fixed; world frame.
struct AnimationForce {
  Vec2 at;     ///< [m]
  Vec2 force;  ///< [N]
};

/// An impact's impulse at one contact.
struct AnimationImpact {
  Vec2 at;             ///< [m]
  double impulse = 0;  ///< [N s] >= 0
};

struct BodyPose {
  Vec2 x;            ///< centre of mass [m]
  double theta = 0;  ///< [rad]
};

/// What the page shows at one time.
struct AnimationFrame {
  double time = 0;                       ///< [s]
  std::vector<BodyPose> poses;           ///< in the order of World::bodies
  std::vector<AnimationForce> forces;    ///< of the last step before `time`
  std::vector<AnimationImpact> impacts;  ///< since the frame before
  double kinetic = 0;                    ///< [J]
  double potential = 0;                  ///< [J]
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
