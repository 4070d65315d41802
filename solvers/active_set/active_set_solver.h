#pragma once

#include "solvers/active_set/bpp.h"
#include "solvers/active_set/semismooth_newton.h"

namespace lcpbench {

/// Options of ActiveSetSolver: those of the two methods it is made of.
struct ActiveSetOptions {
  BppOptions blocks;  ///< block pivoting
  /// Where blocks cycle.
  SemismoothNewtonOptions newton;

  /// Keys of BppOptions and `continuation_rows`. @throws InputError for others
  static ActiveSetOptions FromSettings(const Settings& settings);
};

/// Primal-dual active sets for problems of any size, on sparse factors of which a change of few rows changes few:
/// block pivoting with proximal steps (BppSolver), and from SemismoothNewtonOptions::continuation_rows on, where blocks
/// cycle, continuation (SemismoothNewtonSolver), which cannot cycle, instead of BppSolver's costly safeguards.
///
/// Guarantees, warm start, ways of ending, limits of time: those of the two methods. Unit of iterations and
/// max_iterations: factors asked for, new or updated, of both together.
using ActiveSetSolver = EngineSolver<ActiveSetOptions, class ActiveSetEngine>;
extern template class EngineSolver<ActiveSetOptions, ActiveSetEngine>;

}  // namespace lcpbench
