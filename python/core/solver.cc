#include "python/core/solver.h"

#include <nanobind/stl/string.h>

#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "python/core/long_work.h"
#include "python/core/pickle.h"
#include "python/core/problem.h"
#include "python/core/result.h"
#include "solvers/registry.h"
#include "support/clock.h"
#include "support/input_error.h"

namespace lcpbench::python {
namespace {

constexpr const char* kSolveSignature =
    "def solve(A: object | None = None, b: numpy.typing.ArrayLike | None = None, *, "
    "J: object | None = None, inverse_mass: numpy.typing.ArrayLike | None = None, "
    "bilateral: numpy.typing.ArrayLike | None = None, friction: object | None = None, bounded: object | None = None, "
    "solver: str = 'auto', tolerance: float = 1e-9, initial_f: numpy.typing.ArrayLike | None = None, "
    "time_limit: float | None = None, max_iterations: int = 0, symmetrize: float | None = None, **settings) -> Result";
constexpr const char* kSolve = R"(Solves one problem: w = A f + b under the laws of its rows (see Problem).

A               (n, n) array, C or F order, or SciPy sparse matrix with both triangles; or a Problem, alone
b               (n,) gap accelerations at zero force [m/s^2]
J               (n, columns) array or SciPy sparse matrix, for A = J M^-1 J^T; body k has the columns 3k to 3k + 2
inverse_mass    (columns,) or (bodies, 3), the diagonal of M^-1, >= 0
bilateral       rows with w = 0 and f free: (n,) bool, or indices
friction        tangent rows: object or dict of arrays `row`, `normal` (the contact's row), `mu`, and, where contacts
                slide in a known direction, `slip` (0, 1 or -1)
bounded         rows with lower <= f <= upper: object or dict of arrays `row`, `lower`, `upper`
solver          a key of available_solvers()
tolerance       bound on the scaled natural residual rho, in (0, 1)
initial_f       (n,) warm start
time_limit      [s]; None: none
max_iterations  in the solver's own unit; 0: its default
symmetrize      A becomes (A + A^T) / 2 where max |A_ij - A_ji| / sqrt(|A_ii A_jj|) is at most that, else it is refused
settings        options of the solver, by its own names

A problem that is hard or has no solution is a status of the result. Ctrl-C ends the call. The GIL is released: other threads must not change
the arrays during the call. They are copied once, so that the result does not change with them afterwards.
Raises ValueError naming the argument, MemoryError where more memory is needed than there is.)";

// Options by name, as the registry takes them: True is yes.
Settings ReadSettings(const nb::kwargs& given) {
  Settings settings;
  for (const auto& [name, value] : given) {
    const nb::object text = PyBool_Check(value.ptr()) ? nb::str(value.is(Py_True) ? "yes" : "no") : nb::str(value);
    settings.emplace(nb::cast<std::string>(name), nb::cast<std::string>(text));
  }
  return settings;
}

std::string_view ReadKey(nb::handle key) {
  Py_ssize_t size = 0;
  const char* const text = PyUnicode_Check(key.ptr()) ? PyUnicode_AsUTF8AndSize(key.ptr(), &size) : nullptr;
  if (text == nullptr) Refuse("solver", "expected a key of available_solvers()");
  return {text, static_cast<std::size_t>(size)};
}

LcpOptions ReadOptions(nb::handle tolerance, nb::handle time_limit, std::int64_t max_iterations) {
  LcpOptions options;
  options.tolerance = ReadNumber(tolerance, "tolerance", options.tolerance);
  options.time_limit_s = ReadNumber(time_limit, "time_limit", options.time_limit_s);
  options.max_iterations = max_iterations;
  return options;
}

std::optional<Eigen::VectorXd> ReadStart(nb::handle initial_f) {
  if (initial_f.is_none()) return std::nullopt;
  return ReadEigen(initial_f, "initial_f");
}

// Where this is interrupted, the solver may be at work still.
LcpResult SolveLeavable(const std::shared_ptr<LcpSolver>& solver, const LcpProblem& problem, LcpOptions options,
                        std::optional<Eigen::VectorXd> start) {
  LcpResult answer;
  if (IsShort(problem)) {  // whose time copies would show in
    if (start) options.initial_f = &*start;
    solver->Solve(problem, options, &answer);
    return answer;
  }
  return Leavable(false, [=, start = std::move(start)]() mutable {
    if (start) options.initial_f = &*start;
    solver->Solve(problem, options, &answer);
    return answer;
  });
}

// A solver object that has solved other problems gives the bits of a new one (LcpSolver), so that each thread keeps its
// last one; but not what it holds of large problems, nor one that was interrupted. Who has it takes it: handlers of
// signals may call within a call.
class ThreadSolver {
 public:
  ThreadSolver(std::string_view key, Settings settings) {
    if (kept_ == nullptr || kept_->key != key || kept_->settings != settings) {
      std::shared_ptr<LcpSolver> solver = MakeSolver(key, settings);
      kept_ = std::make_unique<Kept>(std::string(key), std::move(settings), std::move(solver));
    }
  }
  ThreadSolver(const ThreadSolver&) = delete;
  ThreadSolver& operator=(const ThreadSolver&) = delete;
  ~ThreadSolver() {
    if (may_stay_) OfThread() = std::move(kept_);
  }

