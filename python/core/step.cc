#include "python/core/step.h"

#include <cstdint>
#include <functional>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "python/core/long_work.h"
#include "python/core/pickle.h"
#include "python/core/problem.h"
#include "python/core/result.h"
#include "solvers/lcp/compressed_rows.h"
#include "solvers/step/step_solver.h"
#include "support/clock.h"

namespace lcpbench::python {
namespace {

// The arrays of a step, read; the members of `rows` point into the others.
struct GivenRows {
  GivenRows(nb::handle given_body, nb::handle given_J, nb::handle given_b, nb::handle given_mass,
            nb::handle given_bilateral, nb::handle given_friction, nb::handle given_bounded)
      : b(ReadVector<double>(given_b, "b")),
        body(ReadFlat<std::int32_t>(given_body, "body")),
        inverse_mass(ReadFlat<double>(given_mass, "inverse_mass")) {
    rows.rows = b.size;
    rows.b = b.data;
    RequireSize("body", body.size, 2, "2 n");
    rows.body = body.data;
    Index size_of_J = 0;
    if (IsFloatArray(given_J)) {
      J_single = ReadFlat<float>(given_J, "J");
      rows.J_single = J_single.data;
      size_of_J = J_single.size;
    } else {
      J = ReadFlat<double>(given_J, "J");
      rows.J = J.data;
      size_of_J = J.size;
    }
    rows.columns_per_body = size_of_J == 12 * rows.rows && rows.rows > 0 ? 6 : 3;
    RequireSize("J", size_of_J, Index{2} * rows.columns_per_body, "6 n (in the plane) or 12 n (in space)");
    if (inverse_mass.size % rows.columns_per_body != 0) {
      Refuse("inverse_mass", "has " + std::to_string(inverse_mass.size) + " entries, expected " +
                                 std::to_string(rows.columns_per_body) + " for each body");
    }
    rows.bodies = inverse_mass.size / rows.columns_per_body;
    rows.inverse_mass = inverse_mass.data;
    bilateral = ReadBilateral(given_bilateral, rows.rows);
    rows.bilateral = bilateral.data;
    if (!given_friction.is_none()) rows.friction = friction = ReadFriction(given_friction);
    if (!given_bounded.is_none()) rows.bounded = bounded = ReadBounded(given_bounded);
  }
  GivenRows(const GivenRows&) = delete;
  GivenRows& operator=(const GivenRows&) = delete;

  // What is written must not be read, nor written twice.
  void RequireApart(const double* written, const char* name) const {
    RequireApart(written, name, body, "body");
    RequireApart(written, name, J, "J");
    RequireApart(written, name, J_single, "J");
    RequireApart(written, name, b, "b");
    RequireApart(written, name, inverse_mass, "inverse_mass");
    RequireApart(written, name, bilateral, "bilateral");
  }
  template <typename T>
  void RequireApart(const double* written, const char* name, const Vector<T>& other, const char* other_name) const {
    const std::less<const void*> is_before;
    if (!is_before(written, other.data + other.size) || !is_before(other.data, written + rows.rows)) return;
    Refuse(name, std::string("shares memory with ") + other_name + ", expected an array of its own");
  }

  void RequireSize(const char* name, Index size, Index of_row, const char* expected) const {
    if (size == of_row * rows.rows) return;
    Refuse(name, "has " + std::to_string(size) + " entries, expected " + expected +
                     ", with n = " + std::to_string(rows.rows) + " entries of b");
  }

  Vector<double> b;
  Vector<std::int32_t> body;
  Vector<double> inverse_mass;
  Vector<double> J;
  Vector<float> J_single;
  Vector<unsigned char> bilateral;
  std::vector<FrictionRow> friction;
  std::vector<BoundedRow> bounded;
  StepRows rows;
};

struct Answer {
  nb::object f;
  StepAnswer of;
};

struct BatchAnswer {
  nb::object f;
  std::vector<StepAnswer> problems;
};

// Threads take turns.
class Step {
 public:
  explicit Step(const StepOptions& options) : options_(options), solver_(options) {}

