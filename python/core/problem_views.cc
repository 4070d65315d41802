#include "python/core/problem_views.h"

#include <nanobind/ndarray.h>
#include <nanobind/stl/string.h>

#include <cstddef>
#include <utility>
#include <vector>

#include "python/core/long_work.h"
#include "solvers/io/json_lines.h"

namespace lcpbench::python {
namespace {

const LcpProblem& ProblemOf(nb::handle self) { return nb::cast<const LcpProblem&>(self); }

template <typename T>
nb::object View(const T* data, Index size, nb::handle owner) {
  return nb::cast(nb::ndarray<nb::numpy, const T, nb::ndim<1>>(data, {static_cast<std::size_t>(size)}, owner));
}

nb::object DenseA(nb::handle self) {
  const LcpProblem& problem = ProblemOf(self);
  LeavableWithoutGil(IsShort(problem), [=] { return problem.DenseA().size(); });
  const auto n = static_cast<std::size_t>(problem.size());
  return nb::cast(nb::ndarray<nb::numpy, const double, nb::ndim<2>, nb::f_contig>(problem.DenseA().data(), {n, n}, self,
                                                                                  {1, static_cast<std::int64_t>(n)}));
}

nb::object SciPyRows(const SparseMatrix& matrix, nb::handle owner) {
  const nb::object values = View(matrix.valuePtr(), matrix.nonZeros(), owner);
  const nb::object columns = View(matrix.innerIndexPtr(), matrix.nonZeros(), owner);
  const nb::object starts = View(matrix.outerIndexPtr(), matrix.outerSize() + 1, owner);
  return nb::module_::import_("scipy.sparse")
      .attr("csr_array")(nb::make_tuple(values, columns, starts),
                         nb::arg("shape") = nb::make_tuple(matrix.rows(), matrix.cols()));
}

nb::object SparseA(nb::handle self) {
  const LcpProblem& problem = ProblemOf(self);
  LeavableWithoutGil(IsShort(problem), [=] { return problem.SparseA().size(); });
  return SciPyRows(problem.SparseA(), self);
}

nb::object Factor(nb::handle self) {
  return ProblemOf(self).has_factors() ? SciPyRows(ProblemOf(self).J(), self) : nb::none();
}

nb::object InverseMass(nb::handle self) {
  return ProblemOf(self).has_factors() ? ViewOf(ProblemOf(self).inverse_mass(), self) : nb::none();
}

nb::object Bilateral(nb::handle self) {
  const LcpProblem& problem = ProblemOf(self);
  unsigned char* mask = nullptr;
  nb::object array = NewVector<unsigned char>(problem.size(), &mask);
  for (Index i = 0; i < problem.size(); ++i) mask[i] = problem.is_bilateral(i) ? 1 : 0;
  return array.attr("view")("bool");
}

// A column of row lists: a number of each row.
template <typename T, typename Row, typename Member>
nb::object Column(const std::vector<Row>& rows, Member member) {
  T* numbers = nullptr;
  nb::object array = NewVector<T>(static_cast<Index>(rows.size()), &numbers);
  // FrictionRow::slip is a number. NOLINTNEXTLINE(bugprone-signed-char-misuse)
  for (std::size_t k = 0; k < rows.size(); ++k) numbers[k] = static_cast<T>(rows[k].*member);
  return array;
}

nb::object Friction(const LcpProblem& problem) {
  const std::vector<FrictionRow>& rows = problem.friction_rows();
  if (rows.empty()) return nb::none();
  nb::dict columns;
  columns["row"] = Column<std::int64_t>(rows, &FrictionRow::row);
  columns["normal"] = Column<std::int64_t>(rows, &FrictionRow::normal);
  columns["mu"] = Column<double>(rows, &FrictionRow::mu);
  columns["slip"] = Column<std::int64_t>(rows, &FrictionRow::slip);
  return columns;
}

nb::object Bounded(const LcpProblem& problem) {
  const std::vector<BoundedRow>& rows = problem.bounded_rows();
  if (rows.empty()) return nb::none();
  nb::dict columns;
  columns["row"] = Column<std::int64_t>(rows, &BoundedRow::row);
  columns["lower"] = Column<double>(rows, &BoundedRow::lower);
  columns["upper"] = Column<double>(rows, &BoundedRow::upper);
  return columns;
}

}  // namespace

void BindProblemViews(nb::module_& module) {
  auto problem = nb::borrow<nb::class_<LcpProblem>>(module.attr("Problem"));
  problem
      .def_prop_ro("A", &DenseA, nb::sig("def A(self) -> numpy.typing.NDArray[numpy.float64]"),
                   "(n, n), F order: the Delassus matrix; of J made once, on the first request; read-only.")
      .def_prop_ro("sparse_A", &SparseA, nb::sig("def sparse_A(self) -> typing.Any"),
                   "A as a SciPy csr_array with both triangles and every diagonal entry.")
      .def_prop_ro("J", &Factor, nb::sig("def J(self) -> typing.Any"),
                   "(n, columns): the contact Jacobian as a SciPy csr_array; None where A was given.")
      .def_prop_ro("inverse_mass", &InverseMass,
                   nb::sig("def inverse_mass(self) -> numpy.typing.NDArray[numpy.float64] | None"),
                   "(columns,): the diagonal of M^-1; None where A was given.")
      .def_prop_ro("bilateral", &Bilateral, nb::sig("def bilateral(self) -> numpy.typing.NDArray[numpy.bool_]"),
                   "(n,): rows with w = 0 and f free.")
      .def_prop_ro("friction", &Friction, nb::sig("def friction(self) -> dict[str, numpy.typing.NDArray] | None"),
                   "Arrays row, normal, mu and slip of the friction rows; None: there are none.")
      .def_prop_ro("bounded", &Bounded, nb::sig("def bounded(self) -> dict[str, numpy.typing.NDArray] | None"),
                   "Arrays row, lower and upper of the bounded rows; None: there are none.")
      .def(
          "_line", [](const LcpProblem& self, const std::string& id) { return FormatLcpRecord(self, false, {}, id); },
          nb::arg("id"), "The problem as a line of a problem file (docs/formats.md).");
}

}  // namespace lcpbench::python
