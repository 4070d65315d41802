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
#include <optional>
#include <span>
#include <sstream>
#include <stdexcept>
#include <string>
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
#include "solvers/rows/row_input.h"
#include "solvers/step/step_solver.h"
#include "support/input_error.h"
#include "support/number_text.h"

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
  std::vector<lcpbench::StepAnswer> answers;  // one at least
  lcpbench::RowBounds laws;                   // friction and bounded rows
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
void RequireHandle(const void* pointer, const char* name) { RequireNotNull(pointer, name, "the address of a pointer"); }

// A struct of the caller's: ours, or a later version's that does not use its further members.
template <typename Struct>
void RequireStruct(const Struct* given, const char* name, const char* type) {
  constexpr std::size_t kLargestStruct = 65536;  // beyond is uninitialised memory, not a later version
  RequireNotNull(given, name, type);
  if (given->size < sizeof(Struct) || given->size > kLargestStruct) {
    Refuse("size", given->size, "sizeof(" + std::string(type) + "), " + std::to_string(sizeof(Struct)) + " or more");
  }
  const auto* bytes = reinterpret_cast<const unsigned char*>(given);
  if (std::any_of(bytes + sizeof *given, bytes + given->size, [](int byte) { return byte != 0; })) {
    throw InputError(std::string(name) + " has members that this version of the library does not know");
  }
}

// Options, all of which have their defaults where there are none.
template <typename Options>
Options ReadOptions(const Options* options, const char* type) {
  if (options == nullptr) return {};
  RequireStruct(options, "options", type);
  return *options;
}

// Where a caller writes 0, a default stands.
template <typename Number>
Number OrDefault(Number given, Number otherwise) {
  return given == 0 ? otherwise : given;
}

// Writes a struct of that size, with zeros where it is larger than ours.
template <typename Struct>
void Write(Struct source, std::size_t size, void* target) {
  source.size = size;
  std::memcpy(target, &source, sizeof source);
  std::memset(static_cast<char*>(target) + sizeof source, 0, size - sizeof source);
}

void RequireSize(std::int64_t size, const char* name) {
  constexpr std::int64_t kLargestSize = std::numeric_limits<std::int32_t>::max();
  if (size < 0 || size > kLargestSize) Refuse(name, size, std::string("0 <= ") + name + " < 2^31");
}

std::string Place(const char* array, std::int64_t i) { return std::string(array) + "[" + std::to_string(i) + "]"; }

template <typename Item>
std::span<Item> Array(Item* items, std::int64_t size, const char* name) {
  if (size > 0 && items == nullptr) RequireNotNull(items, name, ("an array of " + std::to_string(size)).c_str());
  return {items, static_cast<std::size_t>(size)};
}

// LcpProblem and LcpSolver look at the numbers.
Eigen::VectorXd ReadVector(const double* values, std::int64_t size, const char* name) {
  return Eigen::Map<const Eigen::VectorXd>(Array(values, size, name).data(), size);
}

// How many rows of which kind: what only this interface knows of; the numbers of friction and bounded rows are the
// problem's to check.
void ReadRowKinds(const lcpbench_problem_data& data, RowBounds* laws) {
  RequireSize(data.rows, "rows");
  RequireSize(data.friction_count, "friction_count");
  RequireSize(data.bounded_count, "bounded_count");
  for (std::int64_t i = 0; i < data.rows && data.kinds != nullptr; ++i) {
    if (data.kinds[i] == LCPBENCH_BILATERAL || data.kinds[i] == LCPBENCH_UNILATERAL) continue;
    Refuse(Place("kinds", i), data.kinds[i], "LCPBENCH_UNILATERAL (0) or LCPBENCH_BILATERAL (1)");
  }
  laws->friction.clear();
  laws->bounded.clear();
  for (const lcpbench_friction_row& row : Array(data.friction, data.friction_count, "friction")) {
    if (row.slip < -1 || row.slip > 1) {
      Refuse(Place("friction", &row - data.friction) + ".slip", row.slip, "-1, 0 or 1");
    }
    laws->friction.push_back({row.row, row.normal, row.mu, static_cast<signed char>(row.slip)});
  }
  for (const lcpbench_bounded_row& row : Array(data.bounded, data.bounded_count, "bounded")) {
    laws->bounded.push_back({row.row, row.lower, row.upper});
  }
}

