#pragma once

#include "solvers/lcp/engine_solver.h"

namespace lcpbench {

/// Options of ModeNewtonSolver: none.
struct ModeNewtonOptions {};

/// Newton's method on the modes of contacts with friction [Alart, Curnier 1991]: the modes that phi - omega has (open,
/// stick, slip of either sign), then the solution in these modes. Proximal: the system has eps about the iterate on its
/// diagonal, so that redundant contacts do no harm; the step is shortened until |r| of docs/friction.md section 4
/// falls; where it does not, contact by contact sweeps go on from there, up to 2000 of them, and then proximal points
/// with an eps that is not small, each by a path of the normal map (normal_map_path.h).
///
/// Takes plain, friction, sliding and bounded rows; numerically symmetric A. No guarantee: modes may cycle, and so may
/// sweeps. Cost: a nonsymmetric factor a step, dense up to 128 unknowns, above sparse. Iterations are steps and sweeps;
/// the default limits are 200 steps and 100 proximal points. kSolved is claimed only for an f that
/// passes as the verifier judges; other ends leave the best f. Warm start: the iterate starts at initial_f.
using ModeNewtonSolver = EngineSolver<ModeNewtonOptions, class ModeNewtonEngine>;
extern template class EngineSolver<ModeNewtonOptions, ModeNewtonEngine>;

}  // namespace lcpbench
