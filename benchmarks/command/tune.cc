#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "benchmarks/command/commands.h"
#include "build_info.h"
#include "support/python_script.h"

namespace lcpbench {
namespace {

// The script's options, whose defaults are there: report/tune.py.
struct TuneOption {
  const char* name;
  const char* description;
};
constexpr TuneOption kOptions[] = {
    {"--budget", "Configurations of a solver, the default among them [default: 8]"},
    {"--seed", "Of the drawing [default: 1]"},
    {"--solvers", "Only these, divided by commas [default: all of the build]"},
    {"--space", "What may be set [default: data/tuning.json]"},
    {"--sizes", "Rows of the scenes, besides the smoke tier [default: 150,600]"},
    {"--problem-seed", "Of the scenes [default: 21]"},
    {"--passes", "Timed passes over every stream [default: 3]"},
    {"--cpu", "The processor that solves are kept on"},
    {"--folder", "Of problems and campaign [default: build/results/tuning]"},
    {"--output", "What was chosen [default: data/tuned.json]"},
};

}  // namespace

void AddTuneCommand(CLI::App& app, CommandRun& run) {
  CLI::App* tune = app.add_subcommand("tune", "Tunes all solvers with one budget, for lcpbench run --tuned");
  auto values = std::make_shared<std::vector<std::string>>(std::size(kOptions));
  for (std::size_t k = 0; k < std::size(kOptions); ++k) {
    const std::string name = kOptions[k].name;
    tune->add_option(name == "--output" ? "-o," + name : name, (*values)[k], kOptions[k].description);
  }
  auto resume = std::make_shared<bool>(false);
  tune->add_flag("--resume", *resume, "Go on with the campaign that the folder has");
  tune->callback([values, resume, &run] {
    run = [values, resume] {
      std::vector<std::string> words = {"--lcpbench", std::filesystem::read_symlink("/proc/self/exe").string(),
                                        "--data", kDataFolder};
      for (std::size_t k = 0; k < std::size(kOptions); ++k) {
        // One word: a value may begin with a dash.
        if (!(*values)[k].empty()) words.push_back(std::string(kOptions[k].name) + "=" + (*values)[k]);
      }
      if (*resume) words.emplace_back("--resume");
      return RunPythonScript("tune", {kTuneScript, kInstalledTuneScript}, words);
    };
  });
}

}  // namespace lcpbench
