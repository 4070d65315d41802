#include "python/core/problem.h"

#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>

#include <algorithm>
#include <initializer_list>
#include <string>
#include <tuple>
#include <utility>

#include "python/core/long_work.h"
#include "python/core/pickle.h"
#include "solvers/lcp/memory_budget.h"
#include "support/input_error.h"
#include "support/number_text.h"

namespace lcpbench::python {
namespace {

bool IsSparse(nb::handle value) { return !IsArray(value) && nb::hasattr(value, "tocsr"); }

bool IsMapping(nb::handle value) {
  if (nb::isinstance<nb::dict>(value)) return true;
  return nb::isinstance(value, nb::module_::import_("collections.abc").attr("Mapping"));
}

// Members of an object, or of a mapping, which may have no others.
class Members {
 public:
  Members(nb::handle of, const char* name, std::initializer_list<const char*> known)
      : of_(of), name_(name), is_mapping_(IsMapping(of)) {
    if (!is_mapping_) return;
    for (const nb::handle key : of.attr("keys")()) {
      const std::string found = nb::str(key).c_str();
      if (std::ranges::find(known, found) != known.end()) continue;
      std::string expected;
      for (const char* one : known) expected += (expected.empty() ? "" : ", ") + std::string(one);
      Refuse(name, "has an unknown member '" + found + "', known are " + expected);
    }
  }
  // None where it may be missing and is.
  nb::object Get(const char* member, bool may_miss = false) const {
    const bool is_there = is_mapping_ ? nb::cast<bool>(of_.attr("__contains__")(member)) : nb::hasattr(of_, member);
    if (is_there) return is_mapping_ ? nb::object(of_[member]) : nb::object(of_.attr(member));
    if (!may_miss) Refuse(name_, std::string("lacks '") + member + "'");
    return nb::none();
  }

