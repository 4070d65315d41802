// Everything behind lcpbench.h. No exception leaves it: see Guard.
#include "solvers/c/lcpbench.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <exception>
#include <limits>
#include <memory>
#include <new>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "solvers/lcp/compressed_rows.h"
#include "solvers/lcp/memory_budget.h"
#include "solvers/lcp/problem.h"
#include "solvers/lcp/solver.h"
#include "solvers/lcp/verify.h"
#include "solvers/linear_algebra/loaded_blas.h"
#include "solvers/pivoting/least_norm.h"
#include "solvers/registry.h"
#include "solvers/step/step_solver.h"
#include "support/input_error.h"

struct lcpbench_problem {
  lcpbench::LcpProblem problem;
};

struct lcpbench_solver {
  std::unique_ptr<lcpbench::LcpSolver> solver;
};

struct lcpbench_result {
  lcpbench::LcpResult result;
};

struct lcpbench_step {
  lcpbench::StepSolver solver;
  // Kept, so that the next call allocates none.
  std::vector<lcpbench::StepAnswer> answers;  // of a batch
  std::vector<lcpbench::FrictionRow> friction;
  std::vector<lcpbench::BoundedRow> bounded;
};

namespace lcpbench {
namespace {

// An array, so that telling of exhausted memory needs none. Longer messages are cut.
thread_local char last_error[2048] = "";

lcpbench_error Fail(lcpbench_error error, const char* function, const char* message) {
  std::snprintf(last_error, sizeof last_error, "%s: %s", function, message);
  return error;
}

// Runs `body` so that no exception crosses the C interface; its message becomes that of lcpbench_last_error(), after
// the name of the function.
template <typename Body>
lcpbench_error Guard(const char* function, Body&& body) noexcept {
  try {
    std::forward<Body>(body)();
    return LCPBENCH_OK;
  } catch (const InputError& error) {
    return Fail(LCPBENCH_INVALID_ARGUMENT, function, error.what());
  } catch (const MemoryRefusal& error) {
    return Fail(LCPBENCH_OUT_OF_MEMORY, function, error.what());
  } catch (const std::bad_alloc&) {
    return Fail(LCPBENCH_OUT_OF_MEMORY, function, "out of memory");
  } catch (const std::length_error& error) {
    return Fail(LCPBENCH_OUT_OF_MEMORY, function, error.what());
  } catch (const std::exception& error) {
    return Fail(LCPBENCH_INTERNAL_ERROR, function, error.what());
  } catch (...) {
    return Fail(LCPBENCH_INTERNAL_ERROR, function, "an exception of an unknown type");
  }
}

// Below, names are views: what is right is told from what is wrong without an allocation, for lcpbench_step_solve.

// Names the argument, what it is and what was expected.
template <typename Number>
[[noreturn]] void Refuse(std::string_view name, Number found, const std::string& expected) {
  throw InputError(std::string(name) + " is " + std::to_string(found) + ", expected " + expected);
}

void RequireNotNull(const void* pointer, std::string_view name, const char* expected) {
  if (pointer == nullptr) throw InputError(std::string(name) + " is NULL, expected " + expected);
}

// What nearly every function is given.
void Require(const lcpbench_problem* problem) { RequireNotNull(problem, "problem", "a problem"); }
void Require(const lcpbench_solver* solver) { RequireNotNull(solver, "solver", "a solver"); }
void Require(const lcpbench_result* result) { RequireNotNull(result, "result", "a result"); }
void Require(const lcpbench_step* step) { RequireNotNull(step, "step", "a step solver"); }
void RequireOutput(const void* pointer, const char* name) { RequireNotNull(pointer, name, "where to write"); }
void RequireHandle(const void* pointer, const char* name) { RequireNotNull(pointer, name, "the address of a pointer"); }

// Sizes beyond this are uninitialised memory, not a later version's struct.
constexpr std::size_t kLargestStruct = 65536;

// @param smallest  its size in version 0.1
void RequireStructSize(std::size_t size, std::size_t smallest, std::string_view name) {
  if (size >= smallest && size <= kLargestStruct) return;
  Refuse("size", size, "sizeof(" + std::string(name) + "), " + std::to_string(smallest) + " or more");
}

// Writes as much of `source` as the caller's struct has room for, and zeros where that is larger.
template <typename Struct>
void CopyOut(const Struct& source, Struct* target, std::size_t size) {
  std::memcpy(target, &source, std::min(size, sizeof source));
  if (size > sizeof source) std::memset(reinterpret_cast<char*>(target) + sizeof source, 0, size - sizeof source);
}

// What the caller's struct says, which may be shorter or longer than ours, over `defaults`.
// @param name  "options", the argument
// @param type  of the struct, with the function that initialises it
template <typename Struct>
Struct CopyIn(const Struct* given, const Struct& defaults, std::size_t smallest, std::string_view name,
              std::string_view type) {
  Struct read = defaults;
  RequireStructSize(given->size, smallest, type);
  const std::size_t known = std::min(given->size, sizeof read);
  std::memcpy(&read, given, known);
  const auto* bytes = reinterpret_cast<const unsigned char*>(given);
  if (std::any_of(bytes + known, bytes + given->size, [](int byte) { return byte != 0; })) {
    throw InputError(std::string(name) + " has members that this version of the library does not know");
  }
  return read;
}

// Writes the defaults into the caller's struct, with its size.
template <typename Struct>
void WriteDefaults(Struct defaults, Struct* target, std::size_t size, std::size_t smallest, const char* name,
                   std::string_view type) {
  RequireOutput(target, name);
  RequireStructSize(size, smallest, type);
  defaults.size = size;
  CopyOut(defaults, target, size);
}

constexpr std::int64_t kLargestSize = std::numeric_limits<std::int32_t>::max();

void RequireSize(std::int64_t size, const char* name) {
  if (size < 0 || size > kLargestSize) Refuse(name, size, std::string("0 <= ") + name + " < 2^31");
}

std::string Place(const char* array, std::int64_t i) { return std::string(array) + "[" + std::to_string(i) + "]"; }

void RequireLayout(lcpbench_layout layout) {
  if (layout != LCPBENCH_COLUMN_MAJOR && layout != LCPBENCH_ROW_MAJOR) {
    Refuse("layout", layout, "LCPBENCH_COLUMN_MAJOR (0) or LCPBENCH_ROW_MAJOR (1)");
  }
}

// LcpProblem looks at the numbers.
Eigen::VectorXd ReadVector(const double* values, std::int64_t size, const char* name) {
  if (size == 0) return {};
  RequireNotNull(values, name, "an array of numbers");
  return Eigen::Map<const Eigen::VectorXd>(values, size);
}

void RequireKinds(const std::uint8_t* kinds, std::int64_t n, const char* name) {
  for (std::int64_t i = 0; i < n && kinds != nullptr; ++i) {
    if (kinds[i] == LCPBENCH_BILATERAL || kinds[i] == LCPBENCH_UNILATERAL) continue;
    Refuse(Place(name, i), kinds[i], "LCPBENCH_UNILATERAL (0) or LCPBENCH_BILATERAL (1)");
  }
}

RowBounds ReadKinds(const std::uint8_t* kinds, std::int64_t n) {
  if (kinds == nullptr) return {};
  RequireKinds(kinds, n, "kinds");
  return {{kinds, kinds + n}};
}

MatrixFacts ReadFacts(std::uint32_t facts) {
  constexpr std::uint32_t kKnown = LCPBENCH_SYMMETRIC | LCPBENCH_POSITIVE_SEMIDEFINITE;
  if ((facts & ~kKnown) != 0) {
    Refuse("facts", facts, "0 or bits of LCPBENCH_SYMMETRIC (1) and LCPBENCH_POSITIVE_SEMIDEFINITE (2)");
  }
  MatrixFacts read;
  read.symmetric = (facts & LCPBENCH_SYMMETRIC) != 0;
  read.positive_semidefinite = (facts & LCPBENCH_POSITIVE_SEMIDEFINITE) != 0;
  return read;
}

// Makes the problem of n rows that `make` returns, whose A must be what is said of it.
template <typename Make>
lcpbench_error MakeProblem(const char* function, std::int64_t n, lcpbench_problem** problem, Make make) {
  return Guard(function, [&] {
    RequireHandle(problem, "problem");
    RequireSize(n, "n");
    LcpProblem made = make();
    if (made.facts().symmetric && !made.IsNumericallySymmetric()) {
      char asymmetry[32];
      std::snprintf(asymmetry, sizeof asymmetry, "%.3g", made.Asymmetry());
      throw InputError(std::string("facts has LCPBENCH_SYMMETRIC, but A is not symmetric: entries (i, j) and (j, i) ") +
                       "differ by up to " + asymmetry + " of their diagonal entries");
    }
    *problem = new lcpbench_problem{std::move(made)};
  });
}

// Throws what was found to be wrong.
void RequireNothing(const std::string& wrong) {
  if (!wrong.empty()) throw InputError(wrong);
}

// The compressed arrays of `name`, checked.
SparseMatrix ReadCompressed(const char* name, std::int64_t rows, std::int64_t columns, lcpbench_layout layout,
                            const std::int32_t* starts, const std::int32_t* indices, const double* values,
                            std::int64_t entries) {
  RequireLayout(layout);
  RequireSize(entries, "entries");
  const bool by_columns = layout == LCPBENCH_COLUMN_MAJOR;
  const std::int64_t outer = by_columns ? columns : rows;
  const std::int64_t inner = by_columns ? rows : columns;
  if (entries == 0 && (outer == 0 || (inner == 0 && starts == nullptr))) return {rows, columns};
  RequireNotNull(starts, "starts", "one number for every column (or row) and one more");
  const std::span<const int> begins(starts, static_cast<std::size_t>(outer) + 1);
  RequireNothing(WhyNotStarts(begins, entries, "starts", "entries"));
  if (entries > 0) {
    RequireNotNull(indices, "indices", "an array of indices");
    RequireNotNull(values, "values", "an array of numbers");
  }
  const auto count = static_cast<std::size_t>(entries);
  return ToSparseMatrix({rows, columns, by_columns, begins, {indices, count}, {values, count}}, name);
}

Eigen::MatrixXd ReadDense(const double* A, std::int64_t n, lcpbench_layout layout) {
  RequireLayout(layout);
  if (n == 0) return {};
  RequireNotNull(A, "A", "n x n numbers");
  const double numbers = static_cast<double>(n) * static_cast<double>(n);
  RequireMemory(numbers * sizeof(double), "a copy of A");
  const Eigen::Map<const Eigen::MatrixXd> by_columns(A, n, n);
  if (layout == LCPBENCH_COLUMN_MAJOR) return by_columns;
  return by_columns.transpose();
}

lcpbench_error MakeFromFactors(const char* function, std::int64_t n, std::int64_t columns,
                               std::int32_t columns_per_body, lcpbench_layout layout, const std::int32_t* starts,
                               const std::int32_t* indices, const double* values, std::int64_t entries,
                               const double* inverse_mass, const double* b, const std::uint8_t* kinds,
                               lcpbench_problem** problem) {
  return MakeProblem(function, n, problem, [&] {
    RequireSize(columns, "columns");
    MatrixFacts facts;
    facts.columns_per_body = columns_per_body;
    return LcpProblem::FromFactors("", ReadCompressed("J", n, columns, layout, starts, indices, values, entries),
                                   ReadVector(inverse_mass, columns, "inverse_mass"), ReadVector(b, n, "b"),
                                   ReadKinds(kinds, n), facts);
  });
}

// The two enumerations count alike, so that a status is converted by its number.
static_assert(static_cast<int>(LcpStatus::kNotRun) == LCPBENCH_NOT_RUN);
static_assert(static_cast<int>(LcpStatus::kSolved) == LCPBENCH_SOLVED);
static_assert(static_cast<int>(LcpStatus::kInfeasible) == LCPBENCH_INFEASIBLE);
static_assert(static_cast<int>(LcpStatus::kIterationLimit) == LCPBENCH_ITERATION_LIMIT);
static_assert(static_cast<int>(LcpStatus::kTimeLimit) == LCPBENCH_TIME_LIMIT);
static_assert(static_cast<int>(LcpStatus::kNumericalFailure) == LCPBENCH_NUMERICAL_FAILURE);
static_assert(static_cast<int>(LcpStatus::kUnsupported) == LCPBENCH_UNSUPPORTED);

// Sizes in version 0.1: what programs compiled against it pass. Members that are added later come behind them.
constexpr std::size_t kFirstVerdict = offsetof(lcpbench_verdict, ray_reason) + sizeof(lcpbench_verdict::ray_reason);

bool IsStatus(lcpbench_status status) { return status >= LCPBENCH_NOT_RUN && status <= LCPBENCH_UNSUPPORTED; }

template <std::size_t kSize>
void CopyText(const std::string& text, char (&target)[kSize]) {
  const std::size_t length = std::min(text.size(), kSize - 1);
  std::memcpy(target, text.data(), length);
  target[length] = '\0';
}

void Judge(const LcpProblem& problem, const LcpResult& result, double tolerance, lcpbench_verdict* target,
           std::size_t size, double* w) {
  RequireOutput(target, "verdict");
  RequireStructSize(size, kFirstVerdict, "lcpbench_verdict");
  if (!(tolerance > 0 && tolerance < 1)) Refuse("tolerance", tolerance, "a number in (0, 1)");
  const Verdict found = Verify(problem, result, tolerance);
  const Metrics& m = found.metrics;
  lcpbench_verdict verdict = {};
  verdict.requested = found.requested;
  verdict.passes = found.passes ? 1 : 0;
  verdict.false_success = found.false_success ? 1 : 0;
  verdict.false_infeasible = found.false_infeasible ? 1 : 0;
  verdict.best_tier = found.best_tier;
  verdict.rho = m.rho;
  verdict.backward_error = m.backward_error;
  verdict.natural_residual = m.natural_residual;
  verdict.primal_infeasibility = m.primal_infeasibility;
  verdict.dual_infeasibility = m.dual_infeasibility;
  verdict.complementarity = m.complementarity;
  verdict.gap = m.gap;
  verdict.energy_bound = m.energy_bound;
  verdict.energy_shift = m.energy_shift;
  verdict.answer_floor = m.answer_floor;
  verdict.penetration = m.penetration;
  verdict.adhesion = m.adhesion;
  verdict.separation = m.separation;
  verdict.cone = m.cone;
  verdict.dissipation = m.dissipation;
  verdict.joints = m.joints;
  verdict.beyond_bounds = m.beyond_bounds;
  verdict.model_rho = found.model_rho;
  CopyText(found.reason, verdict.reason);
  if (found.farkas.has_value()) {
    verdict.has_ray = 1;
    verdict.ray_accepted = found.farkas->accepted ? 1 : 0;
    verdict.ray_b_dot_y = found.farkas->b_dot_y;
    verdict.ray_proved = found.farkas->proved ? 1 : 0;
    verdict.ray_force_min = found.farkas->force_min;
    verdict.ray_null_residual = found.farkas->null_residual;
    CopyText(found.farkas->reason, verdict.ray_reason);
  }
  CopyOut(verdict, target, size);
  if (w != nullptr) std::copy(m.w.begin(), m.w.end(), w);
}

// Writes one thing of an object.
template <typename Object, typename Value, typename Get>
lcpbench_error Tell(const char* function, const Object* object, Value* value, const char* name, Get get) {
  return Guard(function, [&] {
    Require(object);
    RequireOutput(value, name);
    *value = get(*object);
  });
}

// Writes where a vector of a result is, NULL where the result does not have it.
template <typename Get>
lcpbench_error TellVector(const char* function, const lcpbench_result* result, const double** values, const char* name,
                          std::int64_t* n, Get get) {
  return Guard(function, [&] {
    Require(result);
    RequireOutput(values, name);
    RequireOutput(n, "n");
    const Eigen::VectorXd* const vector = get(result->result);
    *n = vector == nullptr ? 0 : vector->size();
    *values = *n == 0 ? nullptr : vector->data();
  });
}

constexpr std::size_t kFirstInfo = offsetof(lcpbench_solver_info, is_peer) + sizeof(std::int32_t);
constexpr std::size_t kFirstOptions = offsetof(lcpbench_solve_options, initial_f_size) + sizeof(std::int64_t);

Settings ReadSettings(const lcpbench_setting* settings, std::size_t count) {
  Settings read;
  if (count > 0) RequireNotNull(settings, "settings", "an array of settings");
  for (std::size_t i = 0; i < count; ++i) {
    const std::string place = "settings[" + std::to_string(i) + "]";
    RequireNotNull(settings[i].name, place + ".name", "a string");
    RequireNotNull(settings[i].value, place + ".value", "a string");
    if (!read.emplace(settings[i].name, settings[i].value).second) {
      throw InputError(place + ".name is '" + settings[i].name + "', which is set before");
    }
  }
  return read;
}

lcpbench_solve_options Defaults() {
  lcpbench_solve_options defaults = {};
  defaults.size = sizeof defaults;
  defaults.tolerance = LcpOptions().tolerance;
  defaults.time_limit_s = LcpOptions().time_limit_s;
  return defaults;
}

lcpbench_solve_options ReadOptions(const lcpbench_solve_options* given) {
  if (given == nullptr) return Defaults();
  return CopyIn(given, Defaults(), kFirstOptions, "options",
                "lcpbench_solve_options (call lcpbench_solve_options_init)");
}

constexpr std::size_t kFirstStepOptions = offsetof(lcpbench_step_options, time_limit_s) + sizeof(double);
constexpr std::size_t kFirstStepRows = offsetof(lcpbench_step_rows, inverse_mass) + sizeof(double*);
constexpr std::size_t kFirstStepAnswer = offsetof(lcpbench_step_answer, rho) + sizeof(double);

lcpbench_step_options StepDefaults() {
  lcpbench_step_options defaults = {};
  defaults.size = sizeof defaults;
  defaults.tolerance = StepOptions().tolerance;
  defaults.time_limit_s = StepOptions().time_limit_s;
  defaults.threads = StepOptions().threads;
  return defaults;
}

lcpbench_step_rows StepRowsDefaults() {
  lcpbench_step_rows defaults = {};
  defaults.size = sizeof defaults;
  defaults.columns_per_body = StepRows().columns_per_body;
  return defaults;
}

// What only this interface knows of; rows and numbers are the problem's to check.
void ReadFriction(const lcpbench_friction_row* given, int64_t count, std::vector<FrictionRow>* friction) {
  RequireSize(count, "friction_count");
  if (count > 0) RequireNotNull(given, "friction", "friction rows");
  friction->clear();
  for (int64_t k = 0; k < count; ++k) {
    const lcpbench_friction_row& row = given[k];
    if (row.slip < -1 || row.slip > 1) Refuse(Place("friction", k) + ".slip", row.slip, "-1, 0 or 1");
    if (row.reserved != 0) Refuse(Place("friction", k) + ".reserved", row.reserved, "0");
    friction->push_back({row.row, row.normal, row.mu, static_cast<signed char>(row.slip)});
  }
}
void ReadBounded(const lcpbench_bounded_row* given, int64_t count, std::vector<BoundedRow>* bounded) {
  RequireSize(count, "bounded_count");
  if (count > 0) RequireNotNull(given, "bounded", "bounded rows");
  bounded->clear();
  for (int64_t k = 0; k < count; ++k) bounded->push_back({given[k].row, given[k].lower, given[k].upper});
}

// What only this interface knows of; the arrays are the step solver's to check.
// @param step  for what is read
StepRows ReadStepRows(const lcpbench_step_rows* given, lcpbench_step* step) {
  RequireNotNull(given, "rows", "the arrays of a step");
  const lcpbench_step_rows read =
      CopyIn(given, StepRowsDefaults(), kFirstStepRows, "rows", "lcpbench_step_rows (call lcpbench_step_rows_init)");
  RequireSize(read.rows, "rows.rows");
  RequireSize(read.bodies, "rows.bodies");
  if (read.reserved != 0) Refuse("rows.reserved", read.reserved, "0");
  StepRows rows;
  rows.columns_per_body = read.columns_per_body;
  rows.rows = read.rows;
  rows.bodies = read.bodies;
  ReadFriction(read.friction, read.friction_count, &step->friction);
  ReadBounded(read.bounded, read.bounded_count, &step->bounded);
  rows.friction = step->friction;
  rows.bounded = step->bounded;
  if (read.rows == 0) return rows;
  if (read.J != nullptr && read.J_single != nullptr) {
    throw InputError("rows.J and rows.J_single are both given, expected one of them");
  }
  RequireKinds(read.kinds, read.rows, "rows.kinds");
  rows.body = read.body;
  rows.J = read.J;
  rows.J_single = read.J_single;
  rows.b = read.b;
  rows.bilateral = read.kinds;
  rows.inverse_mass = read.inverse_mass;
  return rows;
}

void CopyOut(const StepAnswer& from, lcpbench_step_answer* target, std::size_t size) {
  lcpbench_step_answer answer = {};
  answer.status = static_cast<lcpbench_status>(from.status);
  answer.iterations = from.iterations;
  answer.rho = from.rho;
  answer.infeasible_proved = from.infeasible_proved ? 1 : 0;
  answer.force_min = from.force_min;
  CopyOut(answer, target, size);
}

}  // namespace
}  // namespace lcpbench

