#pragma once

#include "solvers/exact/modes/mode_answer.h"

namespace lcpbench {

/// One solution of a problem with many contacts: that of one of options.guesses, where these are right, else the
/// end of Lemke's path along the modes [docs/friction.md section 5; Lemke 1965; Eaves 1976], without rounding.
///
/// P(z): w = A f + b + z d, with d in the interior of the cone dual to the friction cones and 0 on joints. For large z
/// every contact is open; from there z and f change linearly in one mode after the other until z = 0. In each step one
/// wall of a cell is crossed: a contact opens, closes, sticks or slips. d is integer and drawn by row from a seed; a
/// tie, two walls at once, starts anew with another.
///
/// Takes one friction row a contact, no sliding rows, and no bounded rows on the path (`detail` says so). kUnknown
/// where the path ends in a ray, which proves nothing, or at a limit. One exact solve a step, about two steps a
/// contact.
ModeAnswer SolveAlongModes(const ExactLcp& problem, const ModeOptions& options);

}  // namespace lcpbench