// The arrays of a step in place; they are the step solver's to check.
// @param laws  what ReadRowKinds has read
StepRows ReadTwoBodies(const lcpbench_problem_data& data, const RowBounds& laws) {
  RequireSize(data.bodies, "bodies");
  if (data.values != nullptr && data.values_single != nullptr) {
    throw InputError("values and values_single are both given, expected one of them");
  }
  return {.columns_per_body = OrDefault(data.columns_per_body, StepRows().columns_per_body),
          .rows = data.rows,
          .bodies = data.bodies,
          .body = data.body,
          .J = data.values,
          .J_single = data.values_single,
          .b = data.b,
          .bilateral = data.kinds,
          .inverse_mass = data.inverse_mass,
          .friction = laws.friction,
          .bounded = laws.bounded};
}

Eigen::MatrixXd ReadDense(const lcpbench_problem_data& data) {
  const std::int64_t n = data.rows;
  const double* const values = Array(data.values, n * n, "values").data();
  RequireMemory(static_cast<double>(n) * static_cast<double>(n) * sizeof(double), "a copy of A");
  const Eigen::Map<const Eigen::MatrixXd> by_columns(values, n, n);
  if (data.by_rows == 0) return by_columns;
  return by_columns.transpose();
}

// The compressed arrays of `name`, checked.
SparseMatrix ReadCompressed(const lcpbench_problem_data& data, std::int64_t columns, const char* name) {
  RequireSize(columns, "columns");
  RequireSize(data.entries, "entries");
  const bool by_columns = data.by_rows == 0;
  const bool is_empty = data.entries == 0 && (data.rows == 0 || columns == 0);
  if (is_empty && data.starts == nullptr) return {data.rows, columns};
  return ToSparseMatrix({.rows = data.rows,
                         .columns = columns,
                         .by_columns = by_columns,
                         .starts = Array(data.starts, (by_columns ? columns : data.rows) + 1, "starts"),
                         .indices = Array(data.indices, data.entries, "indices"),
                         .values = Array(data.values, data.entries, "values")},
                        name);
}

LcpProblem ReadTwoBodyProblem(const lcpbench_problem_data& data, const RowBounds& laws) {
  const StepRows rows = ReadTwoBodies(data, laws);
  CheckRows(rows, nullptr);
  const std::int64_t columns = rows.bodies * rows.columns_per_body;
  RequireSize(columns, "bodies * columns_per_body");
  Array(data.inverse_mass, columns, "inverse_mass");
  return ProblemOf(rows);
}

LcpProblem ReadProblem(const lcpbench_problem_data& data) {
  RowBounds bounds;
  ReadRowKinds(data, &bounds);
  if (data.form == LCPBENCH_TWO_BODIES) return ReadTwoBodyProblem(data, bounds);
  if (data.kinds != nullptr) bounds.bilateral.assign(data.kinds, data.kinds + data.rows);
  MatrixFacts facts;
  facts.symmetric = data.symmetric != 0;
  facts.positive_semidefinite = data.positive_semidefinite != 0;
  Eigen::VectorXd b = ReadVector(data.b, data.rows, "b");
  switch (data.form) {
    case LCPBENCH_DENSE:
      return LcpProblem::FromDense("", ReadDense(data), std::move(b), std::move(bounds), facts);
    case LCPBENCH_SPARSE:
      return LcpProblem::FromSparse("", ReadCompressed(data, data.rows, "A"), std::move(b), std::move(bounds), facts);
    case LCPBENCH_FACTORS:
      facts.columns_per_body = OrDefault(data.columns_per_body, facts.columns_per_body);
      return LcpProblem::FromFactors("", ReadCompressed(data, data.columns, "J"),
                                     ReadVector(data.inverse_mass, data.columns, "inverse_mass"), std::move(b),
                                     std::move(bounds), facts);
    default:
      Refuse("form", data.form, "one of lcpbench_form, LCPBENCH_DENSE (1) to LCPBENCH_TWO_BODIES (4)");
  }
}

