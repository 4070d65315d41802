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
  lcpbench::LcpResult result;  // of the last solve: what the answer points to
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

// Below, names are pointers: what is right is told from what is wrong without an allocation, for lcpbench_step_solve.

// Names the argument, what it is and what was expected.
template <typename Number>
[[noreturn]] void Refuse(const std::string& name, Number found, const std::string& expected) {
  throw InputError(name + " is " + std::to_string(found) + ", expected " + expected);
}

void RequireNotNull(const void* pointer, const char* name, const char* expected) {
  if (pointer == nullptr) throw InputError(std::string(name) + " is NULL, expected " + expected);
}

// What nearly every function is given.
void Require(const lcpbench_problem* problem) { RequireNotNull(problem, "problem", "a problem"); }
void Require(const lcpbench_solver* solver) { RequireNotNull(solver, "solver", "a solver"); }
void Require(const lcpbench_step* step) { RequireNotNull(step, "step", "a step solver"); }
void RequireOutput(const void* pointer, const char* name) { RequireNotNull(pointer, name, "where to write"); }
void RequireHandle(const void* pointer, const char* name) { RequireNotNull(pointer, name, "the address of a pointer"); }

// Sizes beyond this are uninitialised memory, not a later version's struct.
constexpr std::size_t kLargestStruct = 65536;

template <typename Struct>
void RequireStructSize(std::size_t size, const char* type) {
  if (size >= sizeof(Struct) && size <= kLargestStruct) return;
  Refuse("size", size, "sizeof(" + std::string(type) + "), " + std::to_string(sizeof(Struct)) + " or more");
}

// A struct that the caller has filled in: ours, or a later version's that does not use its further members.
template <typename Struct>
void RequireStruct(const Struct* given, const char* name, const char* type) {
  RequireNotNull(given, name, type);
  RequireStructSize<Struct>(given->size, type);
  const auto* bytes = reinterpret_cast<const unsigned char*>(given);
  if (std::any_of(bytes + sizeof *given, bytes + given->size, [](int byte) { return byte != 0; })) {
    throw InputError(std::string(name) + " has members that this version of the library does not know");
  }
}

// Writes a struct, and zeros where the caller's is larger.
template <typename Struct>
void Write(const Struct& source, void* target, std::size_t size) {
  std::memcpy(target, &source, sizeof source);
  std::memset(static_cast<char*>(target) + sizeof source, 0, size - sizeof source);
}

// Where a caller writes 0, a default stands.
template <typename Number>
Number OrDefault(Number given, Number otherwise) {
  return given == 0 ? otherwise : given;
}

void RequireSize(std::int64_t size, const char* name) {
  constexpr std::int64_t kLargestSize = std::numeric_limits<std::int32_t>::max();
  if (size < 0 || size > kLargestSize) Refuse(name, size, std::string("0 <= ") + name + " < 2^31");
}

// Throws what was found to be wrong.
void RequireNothing(const std::string& wrong) {
  if (!wrong.empty()) throw InputError(wrong);
}

std::string Place(const char* array, std::int64_t i) { return std::string(array) + "[" + std::to_string(i) + "]"; }

// LcpProblem and LcpSolver look at the numbers.
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

// Friction and bounded rows of a problem's or a step's arrays: what only this interface knows of; rows and numbers are
// the problem's to check.
template <typename Arrays>
void ReadLaws(const Arrays& given, std::vector<FrictionRow>* friction, std::vector<BoundedRow>* bounded) {
  RequireSize(given.friction_count, "friction_count");
  RequireSize(given.bounded_count, "bounded_count");
  if (given.friction_count > 0) RequireNotNull(given.friction, "friction", "friction rows");
  if (given.bounded_count > 0) RequireNotNull(given.bounded, "bounded", "bounded rows");
  friction->clear();
  bounded->clear();
  for (std::int64_t k = 0; k < given.friction_count; ++k) {
    const lcpbench_friction_row& row = given.friction[k];
    if (row.slip < -1 || row.slip > 1) Refuse(Place("friction", k) + ".slip", row.slip, "-1, 0 or 1");
    if (row.reserved != 0) Refuse(Place("friction", k) + ".reserved", row.reserved, "0");
    friction->push_back({row.row, row.normal, row.mu, static_cast<signed char>(row.slip)});
  }
  for (std::int64_t k = 0; k < given.bounded_count; ++k) {
    bounded->push_back({given.bounded[k].row, given.bounded[k].lower, given.bounded[k].upper});
  }
}

