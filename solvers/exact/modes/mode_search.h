#pragma once

#include "solvers/exact/modes/mode_answer.h"

namespace lcpbench {

/// All solutions, where there are no more modes than options.most_modes: linear systems in rationals, mode by mode,
/// polyhedra of the singular ones by their vertices; without those that doubles prove to have no solution
/// (mode_proof.h). Above, one solution: the modes of the guesses, where these are right, else those at the end of
/// Lemke's path (lemke_path.h). The path takes one friction row a contact, no sliding and no bounded rows (`detail`
/// says so); its end in a ray or at a limit proves nothing.
ModeAnswer SolveByModes(const ExactLcp& problem, const ModeOptions& options);

}  // namespace lcpbench
