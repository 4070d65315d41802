#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "model/contact/body.h"
#include "model/scene_file/shape_reader.h"
#include "support/json_field.h"

namespace lcpbench {

/// The shapes of a scene file by their names.
using NamedShapes = std::map<std::string, SceneShape>;

/// The bodies of a scene file, and what joints and loads need to speak of them by their names and drawings.
struct SceneBodies {
  std::vector<Body> bodies;
  /// origins[i]: the body frame's origin in the frame that bodies[i] is drawn in: its centre of mass, (0, 0) if fixed.
  std::vector<Vec2> origins;
  std::map<std::string, int> index_of;

  Body& operator[](int index) { return bodies[static_cast<std::size_t>(index)]; }
  const Body& operator[](int index) const { return bodies[static_cast<std::size_t>(index)]; }

  /// The body that a field names.
  int Find(const JsonField& name) const;
  /// The point of the drawing that a field states, in body coordinates.
  Vec2 ReadPoint(const JsonField& field, int body) const;
  /// A body-frame point in the world.
  Vec2 WorldPoint(int body, Vec2 point) const;
  /// The body-frame point that lies now where a field states, in the world.
  Vec2 ReadPlace(const JsonField& field, int body) const;
};

/// Reads "bodies". @param most_edges  of all bodies together, so that many bodies of one long shape stay an error
/// @throws InputError naming the JSON path
SceneBodies ReadBodies(const JsonField& field, const NamedShapes& shapes, std::size_t most_edges);

}  // namespace lcpbench