  nb::bytes GetState() {
    StateWriter writer;
    State(writer, options_.tolerance, options_.time_limit_s, options_.threads);
    return writer.Take();
  }
  static void SetState(Step* self, const nb::bytes& state) {
    StateReader reader(state);
    StepOptions options;
    State(reader, options.tolerance, options.time_limit_s, options.threads);
    new (self) Step(options);
  }

  void Reserve(Index max_rows, Index max_bodies) {
    WithoutGil([&] {
      const auto turn = TakeTurn(mutex_);
      solver_.Reserve(max_rows, max_bodies);
    });
  }

  Answer Solve(nb::handle body, nb::handle J, nb::handle b, nb::handle inverse_mass, nb::handle bilateral,
               nb::handle friction, nb::handle bounded, nb::handle initial_f, nb::handle f, nb::handle w) {
    const GivenRows given(body, J, b, inverse_mass, bilateral, friction, bounded);
    const Index n = given.rows.rows;
    Vector<double> start;
    if (!initial_f.is_none()) start = ReadVector<double>(initial_f, "initial_f", n, "n");
    double* forces = nullptr;
    Answer answer = {Output(f, n, &forces), {}};
    if (!initial_f.is_none() && start.data == forces) start = Copied(start);
    given.RequireApart(forces, "f");
    given.RequireApart(forces, "f", start, "initial_f");
    double* const gaps = w.is_none() ? nullptr : ReadOutput(w, "w", n);
    if (gaps != nullptr) {
      given.RequireApart(gaps, "w");
      given.RequireApart(gaps, "w", start, "initial_f");
      given.RequireApart(gaps, "w", Vector<double>{{}, forces, n}, "f");
    }
    WithoutGil([&] {
      const auto turn = TakeTurn(mutex_);
      answer.of = solver_.Solve(given.rows, start.data, forces, gaps);
    });
    return answer;
  }

  BatchAnswer SolveBatch(nb::handle body, nb::handle J, nb::handle b, nb::handle inverse_mass, nb::handle starts,
                         nb::handle bilateral, nb::handle friction, nb::handle bounded, nb::handle f) {
    const GivenRows given(body, J, b, inverse_mass, bilateral, friction, bounded);
    const auto begins = ReadVector<std::int32_t>(starts, "starts");
    const std::span<const std::int32_t> start(begins.data, static_cast<std::size_t>(begins.size));
    if (start.empty()) Refuse("starts", "is empty, expected one number more than there are problems");
    const std::string wrong = WhyNotStarts(start, given.rows.rows, "starts", "n");
    if (!wrong.empty()) Refuse("starts", wrong);
    double* forces = nullptr;
    BatchAnswer answer = {Output(f, given.rows.rows, &forces), std::vector<StepAnswer>(start.size() - 1)};
    given.RequireApart(forces, "f");
    given.RequireApart(forces, "f", begins, "starts");
    WithoutGil([&] {
      const auto turn = TakeTurn(mutex_);
      solver_.SolveBatch(given.rows, start, forces, answer.problems);
    });
    return answer;
  }

  // What `repeats` calls of StepSolver::Solve take in C++, one after the other [s]: what the cost of a call from Python
  // is compared with.
  double Time(nb::handle body, nb::handle J, nb::handle b, nb::handle inverse_mass, nb::handle f, int repeats) {
    const GivenRows given(body, J, b, inverse_mass, nb::none(), nb::none(), nb::none());
    double* const forces = ReadOutput(f, "f", given.rows.rows);
    const double begin = SteadyNow();
    for (int k = 0; k < repeats; ++k) solver_.Solve(given.rows, nullptr, forces);
    return SteadyNow() - begin;
  }

  std::int64_t fallbacks() const { return solver_.fallbacks(); }

 private:
  // Where f is written: the caller's array, or a new one.
  static nb::object Output(nb::handle f, Index n, double** forces) {
    if (f.is_none()) return NewVector(n, forces);
    *forces = ReadOutput(f, "f", n);
    return nb::borrow(f);
  }

