#pragma once

#include "solvers/active_set/bpp.h"
#include "solvers/active_set/semismooth_newton.h"

namespace lcpbench {

/// Options of ActiveSetSolver: those of the two methods it is made of.
struct ActiveSetOptions {
  /// Block pivoting; its `form` here: kAny for the cheapest one.
  BppOptions blocks;
  /// Where blocks cycle.
  SemismoothNewtonOptions newton;

  ActiveSetOptions() { blocks.form = BppOptions::Form::kAny; }

  /// Keys of BppOptions, with kAny as the default of `form`, and `continuation_rows`. @throws InputError for others
  static ActiveSetOptions FromSettings(const Settings& settings);
};

/// Primal-dual active sets for problems of any size, on sparse factors that are updated where few rows change sides:
/// block pivoting with proximal steps (BppSolver), and from SemismoothNewtonOptions::continuation_rows on, where blocks
/// cycle, continuation (SemismoothNewtonSolver), which cannot cycle, instead of BppSolver's costly safeguards. Both on
/// a block in contact or in body space, whichever is predicted to be cheaper (ActiveBlockChoice).
///
/// Guarantees, warm start, ways of ending, limits of time: those of the two methods. Unit of iterations and
/// max_iterations: factors asked for, new or updated, of both together.
using ActiveSetSolver = EngineSolver<ActiveSetOptions, class ActiveSetEngine>;
extern template class EngineSolver<ActiveSetOptions, ActiveSetEngine>;

}  // namespace lcpbench
