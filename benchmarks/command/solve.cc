#include <iostream>
#include <limits>
#include <memory>

#include "benchmarks/campaign/reference_floor.h"
#include "benchmarks/collection/gzip_file.h"
#include "benchmarks/command/commands.h"
#include "benchmarks/command/solver_options.h"
#include "solvers/io/json_lines.h"
#include "solvers/lcp/verify.h"
#include "solvers/registry.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

struct SolveArguments {
  std::string solver;
  double tolerance = 1e-9;
  double time_limit_s = std::numeric_limits<double>::infinity();
  std::int64_t max_iterations = 0;
  bool relative_to_floor = false;
  std::vector<std::string> files;
};

int Solve(const SolveArguments& arguments, const Settings& settings) {
  const std::unique_ptr<LcpSolver> solver = MakeSolver(arguments.solver, settings);
  LcpOptions options;
  options.tolerance = arguments.tolerance;
  options.time_limit_s = arguments.time_limit_s;
  options.max_iterations = arguments.max_iterations;
  // Refused here, before any file is read, and not once per problem.
  if (!(options.tolerance > 0 && options.tolerance < 1)) throw InputError("--tolerance: expected a number in (0, 1)");
  if (!(options.time_limit_s > 0)) throw InputError("--time-limit: expected seconds > 0");
  if (options.max_iterations < 0) throw InputError("--max-iterations: expected a number >= 0");

  return ForEachLine(arguments.files, [&](const std::string& line, const std::string& where) {
    LcpRecord record = ParseLcpRecord(line, where);
    LcpResult result;
    const double start = SteadyNow();
    solver->Prepare(record.problem);
    const double prepared = SteadyNow();
    solver->Solve(record.problem, options, &result);
    const double wall = SteadyNow() - prepared;
    const double solve_s = result.own_solve_s >= 0 ? result.own_solve_s : wall;
    if (arguments.relative_to_floor) {
      record.reference.floor =
          FindReferenceFloor(record.problem, options.tolerance, options.time_limit_s).reference.floor;
    }
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
  solve->add_option("--tolerance", arguments->tolerance, "Bound on rho, the scaled natural residual");
  solve->add_option("--time-limit", arguments->time_limit_s, "Seconds per problem");
  solve->add_option("--max-iterations", arguments->max_iterations, "In the solver's unit; 0 = its default");
  solve->add_flag("--floor", arguments->relative_to_floor,
                  "Judge by the larger of tolerance and the problem's rounding floor, which a reference solve finds");
  const auto settings = AddSettingsOption(*solve);
  solve->add_option("FILE", arguments->files, "JSON lines; - for standard input")->required();
  const auto named = AddNamedSolverOptions(*solve);
  solve->callback([arguments, settings, named, &run] {
    run = [arguments, settings, named] {
      named->Register();
      return Solve(*arguments, ParseSettings(*settings));
    };
  });
}

}  // namespace lcpbench
