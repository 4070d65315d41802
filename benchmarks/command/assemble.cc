#include <iostream>
#include <memory>

#include "benchmarks/collection/gzip_file.h"
#include "benchmarks/command/commands.h"
#include "model/records/records.h"

namespace lcpbench {

void AddAssembleCommand(CLI::App& app, CommandRun& run) {
  auto files = std::make_shared<std::vector<std::string>>();
  CLI::App* assemble =
      app.add_subcommand("assemble", "Assembles J, gamma, A and b of contact records (JSON lines in, JSON lines out)");
  assemble->add_option("FILE", *files, "JSON lines; - for standard input")->required();
  assemble->callback([files, &run] {
    run = [files] {
      return ForEachLine(*files, [](const std::string& line, const std::string& where) {
        std::cout << AssembleRecord(line, where) << std::endl;
      });
    };
  });
}

}  // namespace lcpbench
