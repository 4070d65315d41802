#include <cstdint>
#include <fstream>
#include <iostream>
#include <memory>

#include "benchmarks/command/commands.h"
#include "model/contact/assembly.h"
#include "model/scenes/scene.h"
#include "solvers/io/json_lines.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

struct GenerateArguments {
  std::string scene;
  int size = 100;
  std::uint64_t seed = 1;
  bool with_matrix = false;
  std::string output = "-";
};

int Generate(const GenerateArguments& arguments) {
  const ContactSystem system = GenerateScene(arguments.scene, arguments.size, arguments.seed);
  const std::string line = FormatLcpRecord(AssembleContactLcp(system).problem, arguments.with_matrix);
  if (arguments.output == "-") {
    std::cout << line << std::endl;
    return 0;
  }
  std::ofstream file(arguments.output);
  file << line << std::endl;
  if (!file) throw InputError(arguments.output + ": cannot be written");
  return 0;
}

}  // namespace

void AddGenerateCommand(CLI::App& app, CommandRun& run) {
  auto arguments = std::make_shared<GenerateArguments>();
  CLI::App* generate = app.add_subcommand("generate", "Writes the contact LCP of a scene as a JSON line");
  generate->add_option("SCENE", arguments->scene, "Scene key (lcpbench list scenes)")->required();
  generate->add_option("--size", arguments->size, "Number of rows n");
  generate->add_option("--seed", arguments->seed, "The same seed gives the same problem, bit for bit");
  generate->add_flag("--with-matrix", arguments->with_matrix, "Also write A = J M^-1 J^T");
  generate->add_option("-o,--output", arguments->output, "File, or - for standard output");
  generate->callback([arguments, &run] { run = [arguments] { return Generate(*arguments); }; });
}

}  // namespace lcpbench
