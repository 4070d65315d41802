#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "model/contact/world.h"
#include "model/motion/motion.h"

namespace lcpbench {

// Scene files: a World in JSON, for geometry without C++. data/scenes/ holds examples and the JSON Schema. SI units,
// angles in rad counter-clockwise, y up. [..] marks a default; unknown keys are errors, and so are keys that stand
// twice.
//
//   {"lcpbench_scene": 1,                       format version
//    "name": "cam", "description": "any text",  [name: that of the file]
//    "gravity": [0, -9.81],                     m/s^2 [none]
//    "motion": {"level": "acceleration" | "velocity", "step": 0.01, "restitution": 0.5},   wishes to the motion [none]
//    "shapes": {"link": SHAPE, ...}, "bodies": [BODY, ...], "joints": [JOINT, ...], "loads": LOADS}
//
// SHAPE is drawn in a frame of its own. It is one of
//   the ready-made ones of shapes.h by their parameters:
//     {"disc": {"radius"}}  {"box": {"width", "height"}}  {"rounded_box": {"width", "height", "corner_radius"}}
//     {"capsule": {"length", "radius"}}  {"half_disc": {"radius"}}  {"d_shape": {"straight", "radius"}}
//     {"ring": {"outer_radius", "inner_radius"}}  {"ellipse": {"a", "b"}}  {"superellipse": {"a", "b", "m"}}
//     {"gear": {"teeth", "root_radius", "tip_radius", "tip_share", "foot_share", "flank_radius"}}  [those of GearShape]
//     {"cam": {"base_radius", "nose_radius", "distance"}}  {"bowl": {"outer_radius", "inner_radius", "half_opening"}}
//   {"path": PATH, "holes": [PATH, ...]}: a closed path, counter-clockwise, and clockwise holes in it [none];
//   {"chains": [PATH, ...]}: curves of a fixed body, open (floors, walls) or closed; material on the left of travel.
//
// PATH is a list: a point to begin at, then edges, each beginning where the one before ends. A point [x, y] stands for
// the straight edge to it. A closed path ends at its first point. Edges turn "left" (counter-clockwise, material
// inside: convex) or "right" (concave):
//   {"line": {"to"}}
//   {"arc": {"to", "bulge"}}                       bulge = tan(sweep / 4), > 0 to the left; 1 is a half circle
//   {"arc": {"to", "radius", "turns", "long"}}     the shorter of the two arcs unless "long": true
//   {"arc": {"to", "center", "turns"}}             both ends equally far from the center, to 1e-9
//   {"arc": {"center", "sweep"}}                   sweep > 0 to the left; the end is derived
//   {"ellipse": {"to", "a", "b", "phi", "turns", "long"}}     as the arc of a radius; phi from the x axis to axis a [0]
//   {"ellipse": {"to", "center", "a", "b", "phi", "turns"}}   both ends on the ellipse, to 1e-9
//   {"superellipse": {"to", "center", "a", "b", "m", "phi", "turns"}}
//   {"bezier": {"control1", "control2", "to"}}     cubic
// or with every number stated, parameters s as in feature.h; these may stand first in a path, without a point:
//   {"line": {"from", "to", "s_begin", "s_end"}}   [s_begin 0, s_end 1]
//   {"arc": {"center", "radius", "s_begin", "s_end"}}, and "ellipse", "superellipse" likewise with "center", axes, m,
//   phi;
//       they turn left where s_begin < s_end; "turns" instead of a range stands for the whole curve, from s = 0
//   {"bezier": {"points": [4 points], "s_begin", "s_end"}}   [s_begin 0, s_end 1]
//
// BODY: {"name": unique, "shape": SHAPE or the name of one [none: no contacts], "fixed": true [false],
//        "density": kg/m^2, or "mass": kg with "inertia": kg m^2 about the centre of mass [that of a homogeneous plate]
//        and "center_of_mass": in the drawing [centroid; (0, 0) without shape],
//        "position", "velocity": of the drawing's origin, "angle", "angular_velocity" [all 0],
//        "acceleration", "angular_acceleration": prescribed, fixed bodies only [0]}
// So nobody needs to know where the centre of mass is: the reader moves the drawing into the body frame (MakeBody in
// mass_properties.h), and all points of joints and loads are given in the drawing's frame. A fixed body needs no mass
// (mutual attraction uses it [1]); its body frame is the drawing's, and it moves as prescribed.
//
// JOINT: two different bodies by their names, and points in their drawings. Bodies of a joint do not touch each other.
//   {"type": "pin", "body1", "body2", "point1", "point2"}, or "at" for the point where it is now, in the world
//   {"type": "rod" | "rope", "body1", "body2", "point1", "point2", "length"}     [their distance now]
//   {"type": "path", "body1", "body2", "point1", "edge2"}, or "edge1" and "point2": a point kept on an edge, given as
//   the
//       number of one of the shape's edges in drawing order, from 0, or as an edge with every number stated; optional
//       "s1" or "s2", where on the edge the closest point is sought first, and "nominal_gap" [0] (system.h)
//
// LOADS: {"springs": [{"body1", "point1", "body2", "point2", "stiffness", "rest_length"}],
//         "dampers": [{"body1", "point1", "body2", "point2", "coefficient"}],
//         "thrusters": [{"body", "point", "force"}],              force turns with the body
//         "wrenches": [{"body", "point", "force", "torque"}],     force fixed in the world
//         "attraction": {"strength", "softening"}}                loads.h; every point [centre of mass]
//
// Numbers lie within +-1e30, those that must be positive above 1e-30. Edges of all bodies together: at most 100000
// plus an eighth of the file's bytes, so that memory is proportional to the file's length.

inline constexpr int kSceneFileVersion = 1;
inline constexpr std::size_t kMaxSceneFileBytes = std::size_t{1} << 29;

/// A world, and how its author wants it to move.
struct SceneFile {
  World world;
  std::optional<MotionLevel> level;
  std::optional<double> step;         ///< [s] > 0
  std::optional<double> restitution;  ///< 0..1
};

/// @param where  what errors call the text, such as the file's name
/// @throws InputError, one line: "where: JSON pointer: expected ..., found ...", for geometry with outline and edge;
/// line
///         and column of what is not JSON. The world returned passes RequireValid (world.h), every closed shape
///         RequireValid (outline_checks.h), every edge RequireValidPiece. Time as of those checks.
SceneFile ParseScene(std::string_view text, const std::string& where);

/// @throws InputError as ParseScene, and for files that cannot be read or are longer than kMaxSceneFileBytes
SceneFile ReadSceneFile(const std::string& path);

/// The scene as JSON text that ParseScene reads back as the same world, to the last bit of every number, but for
/// Body::force and Body::torque (derived from the loads), and for names: bodies whose name is empty or taken get their
/// index appended. Outlines of fixed bodies become chains. O(size).
/// @throws InputError for a world that RequireValid refuses, and for a movable body's outline that does not bound a
///         plane shape (outline_checks.h)
std::string FormatScene(const SceneFile& scene);

}  // namespace lcpbench