  LcpResult Solve(const LcpProblem& problem, const LcpOptions& options, std::optional<Eigen::VectorXd> start) {
    LcpResult answer = SolveLeavable(kept_->solver, problem, options, std::move(start));
    may_stay_ = problem.size() <= kMostKeptRows;
    return answer;
  }

 private:
  static constexpr Index kMostKeptRows = 1000;
  struct Kept {
    std::string key;
    Settings settings;
    std::shared_ptr<LcpSolver> solver;
  };
  static std::unique_ptr<Kept>& OfThread() {
    thread_local std::unique_ptr<Kept> kept;
    return kept;
  }
  std::unique_ptr<Kept> kept_ = std::move(OfThread());
  bool may_stay_ = false;
};

nb::object Solve(nb::handle A, nb::handle b, nb::handle J, nb::handle inverse_mass, nb::handle bilateral,
                 nb::handle friction, nb::handle bounded, nb::handle solver, nb::handle tolerance, nb::handle initial_f,
                 nb::handle time_limit, std::int64_t max_iterations, nb::handle symmetrize,
                 const nb::kwargs& settings) {
  std::optional<GivenProblem> given;
  const LcpProblem* made = nullptr;
  if (!IsArray(A) && nb::try_cast<const LcpProblem*>(A, made) && made != nullptr) {
    for (const auto& [name, value] : {std::pair{"b", b},
                                      {"J", J},
                                      {"inverse_mass", inverse_mass},
                                      {"bilateral", bilateral},
                                      {"friction", friction},
                                      {"bounded", bounded}}) {
      if (!value.is_none()) Refuse(name, "is part of the Problem already");
    }
  } else {
    given.emplace(ProblemArguments{A, b, J, inverse_mass, bilateral, friction, bounded});
  }
  const LcpOptions options = ReadOptions(tolerance, time_limit, max_iterations);
  std::optional<Eigen::VectorXd> start = ReadStart(initial_f);
  const double most_asymmetry = ReadSymmetrize(symmetrize);
  ThreadSolver backend(ReadKey(solver), ReadSettings(settings));
  LcpResult answer;
  std::optional<LcpProblem> problem;
  double time_s = 0;
  WithoutGil([&] {
    const double begin = SteadyNow();
    problem = WithSymmetry(given ? given->Make() : *made, most_asymmetry);
    answer = backend.Solve(*problem, options, std::move(start));
    time_s = SteadyNow() - begin;
  });
  return nb::cast(Result{std::move(*problem), std::move(answer), options.tolerance, time_s});
}

// A solver with its problem and workspace. Threads take turns.
class Solver {
 public:
  Solver(std::string_view key, Settings settings, const LcpOptions& options)
      : solver_(MakeSolver(key, settings)), key_(key), settings_(std::move(settings)), options_(options) {}