MatrixFacts ReadFacts(const lcpbench_problem_data& data) {
  constexpr std::uint32_t kKnown = LCPBENCH_SYMMETRIC | LCPBENCH_POSITIVE_SEMIDEFINITE;
  if ((data.facts & ~kKnown) != 0) {
    Refuse("facts", data.facts, "0 or bits of LCPBENCH_SYMMETRIC (1) and LCPBENCH_POSITIVE_SEMIDEFINITE (2)");
  }
  MatrixFacts read;
  read.symmetric = (data.facts & LCPBENCH_SYMMETRIC) != 0;
  read.positive_semidefinite = (data.facts & LCPBENCH_POSITIVE_SEMIDEFINITE) != 0;
  if (data.form == LCPBENCH_FACTORS) {
    read.columns_per_body = OrDefault(data.columns_per_body, read.columns_per_body);
  }
  return read;
}

Eigen::MatrixXd ReadDense(const lcpbench_problem_data& data) {
  const std::int64_t n = data.rows;
  if (n == 0) return {};
  RequireNotNull(data.values, "values", "n x n numbers");
  const double numbers = static_cast<double>(n) * static_cast<double>(n);
  RequireMemory(numbers * sizeof(double), "a copy of A");
  const Eigen::Map<const Eigen::MatrixXd> by_columns(data.values, n, n);
  if (data.layout == LCPBENCH_COLUMN_MAJOR) return by_columns;
  return by_columns.transpose();
}

// The compressed arrays of `name`, checked.
SparseMatrix ReadCompressed(const lcpbench_problem_data& data, std::int64_t columns, const char* name) {
  RequireSize(data.entries, "entries");
  const bool by_columns = data.layout == LCPBENCH_COLUMN_MAJOR;
  const std::int64_t outer = by_columns ? columns : data.rows;
  const std::int64_t inner = by_columns ? data.rows : columns;
  if (data.entries == 0 && (outer == 0 || (inner == 0 && data.starts == nullptr))) return {data.rows, columns};
  RequireNotNull(data.starts, "starts", "one number for every column (or row) and one more");
  const std::span<const int> starts(data.starts, static_cast<std::size_t>(outer) + 1);
  RequireNothing(WhyNotStarts(starts, data.entries, "starts", "entries"));
  if (data.entries > 0) {
    RequireNotNull(data.indices, "indices", "an array of indices");
    RequireNotNull(data.values, "values", "an array of numbers");
  }
  const auto count = static_cast<std::size_t>(data.entries);
  return ToSparseMatrix({data.rows, columns, by_columns, starts, {data.indices, count}, {data.values, count}}, name);
}

LcpProblem ReadProblem(const lcpbench_problem_data& data) {
  RequireSize(data.rows, "rows");
  if (data.layout != LCPBENCH_COLUMN_MAJOR && data.layout != LCPBENCH_ROW_MAJOR) {
    Refuse("layout", data.layout, "LCPBENCH_COLUMN_MAJOR (0) or LCPBENCH_ROW_MAJOR (1)");
  }
  RequireKinds(data.kinds, data.rows, "kinds");
  RowBounds bounds;
  if (data.kinds != nullptr) bounds.bilateral.assign(data.kinds, data.kinds + data.rows);
  ReadLaws(data, &bounds.friction, &bounds.bounded);
  const MatrixFacts facts = ReadFacts(data);
  Eigen::VectorXd b = ReadVector(data.b, data.rows, "b");
  switch (data.form) {
    case LCPBENCH_DENSE:
      return LcpProblem::FromDense("", ReadDense(data), std::move(b), std::move(bounds), facts);
    case LCPBENCH_SPARSE:
      return LcpProblem::FromSparse("", ReadCompressed(data, data.rows, "A"), std::move(b), std::move(bounds), facts);
    case LCPBENCH_FACTORS:
      RequireSize(data.columns, "columns");
      return LcpProblem::FromFactors("", ReadCompressed(data, data.columns, "J"),
                                     ReadVector(data.inverse_mass, data.columns, "inverse_mass"), std::move(b),
                                     std::move(bounds), facts);
    default:
      Refuse("form", data.form, "LCPBENCH_DENSE (1), LCPBENCH_SPARSE (2) or LCPBENCH_FACTORS (3)");
  }
}

Settings ReadSettings(const lcpbench_setting* settings, std::size_t count) {
  Settings read;
  if (count > 0) RequireNotNull(settings, "settings", "an array of settings");
  for (std::size_t i = 0; i < count; ++i) {
    const std::string place = Place("settings", static_cast<std::int64_t>(i));
    RequireNotNull(settings[i].name, (place + ".name").c_str(), "a string");
    RequireNotNull(settings[i].value, (place + ".value").c_str(), "a string");
    if (!read.emplace(settings[i].name, settings[i].value).second) {
      throw InputError(place + ".name is '" + settings[i].name + "', which is set before");
    }
  }
  return read;
}

