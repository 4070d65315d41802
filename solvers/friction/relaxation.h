#pragma once

#include <functional>
#include <memory>
#include <string>

#include "solvers/lcp/engine_solver.h"

namespace lcpbench {

/// The relaxation of a problem with up to one friction row a contact, without sliding and bounded rows, as a plain
/// problem: rows J_n + mu J_t and J_n - mu J_t take the place of a contact's rows n and t, at the place of n; a contact
/// with mu = 0 keeps its row n alone. O(nnz) from factors.
LcpProblem RelaxationOf(const LcpProblem& problem);

/// Options of RelaxationSolver, ShiftSolver and LaggedBoundsSolver: solvers that hand problems without friction on.
struct WithinOptions {
  /// Makes the solver of the problems within, which have no friction rows: `auto` in the registry. Not a setting.
  std::function<std::unique_ptr<LcpSolver>()> make_plain;
  /// Of RelaxationSolver: the part of the tolerance that the solver within is asked for. Below 1 for one that stops at
  /// a residual, which is relative to another load there.
  double of_tolerance = 1;
};

/// Contact with friction relaxed to a problem without: f in the friction cones, w in their duals, f.w = 0. In the plane
/// that is exactly the LCP of two unilateral rows a contact, J_n +- mu J_t, with forces a+ and a-: f_n = a+ + a-, f_t =
/// mu (a+ - a-); `auto` solves it. [docs/friction.md section 1; Anitescu 2006; Todorov 2014]
///
/// A model of its own (LcpResult::model): a contact that slips also opens, w_n = mu |w_t|. Where no contact with a
/// force slips its answer obeys Coulomb's law. A contact with mu = 0 keeps its one row. `detail`
/// of a solved problem says that the answer is the relaxed law's.
///
/// Takes friction rows, one a contact, beside plain rows; symmetric positive semidefinite A, as `auto`. Refuses plain
/// problems, sliding and bounded rows, and several friction rows a contact. Status, iterations, ray and guarantees are
/// those of `auto` on the relaxed problem, but for two: a ray of that is not one of the given problem, so that
/// kInfeasible becomes kNumericalFailure, as does kSolved where Verdict::model_rho is above the tolerance. Cost:
/// RelaxationOf and one solve.
using RelaxationSolver = EngineSolver<WithinOptions, class RelaxationEngine>;
extern template class EngineSolver<WithinOptions, RelaxationEngine>;

}  // namespace lcpbench
