#include <iostream>
#include <limits>
#include <memory>

#include "benchmarks/commands.h"
#include "benchmarks/external_option.h"
#include "benchmarks/input_files.h"
#include "solvers/lcp/input_error.h"
#include "solvers/lcp/json_lines.h"
#include "solvers/lcp/verify.h"
#include "solvers/registry.h"

namespace lcpbench {
namespace {

struct SolveArguments {
  std::string solver;
  double tolerance = 1e-9;
  double time_limit_s = std::numeric_limits<double>::infinity();
  std::int64_t max_iterations = 0;
  std::vector<std::string> settings;
  std::vector<std::string> files;
};

Settings ParseSettings(const std::vector<std::string>& pairs) {
  Settings settings;
  for (const std::string& pair : pairs) {
    const auto equals = pair.find('=');
    if (equals == std::string::npos || equals == 0) {
      throw InputError("--set: expected NAME=VALUE, found '" + pair + "'");
    }
    settings[pair.substr(0, equals)] = pair.substr(equals + 1);
  }
  return settings;
}

int Solve(const SolveArguments& arguments) {
  const std::unique_ptr<LcpSolver> solver = MakeSolver(arguments.solver, ParseSettings(arguments.settings));
  LcpOptions options;
  options.tolerance = arguments.tolerance;
  options.time_limit_s = arguments.time_limit_s;
  options.max_iterations = arguments.max_iterations;
  // Refused here, before any file is read, and not once per problem.
  if (!(options.tolerance > 0 && options.tolerance < 1)) throw InputError("--tolerance: expected a number in (0, 1)");
  if (!(options.time_limit_s > 0)) throw InputError("--time-limit: expected seconds > 0");
  if (options.max_iterations < 0) throw InputError("--max-iterations: expected a number >= 0");

  return ForEachLine(arguments.files, [&](const std::string& line, const std::string& where) {
    const LcpRecord record = ParseLcpRecord(line, where);
    LcpResult result;
    const double start = SteadyNow();
    solver->Prepare(record.problem);
    const double prepared = SteadyNow();
    solver->Solve(record.problem, options, &result);
    const double wall = SteadyNow() - prepared;
    const double solve_s = result.own_solve_s >= 0 ? result.own_solve_s : wall;
    const Verdict verdict = Verify(record.problem, result, options.tolerance, &record.reference);
    std::cout << FormatSolveRecord(record.problem, arguments.solver, result, verdict, prepared - start, solve_s)
              << std::endl;
  });
}

}  // namespace

void AddSolveCommand(CLI::App& app, CommandRun& run) {
  auto arguments = std::make_shared<SolveArguments>();
  CLI::App* solve = app.add_subcommand("solve", "Solves LCPs from JSON lines and judges every answer");
  solve->add_option("--solver", arguments->solver, "Solver key (lcpbench list solvers)")->required();
  solve->add_option("--tolerance", arguments->tolerance, "Bound on rho, the scaled natural residual")
      ->capture_default_str();
  solve->add_option("--time-limit", arguments->time_limit_s, "Seconds per problem")->capture_default_str();
  solve->add_option("--max-iterations", arguments->max_iterations, "In the solver's unit; 0 = its default")
      ->capture_default_str();
  solve->add_option("--set", arguments->settings, "Option of the solver itself, NAME=VALUE; may be repeated")
      ->expected(1);
  solve->add_option("FILE", arguments->files, "JSON lines; - for standard input")->required();
  const auto externals = AddExternalOption(*solve);
  solve->callback([arguments, externals, &run] {
    run = [arguments, externals] {
      RegisterExternals(*externals);
      return Solve(*arguments);
    };
  });
}

}  // namespace lcpbench