// The two enumerations count alike, so that a status is converted by its number.
static_assert(static_cast<int>(LcpStatus::kNotRun) == LCPBENCH_NOT_RUN);
static_assert(static_cast<int>(LcpStatus::kSolved) == LCPBENCH_SOLVED);
static_assert(static_cast<int>(LcpStatus::kInfeasible) == LCPBENCH_INFEASIBLE);
static_assert(static_cast<int>(LcpStatus::kIterationLimit) == LCPBENCH_ITERATION_LIMIT);
static_assert(static_cast<int>(LcpStatus::kTimeLimit) == LCPBENCH_TIME_LIMIT);
static_assert(static_cast<int>(LcpStatus::kNumericalFailure) == LCPBENCH_NUMERICAL_FAILURE);
static_assert(static_cast<int>(LcpStatus::kUnsupported) == LCPBENCH_UNSUPPORTED);

bool IsStatus(lcpbench_status status) { return status >= LCPBENCH_NOT_RUN && status <= LCPBENCH_UNSUPPORTED; }

// Replaces solved forces by those of least norm; the free directions of the forces, -1 where there are none such.
Index TakeLeastNorm(const LcpProblem& problem, const LcpOptions& options, double rank_tolerance, LcpResult* result) {
  if (rank_tolerance == 0 || result->status != LcpStatus::kSolved) return -1;
  LeastNormForces found =
      FindLeastNormForces(problem, result->f, {options.tolerance, rank_tolerance, options.time_limit_s});
  if (found.status != LcpStatus::kSolved) {
    result->detail = "not of least norm: " + found.detail;
    return -1;
  }
  result->f = std::move(found.f);
  return found.nullity;
}

LcpResult ReadAnswer(const lcpbench_answer& answer, Index n) {
  if (answer.n != n) Refuse("answer.n", answer.n, "the problem's n = " + std::to_string(n));
  if (!IsStatus(answer.status)) Refuse("answer.status", answer.status, "a lcpbench_status");
  LcpResult result;
  result.status = static_cast<LcpStatus>(answer.status);
  if (answer.relaxed != 0) result.model = FrictionModel::kRelaxation;
  result.f = ReadVector(answer.f, n, "answer.f");
  if (answer.ray != nullptr && n > 0) result.farkas_ray = ReadVector(answer.ray, n, "answer.ray");
  return result;
}

template <std::size_t kSize>
void CopyText(const std::string& text, char (&target)[kSize]) {
  target[text.copy(target, kSize - 1)] = '\0';
}

lcpbench_verdict MakeVerdict(const Verdict& found) {
  const Metrics& m = found.metrics;
  const FarkasVerdict ray = found.farkas.value_or(FarkasVerdict());
  lcpbench_verdict verdict = {.requested = found.requested,
                              .passes = found.passes,
                              .false_success = found.false_success,
                              .false_infeasible = found.false_infeasible,
                              .has_ray = found.farkas.has_value(),
                              .ray_accepted = ray.accepted,
                              .ray_proved = ray.proved,
                              .best_tier = found.best_tier,
                              .rho = m.rho,
                              .backward_error = m.backward_error,
                              .natural_residual = m.natural_residual,
                              .primal_infeasibility = m.primal_infeasibility,
                              .dual_infeasibility = m.dual_infeasibility,
                              .complementarity = m.complementarity,
                              .gap = m.gap,
                              .energy_bound = m.energy_bound,
                              .energy_shift = m.energy_shift,
                              .answer_floor = m.answer_floor,
                              .ray_b_dot_y = ray.b_dot_y,
                              .ray_null_residual = ray.null_residual,
                              .reason = {},
                              .ray_reason = {},
                              .ray_force_min = ray.force_min,
                              .penetration = m.penetration,
                              .adhesion = m.adhesion,
                              .separation = m.separation,
                              .cone = m.cone,
                              .dissipation = m.dissipation,
                              .joints = m.joints,
                              .beyond_bounds = m.beyond_bounds,
                              .model_rho = found.model_rho};
  CopyText(found.reason, verdict.reason);
  CopyText(ray.reason, verdict.ray_reason);
  return verdict;
}

StepOptions ReadStepOptions(const lcpbench_step_options* given) {
  StepOptions read;
  if (given == nullptr) return read;
  RequireStruct(given, "options", "lcpbench_step_options");
  if (given->reserved != 0) Refuse("options.reserved", given->reserved, "0");
  read.tolerance = OrDefault(given->tolerance, read.tolerance);
  read.time_limit_s = OrDefault(given->time_limit_s, read.time_limit_s);
  read.threads = OrDefault(given->threads, read.threads);
  return read;
}

