#include "python/core/result.h"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>

#include <array>
#include <cstdio>
#include <string>
#include <string_view>
#include <utility>

#include "benchmarks/measure/reference_solves.h"
#include "python/core/long_work.h"
#include "python/core/pickle.h"

namespace lcpbench::python {

template <typename Io>
void Parts(Io& io, Result& r) {
  State(io, r.problem, r.answer, r.tolerance, r.time_s, r.w, r.verdict);
}

namespace {

nb::str Text(std::string_view text) { return nb::str(text.data(), text.size()); }

nb::object ReadW(nb::handle self) {
  auto& result = nb::cast<Result&>(self);
  if (!result.w) result.problem.ComputeW(result.answer.f, &result.w.emplace());
  return ViewOf(*result.w, self);
}

nb::object ReadRay(nb::handle self) {
  const std::optional<Eigen::VectorXd>& ray = nb::cast<const Result&>(self).answer.farkas_ray;
  return ray ? ViewOf(*ray, self) : nb::none();
}

Verdict Judge(const LcpProblem& problem, const LcpResult& answer, double tolerance) {
  if (!(tolerance > 0 && tolerance < 1))
    Refuse("tolerance", "is " + std::to_string(tolerance) + ", expected a number in (0, 1)");
  return LeavableWithoutGil(IsShort(problem), [=] { return Verify(problem, answer, tolerance); });
}

const Verdict& ReadVerdict(Result& result) {
  if (!result.verdict) {
    Verdict verdict = Judge(result.problem, result.answer, result.tolerance);
    if (!result.verdict) result.verdict = std::move(verdict);  // another thread may have been faster
  }
  return *result.verdict;
}

std::optional<bool> IsUnique(Result& result) {
  if (!ReadVerdict(result).passes) return std::nullopt;
  return LeavableWithoutGil(IsShort(result.problem),
                            [problem = result.problem, f = result.answer.f, tolerance = result.tolerance] {
                              return IsOnlyAnswer(problem, f, tolerance);
                            });
}

std::string Describe(const Result& result) {
  char numbers[96];
  std::snprintf(numbers, sizeof numbers, ", n=%td, iterations=%lld, time=%.3g", result.answer.f.size(),
                static_cast<long long>(result.answer.iterations), result.time_s);
  return "Result(status='" + std::string(ToString(result.answer.status)) + "'" + numbers +
         (result.answer.detail.empty() ? ")" : ", detail='" + result.answer.detail + "')");
}

// A number, None where it was not measured.
nb::object Measured(double value) { return value == -1 ? nb::none() : nb::object(nb::float_(value)); }

nb::dict ErrorParts(const Verdict& verdict) {
  const LawMetrics& m = verdict.metrics;
  nb::dict parts;
  for (const auto& [name, value] : {std::pair{"penetration", m.penetration},
                                    {"adhesion", m.adhesion},
                                    {"separation", m.separation},
                                    {"cone", m.cone},
                                    {"dissipation", m.dissipation},
                                    {"joints", m.joints},
                                    {"beyond_bounds", m.beyond_bounds}}) {
    if (value != -1) parts[name] = value;
  }
  return parts;
}

nb::dict AllOf(const Verdict& verdict) {
  nb::dict metrics;
  for (const MetricEntry& entry : AllMetrics()) metrics[Text(entry.key)] = Measured(verdict.metrics.*entry.value);
  return metrics;
}

Verdict VerifyForces(const LcpProblem& problem, nb::handle f, double tolerance, const std::string& status,
                     nb::handle ray) {
  LcpResult answer;
  answer.status = LcpStatusFromString(status);
  const auto read = [&](nb::handle given, const char* name) -> Eigen::VectorXd {
    const Vector<double> numbers = ReadVector<double>(given, name, problem.size(), "n");
    return Eigen::Map<const Eigen::VectorXd>(numbers.data, numbers.size);
  };
  answer.f = read(f, "f");
  if (!ray.is_none()) answer.farkas_ray = read(ray, "ray");
  return Judge(problem, answer, tolerance);
}

void BindVerdict(nb::module_& module) {
  nb::class_<FarkasVerdict>(module, "RayVerdict", "What a claimed ray of infeasibility is worth.")
      .def_ro("accepted", &FarkasVerdict::accepted, "There is no solution: proved, or within rounding.")
      .def_ro("proved", &FarkasVerdict::proved, "Accepted, and nothing was rounded.")
      .def_ro("b_dot_y", &FarkasVerdict::b_dot_y, "b.y, negative for a ray.")
      .def_ro("force_min", &FarkasVerdict::force_min, "Any solution needs |D^1/2 f|_1 of this or more.")
      .def_ro("null_residual", &FarkasVerdict::null_residual, "How far A y is from 0, relative to |A||y|.")
      .def_ro("reason", &FarkasVerdict::reason, "Why it was not accepted.");
  nb::class_<Verdict>(module, "Verdict",
                      R"(The verifier's judgement of f, in extended precision, by the problem as given.

It passes tier T where f is finite, rho <= T and backward_error <= sqrt(T).)")
      .def_ro("passes", &Verdict::passes, "Whether f passes the tolerance that was asked for.")
      .def_ro("requested", &Verdict::requested, "The tolerance that was asked for.")
      .def_prop_ro(
          "rho", [](const Verdict& v) { return v.metrics.rho; },
          "Scaled natural residual, dimensionless: |min(D^1/2 f, D^-1/2 w)| / |D^-1/2 b|, D = diag A.")
      .def_prop_ro(
          "backward_error", [](const Verdict& v) { return v.metrics.backward_error; },
          "Componentwise backward error: max |min(A_ii f_i, w_i)| / (|A||f| + |b|)_i.")
      .def_prop_ro(
          "tier", [](const Verdict& v) { return v.best_tier == 0 ? nb::none() : nb::object(nb::float_(v.best_tier)); },
          nb::sig("def tier(self) -> float | None"), "The smallest of 1e-9, 1e-6, 1e-3 that f passes; None where none.")
      .def_prop_ro("parts", &ErrorParts, nb::sig("def parts(self) -> dict[str, float]"),
                   "Parts of the error where there are friction or bounded rows: penetration, adhesion, separation, "
                   "cone, dissipation, joints, beyond_bounds.")
      .def_prop_ro("metrics", &AllOf, nb::sig("def metrics(self) -> dict[str, float | None]"),
                   "All measures, None where one does not apply.")
      .def_ro("false_success", &Verdict::false_success, "Claimed solved and does not pass.")
      .def_ro("false_infeasible", &Verdict::false_infeasible, "Claimed infeasible without an accepted ray.")
      .def_prop_ro(
          "model_rho", [](const Verdict& v) { return Measured(v.model_rho); },
          nb::sig("def model_rho(self) -> float | None"),
          "Of an answer that obeys another law than Coulomb's: the residual in that.")
      .def_ro("ray", &Verdict::farkas, "Of a result with a ray, what that is worth.")
      .def_ro("reason", &Verdict::reason, "Why it does not pass.")
      .def("__repr__", [](const Verdict& v) {
        char text[128];
        std::snprintf(text, sizeof text, "Verdict(passes=%s, rho=%.3g, backward_error=%.3g, tier=%g)",
                      v.passes ? "True" : "False", v.metrics.rho, v.metrics.backward_error, v.best_tier);
        return std::string(text);
      });
  module.def(
      "verify", &VerifyForces, nb::arg("problem"), nb::arg("f"), nb::kw_only(), nb::arg("tolerance") = 1e-9,
      nb::arg("status") = "solved", nb::arg("ray") = nb::none(),
      nb::sig(
          "def verify(problem: Problem, f: numpy.typing.ArrayLike, *, tolerance: float = 1e-9, status: str = 'solved', "
          "ray: numpy.typing.ArrayLike | None = None) -> Verdict"),
      R"(Judges forces, whoever found them.

f       (n,)
status  what is claimed of f, as Result.status
ray     (n,) of a claim 'infeasible'
Raises ValueError naming the argument.)");
}

}  // namespace

nb::object StatusKey(LcpStatus status) {
  // Never freed: the interpreter ends before statics do.
  static const auto* const keys = [] {
    auto* made = new std::array<nb::object, 7>();
    for (std::size_t k = 0; k < made->size(); ++k) (*made)[k] = Text(ToString(static_cast<LcpStatus>(k)));
    return made;
  }();
  return (*keys)[static_cast<std::size_t>(status)];
}

void BindResult(nb::module_& module) {
  BindVerdict(module);
  nb::class_<Result>(module, "Result", "An answer. w, verdict and f_unique are computed when they are read.")

      .def_prop_ro(
          "f", [](nb::handle self) { return ViewOf(nb::cast<const Result&>(self).answer.f, self); },
          nb::sig("def f(self) -> numpy.typing.NDArray[numpy.float64]"),
          "(n,) forces [N], the best there are where the status is not 'solved'; read-only.")
      .def_prop_ro("w", &ReadW, nb::sig("def w(self) -> numpy.typing.NDArray[numpy.float64]"),
                   "(n,) A f + b [m/s^2], in double; read-only.")
      .def_prop_ro(
          "status", [](const Result& result) { return StatusKey(result.answer.status); },
          nb::sig("def status(self) -> str"),
          "'solved', 'infeasible', 'iteration_limit', 'time_limit', 'numerical_failure' or 'unsupported': the "
          "solver's claim, which `verdict` judges.")
      .def_prop_ro(
          "iterations", [](const Result& result) { return result.answer.iterations; },
          "Pivots, sweeps or Newton steps, as the solver counts.")
      .def_ro("time", &Result::time_s, "From the caller's arrays to f [s].")
      .def_ro("tolerance", &Result::tolerance, "That was asked for.")
      .def_prop_ro("ray", &ReadRay, nb::sig("def ray(self) -> numpy.typing.NDArray[numpy.float64] | None"),
                   "(n,) Farkas' ray of status 'infeasible': y >= 0 on unilateral rows, A y = 0, b.y < 0.")
      .def_prop_ro(
          "detail", [](const Result& result) { return result.answer.detail; }, "The reason in words, or ''.")
      .def_ro("problem", &Result::problem, "What was solved.")
      .def_prop_ro("verdict", &ReadVerdict, nb::rv_policy::reference_internal, "The verifier's judgement.")
      .def_prop_ro("f_unique", &IsUnique,
                   "Whether f is the only solution; None where that is not known (of A: only where it is given as "
                   "symmetric and positive semidefinite).")
      .def("__repr__", &Describe);
  MakePicklable<FarkasVerdict>(module.attr("RayVerdict"), [] { return FarkasVerdict(); });
  MakePicklable<Verdict>(module.attr("Verdict"), [] { return Verdict(); });
  MakePicklable<Result>(module.attr("Result"), [] { return Result{EmptyProblem(), {}}; });
}

}  // namespace lcpbench::python
