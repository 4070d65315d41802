#pragma once

#include <string_view>

#include "solvers/lcp/settings.h"

/// Options that the first-order solvers (pgs, psor, nncg, apgd) share.
namespace lcpbench {

/// How the rows of A are walked.
enum class RowForm {
  kAuto,        ///< matrix-free where every row touches at most two bodies and that is the faster one (measured); else
                ///< assembled
  kAssembled,   ///< walks the rows of A; takes every problem
  kMatrixFree,  ///< walks the rows of J and carries body velocities M^-1 J^T f; A is never formed; needs factors
};

/// The order in which a sweep visits the rows.
enum class SweepOrder {
  kForward,    ///< as given
  kSymmetric,  ///< as given and backwards in turn
  kColoured,   ///< blocks of rows as given, within a block colour by colour: rows of one colour share no body
               ///< (assembled: no entry of A), and are stepped by fours without waiting for each other
};

/// Option `form` = auto (default) | assembled | matrix-free.
RowForm ReadRowForm(SettingsReader* reader);
/// Option `sweep` = forward | symmetric | coloured (default).
SweepOrder ReadSweepOrder(SettingsReader* reader);
/// @throws InputError naming solver and option unless `relaxation` is in (0, 2)
void CheckRelaxation(std::string_view solver, std::string_view option, double relaxation);

}  // namespace lcpbench
