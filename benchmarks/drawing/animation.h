#pragma once

#include <functional>
#include <limits>
#include <nlohmann/json.hpp>
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
  std::vector<DrawnForce> cones;    ///< of friction in that step: of every cone both edges, one after the other
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
  double duration = 5;                                        ///< [s] > 0
  double fps = 60;                                            ///< > 0; at most kMaxFrames frames in all
  double budget_s = std::numeric_limits<double>::infinity();  ///< wall clock; a longer motion is stopped
};
inline constexpr double kMaxFrames = 20000;
/// @throws InputError naming the command's option
void RequireValid(const AnimationOptions& options);

/// Moves on and takes a picture at the start and after every 1 / fps, until the duration is reached or the motion stops
/// by itself. Takes over the motion's observer and check. Impulses of time steps are divided by their step, so that
/// both levels of motion show forces. O(frames (bodies + forces)) memory.
/// @param progress  called after every frame with the share that is done
/// @throws InputError for options outside their ranges, and as Motion::Advance
Animation RecordAnimation(Motion* motion, const AnimationOptions& options,
                          const std::function<void(double)>& progress = {});

/// A recorded motion as one HTML page that needs nothing else, neither network nor server: the bodies with their
/// contact forces, play, pause, scrub and speed, and the energies over time with a cursor. "#t=1.5" in
/// its address opens it at a time. Browsers of 2023 and later (DecompressionStream).
std::string RenderAnimationPage(const Animation& animation);

/// A recorded motion as the page reads it: what does not change, and the frames, packed.
struct AnimationData {
  nlohmann::ordered_json scene;
  /// Base64 of a zlib stream of 16-bit words: first all low bytes, then all high bytes. The words are, in this order:
  /// for every body with "track" in `scene`, x, y and theta of all frames, as second differences in time, with
  ///     x = track[0] + track[1] word,  y = track[2] + track[3] word,  theta = 2 pi word / 65536;
  /// then counts and columns at, at, force, force of all frames' forces that do not slide, and the same of those that
  /// do, of edges of cones and of impacts: scene.forces, slides, cones and impacts hold offset and scale per column.
  /// Their elements are differences to the element of the same number in the frame before (0 where there is none). All
  /// differences modulo 65536.
  std::string frames;
};

/// O(frames (bodies + forces)). Positions are kept to 1/65535 of every body's own travel, angles to 1e-4 rad, where
/// forces act to kVisiblePlace of a body's size, forces to kVisibleForce of those that are seldom exceeded, or both to
/// 1/65535 of their range; forces below kFaintForce of them are left out.
AnimationData PackAnimation(const Animation& animation);

inline constexpr double kVisiblePlace = 2e-3;
inline constexpr double kVisibleForce = 5e-3;
inline constexpr double kFaintForce = 5e-3;

}  // namespace lcpbench
