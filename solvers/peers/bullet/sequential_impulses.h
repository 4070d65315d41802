#pragma once

#include <memory>
#include <string_view>

#include "solvers/lcp/settings.h"
#include "solvers/lcp/solver.h"

namespace lcpbench {

/// btSequentialImpulseConstraintSolver, projected Gauss-Seidel over the velocities of bodies, as engines run it: keys
/// "bullet-si" (until the velocity that a sweep still corrects is small, see TierSettings) and "bullet-si-N" (N
/// sweeps).
///
/// Needs J with rows on at most two bodies. Runs of rows between the same two bodies become one btTypedConstraint whose
/// getInfo2 gives J, -b and the bounds. Nothing of the engine is left that would change w = A f + b: the bodies are at
/// rest, without load, and have neither damping nor error reduction (erp), mixing (cfm) or split impulses. Planar
/// bodies move in the xy-plane. The engine has one mass for the three directions of a body, the largest inverse one
/// here: columns whose inverse mass is another are scaled, which leaves A as it is. f starts at zero always: the engine
/// warm starts contacts only. Iterations are sweeps. Not a word of success is said with N sweeps, unless nothing moved
/// in the last.
///
/// @throws InputError for impossible settings
std::unique_ptr<LcpSolver> MakeSequentialImpulses(std::string_view key, SettingsReader* reader);

}  // namespace lcpbench