  const std::string& key() const { return key_; }

  void Setup(const LcpProblem& given, nb::handle symmetrize) {
    const double most_asymmetry = ReadSymmetrize(symmetrize);
    WithoutGil([&] {
      const auto turn = TakeTurn(mutex_);
      try {
        problem_ = Leavable(IsShort(given), [=, solver = solver_] {
          LcpProblem problem = WithSymmetry(given, most_asymmetry);
          solver->Prepare(problem);
          return problem;
        });
      } catch (const Cancelled&) {
        solver_ = MakeSolver(key_, settings_);
        throw;
      }
    });
  }

  nb::bytes GetState() {
    StateWriter writer;
    WithoutGil([&] {
      const auto turn = TakeTurn(mutex_);
      std::vector<std::string> words = {key_};
      for (const auto& [name, value] : settings_) words.insert(words.end(), {name, value});
      State(writer, words, options_.tolerance, options_.time_limit_s, options_.max_iterations, problem_);
    });
    return writer.Take();
  }
  static void SetState(Solver* self, const nb::bytes& state) {
    StateReader reader(state);
    std::vector<std::string> words;
    LcpOptions options;
    bool has_problem = false;
    LcpProblem problem = EmptyProblem();
    State(reader, words, options.tolerance, options.time_limit_s, options.max_iterations, has_problem);
    if (has_problem) State(reader, problem);
    Settings settings;
    for (std::size_t k = 2; k < words.size(); k += 2) settings.emplace(words[k - 1], words[k]);
    new (self) Solver(words.at(0), std::move(settings), options);
    if (has_problem) self->problem_ = std::move(problem);
  }

  void Update(nb::handle b) {
    Eigen::VectorXd other = ReadEigen(b, "b");
    WithoutGil([&] {
      const auto turn = TakeTurn(mutex_);
      problem_ = RequireProblem().WithB(std::move(other));
    });
  }

  nb::object Solve(nb::handle initial_f) {
    std::optional<Eigen::VectorXd> start = ReadStart(initial_f);
    LcpResult answer;
    std::optional<LcpProblem> problem;
    double time_s = 0;
    WithoutGil([&] {
      const auto turn = TakeTurn(mutex_);
      problem = RequireProblem();
      const double begin = SteadyNow();
      try {
        answer = SolveLeavable(solver_, *problem, options_, std::move(start));
      } catch (const Cancelled&) {
        solver_ = MakeSolver(key_, settings_);
        throw;
      }
      time_s = SteadyNow() - begin;
    });
    return nb::cast(Result{std::move(*problem), std::move(answer), options_.tolerance, time_s});
  }

 private:
  const LcpProblem& RequireProblem() const {
    if (!problem_) throw InputError("setup(problem) comes first");
    return *problem_;
  }