  // A warm start in the array that the forces are written to.
  static Vector<double> Copied(const Vector<double>& start) {
    double* copy = nullptr;
    nb::object owner = NewVector(start.size, &copy);
    std::copy_n(start.data, start.size, copy);
    return {std::move(owner), copy, start.size};
  }

  StepOptions options_;
  StepSolver solver_;
  std::timed_mutex mutex_;
};

void InitStep(Step* self, nb::handle tolerance, nb::handle time_limit, int threads) {
  StepOptions options;
  options.tolerance = ReadNumber(tolerance, "tolerance", options.tolerance);
  options.time_limit_s = ReadNumber(time_limit, "time_limit", options.time_limit_s);
  options.threads = threads;
  new (self) Step(options);
}

// An array of what `read` takes of every problem.
template <typename T, typename Read>
auto OfProblems(Read read) {
  return [read](const BatchAnswer& answer) {
    T* values = nullptr;
    nb::object array = NewVector<T>(static_cast<Index>(answer.problems.size()), &values);
    for (const StepAnswer& problem : answer.problems) *values++ = static_cast<T>(read(problem));
    return array;
  };
}

nb::list Statuses(const BatchAnswer& answer) {
  nb::list statuses;
  for (const StepAnswer& problem : answer.problems) statuses.append(StatusKey(problem.status));
  return statuses;
}

constexpr const char* kStep = R"(Solves one step of an engine: rows that act on two bodies, or on one and the ground.

body          (n, 2) int32, the bodies of a row; -1: the ground
J             (n, 2 p) or (n, 2, p) float64 or float32: p = 3 numbers a body in the plane (x, y, rotation), 6 in space
              (in principal axes), of the first body, then of the second
b             (n,) gap accelerations at zero force [m/s^2]
inverse_mass  (bodies, p), >= 0; 0: cannot move
bilateral, friction, bounded  as of `solve`
initial_f     (n,) warm start: the forces of the step before, 0 for new rows
f             (n,) where the forces are written [N], which may be initial_f; None: a new array
w             (n,) where A f + b is written; None: not wanted. Neither may share memory with another argument

Arrays of these types without gaps are read in place; they are copied only where the step goes to other methods of
`auto` (`fallbacks`), as one with more than 2000 rows that hang together does. The GIL is released.
Raises ValueError naming the argument.)";

constexpr const char* kBatch = R"(Solves many problems that share no body that can move, several at once.

Problem k has the rows starts[k] to starts[k + 1] - 1 of the arrays, which are those of `solve`. Without friction and
bounded rows SIMD lanes solve a problem each; where any problem has such rows, threads do. The forces of a problem do
not depend on its neighbours, nor on the number of threads.)";

}  // namespace