Settings ReadSettings(const char* settings) {
  Settings read;
  std::istringstream words(settings == nullptr ? "" : settings);
  for (std::string word; words >> word;) {
    const std::size_t equals = word.find('=');
    if (equals == std::string::npos) throw InputError("settings has '" + word + "', expected NAME=VALUE");
    if (read.emplace(word.substr(0, equals), word.substr(equals + 1)).second) continue;
    throw InputError("settings has '" + word + "', but its name is set before");
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

LcpResult ReadAnswer(const lcpbench_answer& answer, Index n) {
  if (answer.n != n) Refuse("answer.n", answer.n, "the problem's n = " + std::to_string(n));
  if (!IsStatus(answer.status)) Refuse("answer.status", answer.status, "a lcpbench_status");
  LcpResult result;
  result.status = static_cast<LcpStatus>(answer.status);
  if (answer.relaxed != 0) result.model = FrictionModel::kRelaxation;
  result.f = ReadVector(answer.f, n, "answer.f");
  if (answer.friction_bounds != nullptr && n > 0) {
    result.model = FrictionModel::kFrozenBounds;
    result.friction_bounds = ReadVector(answer.friction_bounds, n, "answer.friction_bounds");
  }
  if (answer.ray != nullptr && n > 0) result.farkas_ray = ReadVector(answer.ray, n, "answer.ray");
  return result;
}

lcpbench_verdict MakeVerdict(const Verdict& found) {
  const Metrics& m = found.metrics;
  const FarkasVerdict ray = found.farkas.value_or(FarkasVerdict());
  lcpbench_verdict verdict = {.size = 0,
                              .requested = found.requested,
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
  std::snprintf(verdict.reason, sizeof verdict.reason, "%s", found.reason.c_str());
  std::snprintf(verdict.ray_reason, sizeof verdict.ray_reason, "%s", ray.reason.c_str());
  return verdict;
}

// What solves of problems and of steps tell.
template <typename Found>
lcpbench_answer MakeAnswer(const Found& found, Index n, const double* f) {
  lcpbench_answer answer = {};
  answer.status = static_cast<lcpbench_status>(found.status);
  answer.n = n;
  answer.f = n == 0 ? nullptr : f;
  answer.iterations = found.iterations;
  answer.nullity = -1;
  answer.detail = "";
  answer.rho = std::numeric_limits<double>::infinity();
  return answer;
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
      throw InputError("symmetric is set, but A is not symmetric: entries (i, j) and (j, i) differ by up to " +
                       FormatNumber(made.Asymmetry(), "%.3g") + " of their diagonal entries");
    }
    *problem = new lcpbench_problem{std::move(made)};
  });
}

void lcpbench_problem_free(lcpbench_problem* problem) { delete problem; }

size_t lcpbench_solver_count() { return AllSolvers().size(); }

lcpbench_error lcpbench_solver_describe(size_t index, lcpbench_solver_info* info) {
  return Guard(__func__, [&] {
    RequireStruct(info, "info", "lcpbench_solver_info");
    const auto solvers = AllSolvers();
    if (index >= solvers.size()) {
      Refuse("index", index, "one below the " + std::to_string(solvers.size()) + " of lcpbench_solver_count");
    }
    // The table outlives every call: this interface registers no further solvers.
    const SolverEntry& entry = solvers[index];
    const lcpbench_solver_info row = {.size = 0,
                                      .key = entry.key.c_str(),
                                      .method = entry.method.c_str(),
                                      .source = entry.source.c_str(),
                                      .licence = entry.licence.c_str(),
                                      .available = entry.available,
                                      .uses_tolerance = entry.uses_tolerance,
                                      .is_peer = entry.origin == SolverOrigin::kPeer};
    Write(row, info->size, info);
  });
}

lcpbench_error lcpbench_solver_create(const char* key, const char* settings, lcpbench_solver** solver) {
  return Guard(__func__, [&] {
    RequireHandle(solver, "solver");
    RequireNotNull(key, "key", "a solver's key");
    *solver = new lcpbench_solver{MakeSolver(key, ReadSettings(settings)), {}};
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
    const auto given = ReadOptions(options, "lcpbench_solve_options");
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
    std::optional<LeastNormForces> least;
    solver->solver->Solve(problem->problem, solve, &result);
    if (given.rank_tolerance > 0) {
      least = TakeLeastNorm(problem->problem, {solve.tolerance, given.rank_tolerance, solve.time_limit_s}, &result);
    }
    lcpbench_answer made = MakeAnswer(result, n, result.f.data());
    made.relaxed = result.model == FrictionModel::kRelaxation;
    if (result.friction_bounds.size() > 0) made.friction_bounds = result.friction_bounds.data();
    if (result.farkas_ray.has_value() && n > 0) made.ray = result.farkas_ray->data();
    if (least.has_value()) made.nullity = least->nullity;
    made.detail = result.detail.c_str();
    Write(made, answer->size, answer);
  });
}

