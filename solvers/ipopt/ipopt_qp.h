#pragma once

#include "solvers/lcp/engine_solver.h"

namespace lcpbench {

/// Options of IpoptQpSolver.
struct IpoptQpOptions {
  /// The variables of the quadratic programme.
  enum class Form {
    kAuto,     ///< see IpoptQpSolver
    kContact,  ///< n variables, Hessian A
    kLifted,   ///< n + 3N variables, Hessian diag(0, I); needs factors
  };
  Form form = Form::kAuto;  ///< see Form
  /// SettingsReader::SelfCheck; without it Ipopt stops by its own tests, with the tolerance as its `tol`.
  bool self_check = true;

  /// Options `form` = auto | contact | lifted and `self_check`.
  static IpoptQpOptions FromSettings(const Settings& settings);
};

/// The LCP as a convex QP, solved by Ipopt's interior point method:
///     min 1/2 f.A f + b.f    subject to  f >= 0 on unilateral rows, f free on bilateral ones.
/// Its optimality conditions are the LCP, w being the multiplier of f >= 0.
///
/// Two forms. Contact: as written; the KKT matrix is A + diag. Lifted, for problems given by factors: body velocities
/// v = S^T f, S = D^-1/2 J M^-1/2, are variables of their own and the objective is 1/2 v.v + b.f; A is never formed and
/// the KKT matrix has the entries of J. Contact is three to five times as fast on piles and chains, lifted where many
/// rows share a body (A is dense there). Auto with factors: lifted alone where A has over 25 times the entries of J,
/// else contact, and lifted where contact gave no answer (redundant joints have no barrier term on their null space,
/// and each form fails on problems of its own there). Auto without factors: contact.
///
/// Matrix class: symmetric PSD, of any rank; A must be symmetric (to rounding) or the problem is refused. An indefinite
/// A is taken and may fail. Degenerate rows cost accuracy: f_i = w_i = sqrt(mu) there. On our 189 solvable reference
/// problems 1e-6 is always met, and 1e-9 wherever factors are given; from A alone redundant joints may miss 1e-9. All
/// scene families are met at 1e-9 up to n = 1000, and at n = 10^4 given time: within 5 s 14 of 16, the other two
/// (discs-in-v, boxes-and-discs) being redundant ones whose factors fill in.
///
/// Out of reach, whatever the options: microseconds at small n. A call of Debian's MUMPS 5.5, three of which make an
/// iteration, takes 20 us to add up the size of its own structures, and Ipopt 3.11 asks the kernel for CPU times at
/// every step: together two fifths of the time at n = 10.
///
/// Works on the Jacobi-scaled problem with |b| = 1. Ipopt runs its Mehrotra predictor-corrector mode; it is stopped
/// after the first iteration whose f, clipped at 0 and unscaled, meets the requested tier by the project's own measure
/// (extended precision, given form), and nothing is claimed otherwise. Where rho passes but the backward error does
/// not, scaled forces below a tenth of the tolerance are tried as zeros. Every Ipopt option set, with its reason,
/// stands in ipopt_engine.cc.
///
/// On an infeasible problem the iterates diverge along a Farkas ray: iterates and steps are tried as one, and
/// kInfeasible is claimed only with a ray that VerifyFarkasRay accepts.
///
/// Unit of `iterations`: Ipopt iterations, both forms together; default limit 200 per form. An iteration is one MUMPS
/// factorisation of the KKT matrix and two to four solves, plus O(nnz) for the test. Set-up: A, or S, and Ipopt's
/// objects. Warm start: initial_f and w = A f + b, moved off their bounds, primal and dual; a start that meets the tier
/// is returned as it is. A failure leaves in f the iterate of least rho; detail names Ipopt's own status.
/// kIterationLimit: the limit; kTimeLimit is read after each iteration, so that one factorisation may overrun it. Ipopt
/// allocates during Solve. Distinct objects may be used from distinct threads, but take turns: MUMPS is not
/// thread-safe.
///
/// [Waechter, Biegler 2006; Mehrotra 1992]
using IpoptQpSolver = EngineSolver<IpoptQpOptions, class IpoptQpEngine>;
extern template class EngineSolver<IpoptQpOptions, IpoptQpEngine>;

}  // namespace lcpbench