void BindStep(nb::module_& module) {
  nb::class_<Answer>(module, "StepAnswer", "How a step ended.")
      .def_ro("f", &Answer::f, nb::sig("def f(self) -> numpy.typing.NDArray[numpy.float64]"), "(n,) forces [N].")
      .def_prop_ro(
          "status", [](const Answer& answer) { return StatusKey(answer.of.status); },
          nb::sig("def status(self) -> str"), "As Result.status.")
      .def_prop_ro(
          "iterations", [](const Answer& answer) { return answer.of.iterations; }, "Pivots or iterations.")
      .def_prop_ro(
          "rho", [](const Answer& answer) { return answer.of.rho; },
          "Natural residual as the solver measured it; inf where it did not.")
      .def_prop_ro(
          "infeasible_proved", [](const Answer& answer) { return answer.of.infeasible_proved; },
          "Of status 'infeasible': whether it is proved, or holds within rounding.")
      .def_prop_ro(
          "force_min", [](const Answer& answer) { return answer.of.force_min; },
          "Of status 'infeasible' within rounding: any solution needs |D^1/2 f|_1 of this or more.");
  nb::class_<BatchAnswer>(module, "BatchAnswer", "How the problems of a batch ended.")
      .def_ro("f", &BatchAnswer::f, nb::sig("def f(self) -> numpy.typing.NDArray[numpy.float64]"),
              "(n,) forces of all problems [N].")
      .def(
          "__len__", [](const BatchAnswer& answer) { return answer.problems.size(); }, "How many problems.")
      .def_prop_ro("status", &Statuses, nb::sig("def status(self) -> list[str]"), "Of each problem, as Result.status.")
      .def_prop_ro(
          "solved",
          [](const BatchAnswer& answer) {
            return nb::object(
                OfProblems<unsigned char>([](const StepAnswer& of) { return of.status == LcpStatus::kSolved; })(answer)
                    .attr("view")("bool"));
          },
          nb::sig("def solved(self) -> numpy.typing.NDArray[numpy.bool_]"), "(problems,) bool.")
      .def_prop_ro("iterations", OfProblems<std::int64_t>([](const StepAnswer& of) { return of.iterations; }),
                   nb::sig("def iterations(self) -> numpy.typing.NDArray[numpy.int64]"), "(problems,)")
      .def_prop_ro("rho", OfProblems<double>([](const StepAnswer& of) { return of.rho; }),
                   nb::sig("def rho(self) -> numpy.typing.NDArray[numpy.float64]"),
                   "(problems,) an upper bound, at most 4 times too large.");
  nb::class_<Step>(module, "StepSolver", R"(Solves step after step of an engine, from its arrays, as 'auto' does.

threads: of one solve_batch. Kept from step to step: after `reserve` a solve allocates nothing but its answer.
Threads take turns.)")
      .def("__init__", &InitStep, nb::kw_only(), nb::arg("tolerance") = 1e-9, nb::arg("time_limit") = nb::none(),
           nb::arg("threads") = 1,
           nb::sig("def __init__(self, *, tolerance: float = 1e-9, time_limit: float | None = None, threads: int = 1) "
                   "-> None"))
      .def("__getstate__", &Step::GetState)
      .def("__setstate__", [](Step& self, const nb::bytes& state) { Step::SetState(&self, state); })
      .def("reserve", &Step::Reserve, nb::arg("max_rows"), nb::arg("max_bodies"),
           "Workspace for steps of up to so many rows and bodies; larger ones allocate by themselves.")
      .def("solve", &Step::Solve, nb::arg("body"), nb::arg("J"), nb::arg("b"), nb::arg("inverse_mass"), nb::kw_only(),
           nb::arg("bilateral") = nb::none(), nb::arg("friction") = nb::none(), nb::arg("bounded") = nb::none(),
           nb::arg("initial_f") = nb::none(), nb::arg("f") = nb::none(), nb::arg("w") = nb::none(),
           nb::sig(
               "def solve(self, body: numpy.typing.ArrayLike, J: numpy.typing.ArrayLike, b: numpy.typing.ArrayLike, "
               "inverse_mass: numpy.typing.ArrayLike, *, "
               "bilateral: numpy.typing.ArrayLike | None = None, friction: object | None = None, bounded: object | "
               "None = None, "
               "initial_f: numpy.typing.ArrayLike | None = None, f: numpy.typing.NDArray[numpy.float64] | None = None, "
               "w: numpy.typing.NDArray[numpy.float64] | None = None) -> StepAnswer"),
           kStep)
      .def("solve_batch", &Step::SolveBatch, nb::arg("body"), nb::arg("J"), nb::arg("b"), nb::arg("inverse_mass"),
           nb::arg("starts"), nb::kw_only(), nb::arg("bilateral") = nb::none(), nb::arg("friction") = nb::none(),
           nb::arg("bounded") = nb::none(), nb::arg("f") = nb::none(),
           nb::sig(
               "def solve_batch(self, body: numpy.typing.ArrayLike, J: numpy.typing.ArrayLike, b: "
               "numpy.typing.ArrayLike, inverse_mass: numpy.typing.ArrayLike, "
               "starts: numpy.typing.ArrayLike, *, bilateral: numpy.typing.ArrayLike | None = None, friction: object | "
               "None = None, bounded: object | None = None, "
               "f: numpy.typing.NDArray[numpy.float64] | None = None) -> BatchAnswer"),
           kBatch)
      .def("_time", &Step::Time)
      .def_prop_ro("fallbacks", &Step::fallbacks, "How many solves went to solvers that allocate.");
}

}  // namespace lcpbench::python
