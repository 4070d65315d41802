#pragma once

#include <limits>

#include "solvers/lcp/engine_solver.h"

namespace lcpbench {

/// Options of BppSolver.
struct BppOptions {
  /// Which form of A is factored.
  enum class Form {
    kAuto,  ///< sparse where its factorization is predicted to take less time
    kDense,
    kSparse,
  };
  Form form = Form::kAuto;  ///< see Form

  /// Weight e of the proximal term against diag A at the start, dimensionless, in [1e-11, 1e-2]. Larger values keep
  /// blocks from cycling on singular A, smaller ones leave less for the outer loop to do. Above 10^4 rows it falls with
  /// the square of their number, as the least eigenvalue of A does on chains.
  double proximal = 1e-8;

  /// Where blocks cycle, the weight rises, up to this; single exchanges follow only there. Blocks that cycle at 1e-8
  /// mostly settle at 1e-2 or 1e-1. At least `proximal`; equal to it: the papers' method. In [1e-11, 100].
  double largest_proximal = 1;

  /// How many block exchanges in a row may fail to lower the least number of violated rows so far before the
  /// weight rises or single exchanges follow. [Portugal, Judice, Vicente 1994 use 3 to 10] In [1, 100].
  int patience = 3;

  /// Ends with kNumericalFailure after the first factorization if more than one row in kDependentShare of its F depends
  /// on others: blocks are likely to cycle then, and a caller may have a better method.
  bool end_when_singular = false;
  static constexpr Index kDependentShare = 50;  ///< of end_when_singular

  /// Ends with kNumericalFailure where blocks cycle, instead of raising the weight.
  bool end_when_cycling = false;

  /// From so many rows on, where blocks cycle, continuation (SemismoothNewtonSolver), which cannot cycle, goes on
  /// within what is left of the limits, instead of the costly safeguards. By default never.
  Index continuation_rows = std::numeric_limits<Index>::max();

  /// Larger problems are refused as unsupported where the dense form is used: two n x n arrays besides DenseA(). In [1,
  /// 100000].
  Index max_dense_rows = 10'000;

  /// Keys `form` (auto, dense, sparse), `proximal`, `largest_proximal`, `patience`, `end_when_singular` (yes,
  /// no), `end_when_cycling` (yes, no), `max_dense_rows` and, where it is other than never, `continuation_rows`, as of
  /// `active-set`, whose default is that of SemismoothNewtonOptions.
  void Read(SettingsReader* reader);
};

/// Block principal pivoting with a proximal outer loop (BlockPivoting). Measurements: docs/solvers/active_set.md.
///
/// Inner method [Kostreva 1978; Portugal, Judice, Vicente 1994]: for a set F of active rows, f_F solves w_F = 0 and
/// f = 0 elsewhere; all rows with f_i < 0 in F or w_i < 0 outside are violated and change sides together. If `patience`
/// exchanges in a row do not lower the least number of violated rows, blocks cycle: e (below) rises to 1e-2, then
/// tenfold each time; at `largest_proximal` only the violated row of least index changes sides [Murty 1974]. Bilateral
/// rows are always in F. Unit of iterations and max_iterations: sets F, one factorization each; default 10 n + 200.
///
/// The inner problem is that of A + e D, D = diag A, with b - e D c in the place of b: a proximal-point step from c
/// [Rockafellar 1976] with a positive definite matrix, whatever the rank of A. After each step f_F is corrected on A
/// itself, and rows violated by it change sides while their number falls. e falls to 0.3 e after each step.
///
/// Guaranteed: nothing in double precision; in exact arithmetic every solvable problem of symmetric PSD A, without a
/// polynomial bound. kSolved only after w was recomputed by the given form, kInfeasible only with a ray that
/// VerifyFarkasRay accepts.
///
/// Start: F = all rows. With initial_f whose rho is at most 5 % of the one at f = 0, F = {D f > w} and c = initial_f;
/// of any other the set alone counts. A warm start whose first set leaves more than 10 % of the rows violated, or whose
/// blocks cycle, is forgotten.
///
/// With continuation_rows (`active-set`), guarantees, warm start and ways of ending are those of the two methods, and
/// iterations are factors asked for, new or updated, of both together.
///
/// From arrays, up to 128 rows of at most two moving bodies each need no LcpProblem (RowEngine), with a dense block
/// unless `form` asks for another one. Up to six, cold and with the default options, are solved in registers by the
/// same exchanges without a proximal loop (FixedSizeBpp), which counts as one iteration.
///
/// Powers of two in A, b or single rows change no bit (ScaledVectors). Prepare analyses A: O(fill). Solve does not
/// allocate for a prepared problem, unless it reports a failure or a ray. kIterationLimit, kTimeLimit and
/// kNumericalFailure leave the best f published, zeros if none was. kUnsupported: A_ii < 0.
class BppSolver final : public EngineSolver<BppOptions, class BppEngine> {
 public:
  using EngineSolver::EngineSolver;

  /// Nanoseconds of one iteration on the prepared problem, predicted from its structure.
  double StepTime() const;
  /// Whether the prepared problem's A is factored as a dense matrix.
  bool is_dense() const;
};
extern template class EngineSolver<BppOptions, BppEngine>;

}  // namespace lcpbench
