#pragma once

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

/// Option `form` = auto (default) | assembled | matrix-free.
RowForm ReadRowForm(SettingsReader* reader);

}  // namespace lcpbench