// What only this interface knows of; the arrays are the step solver's to check.
// @param step  for what is read
StepRows ReadStepRows(const lcpbench_step_rows* given, lcpbench_step* step) {
  RequireStruct(given, "rows", "lcpbench_step_rows");
  RequireSize(given->rows, "rows.rows");
  RequireSize(given->bodies, "rows.bodies");
  if (given->reserved != 0) Refuse("rows.reserved", given->reserved, "0");
  if (given->J != nullptr && given->J_single != nullptr) {
    throw InputError("rows.J and rows.J_single are both given, expected one of them");
  }
  ReadLaws(*given, &step->friction, &step->bounded);
  RequireKinds(given->kinds, given->rows, "rows.kinds");
  return {.columns_per_body = OrDefault(given->columns_per_body, StepRows().columns_per_body),
          .rows = given->rows,
          .bodies = given->bodies,
          .body = given->body,
          .J = given->J,
          .J_single = given->J_single,
          .b = given->b,
          .bilateral = given->kinds,
          .inverse_mass = given->inverse_mass,
          .friction = step->friction,
          .bounded = step->bounded};
}

lcpbench_step_answer MakeStepAnswer(const StepAnswer& from) {
  return {.status = static_cast<lcpbench_status>(from.status),
          .infeasible_proved = from.infeasible_proved,
          .iterations = from.iterations,
          .rho = from.rho,
          .force_min = from.force_min};
}

}  // namespace
}  // namespace lcpbench

using namespace lcpbench;

const char* lcpbench_last_error() { return last_error; }

const char* lcpbench_version() { return LCPBENCH_VERSION; }

const char* lcpbench_status_key(lcpbench_status status) {
  // Keys are literals, which end in a zero.
  return IsStatus(status) ? ToString(static_cast<LcpStatus>(status)).data() : "unknown";
}

lcpbench_error lcpbench_problem_create(const lcpbench_problem_data* data, lcpbench_problem** problem) {
  return Guard(__func__, [&] {
    RequireHandle(problem, "problem");
    RequireStruct(data, "data", "lcpbench_problem_data");
    LcpProblem made = ReadProblem(*data);
    if (made.facts().symmetric && !made.IsNumericallySymmetric()) {
      char asymmetry[32];
      std::snprintf(asymmetry, sizeof asymmetry, "%.3g", made.Asymmetry());
      throw InputError(std::string("facts has LCPBENCH_SYMMETRIC, but A is not symmetric: entries (i, j) and (j, i) ") +
                       "differ by up to " + asymmetry + " of their diagonal entries");
    }
    *problem = new lcpbench_problem{std::move(made)};
  });
}

void lcpbench_problem_free(lcpbench_problem* problem) { delete problem; }

size_t lcpbench_solver_count() { return AllSolvers().size(); }

lcpbench_error lcpbench_solver_describe(size_t index, lcpbench_solver_info* info, size_t size) {
  return Guard(__func__, [&] {
    RequireOutput(info, "info");
    RequireStructSize<lcpbench_solver_info>(size, "lcpbench_solver_info");
    const auto solvers = AllSolvers();
    if (index >= solvers.size()) {
      Refuse("index", index, "one below the " + std::to_string(solvers.size()) + " of lcpbench_solver_count");
    }
    // The table outlives every call: this interface registers no further solvers.
    const SolverEntry& entry = solvers[index];
    const lcpbench_solver_info row = {.key = entry.key.c_str(),
                                      .method = entry.method.c_str(),
                                      .source = entry.source.c_str(),
                                      .licence = entry.licence.c_str(),
                                      .available = entry.available,
                                      .uses_tolerance = entry.uses_tolerance,
                                      .is_peer = entry.origin == SolverOrigin::kPeer};
    Write(row, info, size);
  });
}