using namespace lcpbench;

const char* lcpbench_last_error() { return last_error; }

const char* lcpbench_version() { return LCPBENCH_VERSION; }

lcpbench_error lcpbench_problem_from_dense(int64_t n, const double* A, lcpbench_layout layout, const double* b,
                                           const uint8_t* kinds, uint32_t facts, lcpbench_problem** problem) {
  return MakeProblem(__func__, n, problem, [&] {
    return LcpProblem::FromDense("", ReadDense(A, n, layout), ReadVector(b, n, "b"), ReadKinds(kinds, n),
                                 ReadFacts(facts));
  });
}

lcpbench_error lcpbench_problem_from_sparse(int64_t n, lcpbench_layout layout, const int32_t* starts,
                                            const int32_t* indices, const double* values, int64_t entries,
                                            const double* b, const uint8_t* kinds, uint32_t facts,
                                            lcpbench_problem** problem) {
  return MakeProblem(__func__, n, problem, [&] {
    return LcpProblem::FromSparse("", ReadCompressed("A", n, n, layout, starts, indices, values, entries),
                                  ReadVector(b, n, "b"), ReadKinds(kinds, n), ReadFacts(facts));
  });
}

lcpbench_error lcpbench_problem_from_factors(int64_t n, int64_t columns, lcpbench_layout layout, const int32_t* starts,
                                             const int32_t* indices, const double* values, int64_t entries,
                                             const double* inverse_mass, const double* b, const uint8_t* kinds,
                                             lcpbench_problem** problem) {
  return MakeFromFactors(__func__, n, columns, MatrixFacts().columns_per_body, layout, starts, indices, values, entries,
                         inverse_mass, b, kinds, problem);
}