lcpbench_error lcpbench_verify(const lcpbench_problem* problem, const lcpbench_answer* answer, double tolerance,
                               lcpbench_verdict* verdict, double* w) {
  return Guard(__func__, [&] {
    Require(problem);
    RequireStruct(answer, "answer", "lcpbench_answer");
    RequireStruct(verdict, "verdict", "lcpbench_verdict");
    if (!(tolerance > 0 && tolerance < 1)) Refuse("tolerance", tolerance, "a number in (0, 1)");
    const LcpResult result = ReadAnswer(*answer, problem->problem.size());
    const Verdict found = Verify(problem->problem, result, tolerance);
    Write(MakeVerdict(found), verdict->size, verdict);
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
    const auto given = ReadOptions(options, "lcpbench_step_options");
    RequireSize(given.threads, "threads");
    RequireSize(given.max_rows, "max_rows");
    RequireSize(given.max_bodies, "max_bodies");
    StepOptions read;
    read.tolerance = OrDefault(given.tolerance, read.tolerance);
    read.time_limit_s = OrDefault(given.time_limit_s, read.time_limit_s);
    read.threads = OrDefault(static_cast<int>(given.threads), read.threads);
    std::unique_ptr<lcpbench_step> made(new lcpbench_step{StepSolver(read), std::vector<StepAnswer>(1), {}});
    made->solver.Reserve(given.max_rows, given.max_bodies);
    made->laws.friction.reserve(static_cast<std::size_t>(given.max_rows));
    made->laws.bounded.reserve(static_cast<std::size_t>(given.max_rows));
    *step = made.release();
  });
}

lcpbench_error lcpbench_step_solve(lcpbench_step* step, const lcpbench_problem_data* data, const double* initial_f,
                                   double* f, double* w, lcpbench_answer* answers) {
  return Guard(__func__, [&] {
    Require(step);
    RequireStruct(data, "data", "lcpbench_problem_data");
    if (data->form != LCPBENCH_TWO_BODIES) Refuse("form", data->form, "LCPBENCH_TWO_BODIES (4)");
    ReadRowKinds(*data, &step->laws);
    const StepRows rows = ReadTwoBodies(*data, step->laws);
    Array(f, rows.rows, "f");
    const bool is_batch = data->starts != nullptr;
    if (is_batch && (initial_f != nullptr || w != nullptr)) {
      throw InputError("initial_f and w are for one problem, expected NULL where data has starts");
    }
    if (initial_f != nullptr && initial_f == f) throw InputError("initial_f is f, expected an array of its own");
    RequireSize(data->problems, "problems");
    const std::int32_t all[2] = {0, static_cast<std::int32_t>(rows.rows)};
    const std::span<const int> starts = is_batch ? Array(data->starts, data->problems + 1, "starts") : all;
    const std::string wrong = WhyNotStarts(starts, rows.rows, "starts", "rows");
    if (!wrong.empty()) throw InputError(wrong);
    const std::size_t problems = starts.size() - 1;
    if (problems > 0) RequireStruct(answers, "answers", "lcpbench_answer");
    if (step->answers.size() < problems) step->answers.resize(problems);
    const std::span<StepAnswer> found(step->answers.data(), problems);
    if (is_batch) {
      step->solver.SolveBatch(rows, starts, f, found);
    } else {
      found.front() = step->solver.Solve(rows, initial_f, f, w);
    }
    const std::size_t size = problems > 0 ? answers->size : 0;
    for (std::size_t k = 0; k < problems; ++k) {
      lcpbench_answer answer = MakeAnswer(found[k], starts[k + 1] - starts[k], f + starts[k]);
      answer.rho = found[k].rho;
      answer.force_min = found[k].force_min;
      answer.infeasible_proved = found[k].infeasible_proved;
      answer.fallbacks = step->solver.fallbacks();
      Write(answer, size, reinterpret_cast<char*>(answers) + k * size);
    }
  });
}

void lcpbench_step_free(lcpbench_step* step) { delete step; }
