#pragma once

#include "solvers/lcp/engine_solver.h"

namespace lcpbench {

/// Options of IpoptSolver.
struct IpoptOptions {
  /// What Ipopt is given.
  enum class Program {
    kQp,   ///< `ipopt-qp`: min 1/2 f.A f + b.f, f >= 0
    kNcp,  ///< `ipopt-ncp`: min f.w subject to w = A f + b, f, w >= 0
  };
  /// Its variables.
  enum class Form {
    kAuto,     ///< see IpoptSolver
    kContact,  ///< f, and w of kNcp; A in the Hessian or the constraints
    kLifted,   ///< body velocities as well; constraints with J; needs factors
  };
  Program program = Program::kQp;  ///< see Program
  Form form = Form::kAuto;         ///< see Form

  /// Setting `form` = auto | contact | lifted.
  void Read(SettingsReader* reader);
};

/// The LCP as a quadratic program, solved by Ipopt's interior point method.
///
/// kQp: min 1/2 f.A f + b.f subject to f >= 0 on unilateral rows, f free on bilateral ones. Its optimality conditions
/// are the LCP, w being the multiplier of f >= 0. For symmetric A only.
/// kNcp: min f.(A f + b) subject to w = A f + b, f, w >= 0 on unilateral rows, w = 0 (not a variable) on bilateral
/// ones. The value is 0 at the solutions of the LCP and nowhere else. [Cottle, Pang, Stone, sec. 1.4]
///
/// Contact form: as written. Lifted form, for problems given by factors: body velocities v = S^T f, S = D^-1/2 J
/// M^-1/2, are variables of their own, and A is never formed. Auto with factors: lifted alone where A has over 25 times
/// the entries of J, else contact, and lifted where contact gave no answer. Auto without factors: contact.
///
/// Guaranteed: symmetric PSD A of any rank to 1e-6 (kQp). Degenerate rows cost accuracy: f_i = w_i = sqrt(mu) there.
/// kNcp takes any A as a local method: a stationary point with f.w > 0 ends as a failure. docs/solvers/ipopt.md has
/// what was measured, and why Ipopt's options are as they are.
///
/// Works on the Jacobi-scaled problem with |b| = 1. Ipopt is stopped after the first iteration whose f, clipped at 0
/// and unscaled, meets the requested tier by the project's own measure (extended precision, given form); nothing is
/// claimed otherwise. Where rho passes but the backward error does not, scaled forces below a tenth of the tolerance
/// are tried as zeros. Iterates of an infeasible problem diverge along a Farkas ray: iterates and steps are tried as
/// one, and kInfeasible is claimed only with a ray that VerifyFarkasRay accepts.
///
/// Unit of `iterations`: Ipopt iterations, both forms together; default limit 200 per form. Each costs one MUMPS
/// factorization of the KKT matrix, two to four solves, and O(nnz) for the test. Warm start: initial_f and w = A f + b,
/// moved off their bounds; a start that meets the tier is returned as it is. A failure leaves in f the iterate of least
/// rho; detail names Ipopt's own status. The time limit is read after each iteration. Ipopt allocates during Solve.
/// Distinct objects may be used from distinct threads, but take turns: MUMPS is not thread-safe.
///
/// [Waechter, Biegler 2006; Mehrotra 1992]
using IpoptSolver = EngineSolver<IpoptOptions, class IpoptEngine>;
extern template class EngineSolver<IpoptOptions, IpoptEngine>;

}  // namespace lcpbench
