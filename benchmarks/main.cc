#include <exception>
#include <iostream>

#include "benchmarks/commands.h"
#include "build_info.h"
#include "solvers/lcp/input_error.h"

int main(int argc, char** argv) {
  using namespace lcpbench;
  CLI::App app("Compares solvers of the linear complementarity problem of rigid bodies touching along curved edges");
  app.name("lcpbench");
  app.set_version_flag("--version", std::string("lcpbench ") + kVersion);
  app.require_subcommand(1);
  // One line per mistake, as everywhere else.
  app.failure_message([](const CLI::App* failed, const CLI::Error& error) {
    return failed->get_name() + ": " + error.what() + " (see --help)\n";
  });

  CommandRun run;
  AddListCommand(app, run);
  AddGenerateCommand(app, run);
  AddSolveCommand(app, run);
  AddAssembleCommand(app, run);
  AddReplayCommand(app, run);
  AddRunCommand(app, run);
  AddReportCommand(app, run);

  try {
    app.parse(argc, argv);
    return run();
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : kMisuse;
  } catch (const InputError& error) {
    std::cerr << "lcpbench: " << error.what() << std::endl;
    return kMisuse;
  } catch (const std::exception& error) {
    std::cerr << "lcpbench: internal error: " << error.what() << std::endl;
    return 1;
  }
}
