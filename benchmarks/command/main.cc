#include <string>

#include "benchmarks/command/commands.h"
#include "benchmarks/command/program.h"
#include "build_info.h"
#include "support/input_error.h"

namespace {

// CLI11 would only say that a subcommand is missing, for `lcpbench frobnicate` and `lcpbench list frobnicate` alike.
void RequireKnownCommand(const CLI::App& app, int argc, char** argv) {
  const CLI::App* current = &app;
  for (int i = 1; i == argc || argv[i][0] != '-'; ++i) {
    const auto commands = current->get_subcommands([](const CLI::App*) { return true; });
    if (commands.empty()) return;
    std::string names;
    const CLI::App* found = nullptr;
    for (const CLI::App* command : commands) {
      if (i < argc && command->check_name(argv[i])) found = command;
      // Without a group: of no use to people.
      if (!command->get_group().empty()) names += (names.empty() ? "" : ", ") + command->get_name();
    }
    if (i == argc) throw lcpbench::InputError("expected a command, one of " + names);
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

  CommandRun run;
  for (const auto add :
       {AddListCommand, AddGenerateCommand, AddSceneCommand, AddSolveCommand, AddServeCommand, AddCertifyCommand,
        AddConvertCommand, AddCollectionCommand, AddImportCommand, AddRecordCommands, AddRecordingCommand,
        AddRunCommands, AddReportCommands, AddRecommendCommand, AddSequenceCommand, AddMotionCommand}) {
    add(app, run);
  }
  HideStandIns(app);

  RequireKnownCommand(app, argc, argv);
  if (const auto status = ParseCommandLine(app, argc, argv)) return *status;
  return run();
}

}  // namespace

int main(int argc, char** argv) {
  return lcpbench::RunProgram("lcpbench", [&] { return RunCommand(argc, argv); });
}
