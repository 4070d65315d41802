#include <algorithm>
#include <cctype>
#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "benchmarks/collection/problem_formats.h"
#include "benchmarks/command/commands.h"
#include "benchmarks/command/options.h"
#include "solvers/io/gzip_file.h"
#include "solvers/io/json_lines.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

namespace fs = std::filesystem;

// A file's name from an id: no folders, no spaces.
std::string FileName(std::string id) {
  const auto is_plain = [](unsigned char c) { return c < 0x80 && (std::isalnum(c) != 0 || c == '-' || c == '.'); };
  std::replace_if(id.begin(), id.end(), std::not_fn(is_plain), '_');
  return id.empty() || id.front() == '.' ? "_" + id : id;
}

struct Convert {
  std::vector<std::string> files;
  std::string output = "-";
  std::string to;
  ReadingOptions reading;

  void Declare(CLI::App& app) {
    app.add_option(
           "FILE", files,
           "JSON lines, - for standard input; name.mtx with name_b.mtx beside it; Siconos' name.dat; a quadratic "
           "program's name.qps (or .mps); all of them also with .gz; name.npz of qpsolvers; FCLib's name.hdf5 (or .h5)")
        ->required();
    app.add_option("-o,--output", output,
                   "name.mtx, name.hdf5, name.h5, name.dat, or, as a quadratic program, name.qps or name.npz (of "
                   "qpsolvers) for one problem, a folder for many, else a file of JSON lines; text also as .gz");
    app.add_option("--to", to, "In a folder: jsonl, mtx (the default), hdf5, dat, qps or npz");
    AddReadingOptions(app, &reading);
  }

  int Run() const {
    const bool is_folder = fs::is_directory(output);
    const ProblemFormat& format = Format(is_folder);
    std::optional<TextOrGzipOutput> lines;
    if (!is_folder && format.is_lines()) lines.emplace(output);
    std::set<std::string> written;
    bool any = false;
    const int status = ForEachProblem(files, reading, [&](const LcpRecord& record) {
      const LcpProblem& problem = record.problem;
      any = true;
      if (lines) return lines->Write(FormatLcpRecord(problem, false, record.symmetrized) + "\n");
      const std::string path =
          is_folder ? (fs::path(output) / (FileName(problem.id()) + "." + format.name)).string() : output;
      if (!written.insert(path).second) {
        throw InputError(path + ": expected one problem of this name, found '" + problem.id() +
                         "' besides; a folder takes problems of different ids");
      }
      format.write(problem, path);
    });
    // Where all records are bad no file is made.
    if (lines && (any || status == 0)) lines->Close();
    return status;
  }

 private:
  const ProblemFormat& Format(bool is_folder) const {
    if (is_folder) return FormatNamed(to.empty() ? "mtx" : to);
    const ProblemFormat& format = UsableFormatOfFile(output);
    if (to.empty() || &FormatNamed(to) == &format) return format;
    throw InputError("--to " + to + ": expected a folder or a file of this format for --output, found '" + output +
                     "'");
  }
};

}  // namespace

void AddConvertCommand(CLI::App& app, CommandRun& run) {
  AddCommand<Convert>(app, run, "convert", "Writes problems in another format, bit for bit");
}

}  // namespace lcpbench
