#pragma once

#include <string>

#include "benchmarks/drawing/animation.h"

namespace lcpbench {

/// A recorded motion as one HTML page that needs nothing else, neither network nor server: the bodies with their
/// contact forces, play, pause, scrub and speed, and the energies over time with a cursor. Opened with "#selftest" the
/// page works its own controls and writes what it found below itself and to the console: "selftest passed" or the
/// failures. Browsers of 2023 and later (DecompressionStream).
std::string RenderAnimationPage(const Animation& animation);

}  // namespace lcpbench