lcpbench_error lcpbench_problem_from_body_factors(int64_t n, int64_t columns, int32_t columns_per_body,
                                                  lcpbench_layout layout, const int32_t* starts, const int32_t* indices,
                                                  const double* values, int64_t entries, const double* inverse_mass,
                                                  const double* b, const uint8_t* kinds, lcpbench_problem** problem) {
  return MakeFromFactors(__func__, n, columns, columns_per_body, layout, starts, indices, values, entries, inverse_mass,
                         b, kinds, problem);
}

lcpbench_error lcpbench_problem_with_laws(const lcpbench_problem* problem, const lcpbench_friction_row* friction,
                                          int64_t friction_count, const lcpbench_bounded_row* bounded,
                                          int64_t bounded_count, lcpbench_problem** with_laws) {
  return Guard(__func__, [&] {
    Require(problem);
    RequireHandle(with_laws, "with_laws");
    RowBounds bounds{problem->problem.bounds().bilateral};
    ReadFriction(friction, friction_count, &bounds.friction);
    ReadBounded(bounded, bounded_count, &bounds.bounded);
    *with_laws = new lcpbench_problem{problem->problem.WithBounds(std::move(bounds))};
  });
}

lcpbench_error lcpbench_problem_size(const lcpbench_problem* problem, int64_t* n) {
  return Tell(__func__, problem, n, "n", [](const lcpbench_problem& of) { return of.problem.size(); });
}

