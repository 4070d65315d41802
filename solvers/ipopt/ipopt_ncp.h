#pragma once

#include "solvers/lcp/engine_solver.h"

namespace lcpbench {

/// Options of IpoptNcpSolver.
struct IpoptNcpOptions {
  /// The variables of the nonlinear programme.
  enum class Form {
    kAuto,     ///< see IpoptNcpSolver
    kContact,  ///< variables f and w, constraints with A
    kLifted,   ///< variables f, w and body velocities, constraints with J; needs factors
  };
  Form form = Form::kAuto;  ///< see Form
  /// SettingsReader::SelfCheck; without it Ipopt stops by its own tests, with the tolerance as its `tol`.
  bool self_check = true;

  /// Options `form` = auto | contact | lifted and `self_check`.
  static IpoptNcpOptions FromSettings(const Settings& settings);
};

/// The LCP with both of its sides as variables and complementarity as the objective, solved by Ipopt:
///     min f.w  subject to  w = A f + b,   f, w >= 0 on unilateral rows,   w = 0 (not a variable) on bilateral ones.
/// The value is 0 at the solutions of the LCP and nowhere else. [Cottle, Pang, Stone, sec. 1.4]
///
/// The objective is written in f alone, f.(A f + b), which is the same on the feasible set: the Hessian A + A^T is PSD
/// where A is. The literal f.w has an indefinite Hessian that is convex only along the constraints; regularised, it
/// loses that, and measured it needed up to ten times the iterations where joints are redundant.
///
/// Other ways to write complementarity, each tried with the same options and stopping test; iterations, summed over the
/// 16 scene families, at 1e-6 for n = 10 and n = 100 (all solved where nothing else is said), against 80 and 155 here:
///   the literal f.w as the objective                           80, 155
///   the convex energy plus an exact penalty on f.w             79, 150
///   f.w <= t as a constraint, t = tolerance^2                 109, 192; with a wider t 13 of 16 at n = 100
///   f_i w_i <= t row by row [Scholtes 2001], t = tolerance^2  118, 263; with a wider t 1 of 16 at n = 100
///   smoothed Fischer-Burmeister equations                     102, 179
/// The penalty on the energy is `ipopt-qp` in all but name, and equations leave Ipopt the line search of a Newton
/// method. The KKT matrix has 3n rows and A twice, against n rows and A once in `ipopt-qp`: two to five times slower.
/// All scene families are met at 1e-9 up to n = 1000; at n = 10^4 12 of 16 within 5 s, the others run out of time.
///
/// Two forms. Contact: constraints A f - w = -b. Lifted, for problems given by factors: v = S^T f with
/// S = D^-1/2 J M^-1/2, constraints S v - w = -b, objective v.v + b.f. Auto with factors: lifted alone where A has over
/// 25 times the entries of J, else contact, and lifted where contact gave no answer.
///
/// Matrix class: symmetric PSD A as `ipopt-qp` (the method converges wherever its linear algebra does, but the
/// constraints have no interior on infeasible and on barely feasible problems, hence no promise). Any other A, such as
/// that of friction, is taken by the contact form as a local method: a stationary point with f.w > 0 ends as a failure
/// (none of our 27 friction reference problems did).
///
/// Scaling, stopping test, clipping, iterations, warm start, limits and what a failure leaves behind are those of
/// `ipopt-qp` (see ipopt_qp.h). kInfeasible only with a verified ray, which this formulation rarely yields: Ipopt's own
/// Infeasible_Problem_Detected is reported as kNumericalFailure with that name in detail.
///
/// [Waechter, Biegler 2006; Mehrotra 1992]
using IpoptNcpSolver = EngineSolver<IpoptNcpOptions, class IpoptNcpEngine>;
extern template class EngineSolver<IpoptNcpOptions, IpoptNcpEngine>;

}  // namespace lcpbench
