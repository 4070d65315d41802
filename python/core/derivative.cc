#include "python/core/derivative.h"

#include <nanobind/stl/string.h>

#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "python/core/long_work.h"
#include "python/core/problem.h"
#include "python/core/result.h"
#include "solvers/derivative/derivative.h"

namespace lcpbench::python {
namespace {

struct DerivativeOfProblem {
  LcpProblem problem;
  Derivative derivative;
};

struct GradientOfProblem {
  LcpProblem problem;
  ProblemGradient gradient;
};

std::optional<SparseMatrix> ReadChange(nb::handle value, const char* name) {
  if (value.is_none()) return std::nullopt;
  return GivenProblem::ReadSparseMatrix(value, name);
}

std::optional<Eigen::VectorXd> ReadOptional(nb::handle value, const char* name) {
  if (value.is_none()) return std::nullopt;
  return ReadEigen(value, name);
}

DerivativeOfProblem MakeDerivative(const LcpProblem& given, nb::handle result, double tolerance,
                                   double degeneracy_tolerance, double rank_tolerance, nb::handle symmetrize) {
  const DerivativeOptions options{tolerance, degeneracy_tolerance, rank_tolerance};
  const bool is_answer = nb::isinstance<Result>(result);
  const Eigen::VectorXd f = is_answer ? nb::cast<const Result&>(result).answer.f : ReadEigen(result, "result");
  const double most_asymmetry = ReadSymmetrize(symmetrize);
  return LeavableWithoutGil(IsShort(given), [=]() -> DerivativeOfProblem {
    const LcpProblem problem = WithSymmetry(given, most_asymmetry);
    return {problem, Derivative(problem, f, options)};
  });
}

SolutionChange Jvp(const DerivativeOfProblem& self, nb::handle dA, nb::handle dJ, nb::handle dinverse_mass,
                   nb::handle db, nb::handle dmu) {
  const ProblemChange change{ReadChange(dA, "dA"), ReadChange(dJ, "dJ"), ReadOptional(dinverse_mass, "dinverse_mass"),
                             ReadOptional(db, "db"), ReadOptional(dmu, "dmu")};
  return LeavableWithoutGil(IsShort(self.problem),
                            [=, derivative = self.derivative] { return derivative.Jvp(change); });
}

GradientOfProblem Vjp(const DerivativeOfProblem& self, nb::handle f_bar, nb::handle w_bar) {
  const Eigen::VectorXd of_f = ReadOptional(f_bar, "f_bar").value_or(Eigen::VectorXd());
  const Eigen::VectorXd of_w = ReadOptional(w_bar, "w_bar").value_or(Eigen::VectorXd());
  return LeavableWithoutGil(IsShort(self.problem), [=]() -> GradientOfProblem {
    return {self.problem, self.derivative.Vjp(of_f, of_w)};
  });
}

nb::object Copy(const Eigen::VectorXd& values) {
  double* data = nullptr;
  nb::object array = NewVector(values.size(), &data);
  std::copy(values.begin(), values.end(), data);
  return array;
}

nb::object Copy(const Eigen::MatrixXd& values) {
  const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> by_rows = values;
  const Eigen::VectorXd flat = Eigen::Map<const Eigen::VectorXd>(by_rows.data(), by_rows.size());
  return Copy(flat).attr("reshape")(values.rows(), values.cols());
}

nb::object Degenerate(const DerivativeOfProblem& self) {
  unsigned char* data = nullptr;
  const std::vector<char>& marks = self.derivative.degenerate();
  nb::object array = NewVector(static_cast<Index>(marks.size()), &data);
  std::copy(marks.begin(), marks.end(), data);
  return array.attr("astype")("bool");
}

const LcpProblem& RequireFactors(const GradientOfProblem& self) {
  if (!self.problem.has_factors()) Refuse("J", "expected a problem given by J and inverse_mass");
  return self.problem;
}

const char* ForcesKey(const DerivativeOfProblem& self) {
  switch (self.derivative.forces()) {
    case Derivative::Forces::kUnique:
      return "unique";
    case Derivative::Forces::kLeastNorm:
      return "least-norm";
    default:
      return "nearest";
  }
}

void BindChange(nb::module_& module) {
  nb::class_<SolutionChange>(module, "SolutionChange", R"(A one-sided derivative along a direction: df, dw = change.)")
      .def_prop_ro(
          "f", [](nb::handle self) { return ViewOf(nb::cast<const SolutionChange&>(self).f, self); },
          nb::sig("def f(self) -> numpy.typing.NDArray[numpy.float64]"),
          "(n,) NaN where the status is not 'solved', and where f jumps; read-only.")
      .def_prop_ro(
          "w", [](nb::handle self) { return ViewOf(nb::cast<const SolutionChange&>(self).w, self); },
          nb::sig("def w(self) -> numpy.typing.NDArray[numpy.float64]"),
          "(n,) NaN where the status is not 'solved'; read-only.")
      .def_prop_ro(
          "status", [](const SolutionChange& self) { return StatusKey(self.status); },
          nb::sig("def status(self) -> str"),
          "'solved'; 'infeasible' where there is no solution near f along the direction; else why it was not found.")
      .def_ro("detail", &SolutionChange::detail, "The reason in words, or ''.")
      .def(
          "__iter__", [](nb::handle self) { return nb::make_tuple(self.attr("f"), self.attr("w")).attr("__iter__")(); },
          nb::sig("def __iter__(self) -> Iterator[numpy.typing.NDArray[numpy.float64]]"), "f, then w.");
  nb::class_<GradientOfProblem>(module, "Gradient", "The gradient of a number in the data; parts are made when read.")
      .def_prop_ro(
          "b", [](const GradientOfProblem& self) { return Copy(self.gradient.b); },
          nb::sig("def b(self) -> numpy.typing.NDArray[numpy.float64]"), "(n,)")
      .def_prop_ro(
          "mu", [](const GradientOfProblem& self) { return Copy(self.gradient.mu); },
          nb::sig("def mu(self) -> numpy.typing.NDArray[numpy.float64]"),
          "A number for each friction row, by ascending row.")
      .def_prop_ro(
          "A", [](const GradientOfProblem& self) { return Copy(self.gradient.A()); },
          nb::sig("def A(self) -> numpy.typing.NDArray[numpy.float64]"),
          "(n, n), each entry by itself; where A stays symmetric, its symmetric part says the same.")
      .def_prop_ro(
          "J", [](const GradientOfProblem& self) { return Copy(self.gradient.J(RequireFactors(self))); },
          nb::sig("def J(self) -> numpy.typing.NDArray[numpy.float64]"),
          "(n, columns), of problems given by J: also of entries that are 0.")
      .def_prop_ro(
          "inverse_mass",
          [](const GradientOfProblem& self) { return Copy(self.gradient.InverseMass(RequireFactors(self))); },
          nb::sig("def inverse_mass(self) -> numpy.typing.NDArray[numpy.float64]"),
          "(columns,), of problems given by J.");
}

}  // namespace

void BindDerivative(nb::module_& module) {
  BindChange(module);
  nb::class_<DerivativeOfProblem>(module, "Derivative",
                                  "Derivatives of one solution in the data of its problem; see `derivative`.")
      .def_prop_ro(
          "strictly_complementary",
          [](const DerivativeOfProblem& self) { return self.derivative.strictly_complementary(); },
          "No row is degenerate: f is differentiable.")
      .def_prop_ro("degenerate", &Degenerate, nb::sig("def degenerate(self) -> numpy.typing.NDArray[numpy.bool_]"),
                   "(n,) rows at a corner of their law, f = w = 0 of a contact or f at a bound without slip.")
      .def_prop_ro(
          "f_unique",
          [](const DerivativeOfProblem& self) { return self.derivative.forces() == Derivative::Forces::kUnique; },
          "Whether f is the only solution (with friction or bounded rows: in its modes), as no rows that are closed or "
          "may "
          "close depend on each other.")
      .def_prop_ro("forces", &ForcesKey,
                   "Whose derivative it is: 'unique'; of plain problems 'least-norm', of all solutions; else "
                   "'nearest', of the solutions in the modes of f.")
      .def_prop_ro(
          "f", [](nb::handle self) { return ViewOf(nb::cast<const DerivativeOfProblem&>(self).derivative.f(), self); },
          nb::sig("def f(self) -> numpy.typing.NDArray[numpy.float64]"),
          "(n,) the forces that are differentiated; read-only.")
      .def_prop_ro(
          "w", [](nb::handle self) { return ViewOf(nb::cast<const DerivativeOfProblem&>(self).derivative.w(), self); },
          nb::sig("def w(self) -> numpy.typing.NDArray[numpy.float64]"), "(n,) A f + b; read-only.")
      .def("jvp", &Jvp, nb::kw_only(), nb::arg("dA") = nb::none(), nb::arg("dJ") = nb::none(),
           nb::arg("dinverse_mass") = nb::none(), nb::arg("db") = nb::none(), nb::arg("dmu") = nb::none(),
           nb::sig("def jvp(self, *, dA: Any = None, dJ: Any = None, dinverse_mass: ArrayLike | None = None, db: "
                   "ArrayLike | None = None, dmu: ArrayLike | None = None) -> SolutionChange"),
           R"(df, dw along a direction, from its side where the point is degenerate: df, dw = derivative.jvp(db=db).

dA             (n, n) array or SciPy sparse matrix
dJ             (n, columns), likewise; of problems given by J
dinverse_mass  (columns,), likewise
db             (n,)
dmu            a number for each friction row, by ascending row
Raises ValueError naming the argument.)")
      .def("vjp", &Vjp, nb::kw_only(), nb::arg("f_bar") = nb::none(), nb::arg("w_bar") = nb::none(),
           nb::sig("def vjp(self, *, f_bar: ArrayLike | None = None, w_bar: ArrayLike | None = None) -> Gradient"),
           R"(The gradient of a number L in the data from its gradients in f and w, (n,) each.

Where the point is degenerate: that of one mode, in which contacts that touch without force open and friction at its
bound slips. Raises ValueError naming the argument.)");
  module.def(
      "derivative", &MakeDerivative, nb::arg("problem"), nb::arg("result"), nb::kw_only(), nb::arg("tolerance") = 1e-6,
      nb::arg("degeneracy_tolerance") = 1e-8, nb::arg("rank_tolerance") = 1e-10, nb::arg("symmetrize") = nb::none(),
      nb::sig("def derivative(problem: Problem, result: Result | ArrayLike, *, tolerance: float = 1e-6, "
              "degeneracy_tolerance: float = 1e-8, rank_tolerance: float = 1e-10, symmetrize: float | None = None) -> "
              "Derivative"),
      R"(Derivatives of a solution f, w in A, or J and the inverse masses, b and mu.

    problem = lcpbench.Problem(J=J, inverse_mass=inverse_mass, b=b)
    derivative = lcpbench.derivative(problem, lcpbench.solve(J=J, inverse_mass=inverse_mass, b=b))
    df, dw = derivative.jvp(db=db)
    gradient = derivative.vjp(f_bar=f_bar)      # gradient.b, gradient.J, ...

result                an answer, or its forces (n,)
tolerance             that f must pass
degeneracy_tolerance  scaled forces and gaps up to this part of an island's largest force are 0
rank_tolerance        rows whose condition is above its reciprocal depend on each other
symmetrize            as of `solve`: the derivative is that of the problem with (A + A^T) / 2
Raises ValueError naming the argument, also where f does not solve the problem.)");
}

}  // namespace lcpbench::python