void lcpbench_problem_free(lcpbench_problem* problem) { delete problem; }

lcpbench_error lcpbench_result_create(lcpbench_result** result) {
  return Guard(__func__, [&] {
    RequireHandle(result, "result");
    *result = new lcpbench_result();
  });
}

lcpbench_error lcpbench_result_status(const lcpbench_result* result, lcpbench_status* status) {
  return Tell(__func__, result, status, "status",
              [](const lcpbench_result& of) { return static_cast<lcpbench_status>(of.result.status); });
}

lcpbench_error lcpbench_result_iterations(const lcpbench_result* result, int64_t* iterations) {
  return Tell(__func__, result, iterations, "iterations",
              [](const lcpbench_result& of) { return of.result.iterations; });
}

lcpbench_error lcpbench_result_detail(const lcpbench_result* result, const char** detail) {
  return Tell(__func__, result, detail, "detail", [](const lcpbench_result& of) { return of.result.detail.c_str(); });
}

lcpbench_error lcpbench_result_f(const lcpbench_result* result, const double** f, int64_t* n) {
  return TellVector(__func__, result, f, "f", n, [](const LcpResult& of) { return &of.f; });
}

lcpbench_error lcpbench_result_farkas_ray(const lcpbench_result* result, const double** ray, int64_t* n) {
  return TellVector(__func__, result, ray, "ray", n,
                    [](const LcpResult& of) { return of.farkas_ray.has_value() ? &*of.farkas_ray : nullptr; });
}

