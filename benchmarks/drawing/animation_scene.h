#pragma once

#include <nlohmann/json.hpp>

#include "benchmarks/drawing/animation.h"

namespace lcpbench {

/// What does not change in a recorded motion, for the page: name, caption, statistics, colours, the view that holds
/// most of the motion [m], every body's outline once (paths of SVG in the body frame, y up, `unit` path units per
/// metre), connectors between bodies, and the frames' energies. O(bodies + frames).
nlohmann::ordered_json SceneJson(const Animation& animation);

}  // namespace lcpbench
