#include <algorithm>
#include <cstddef>
#include <cstring>
#include <memory>
#include <string>

#include "solvers/c/guard.h"
#include "solvers/c/handles.h"
#include "solvers/c/lcpbench.h"
#include "solvers/linear_algebra/library_threads.h"
#include "solvers/registry.h"

namespace lcpbench {
namespace {

// Sizes in version 0.1: what programs compiled against it pass. Members that are added later come behind them.
constexpr std::size_t kFirstInfo = offsetof(lcpbench_solver_info, is_peer) + sizeof(std::int32_t);
constexpr std::size_t kFirstOptions = offsetof(lcpbench_solve_options, initial_f_size) + sizeof(std::int64_t);

Settings ReadSettings(const lcpbench_setting* settings, std::size_t count) {
  Settings read;
  if (count > 0) RequireNotNull(settings, "settings", "an array of settings");
  for (std::size_t i = 0; i < count; ++i) {
    const std::string place = "settings[" + std::to_string(i) + "]";
    RequireNotNull(settings[i].name, (place + ".name").c_str(), "a string");
    RequireNotNull(settings[i].value, (place + ".value").c_str(), "a string");
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

// The caller's struct may be shorter or longer than ours.
lcpbench_solve_options ReadOptions(const lcpbench_solve_options* given) {
  lcpbench_solve_options read = Defaults();
  if (given == nullptr) return read;
  RequireStructSize(given->size, kFirstOptions, "lcpbench_solve_options (call lcpbench_solve_options_init)");
  std::memcpy(&read, given, std::min(given->size, sizeof read));
  const auto* bytes = reinterpret_cast<const unsigned char*>(given);
  if (std::any_of(bytes + std::min(given->size, sizeof read), bytes + given->size,
                  [](int byte) { return byte != 0; })) {
    throw InputError("options has members that this version of the library does not know");
  }
  return read;
}

}  // namespace
}  // namespace lcpbench

using lcpbench::Guard;
using lcpbench::InputError;

lcpbench_error lcpbench_solver_count(size_t* count) {
  return Guard(__func__, [&] {
    lcpbench::RequireNotNull(count, "count", "where to write");
    *count = lcpbench::AllSolvers().size();
  });
}

lcpbench_error lcpbench_solver_describe(size_t index, lcpbench_solver_info* info, size_t size) {
  return Guard(__func__, [&] {
    lcpbench::RequireNotNull(info, "info", "where to write");
    lcpbench::RequireStructSize(size, lcpbench::kFirstInfo, "lcpbench_solver_info");
    const auto solvers = lcpbench::AllSolvers();
    if (index >= solvers.size()) {
      throw InputError("index is " + std::to_string(index) + ", expected one below the " +
                       std::to_string(solvers.size()) + " of lcpbench_solver_count");
    }
    // The table outlives every call: this interface registers no further solvers.
    const lcpbench::SolverEntry& entry = solvers[index];
    lcpbench_solver_info row = {};
    row.key = entry.key.c_str();
    row.method = entry.method.c_str();
    row.source = entry.source.c_str();
    row.licence = entry.licence.c_str();
    row.available = entry.available ? 1 : 0;
    row.uses_tolerance = entry.uses_tolerance ? 1 : 0;
    row.is_peer = entry.origin == lcpbench::SolverOrigin::kPeer ? 1 : 0;
    lcpbench::CopyOut(row, info, size);
  });
}

lcpbench_error lcpbench_solver_create(const char* key, const lcpbench_setting* settings, size_t count,
                                      lcpbench_solver** solver) {
  return Guard(__func__, [&] {
    lcpbench::RequireNotNull(solver, "solver", "the address of a pointer");
    lcpbench::RequireNotNull(key, "key", "a solver's key");
    *solver = new lcpbench_solver{lcpbench::MakeSolver(key, lcpbench::ReadSettings(settings, count))};
  });
}

lcpbench_error lcpbench_solver_prepare(lcpbench_solver* solver, const lcpbench_problem* problem) {
  return Guard(__func__, [&] {
    lcpbench::RequireNotNull(solver, "solver", "a solver");
    lcpbench::RequireNotNull(problem, "problem", "a problem");
    solver->solver->Prepare(problem->problem);
  });
}

void lcpbench_solver_free(lcpbench_solver* solver) { delete solver; }

lcpbench_error lcpbench_solve_options_init(lcpbench_solve_options* options, size_t size) {
  return Guard(__func__, [&] {
    lcpbench::RequireNotNull(options, "options", "where to write");
    lcpbench::RequireStructSize(size, lcpbench::kFirstOptions, "lcpbench_solve_options");
    lcpbench_solve_options defaults = lcpbench::Defaults();
    defaults.size = size;
    lcpbench::CopyOut(defaults, options, size);
  });
}

lcpbench_error lcpbench_solve(lcpbench_solver* solver, const lcpbench_problem* problem,
                              const lcpbench_solve_options* options, lcpbench_result* result) {
  return Guard(__func__, [&] {
    lcpbench::RequireNotNull(solver, "solver", "a solver");
    lcpbench::RequireNotNull(problem, "problem", "a problem");
    lcpbench::RequireNotNull(result, "result", "a result");
    const lcpbench_solve_options given = lcpbench::ReadOptions(options);
    lcpbench::LcpOptions solve;
    solve.tolerance = given.tolerance;
    solve.time_limit_s = given.time_limit_s;
    solve.max_iterations = given.max_iterations;
    Eigen::VectorXd initial_f;
    if (given.initial_f != nullptr) {
      if (given.initial_f_size != problem->problem.size()) {
        throw InputError("initial_f_size is " + std::to_string(given.initial_f_size) +
                         ", expected the problem's n = " + std::to_string(problem->problem.size()));
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
    if (threads < 1) throw InputError("threads is " + std::to_string(threads) + ", expected a number >= 1");
    const int now = lcpbench::LimitLibraryThreads(threads);
    if (reported != nullptr) *reported = now;
  });
}
