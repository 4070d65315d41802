#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "model/contact/assembly.h"
#include "model/geometry/feature.h"
#include "model/motion/contact_finder.h"
#include "model/scene_file/scene_file.h"
#include "model/shape/outline.h"
#include "tests/fuzz/error_law.h"

namespace lcpbench {

/// Above this many edges only the reader is tried: contacts of a thousand overlapping edges take their time.
inline constexpr std::size_t kMostFuzzedEdges = 64;

inline std::size_t CountEdges(const World& world) {
  std::size_t edges = 0;
  for (const Body& body : world.bodies) edges += body.outline.size();
  return edges;
}

/// Which promise of scene_file.h the text breaks; "" if none: it gives a valid world, which survives being written and
/// read, or an InputError of one line. What is not an InputError is thrown on.
inline std::string BrokenSceneLaw(std::string_view text) {
  const std::string where = "input";
  SceneFile scene;
  try {
    scene = ParseScene(text, where);
  } catch (const InputError& error) {
    return BrokenErrorLaw(error.what(), where + ": ");
  }
  try {
    RequireValid(scene.world);
    for (const Body& body : scene.world.bodies) {
      for (const OutlineEdge& edge : body.outline) RequireValidPiece(edge, "body '" + body.name + "'");
    }
  } catch (const InputError& error) {
    return std::string("an invalid world was accepted: ") + error.what();
  }
  if (CountEdges(scene.world) > kMostFuzzedEdges) return "";

  std::string written;
  try {
    written = FormatScene(scene);
    const std::string again = FormatScene(ParseScene(written, where));
    if (again != written) return "written twice, differs:\n" + written + again;
  } catch (const InputError& error) {
    // Moved to its centre of mass, an outline may just miss the tolerances that it met where it was drawn.
    const std::string problem = error.what();
    if (problem.find("outline") == std::string::npos) return "what was read is not written: " + problem;
  }
  try {
    const ContactFinder finder(scene.world);
    constexpr double kTolerance = 1e-3;
    const auto contacts = finder.Find(scene.world.bodies, kTolerance, kTolerance);
    static_cast<void>(AssembleContactLcp(InstantOf(scene.world, contacts)));
  } catch (const InputError&) {
    // Singular geometry, and numbers that overflow on the way.
  }
  return "";
}

}  // namespace lcpbench