const char* lcpbench_status_key(lcpbench_status status) {
  // Keys are literals, which end in a zero.
  return IsStatus(status) ? ToString(static_cast<LcpStatus>(status)).data() : "unknown";
}

void lcpbench_result_free(lcpbench_result* result) { delete result; }

lcpbench_error lcpbench_result_least_norm(const lcpbench_problem* problem, lcpbench_result* result, double tolerance,
                                          double rank_tolerance, int64_t* nullity) {
  return Guard(__func__, [&] {
    Require(problem);
    RequireOutput(result, "result");
    RequireOutput(nullity, "nullity");
    if (!(tolerance > 0 && tolerance < 1)) Refuse("tolerance", tolerance, "a number in (0, 1)");
    if (!(rank_tolerance > 0 && rank_tolerance < 1)) Refuse("rank_tolerance", rank_tolerance, "a number in (0, 1)");
    if (result->result.status != LcpStatus::kSolved) throw InputError("result is not solved, expected one that is");
    LeastNormForces found = FindLeastNormForces(problem->problem, result->result.f,
                                                {.tolerance = tolerance, .rank_tolerance = rank_tolerance});
    const bool is_found = found.status == LcpStatus::kSolved;
    *nullity = is_found ? found.nullity : -1;
    if (is_found) {
      result->result.f = std::move(found.f);
    } else {
      result->result.detail = "not of least norm: " + found.detail;
    }
  });
}

