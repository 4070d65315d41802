#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "benchmarks/commands.h"
#include "benchmarks/input_files.h"
#include "solvers/lcp/input_error.h"
#include "solvers/lcp/json_lines.h"
#include "solvers/lcp/matrix_market.h"

namespace lcpbench {
namespace {

namespace fs = std::filesystem;

struct ConvertArguments {
  std::vector<std::string> files;
  std::string output = "-";
};

bool IsMarketFile(const std::string& path) { return fs::path(path).extension() == ".mtx"; }

// Where problems go: JSON lines to a file or standard output, or Matrix Market files, one set or a folder of sets.
class Sink {
 public:
  explicit Sink(const std::string& output) : output_(output), is_folder_(fs::is_directory(output)) {
    if (is_folder_ || IsMarketFile(output) || output == "-") return;
    file_.open(output);
    if (!file_) throw InputError(output + ": cannot be opened for writing");
  }

  void Take(const LcpProblem& problem) {
    if (!is_folder_ && !IsMarketFile(output_)) {
      std::ostream& out = output_ == "-" ? std::cout : file_;
      out << FormatLcpRecord(problem) << '\n' << std::flush;
      if (!out) throw InputError(output_ + ": writing failed");
      return;
    }
    const std::string path = is_folder_ ? (fs::path(output_) / (FileName(problem.id()) + ".mtx")).string() : output_;
    if (!written_.insert(path).second) {
      throw InputError(path + ": expected one problem of this name, found '" + problem.id() +
                       "' besides; a folder takes problems of different ids");
    }
    WriteMarketProblem(problem, path);
  }

 private:
  // Of ids as ids are in files: no folders, no spaces.
  static std::string FileName(const std::string& id) {
    std::string name;
    for (const char c : id) {
      const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' ||
                         c == '.' || c == '_';
      name += plain ? c : '_';
    }
    return name.empty() || name.front() == '.' ? "_" + name : name;
  }

  std::string output_;
  bool is_folder_;
  std::ofstream file_;
  std::set<std::string> written_;
};

int Convert(const ConvertArguments& arguments) {
  Sink sink(arguments.output);
  int status = 0;
  for (const std::string& path : arguments.files) {
    if (!IsMarketFile(path)) {
      const int read = ForEachLine({path}, [&](const std::string& line, const std::string& where) {
        sink.Take(ParseLcpRecord(line, where).problem);
      });
      status = std::max(status, read);
      continue;
    }
    try {
      sink.Take(ReadMarketProblem(path).problem);
    } catch (const InputError& error) {
      std::cerr << "lcpbench: " << error.what() << std::endl;
      status = kMisuse;
    }
  }
  return status;
}

}  // namespace

void AddConvertCommand(CLI::App& app, CommandRun& run) {
  auto arguments = std::make_shared<ConvertArguments>();
  CLI::App* convert = app.add_subcommand("convert", "Writes problems in another format, bit for bit");
  convert
      ->add_option("FILE", arguments->files, "JSON lines, - for standard input; or name.mtx with name_b.mtx beside it")
      ->required();
  convert
      ->add_option("-o,--output", arguments->output,
                   "name.mtx for one problem, a folder for many, else a file of JSON lines")
      ->capture_default_str();
  convert->callback([arguments, &run] { run = [arguments] { return Convert(*arguments); }; });
}

}  // namespace lcpbench
