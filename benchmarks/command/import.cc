#include <algorithm>
#include <filesystem>
#include <iostream>
#include <set>
#include <string>
#include <vector>

#include "benchmarks/collection/problem_formats.h"
#include "benchmarks/collection/references.h"
#include "benchmarks/command/commands.h"
#include "benchmarks/command/options.h"
#include "solvers/io/file_ending.h"
#include "solvers/io/gzip_file.h"
#include "support/input_error.h"
#include "support/text_file.h"

namespace lcpbench {
namespace {

namespace fs = std::filesystem;

constexpr const char* kReferencesName = "references.jsonl.gz";

bool IsJsonLines(const fs::path& path) {
  return EndingOf(path.string()).format == ".jsonl" && path.filename() != kReferencesName;
}

// A file of one problem in another format; of Matrix Market name.mtx, and no part of one.
bool IsProblemFile(const fs::path& path) {
  if (FormatOfFile(path.string()).is_lines()) return false;
  const std::string stem = IdOfFile(path.string());
  const std::vector<std::string> parts = {"_b", "_x", "_J", "_invM", "_bilateral"};
  return EndingOf(path.string()).format != ".mtx" ||
         std::none_of(parts.begin(), parts.end(),
                      [&stem](const std::string& part) { return stem.ends_with(part) && stem.size() > part.size(); });
}

// Sorted: the same manifest whatever order the file system has.
std::set<fs::path> ProblemFiles(const std::string& folder) {
  if (!fs::is_directory(folder)) throw InputError(folder + ": expected a folder of problem files");
  std::set<fs::path> files;
  for (const auto& item : fs::recursive_directory_iterator(folder)) {
    if (item.is_regular_file() && (IsJsonLines(item.path()) || IsProblemFile(item.path()))) files.insert(item.path());
  }
  if (files.empty()) {
    throw InputError(
        folder +
        ": expected files *.jsonl, *.mtx, *.dat, *.qps, *.mps, also with .gz, *.npz, *.hdf5 or *.h5, found none");
  }
  return files;
}

struct Import {
  std::string folder;
  std::string provenance;
  std::string licence;
  ExamineOptions examine;
  Manifest manifest;

  void Declare(CLI::App& app) {
    manifest.version = "1";
    manifest.purpose = "Imported problems.";
    manifest.references = kReferencesName;
    app.add_option("FOLDER", folder,
                   "With files *.jsonl, name.mtx, *.dat, *.qps, *.mps, also with .gz, *.npz, *.hdf5, *.h5")
        ->required();
    app.add_option("--name", manifest.name, "Of the set [default: the folder's]");
    app.add_option("--set-version", manifest.version, "Of the set");
    app.add_option("--provenance", provenance, "Where the problems come from")->required();
    app.add_option("--licence", licence, "SPDX name of their licence")->required();
    app.add_option("--exact-up-to", examine.exact_up_to, "Rows up to which answers are proved exactly")
        ->check(AtLeast(0));
    app.footer(
        "Writes FOLDER/manifest.json and FOLDER/references.jsonl.gz. Files that cannot be read are named and left "
        "out; the exit status is then 2.");
  }

  int Run() {
    if (manifest.name.empty()) {
      // With a slash at the end the folder is its path's parent.
      manifest.name = fs::absolute(fs::path(folder) / "").lexically_normal().parent_path().filename().string();
    }
    int status = 0;
    for (const fs::path& file : ProblemFiles(folder)) {
      const std::string relative = file.lexically_relative(folder).string();
      const auto take = [&](const LcpRecord& record, const std::string& where, const std::string& line) {
        const std::size_t number = line.empty() ? 1 : std::stoul(where.substr(where.rfind(':') + 1));
        Take(record.problem, {relative, number}, where);
      };
      status = std::max(status, ForEachProblem({file.string()}, {}, take));
    }
    if (manifest.problems.empty()) throw InputError(folder + ": no problem could be read");
    WriteGzipFile((fs::path(folder) / kReferencesName).string(), references_);
    const std::string path = (fs::path(folder) / "manifest.json").string();
    WriteTextFile(path, FormatManifest(manifest));
    std::cerr << path << ": " << manifest.problems.size() << " problems" << std::endl;
    return status;
  }

 private:
  void Take(const LcpProblem& problem, FileSource source, const std::string& where) {
    if (!ids_.insert(problem.id()).second) throw InputError(where + ": id '" + problem.id() + "' is there already");
    const Examined examined = Examine(problem, examine);
    ManifestEntry& entry = manifest.problems.emplace_back(examined.entry);
    entry.family = manifest.name;
    entry.source = std::move(source);
    entry.provenance = provenance;
    entry.licence = licence;
    if (!examined.reference_line.empty()) references_ += examined.reference_line + '\n';
  }

  std::string references_;
  std::set<std::string> ids_;
};

}  // namespace

void AddImportCommand(CLI::App& app, CommandRun& run) {
  AddCommand<Import>(app, run, "import", "Makes a folder of problem files a set: manifest and proved answers");
}

}  // namespace lcpbench