 private:
  nb::handle of_;
  const char* name_;
  bool is_mapping_;
};

}  // namespace

std::vector<FrictionRow> ReadFriction(nb::handle friction) {
  if (friction.is_none()) return {};
  const Members of(friction, "friction", {"row", "normal", "mu", "slip"});
  const auto row = ReadVector<std::int64_t>(of.Get("row"), "friction.row");
  const auto normal = ReadVector<std::int64_t>(of.Get("normal"), "friction.normal", row.size, "rows of friction");
  const auto mu = ReadVector<double>(of.Get("mu"), "friction.mu", row.size, "rows of friction");
  const nb::object slips = of.Get("slip", true);
  Vector<std::int64_t> slip;
  if (!slips.is_none()) slip = ReadVector<std::int64_t>(slips, "friction.slip", row.size, "rows of friction");
  std::vector<FrictionRow> rows(static_cast<std::size_t>(row.size));
  for (Index k = 0; k < row.size; ++k) {
    const std::int64_t direction = slips.is_none() ? 0 : slip.data[k];
    if (direction < -1 || direction > 1) {
      Refuse("friction.slip",
             "entry " + std::to_string(k) + " is " + std::to_string(direction) + ", expected -1, 0 or 1");
    }
    rows[static_cast<std::size_t>(k)] = {row.data[k], normal.data[k], mu.data[k], static_cast<signed char>(direction)};
  }
  return rows;
}

std::vector<BoundedRow> ReadBounded(nb::handle bounded) {
  if (bounded.is_none()) return {};
  const Members of(bounded, "bounded", {"row", "lower", "upper"});
  const auto row = ReadVector<std::int64_t>(of.Get("row"), "bounded.row");
  const auto lower = ReadVector<double>(of.Get("lower"), "bounded.lower", row.size, "bounded rows");
  const auto upper = ReadVector<double>(of.Get("upper"), "bounded.upper", row.size, "bounded rows");
  std::vector<BoundedRow> rows(static_cast<std::size_t>(row.size));
  for (Index k = 0; k < row.size; ++k) rows[static_cast<std::size_t>(k)] = {row.data[k], lower.data[k], upper.data[k]};
  return rows;
}

GivenProblem::GivenProblem(const ProblemArguments& arguments) {
  const bool has_factors = !arguments.J.is_none();
  if (arguments.b.is_none()) Refuse("b", "is missing");
  if (has_factors && !arguments.A.is_none()) Refuse("J", "expected A, or J and inverse_mass, found both");
  if (!has_factors && arguments.A.is_none()) Refuse("A", "is missing, expected A, or J and inverse_mass");
  if (has_factors == arguments.inverse_mass.is_none()) {
    Refuse("inverse_mass", has_factors ? "is missing" : "is for J, found A");
  }
  TakeMatrix(has_factors ? arguments.J : arguments.A, has_factors ? "J" : "A");
  form_ = has_factors ? MatrixForm::kFactors : sparse_ ? MatrixForm::kSparse : MatrixForm::kDense;
  if (has_factors) inverse_mass_ = ReadFlat<double>(arguments.inverse_mass, "inverse_mass");
  b_ = ReadVector<double>(arguments.b, "b");
  const auto bilateral = ReadBilateral(arguments.bilateral, b_.size);
  bounds_.friction = ReadFriction(arguments.friction);
  bounds_.bounded = ReadBounded(arguments.bounded);
  if (bilateral.data != nullptr) bounds_.bilateral.assign(bilateral.data, bilateral.data + bilateral.size);
}

SparseMatrix GivenProblem::ReadSparseMatrix(nb::handle matrix, const char* name) {
  GivenProblem given;
  given.TakeMatrix(matrix, name);
  return given.MakeFactor(name);
}

void GivenProblem::TakeMatrix(nb::handle matrix, const char* name) {
  if (IsSparse(matrix)) {
    sparse_ = ReadSparse(matrix, name);
  } else {
    dense_ = ReadMatrix(matrix, name);
  }
}

GivenProblem::Sparse GivenProblem::ReadSparse(nb::handle value, const char* name) {
  nb::object given = nb::borrow(value);
  auto format = nb::cast<std::string>(nb::str(nb::getattr(given, "format", nb::str(""))));
  if (const auto dimensions = nb::len(nb::object(given.attr("shape"))); dimensions != 2) {
    Refuse(name, "expected two dimensions, found " + std::to_string(dimensions));
  }
  if (format != "csr" && format != "csc") {
    given = given.attr("tocsr")();
    format = "csr";
  }
  Sparse read = {ReadVector<std::int32_t>(given.attr("indptr"), name),
                 ReadVector<std::int32_t>(given.attr("indices"), name),
                 ReadVector<double>(given.attr("data"), name),
                 {}};
  CompressedArrays& arrays = read.arrays;
  std::tie(arrays.rows, arrays.columns) = nb::cast<std::pair<Index, Index>>(given.attr("shape"));
  arrays.by_columns = format == "csc";
  arrays.adds_parts = true;
  const Index outer = arrays.by_columns ? arrays.columns : arrays.rows;
  if (read.starts.size != outer + 1) Refuse(name, "indptr does not fit its shape");
  // SciPy's arrays may be longer than what is used of them.
  const auto entries = static_cast<std::size_t>(std::max(0, read.starts.data[outer]));
  if (entries > static_cast<std::size_t>(std::min(read.indices.size, read.values.size))) {
    Refuse(name, "indptr ends beyond its entries");
  }
  arrays.starts = {read.starts.data, static_cast<std::size_t>(read.starts.size)};
  arrays.indices = {read.indices.data, entries};
  arrays.values = {read.values.data, entries};
  return read;
}

SparseMatrix GivenProblem::MakeSparse(const char* name) const {
  try {
    return ToSparseMatrix(sparse_->arrays, name);
  } catch (const InputError& error) {
    Refuse(name, error.what());
  }
}

// J, without its zeros where it is given with them.
SparseMatrix GivenProblem::MakeFactor(const char* name) const {
  if (sparse_) return MakeSparse(name);
  using ByRows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  if (!dense_->by_columns) {
    return Eigen::Map<const ByRows>(dense_->data, dense_->rows, dense_->columns).sparseView(1.0, 0.0);
  }
  return Eigen::Map<const Eigen::MatrixXd>(dense_->data, dense_->rows, dense_->columns).sparseView(1.0, 0.0);
}

LcpProblem GivenProblem::Make(const MatrixFacts& facts) const {
  const auto vector = [](const Vector<double>& read) {
    return Eigen::Map<const Eigen::VectorXd>(read.data, read.size);
  };
  if (form_ == MatrixForm::kFactors) {
    return LcpProblem::FromFactors("", MakeFactor("J"), vector(inverse_mass_), vector(b_), bounds_, facts);
  }
  if (form_ == MatrixForm::kSparse) return LcpProblem::FromSparse("", MakeSparse("A"), vector(b_), bounds_, facts);
  const auto [rows, columns] = std::pair(dense_->rows, dense_->columns);
  RequireMemory(static_cast<double>(rows) * static_cast<double>(columns) * sizeof(double), "a copy of A");
  Eigen::MatrixXd A(rows, columns);
  constexpr Index kColumnsAtOnce = 64;
  for (Index j = 0; j < columns; j += kColumnsAtOnce) {
    if (j > 0) Cancellation::Check();  // not of few columns: it reads the clock
    const Index some = std::min(kColumnsAtOnce, columns - j);
    if (dense_->by_columns) {
      A.middleCols(j, some) = Eigen::Map<const Eigen::MatrixXd>(dense_->data + j * rows, rows, some);
    } else {
      A.middleCols(j, some) =
          Eigen::Map<const Eigen::MatrixXd>(dense_->data, columns, rows).middleRows(j, some).transpose();
    }
  }
  return LcpProblem::FromDense("", std::move(A), vector(b_), bounds_, facts);
}

double ReadSymmetrize(nb::handle symmetrize) {
  const double most = ReadNumber(symmetrize, "symmetrize", -1);
  if (!symmetrize.is_none() && !(most >= 0))
    Refuse("symmetrize", "is " + NumberText(most) + ", expected a number >= 0");
  return most;
}

LcpProblem WithSymmetry(LcpProblem problem, double symmetrize, const MatrixFacts& facts) {
  if (symmetrize < 0 || problem.Asymmetry() == 0) return problem;
  if (problem.Asymmetry() > symmetrize) {
    Refuse("symmetrize", "A has an asymmetry of " + FormatNumber(problem.Asymmetry(), "%.3g") + ", expected at most " +
                             NumberText(symmetrize));
  }
  return Symmetrized(problem, facts);
}

namespace {

void InitProblem(LcpProblem* self, nb::handle A, nb::handle b, nb::handle J, nb::handle inverse_mass,
                 nb::handle bilateral, nb::handle friction, nb::handle bounded, bool symmetric,
                 bool positive_semidefinite, int columns_per_body, nb::handle symmetrize) {
  const GivenProblem given({A, b, J, inverse_mass, bilateral, friction, bounded});
  MatrixFacts facts;
  facts.symmetric = symmetric;
  facts.positive_semidefinite = positive_semidefinite;
  facts.columns_per_body = columns_per_body;
  const double most = ReadSymmetrize(symmetrize);
  WithoutGil([&] {
    LcpProblem made = given.Make(facts);
    if (!symmetric && most < 0) {
      new (self) LcpProblem(std::move(made));
      return;
    }
    new (self) LcpProblem(Leavable(IsShort(made), [=] {
      LcpProblem problem = WithSymmetry(made, most, facts);
      if (symmetric && !problem.IsNumericallySymmetric()) {
        Refuse("symmetric", "A has an asymmetry of " + FormatNumber(problem.Asymmetry(), "%.3g") +
                                ", expected a symmetric matrix; symmetrize= makes a small one 0");
      }
      return problem;
    }));
  });
}

const char* FormOf(const LcpProblem& problem) {
  switch (problem.given_form()) {
    case MatrixForm::kDense:
      return "dense";
    case MatrixForm::kSparse:
      return "sparse";
    default:
      return "factors";
  }
}

}  // namespace

void BindProblem(nb::module_& module) {
  nb::class_<LcpProblem>(module, "Problem", R"(A problem: find f and w with

    w = A f + b,   unilateral rows: f >= 0, w >= 0, f w = 0;   bilateral rows: w = 0, f free,

friction rows |f| <= mu f_normal, opposing the slip w, and bounded rows lower <= f <= upper.

As contact, f are forces [N], w gap accelerations [m/s^2], A = J M^-1 J^T [1/kg] the Delassus matrix of the contact
Jacobian J and b the gap accelerations at zero force. Immutable: solvers and threads may share it. The arguments are
those of `solve`, and copied.

symmetric, positive_semidefinite: what is proved about A (of J always true); f_unique of a result needs both.
symmetrize: A becomes (A + A^T) / 2 where max |A_ij - A_ji| / sqrt(|A_ii A_jj|) is at most that, else it is refused.
columns_per_body: of J, 3 (bodies in the plane) or 6 (in space, in principal axes).
Raises ValueError naming the argument.)")
      .def("__init__", &InitProblem, nb::arg("A") = nb::none(), nb::arg("b") = nb::none(), nb::kw_only(),
           nb::arg("J") = nb::none(), nb::arg("inverse_mass") = nb::none(), nb::arg("bilateral") = nb::none(),
           nb::arg("friction") = nb::none(), nb::arg("bounded") = nb::none(), nb::arg("symmetric") = false,
           nb::arg("positive_semidefinite") = false, nb::arg("columns_per_body") = 3,
           nb::arg("symmetrize") = nb::none(),
           nb::sig("def __init__(self, A: object | None = None, b: numpy.typing.ArrayLike | None = None, *, "
                   "J: object | None = None, inverse_mass: numpy.typing.ArrayLike | None = None, "
                   "bilateral: numpy.typing.ArrayLike | None = None, friction: object | None = None, "
                   "bounded: object | None = None, symmetric: bool = False, positive_semidefinite: bool = False, "
                   "columns_per_body: int = 3, symmetrize: float | None = None) -> None"))
      .def("__len__", &LcpProblem::size, "The number of rows n.")
      .def_prop_ro("size", &LcpProblem::size, "The number of rows n.")
      .def_prop_ro("form", &FormOf, "How A was given: 'dense', 'sparse' or 'factors'.")
      .def_prop_ro(
          "b", [](nb::handle self) { return ViewOf(nb::cast<const LcpProblem&>(self).b(), self); },
          nb::sig("def b(self) -> numpy.typing.NDArray[numpy.float64]"),
          "(n,) gap accelerations at zero force; read-only.");
  MakePicklable<LcpProblem>(module.attr("Problem"), &EmptyProblem);
}

}  // namespace lcpbench::python