lcpbench_error lcpbench_verify_result(const lcpbench_problem* problem, const lcpbench_result* result, double tolerance,
                                      lcpbench_verdict* verdict, size_t size, double* w) {
  return Guard(__func__, [&] {
    Require(problem);
    Require(result);
    if (result->result.status == LcpStatus::kNotRun) throw InputError("result is empty, expected one of a solve");
    if (result->result.f.size() != problem->problem.size()) {
      throw InputError("result has " + std::to_string(result->result.f.size()) +
                       " forces, expected the problem's n = " + std::to_string(problem->problem.size()));
    }
    Judge(problem->problem, result->result, tolerance, verdict, size, w);
  });
}

lcpbench_error lcpbench_verify(const lcpbench_problem* problem, const double* f, int64_t f_size, lcpbench_status claim,
                               const double* ray, double tolerance, lcpbench_verdict* verdict, size_t size, double* w) {
  return Guard(__func__, [&] {
    Require(problem);
    const Index n = problem->problem.size();
    if (f_size != n) Refuse("f_size", f_size, "the problem's n = " + std::to_string(n));
    if (n > 0) RequireNotNull(f, "f", "n numbers");
    if (!IsStatus(claim)) Refuse("claim", claim, "a lcpbench_status");
    LcpResult result;
    result.status = static_cast<LcpStatus>(claim);
    if (n > 0) result.f = Eigen::Map<const Eigen::VectorXd>(f, n);
    if (ray != nullptr && n > 0) result.farkas_ray = Eigen::Map<const Eigen::VectorXd>(ray, n);
    Judge(problem->problem, result, tolerance, verdict, size, w);
  });
}

