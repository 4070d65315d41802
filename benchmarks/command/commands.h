#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <memory>
#include <string>

#include "solvers/lcp/settings.h"
#include "support/exit_status.h"

namespace lcpbench {

/// What is done once the command line is parsed. Returns the exit status; throws InputError for a user's mistake.
using CommandRun = std::function<int()>;

/// Adds a subcommand to `parent` that leaves in `run` what it does. Command has the values of its options as members,
/// Declare(CLI::App&), which adds the options, and int Run().
template <typename Command>
void AddCommand(CLI::App& parent, CommandRun& run, const std::string& name, const std::string& description) {
  CLI::App* app = parent.add_subcommand(name, description);
  const auto command = std::make_shared<Command>();
  command->Declare(*app);
  app->callback([command, &run] { run = [command] { return command->Run(); }; });
}

/// Serves a solver of this build on standard input and output (RunWorker). @return exit status
/// @throws InputError for an unknown key, and for wrong settings where nobody listens
int ServeSolver(const std::string& key, const Settings& settings);

void AddListCommand(CLI::App& app, CommandRun& run);
void AddGenerateCommand(CLI::App& app, CommandRun& run);
void AddSceneCommand(CLI::App& app, CommandRun& run);
void AddSolveCommand(CLI::App& app, CommandRun& run);
void AddServeCommand(CLI::App& app, CommandRun& run);
void AddCertifyCommand(CLI::App& app, CommandRun& run);
void AddConvertCommand(CLI::App& app, CommandRun& run);
void AddCollectionCommand(CLI::App& app, CommandRun& run);
void AddImportCommand(CLI::App& app, CommandRun& run);
void AddRecordCommands(CLI::App& app, CommandRun& run);
void AddRecordingCommand(CLI::App& app, CommandRun& run);
void AddRunCommands(CLI::App& app, CommandRun& run);
void AddReportCommands(CLI::App& app, CommandRun& run);
void AddRecommendCommand(CLI::App& app, CommandRun& run);
void AddSequenceCommand(CLI::App& app, CommandRun& run);
void AddMotionCommand(CLI::App& app, CommandRun& run);

}  // namespace lcpbench
