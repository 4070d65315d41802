#include "python/core/exact.h"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "benchmarks/measure/reference_solves.h"
#include "python/core/long_work.h"
#include "python/core/pickle.h"
#include "python/core/problem.h"
#include "solvers/exact/modes/mode_search.h"
#include "support/number_text.h"

namespace lcpbench::python {
namespace {

// In this namespace, as pickle.h finds Parts by the type.
struct Certificate : ExactAnswer {};

template <typename Io>
void Parts(Io& io, Certificate& c) {
  State(io, c.status, c.fault, c.detail, c.modes, c.certified, c.complete, c.f, c.w, c.f_least_norm, c.ray, c.f_unique,
        c.w_unique, c.rank);
}

Certificate CertifyProblem(const LcpProblem& given, nb::handle time_limit, nb::handle symmetrize) {
  const double time_limit_s = ReadNumber(time_limit, "time_limit", ExactOptions().time_limit_s);
  if (!(time_limit_s > 0)) Refuse("time_limit", "is " + std::to_string(time_limit_s) + ", expected a number > 0");
  const double most_asymmetry = ReadSymmetrize(symmetrize);
  return LeavableWithoutGil(false, [=] {
    const LcpProblem problem = WithSymmetry(given, most_asymmetry);
    if (problem.Asymmetry() != 0) {
      Refuse("problem", "A has an asymmetry of " + FormatNumber(problem.Asymmetry(), "%.3g") +
                            ", expected a symmetric matrix; symmetrize= makes a small one 0");
    }
    return Certificate{Certify(ExactFrom(problem), FromSolvers(problem, time_limit_s))};
  });
}

// A list of fractions.Fraction; None where there is nothing.
template <RationalVector ExactAnswer::*member>
nb::object Fractions(const Certificate& certificate) {
  if ((certificate.*member).empty()) return nb::none();
  const nb::object fraction = nb::module_::import_("fractions").attr("Fraction");
  nb::list fractions;
  for (const Rational& value : certificate.*member) fractions.append(fraction(value.str()));
  return fractions;
}

}  // namespace

void BindExact(nb::module_& module) {
  nb::class_<Certificate>(module, "Certificate", "An answer in rational numbers, with what is proved of it.")

      .def_prop_ro(
          "status", [](const Certificate& c) { return ToString(c.status); },
          "'solved', 'infeasible', 'not positive semidefinite', 'time limit' or 'unknown'.")
      .def_ro("certified", &Certificate::certified, "Checked in exact arithmetic from the definitions.")
      .def_ro("complete", &Certificate::complete, "Whether all solutions were looked at.")
      .def_prop_ro("f", &Fractions<&Certificate::f>, nb::sig("def f(self) -> list[fractions.Fraction] | None"),
                   "(n,) a solution.")
      .def_prop_ro("w", &Fractions<&Certificate::w>, nb::sig("def w(self) -> list[fractions.Fraction] | None"),
                   "(n,) A f + b.")
      .def_prop_ro("f_least_norm", &Fractions<&Certificate::f_least_norm>,
                   nb::sig("def f_least_norm(self) -> list[fractions.Fraction] | None"),
                   "(n,) the solution of least Euclidean norm.")
      .def_prop_ro("ray", &Fractions<&Certificate::ray>, nb::sig("def ray(self) -> list[fractions.Fraction] | None"),
                   "(n,) of an infeasible problem: y >= 0 on unilateral rows, A y = 0, b.y = -1.")
      .def_ro("f_unique", &Certificate::f_unique, "Whether f is the only solution; None: not known.")
      .def_ro("w_unique", &Certificate::w_unique, "Whether w is that of every solution; None: not known.")
      .def_ro("rank", &Certificate::rank, "Of A; None: not looked at.")
      .def_ro("modes", &Certificate::modes,
              "Of f, a character a row, where there are friction or bounded rows: open O or o, closed C, stick S, "
              "slip + or -, sliding k, joint B.")
      .def_prop_ro(
          "detail", [](const Certificate& c) { return c.fault.empty() ? c.detail : c.fault; },
          "What is not known, and why.")
      .def("__repr__", [](const Certificate& c) {
        return "Certificate(status='" + std::string(ToString(c.status)) +
               "', certified=" + (c.certified ? "True)" : "False)");
      });
  MakePicklable<Certificate>(module.attr("Certificate"), [] { return Certificate(); });
  module.def("certify", &CertifyProblem, nb::arg("problem"), nb::kw_only(), nb::arg("time_limit") = nb::none(),
             nb::arg("symmetrize") = nb::none(),
             nb::sig("def certify(problem: Problem, *, time_limit: float | None = None, symmetrize: float | None = "
                     "None) -> Certificate"),
             R"(Solves a problem in rational numbers: its doubles are taken as the numbers that they are.

Plain problems need a symmetric positive semidefinite A, and take milliseconds for some tens of rows and seconds for
some hundreds; of problems with friction or bounded rows all solutions are found up to six contacts, one above.

time_limit  [s], looked at between exact solves; None: an hour
symmetrize  as of `solve`: the answer is that of (A + A^T) / 2
Raises ValueError where A is not symmetric, or has more than 4000 rows.)");
}

}  // namespace lcpbench::python