lcpbench_error lcpbench_solver_count(size_t* count) {
  return Guard(__func__, [&] {
    RequireOutput(count, "count");
    *count = AllSolvers().size();
  });
}

lcpbench_error lcpbench_solver_describe(size_t index, lcpbench_solver_info* info, size_t size) {
  return Guard(__func__, [&] {
    RequireOutput(info, "info");
    RequireStructSize(size, kFirstInfo, "lcpbench_solver_info");
    const auto solvers = AllSolvers();
    if (index >= solvers.size()) {
      Refuse("index", index, "one below the " + std::to_string(solvers.size()) + " of lcpbench_solver_count");
    }
    // The table outlives every call: this interface registers no further solvers.
    const SolverEntry& entry = solvers[index];
    lcpbench_solver_info row = {};
    row.key = entry.key.c_str();
    row.method = entry.method.c_str();
    row.source = entry.source.c_str();
    row.licence = entry.licence.c_str();
    row.available = entry.available ? 1 : 0;
    row.uses_tolerance = entry.uses_tolerance ? 1 : 0;
    row.is_peer = entry.origin == SolverOrigin::kPeer ? 1 : 0;
    CopyOut(row, info, size);
  });
}

lcpbench_error lcpbench_solver_create(const char* key, const lcpbench_setting* settings, size_t count,
                                      lcpbench_solver** solver) {
  return Guard(__func__, [&] {
    RequireHandle(solver, "solver");
    RequireNotNull(key, "key", "a solver's key");
    *solver = new lcpbench_solver{MakeSolver(key, ReadSettings(settings, count))};
  });
}

lcpbench_error lcpbench_solver_prepare(lcpbench_solver* solver, const lcpbench_problem* problem) {
  return Guard(__func__, [&] {
    Require(solver);
    Require(problem);
    solver->solver->Prepare(problem->problem);
  });
}

void lcpbench_solver_free(lcpbench_solver* solver) { delete solver; }

lcpbench_error lcpbench_solve_options_init(lcpbench_solve_options* options, size_t size) {
  return Guard(__func__,
               [&] { WriteDefaults(Defaults(), options, size, kFirstOptions, "options", "lcpbench_solve_options"); });
}

lcpbench_error lcpbench_solve(lcpbench_solver* solver, const lcpbench_problem* problem,
                              const lcpbench_solve_options* options, lcpbench_result* result) {
  return Guard(__func__, [&] {
    Require(solver);
    Require(problem);
    Require(result);
    const lcpbench_solve_options given = ReadOptions(options);
    LcpOptions solve;
    solve.tolerance = given.tolerance;
    solve.time_limit_s = given.time_limit_s;
    solve.max_iterations = given.max_iterations;
    Eigen::VectorXd initial_f;
    if (given.initial_f != nullptr) {
      if (given.initial_f_size != problem->problem.size()) {
        Refuse("initial_f_size", given.initial_f_size, "the problem's n = " + std::to_string(problem->problem.size()));
      }
      initial_f = Eigen::Map<const Eigen::VectorXd>(given.initial_f, given.initial_f_size);
      solve.initial_f = &initial_f;
    } else if (given.initial_f_size != 0) {
      throw InputError("initial_f is NULL, expected " + std::to_string(given.initial_f_size) + " numbers");
    }
    solver->solver->Solve(problem->problem, solve, &result->result);
  });
}

