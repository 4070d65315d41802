#include <memory>
#include <string>
#include <vector>

#include "benchmarks/command/commands.h"
#include "benchmarks/command/solver_options.h"
#include "build_info.h"
#include "solvers/peers/protocol/worker.h"
#include "solvers/registry.h"

namespace lcpbench {
namespace {

int Serve(const std::string& solver, const Settings& settings) {
  const SolverEntry& entry = FindSolver(solver);
  MakeSolver(solver, settings);  // what is wrong with them is said now
  Hello hello;
  hello.name = entry.key;
  hello.library_version = kVersion;
  hello.licence = entry.licence;
  return RunWorker(hello, [&] { return entry.make(settings); });
}

}  // namespace

void AddServeCommand(CLI::App& app, CommandRun& run) {
  auto solver = std::make_shared<std::string>();
  auto settings = std::make_shared<std::vector<std::string>>();
  CLI::App* serve = app.add_subcommand(
      "serve", "Serves a solver of this build on standard input and output, for --external of another build");
  serve->add_option("KEY", *solver, "Solver key (lcpbench list solvers)")->required();
  serve->add_option("NAME=VALUE", *settings, "Options of the solver itself");
  serve->callback(
      [solver, settings, &run] { run = [solver, settings] { return Serve(*solver, ParseSettings(*settings)); }; });
}

}  // namespace lcpbench
