#include "benchmarks/command/commands.h"
#include "benchmarks/command/options.h"
#include "solvers/io/json_lines.h"
#include "support/text_file.h"

namespace lcpbench {
namespace {

struct Generate {
  SceneOptions start;
  bool with_matrix = false;
  std::string output = "-";

  void Declare(CLI::App& app) {
    app.add_option("SCENE", start.scene, "Scene key (lcpbench list scenes) or scene file, whose contacts are found")
        ->required();
    start.AddSizeAndSeed(app);
    start.AddFriction(app);
    start.AddStep(app);
    app.add_flag("--with-matrix", with_matrix, "Also write A = J M^-1 J^T");
    app.add_option("-o,--output", output, "File, or - for standard output");
  }

  int Run() const {
    WriteTextFile(output, FormatLcpRecord(start.LoadProblem().second.problem, with_matrix) + "\n");
    return 0;
  }
};

}  // namespace

void AddGenerateCommand(CLI::App& app, CommandRun& run) {
  AddCommand<Generate>(app, run, "generate",
                       "Writes the contact LCP of a scene as a JSON line; with friction, of a time step");
}

}  // namespace lcpbench
