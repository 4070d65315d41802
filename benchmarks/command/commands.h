#pragma once

#include <CLI/CLI.hpp>
#include <functional>

#include "support/exit_status.h"

namespace lcpbench {

/// A subcommand adds itself to `app` and leaves in `run` what is to be done once the command line is parsed; `run`
/// returns the exit status and throws InputError for a user's mistake.
using CommandRun = std::function<int()>;

void AddListCommand(CLI::App& app, CommandRun& run);
void AddGenerateCommand(CLI::App& app, CommandRun& run);
void AddSceneCommand(CLI::App& app, CommandRun& run);
void AddSolveCommand(CLI::App& app, CommandRun& run);
void AddServeCommand(CLI::App& app, CommandRun& run);
void AddCertifyCommand(CLI::App& app, CommandRun& run);
void AddConvertCommand(CLI::App& app, CommandRun& run);
void AddCollectionCommand(CLI::App& app, CommandRun& run);
void AddImportCommand(CLI::App& app, CommandRun& run);
void AddAssembleCommand(CLI::App& app, CommandRun& run);
void AddReplayCommand(CLI::App& app, CommandRun& run);
void AddRunCommand(CLI::App& app, CommandRun& run);
void AddMergeCommand(CLI::App& app, CommandRun& run);
void AddCampaignWorkerCommand(CLI::App& app, CommandRun& run);
void AddReportCommands(CLI::App& app, CommandRun& run);
void AddRecommendCommand(CLI::App& app, CommandRun& run);
void AddSequenceCommand(CLI::App& app, CommandRun& run);
void AddMotionCommand(CLI::App& app, CommandRun& run);

}  // namespace lcpbench