lcpbench_error lcpbench_solver_create(const char* key, const lcpbench_setting* settings, size_t count,
                                      lcpbench_solver** solver) {
  return Guard(__func__, [&] {
    RequireHandle(solver, "solver");
    RequireNotNull(key, "key", "a solver's key");
    *solver = new lcpbench_solver{MakeSolver(key, ReadSettings(settings, count)), {}};
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

lcpbench_error lcpbench_solve(lcpbench_solver* solver, const lcpbench_problem* problem,
                              const lcpbench_solve_options* options, lcpbench_answer* answer) {
  return Guard(__func__, [&] {
    Require(solver);
    Require(problem);
    RequireStruct(answer, "answer", "lcpbench_answer");
    lcpbench_solve_options given = {};
    if (options != nullptr) {
      RequireStruct(options, "options", "lcpbench_solve_options");
      given = *options;
    }
    LcpOptions solve;
    solve.tolerance = OrDefault(given.tolerance, solve.tolerance);
    solve.time_limit_s = OrDefault(given.time_limit_s, solve.time_limit_s);
    solve.max_iterations = given.max_iterations;
    if (!(given.rank_tolerance >= 0 && given.rank_tolerance < 1)) {
      Refuse("rank_tolerance", given.rank_tolerance, "0 or a number in (0, 1)");
    }
    const Index n = problem->problem.size();
    Eigen::VectorXd initial_f;
    if (given.initial_f != nullptr || given.initial_f_size != 0) {
      if (given.initial_f_size != n) {
        Refuse("initial_f_size", given.initial_f_size, "the problem's n = " + std::to_string(n));
      }
      initial_f = ReadVector(given.initial_f, n, "initial_f");
      solve.initial_f = &initial_f;
    }
    LcpResult& result = solver->result;
    solver->solver->Solve(problem->problem, solve, &result);
    const Index nullity = TakeLeastNorm(problem->problem, solve, given.rank_tolerance, &result);
    const lcpbench_answer made = {.size = answer->size,
                                  .status = static_cast<lcpbench_status>(result.status),
                                  .relaxed = result.model == FrictionModel::kRelaxation,
                                  .n = n,
                                  .f = n == 0 ? nullptr : result.f.data(),
                                  .ray = result.farkas_ray.has_value() && n > 0 ? result.farkas_ray->data() : nullptr,
                                  .iterations = result.iterations,
                                  .nullity = nullity,
                                  .detail = result.detail.c_str()};
    Write(made, answer, answer->size);
  });
}

lcpbench_error lcpbench_verify(const lcpbench_problem* problem, const lcpbench_answer* answer, double tolerance,
                               lcpbench_verdict* verdict, size_t size, double* w) {
  return Guard(__func__, [&] {
    Require(problem);
    RequireStruct(answer, "answer", "lcpbench_answer");
    RequireOutput(verdict, "verdict");
    RequireStructSize<lcpbench_verdict>(size, "lcpbench_verdict");
    if (!(tolerance > 0 && tolerance < 1)) Refuse("tolerance", tolerance, "a number in (0, 1)");
    const LcpResult result = ReadAnswer(*answer, problem->problem.size());
    const Verdict found = Verify(problem->problem, result, tolerance);
    Write(MakeVerdict(found), verdict, size);
    if (w != nullptr) std::copy(found.metrics.w.begin(), found.metrics.w.end(), w);
  });
}

lcpbench_error lcpbench_limit_library_threads(int32_t threads, int32_t* reported) {
  return Guard(__func__, [&] {
    if (threads < 1) Refuse("threads", threads, "a number >= 1");
    const int now = LimitLibraryThreads(threads);
    if (reported != nullptr) *reported = now;
  });
}

lcpbench_error lcpbench_step_create(const lcpbench_step_options* options, lcpbench_step** step) {
  return Guard(__func__, [&] {
    RequireHandle(step, "step");
    *step = new lcpbench_step{StepSolver(ReadStepOptions(options)), {}, {}, {}};
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
    RequireStructSize<lcpbench_step_answer>(size, "lcpbench_step_answer");
    if (read.rows > 0) RequireOutput(f, "f");
    if (initial_f != nullptr && initial_f == f) throw InputError("initial_f is f, expected an array of its own");
    Write(MakeStepAnswer(step->solver.Solve(read, initial_f, f, w)), answer, size);
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
    RequireStructSize<lcpbench_step_answer>(size, "lcpbench_step_answer");
    if (count > 0) RequireOutput(answers, "answers");
    if (read.rows > 0) RequireOutput(f, "f");
    const auto problems = static_cast<std::size_t>(count);
    if (step->answers.size() < problems) step->answers.resize(problems);
    const std::span<StepAnswer> found(step->answers.data(), problems);
    step->solver.SolveBatch(read, begins, f, found);
    auto* target = reinterpret_cast<char*>(answers);
    for (std::size_t k = 0; k < problems; ++k) Write(MakeStepAnswer(found[k]), target + k * size, size);
  });
}

lcpbench_error lcpbench_step_fallbacks(const lcpbench_step* step, int64_t* fallbacks) {
  return Guard(__func__, [&] {
    Require(step);
    RequireOutput(fallbacks, "fallbacks");
    *fallbacks = step->solver.fallbacks();
  });
}

void lcpbench_step_free(lcpbench_step* step) { delete step; }
