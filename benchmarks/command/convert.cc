#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "benchmarks/collection/problem_formats.h"
#include "benchmarks/command/commands.h"
#include "solvers/io/json_lines.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

namespace fs = std::filesystem;

struct ConvertArguments {
  std::vector<std::string> files;
  std::string output = "-";
  std::string format;
};

// Where problems go: JSON lines to a file or standard output, one file of another format, or a folder of files.
class Sink {
 public:
  Sink(const std::string& output, const std::string& format)
      : output_(output), is_folder_(fs::is_directory(output)), format_(FormatOf(output, is_folder_, format)) {
    if (is_folder_ || format_.read != nullptr || output == "-") return;
    file_.open(output);
    if (!file_) throw InputError(output + ": cannot be opened for writing");
  }

  void Take(const LcpProblem& problem) {
    if (!is_folder_ && format_.read == nullptr) {
      std::ostream& out = output_ == "-" ? std::cout : file_;
      out << FormatLcpRecord(problem) << '\n' << std::flush;
      if (!out) throw InputError(output_ + ": writing failed");
      return;
    }
    const std::string path =
        is_folder_ ? (fs::path(output_) / (FileName(problem.id()) + "." + format_.name)).string() : output_;
    if (!written_.insert(path).second) {
      throw InputError(path + ": expected one problem of this name, found '" + problem.id() +
                       "' besides; a folder takes problems of different ids");
    }
    format_.write(problem, path);
  }

 private:
  static const ProblemFormat& FormatOf(const std::string& output, bool is_folder, const std::string& format) {
    if (is_folder) return FormatNamed(format.empty() ? "mtx" : format);
    if (format.empty() || &FormatNamed(format) == &FormatOfFile(output)) return FormatOfFile(output);
    throw InputError("--to " + format + ": expected a folder or a file of this format for --output, found '" + output +
                     "'");
  }

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
  const ProblemFormat& format_;  // with a reader unless it is JSON lines
  std::ofstream file_;
  std::set<std::string> written_;
};

int Convert(const ConvertArguments& arguments) {
  Sink sink(arguments.output, arguments.format);
  return ForEachProblem(arguments.files, [&](const LcpRecord& record) { sink.Take(record.problem); });
}

}  // namespace

void AddConvertCommand(CLI::App& app, CommandRun& run) {
  auto arguments = std::make_shared<ConvertArguments>();
  CLI::App* convert = app.add_subcommand("convert", "Writes problems in another format, bit for bit");
  convert
      ->add_option("FILE", arguments->files,
                   "JSON lines, - for standard input; name.mtx with name_b.mtx beside it; FCLib's name.hdf5 (or .h5); "
                   "Siconos' name.dat")
      ->required();
  convert->add_option(
      "-o,--output", arguments->output,
      "name.mtx, name.hdf5, name.h5 or name.dat for one problem, a folder for many, else a file of JSON "
      "lines");
  convert->add_option("--to", arguments->format, "In a folder: jsonl, mtx (the default), hdf5 or dat");
  convert->callback([arguments, &run] { run = [arguments] { return Convert(*arguments); }; });
}

}  // namespace lcpbench