lcpbench_error lcpbench_limit_library_threads(int32_t threads, int32_t* reported) {
  return Guard(__func__, [&] {
    if (threads < 1) Refuse("threads", threads, "a number >= 1");
    const int now = LimitLibraryThreads(threads);
    if (reported != nullptr) *reported = now;
  });
}

lcpbench_error lcpbench_step_options_init(lcpbench_step_options* options, size_t size) {
  return Guard(__func__, [&] {
    WriteDefaults(StepDefaults(), options, size, kFirstStepOptions, "options", "lcpbench_step_options");
  });
}

lcpbench_error lcpbench_step_rows_init(lcpbench_step_rows* rows, size_t size) {
  return Guard(__func__,
               [&] { WriteDefaults(StepRowsDefaults(), rows, size, kFirstStepRows, "rows", "lcpbench_step_rows"); });
}

lcpbench_error lcpbench_step_create(const lcpbench_step_options* options, lcpbench_step** step) {
  return Guard(__func__, [&] {
    RequireHandle(step, "step");
    StepOptions given;
    if (options != nullptr) {
      const lcpbench_step_options read = CopyIn(options, StepDefaults(), kFirstStepOptions, "options",
                                                "lcpbench_step_options (call lcpbench_step_options_init)");
      given.tolerance = read.tolerance;
      given.time_limit_s = read.time_limit_s;
      given.threads = read.threads;
      if (read.reserved != 0) Refuse("options.reserved", read.reserved, "0");
    }
    *step = new lcpbench_step{StepSolver(given), {}, {}, {}};
  });
}

lcpbench_error lcpbench_step_reserve(lcpbench_step* step, int64_t max_rows, int64_t max_bodies) {
  return Guard(__func__, [&] {
    Require(step);
    RequireSize(max_rows, "max_rows");
    RequireSize(max_bodies, "max_bodies");
    step->solver.Reserve(max_rows, max_bodies);
    step->friction.reserve(static_cast<std::size_t>(max_rows));
    step->bounded.reserve(static_cast<std::size_t>(max_rows));
  });
}

lcpbench_error lcpbench_step_solve(lcpbench_step* step, const lcpbench_step_rows* rows, const double* initial_f,
                                   double* f, double* w, lcpbench_step_answer* answer, size_t size) {
  return Guard(__func__, [&] {
    Require(step);
    const StepRows read = ReadStepRows(rows, step);
    RequireOutput(answer, "answer");
    RequireStructSize(size, kFirstStepAnswer, "lcpbench_step_answer");
    if (read.rows > 0) RequireOutput(f, "f");
    if (initial_f != nullptr && initial_f == f) throw InputError("initial_f is f, expected an array of its own");
    CopyOut(step->solver.Solve(read, initial_f, f, w), answer, size);
  });
}

lcpbench_error lcpbench_step_solve_batch(lcpbench_step* step, const lcpbench_step_rows* rows, const int32_t* starts,
                                         int64_t count, double* f, lcpbench_step_answer* answers, size_t size) {
  return Guard(__func__, [&] {
    Require(step);
    const StepRows read = ReadStepRows(rows, step);
    RequireSize(count, "count");
    RequireNotNull(starts, "starts", "one number for every problem and one more");
    const std::span<const int> begins(starts, static_cast<std::size_t>(count) + 1);
    RequireNothing(WhyNotStarts(begins, read.rows, "starts", "rows.rows"));
    RequireStructSize(size, kFirstStepAnswer, "lcpbench_step_answer");
    if (count > 0) RequireOutput(answers, "answers");
    if (read.rows > 0) RequireOutput(f, "f");
    const auto problems = static_cast<std::size_t>(count);
    if (step->answers.size() < problems) step->answers.resize(problems);
    const std::span<StepAnswer> found(step->answers.data(), problems);
    step->solver.SolveBatch(read, begins, f, found);
    auto* target = reinterpret_cast<char*>(answers);
    for (const StepAnswer& answer : found) {
      CopyOut(answer, reinterpret_cast<lcpbench_step_answer*>(target), size);
      target += size;
    }
  });
}

lcpbench_error lcpbench_step_fallbacks(const lcpbench_step* step, int64_t* fallbacks) {
  return Tell(__func__, step, fallbacks, "fallbacks", [](const lcpbench_step& of) { return of.solver.fallbacks(); });
}

void lcpbench_step_free(lcpbench_step* step) { delete step; }
