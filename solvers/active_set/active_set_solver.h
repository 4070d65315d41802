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

/// Primal-dual active sets for problems of any size, on sparse factors that are updated where few rows change sides.
///
/// Two methods that ask for a factor of the active block with one shift after the other, and leave all work to it:
/// 1. Block pivoting with proximal steps (BppSolver): violated rows change sides all together. 4 to 15 factorisations
///    where contacts are not redundant, whatever n. Its safeguards against cycling, a heavier shift and single
///    exchanges, cost hundreds of factorisations on large redundant problems; so there, from
///    SemismoothNewtonOptions::continuation_rows on, it ends where blocks cycle, and
/// 2. SemismoothNewtonSolver goes on, by continuation from a shift of 1: the exchange goes as far as a convex function
///    falls, so that cycling cannot happen.
/// Both on a block in contact or in body space, whichever is predicted to be cheaper (ActiveBlockChoice); the one in
/// body space is updated (BodyActiveBlock).
///
/// Guaranteed: symmetric positive semidefinite A, as those two, which see; nothing in double precision. An answer is
/// claimed only if it meets the tolerance in the given form, infeasibility only with a ray that VerifyFarkasRay takes.
/// Warm start, other ways of ending, limits of time: as the two methods. Unit of `iterations` and max_iterations:
/// factors asked for, new or updated, of both together.
///
/// Cost: set-up of the second method where the first one ends, besides those of the methods.
using ActiveSetSolver = EngineSolver<ActiveSetOptions, class ActiveSetEngine>;
extern template class EngineSolver<ActiveSetOptions, ActiveSetEngine>;

}  // namespace lcpbench
