#include <cstddef>
#include <string>

#include "model/contact/assembly.h"
#include "model/geometry/feature.h"
#include "model/motion/contact_finder.h"
#include "model/scene_file/scene_file.h"
#include "model/shape/outline.h"
#include "tests/fuzz/error_law.h"
#include "tests/fuzz/laws.h"

namespace lcpbench {

std::string BrokenSceneLaw(const std::string& text) {
  return BrokenReadingLaw("input: ", [&](bool* is_read) -> std::string {
    const SceneFile scene = ParseScene(text, "input");
    *is_read = true;
    RequireValid(scene.world);
    std::size_t edges = 0;
    for (const Body& body : scene.world.bodies) {
      edges += body.outline.size();
      for (const OutlineEdge& edge : body.outline) RequireValidPiece(edge, "body '" + body.name + "'");
    }
    constexpr std::size_t kMostEdges = 64;  // contacts of a thousand overlapping edges take their time
    if (edges > kMostEdges) return "";
    try {
      const std::string written = FormatScene(scene);
      const std::string again = FormatScene(ParseScene(written, "input"));
      if (again != written) return "written twice, differs:\n" + written + again;
    } catch (const InputError& error) {
      // Moved to its centre of mass, an outline may just miss the tolerances that it met where it was drawn.
      if (std::string(error.what()).find("outline") == std::string::npos) throw;
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
  });
}

}  // namespace lcpbench
