#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "model/contact/world.h"
#include "model/motion/impact.h"
#include "model/motion/motion.h"

namespace lcpbench {

// Scene files: a World in JSON, for geometry without C++; docs/scene_files.md describes the format. SI units, angles in
// rad counter-clockwise, y up. Numbers lie within +-1e30, those that must be positive above 1e-30. Edges of all bodies
// together: at most 100000 plus an eighth of the file's bytes, so that memory is proportional to the file's length.

inline constexpr int kSceneFileVersion = 1;
inline constexpr std::size_t kMaxSceneFileBytes = std::size_t{1} << 29;

/// A world, and how its author wants it to move.
struct SceneFile {
  World world;
  std::optional<MotionLevel> level;
  std::optional<double> step;         ///< [s] > 0
  std::optional<double> restitution;  ///< 0..1
  std::optional<ImpactLaw> impact_law;
  std::optional<double> resting_speed;  ///< [m/s] >= 0
};

/// @param where  what errors call the text, such as the file's name
/// @throws InputError, one line: "where: JSON pointer: expected ..., found ...", for geometry with outline and edge;
/// line
///         and column of what is not JSON. The world returned passes RequireValid (world.h), every closed shape
///         RequireValid (outline.h), every edge RequireValidPiece. Time as of those checks.
SceneFile ParseScene(std::string_view text, const std::string& where);

/// @throws InputError as ParseScene, and for files that cannot be read or are longer than kMaxSceneFileBytes
SceneFile ReadSceneFile(const std::string& path);

/// The scene as JSON text that ParseScene reads back as the same world, to the last bit of every number, but for
/// Body::force and Body::torque (derived from the loads), and for names: bodies whose name is empty or taken get their
/// index appended. Outlines of fixed bodies become chains. O(size).
/// @throws InputError for a world that RequireValid refuses, and for a movable body's outline that does not bound a
///         plane shape (outline.h)
std::string FormatScene(const SceneFile& scene);

}  // namespace lcpbench
