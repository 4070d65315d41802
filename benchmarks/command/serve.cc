#include "benchmarks/command/commands.h"
#include "benchmarks/command/options.h"
#include "build_info.h"
#include "solvers/peers/protocol/worker.h"
#include "solvers/registry.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

struct Serve {
  std::string solver;
  std::vector<std::string> settings;

  void Declare(CLI::App& app) {
    app.add_option("KEY", solver, "Solver key (lcpbench list solvers)")->required();
    app.add_option("NAME=VALUE", settings, "Options of the solver itself");
  }

  int Run() const { return ServeSolver(solver, ParseSettings(settings)); }
};

}  // namespace

int ServeSolver(const std::string& key, const Settings& settings) {
  const SolverEntry& entry = FindSolver(key);
  try {
    MakeSolver(key, settings);
  } catch (const InputError& error) {
    if (RefuseToStart(error.what())) return kMisuse;
    throw;
  }
  Hello hello;
  hello.name = entry.key;
  hello.library_version = kVersion;
  hello.licence = entry.licence;
  return RunWorker(hello, [&] { return entry.make(settings); });
}

void AddServeCommand(CLI::App& app, CommandRun& run) {
  AddCommand<Serve>(app, run, "serve",
                    "Serves a solver of this build on standard input and output, for --external of another build");
}

}  // namespace lcpbench
