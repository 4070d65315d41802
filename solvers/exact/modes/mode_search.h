#pragma once

#include "solvers/exact/modes/mode_answer.h"

namespace lcpbench {

/// All solutions, where there are no more modes than options.most_modes: linear systems in rationals, mode by mode,
/// polyhedra of the singular ones by their vertices; without those that doubles prove to have no solution
/// (mode_proof.h). Above, one solution: the modes of the guesses, then Lemke's path along the modes (mode_path.h).
ModeAnswer SolveByModes(const ExactLcp& problem, const ModeOptions& options);

}  // namespace lcpbench
