#include <cerrno>
#include <csignal>
#include <exception>
#include <filesystem>
#include <iostream>
#include <new>
#include <system_error>

#include "benchmarks/command/commands.h"
#include "build_info.h"
#include "solvers/lcp/memory_budget.h"
#include "solvers/linear_algebra/library_threads.h"
#include "support/exit_status.h"
#include "support/input_error.h"
#include "support/output_error.h"
#include "support/printable.h"
#include "support/subprocess.h"
#include "support/text_file.h"

namespace {

// CLI11 would only say that a subcommand is missing, for `lcpbench frobnicate` and `lcpbench list frobnicate` alike.
void RequireKnownCommand(const CLI::App& app, int argc, char** argv) {
  const CLI::App* current = &app;
  for (int i = 1; i < argc && argv[i][0] != '-'; ++i) {
    const auto commands = current->get_subcommands([](const CLI::App*) { return true; });
    if (commands.empty()) return;
    std::string names;
    const CLI::App* found = nullptr;
    for (const CLI::App* command : commands) {
      if (command->check_name(argv[i])) found = command;
      // Without a group: of no use to people.
      if (!command->get_group().empty()) names += (names.empty() ? "" : ", ") + command->get_name();
    }
    if (found == nullptr) {
      throw lcpbench::InputError(std::string("unknown command '") + argv[i] + "', expected one of " + names);
    }
    current = found;
  }
}

// Values that stand for "not given" are no defaults to show.
void HideStandIns(CLI::App& app) {
  for (CLI::Option* option : app.get_options()) {
    const std::string shown = option->get_default_str();
    if (shown == "[]" || shown == "0" || shown == "-1") option->default_str("");
  }
  for (CLI::App* command : app.get_subcommands([](CLI::App*) { return true; })) HideStandIns(*command);
}

int RunCommand(int argc, char** argv) {
  using namespace lcpbench;
  CLI::App app("Compares solvers of the linear complementarity problem of rigid bodies touching along curved edges");
  app.name("lcpbench");
  app.set_version_flag("--version", std::string("lcpbench ") + kVersion);
  app.require_subcommand(1);
  app.option_defaults()->always_capture_default();
  // One line per mistake, as everywhere else.
  app.failure_message([](const CLI::App* failed, const CLI::Error& error) {
    return Printable(failed->get_name() + ": " + error.what()) + " (see --help)\n";
  });

  // One solve, one thread: for every backend alike.
  LimitLibraryThreads(1);
  EndSubprocessesOnSignals();

  CommandRun run;
  for (const auto add :
       {AddListCommand, AddGenerateCommand, AddSceneCommand, AddSolveCommand, AddServeCommand, AddCertifyCommand,
        AddConvertCommand, AddCollectionCommand, AddImportCommand, AddRecordCommands, AddRecordingCommand,
        AddRunCommands, AddReportCommands, AddRecommendCommand, AddSequenceCommand, AddMotionCommand}) {
    add(app, run);
  }
  HideStandIns(app);

  try {
    RequireKnownCommand(app, argc, argv);
    app.parse(argc, argv);
    return run();
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : kMisuse;
  }
}

}  // namespace

int main(int argc, char** argv) {
  using namespace lcpbench;
  std::signal(SIGXFSZ, SIG_IGN);  // a limit of a file's size is told as a full disk is
  try {
    const CheckedStandardOutput checked;
    const int status = RunCommand(argc, argv);
    std::cout << std::flush;
    return status;
  } catch (const OutputError& error) {
    if (error.error() == EPIPE) return kBrokenPipe;
    std::cerr << "lcpbench: " << error.what() << std::endl;
    return kLostOutput;
  } catch (const InputError& error) {
    std::cerr << "lcpbench: " << Printable(error.what()) << std::endl;
    return kMisuse;
  } catch (const MemoryRefusal& refusal) {
    std::cerr << "lcpbench: " << Printable(refusal.what()) << std::endl;
    return kMisuse;
  } catch (const std::filesystem::filesystem_error& error) {
    std::cerr << "lcpbench: " << Printable(error.path1().string()) << ": " << error.code().message() << std::endl;
    return kMisuse;
  } catch (const std::bad_alloc&) {
    std::cerr << "lcpbench: not enough memory" << std::endl;
    return kMisuse;
  } catch (const std::system_error& error) {  // the system gives no process, or a file ends in an error
    std::cerr << "lcpbench: " << Printable(error.what()) << std::endl;
    return kMisuse;
  } catch (const std::exception& error) {
    std::cerr << "lcpbench: internal error: " << Printable(error.what()) << std::endl;
    return 1;
  }
}