  std::shared_ptr<LcpSolver> solver_;
  std::string key_;
  Settings settings_;
  LcpOptions options_;
  std::optional<LcpProblem> problem_;
  std::timed_mutex mutex_;
};

void InitSolver(Solver* self, nb::handle solver, nb::handle tolerance, nb::handle time_limit,
                std::int64_t max_iterations, const nb::kwargs& settings) {
  new (self) Solver(ReadKey(solver), ReadSettings(settings), ReadOptions(tolerance, time_limit, max_iterations));
}

nb::list AvailableSolvers(bool all) {
  nb::list solvers;
  for (const SolverEntry& entry : AllSolvers()) {
    if (all || entry.available) solvers.append(nb::cast(entry));
  }
  return solvers;
}

void BindSolverEntry(nb::module_& module) {
  nb::class_<SolverEntry>(module, "SolverEntry", "A row of the table of solvers.")
      .def_ro("key", &SolverEntry::key, "What `solve` and `Solver` take.")
      .def_ro("method", &SolverEntry::method, "One line.")
      .def_ro("source", &SolverEntry::source, "Paper or library.")
      .def_ro("licence", &SolverEntry::licence, "SPDX expression: of our code, or of the peer's library.")
      .def_ro("available", &SolverEntry::available, "Whether it is in this build.")
      .def_ro("uses_tolerance", &SolverEntry::uses_tolerance, "False: a direct method.")
      .def_ro("takes_friction", &SolverEntry::takes_friction, "Whether it takes friction and sliding rows.")
      .def_ro("takes_bounded", &SolverEntry::takes_bounded, "Whether it takes bounded rows.")
      .def_prop_ro(
          "is_peer", [](const SolverEntry& entry) { return entry.origin == SolverOrigin::kPeer; },
          "Another project's solver, which runs in a process of its own.")
      .def("__repr__",
           [](const SolverEntry& entry) { return "SolverEntry('" + entry.key + "': " + entry.method + ")"; });
}

}  // namespace

void BindSolvers(nb::module_& module) {
  BindSolverEntry(module);
  module.def("available_solvers", &AvailableSolvers, nb::arg("all") = false,
             nb::sig("def available_solvers(all: bool = False) -> list[SolverEntry]"),
             "The solvers of this build, ours first; all: also those that were not built.");
  module.def("solve", &Solve, nb::arg("A") = nb::none(), nb::arg("b") = nb::none(), nb::kw_only(),
             nb::arg("J") = nb::none(), nb::arg("inverse_mass") = nb::none(), nb::arg("bilateral") = nb::none(),
             nb::arg("friction") = nb::none(), nb::arg("bounded") = nb::none(), nb::arg("solver") = "auto",
             nb::arg("tolerance") = 1e-9, nb::arg("initial_f") = nb::none(), nb::arg("time_limit") = nb::none(),
             nb::arg("max_iterations") = 0, nb::arg("symmetrize") = nb::none(), nb::arg("settings"),
             nb::sig(kSolveSignature), kSolve);
  nb::class_<Solver>(module, "Solver", R"(A solver that is kept from solve to solve, with what it prepared of a problem.

    solver = lcpbench.Solver("lemke", tolerance=1e-6)
    solver.setup(problem)            # what depends on A and the kinds of rows
    result = solver.solve()
    solver.update(b)                 # the same matrix, another b
    result = solver.solve(initial_f=result.f)

Arguments as of `solve`. Threads take turns.)")
      .def("__init__", &InitSolver, nb::arg("solver") = "auto", nb::kw_only(), nb::arg("tolerance") = 1e-9,
           nb::arg("time_limit") = nb::none(), nb::arg("max_iterations") = 0, nb::arg("settings"),
           nb::sig("def __init__(self, solver: str = 'auto', *, tolerance: float = 1e-9, time_limit: float | None = "
                   "None, max_iterations: int = 0, **settings) -> None"))
      .def("__getstate__", &Solver::GetState)
      .def("__setstate__", [](Solver& self, const nb::bytes& state) { Solver::SetState(&self, state); })
      .def_prop_ro("key", &Solver::key, "The solver's key.")
      .def("setup", &Solver::Setup, nb::arg("problem"), nb::kw_only(), nb::arg("symmetrize") = nb::none(),
           nb::sig("def setup(self, problem: Problem, *, symmetrize: float | None = None) -> None"),
           "Takes a problem, and prepares what does not depend on b.")
      .def("update", &Solver::Update, nb::arg("b"), nb::sig("def update(self, b: numpy.typing.ArrayLike) -> None"),
           "(n,): the same matrix with another b.")
      .def("solve", &Solver::Solve, nb::arg("initial_f") = nb::none(),
           nb::sig("def solve(self, initial_f: numpy.typing.ArrayLike | None = None) -> Result"),
           "initial_f: (n,) warm start. A hard problem is a status.");
}

}  // namespace lcpbench::python
