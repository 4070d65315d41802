#pragma once

#include "solvers/friction/relaxation.h"

namespace lcpbench {

/// Coulomb's law as the fixed point of relaxations: each round solves the relaxation (relaxation.h) with the gaps
/// shifted by what the last one slips, b_n + mu |w_t|, and then takes a few steps of mode-newton from there [De Saxce,
/// Feng 1991; Acary, Cadoux, Lemarechal, Malick 2011]. Only b changes between rounds, and each starts at the forces of
/// the last.
///
/// Takes what the relaxation takes. No guarantee: rounds may cycle (docs/friction.md section 5 has the rate of one
/// contact). Iterations are rounds and Newton steps; the default limit is 60 rounds. kSolved is claimed only for an f
/// that passes as the verifier judges; other ends leave the best f.
using ShiftSolver = EngineSolver<WithinOptions, class ShiftEngine>;
extern template class EngineSolver<WithinOptions, ShiftEngine>;

}  // namespace lcpbench
