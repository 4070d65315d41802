#include <algorithm>
#include <filesystem>
#include <iostream>
#include <set>
#include <string>
#include <vector>

#include "benchmarks/collection/gzip_file.h"
#include "benchmarks/collection/problem_formats.h"
#include "benchmarks/collection/references.h"
#include "benchmarks/command/commands.h"
#include "benchmarks/command/options.h"
#include "solvers/io/json_lines.h"
#include "support/input_error.h"
#include "support/text_file.h"

namespace lcpbench {
namespace {

namespace fs = std::filesystem;

constexpr const char* kReferencesName = "references.jsonl.gz";

bool IsJsonLines(const fs::path& path) {
  const std::string name = path.filename().string();
  return name.ends_with(".jsonl") || (name.ends_with(".jsonl.gz") && name != kReferencesName);
}

// A file of one problem in another format; of Matrix Market name.mtx, and no part of one.
bool IsProblemFile(const fs::path& path) {
  if (FormatOfFile(path.string()).read == nullptr) return false;
  const std::string stem = path.stem().string();
  const std::vector<std::string> parts = {"_b", "_x", "_J", "_invM", "_bilateral"};
  return path.extension() != ".mtx" || std::none_of(parts.begin(), parts.end(), [&stem](const std::string& part) {
           return stem.ends_with(part) && stem.size() > part.size();
         });
}

// Sorted: the same manifest whatever order the file system has.
std::set<fs::path> ProblemFiles(const std::string& folder) {
  if (!fs::is_directory(folder)) throw InputError(folder + ": expected a folder of problem files");
  std::set<fs::path> files;
  for (const auto& item : fs::recursive_directory_iterator(folder)) {
    if (item.is_regular_file() && (IsJsonLines(item.path()) || IsProblemFile(item.path()))) files.insert(item.path());
  }
  if (files.empty()) {
    throw InputError(folder + ": expected files *.jsonl, *.jsonl.gz, *.mtx, *.hdf5, *.h5 or *.dat, found none");
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
    app.add_option("FOLDER", folder, "With files *.jsonl, *.jsonl.gz, name.mtx, *.hdf5, *.h5, *.dat")->required();
    app.add_option("--name", manifest.name, "Of the set [default: the folder's]");
    app.add_option("--set-version", manifest.version, "Of the set");
    app.add_option("--provenance", provenance, "Where the problems come from")->required();
    app.add_option("--licence", licence, "SPDX name of their licence")->required();
    app.add_option("--exact-up-to", examine.exact_up_to, "Rows up to which answers are proved exactly")
        ->check(AtLeast(0));
    app.footer(
        "Writes FOLDER/manifest.json and FOLDER/references.jsonl.gz. Files that cannot be read are told and left "
        "out; exit status 2 then.");
  }

  int Run() {
    if (manifest.name.empty()) {
      // With a slash at the end the folder is its path's parent.
      manifest.name = fs::absolute(fs::path(folder) / "").lexically_normal().parent_path().filename().string();
    }
    int status = 0;
    for (const fs::path& file : ProblemFiles(folder)) {
      const std::string relative = file.lexically_relative(folder).string();
      const auto take_line = [&](const std::string& line, const std::string& where) {
        const std::size_t number = std::stoul(where.substr(where.rfind(':') + 1));
        Take(ParseLcpRecord(line, where).problem, {relative, number}, where);
      };
      const auto take = [&](const LcpRecord& record) { Take(record.problem, {relative, 1}, file.string()); };
      status = std::max(status, IsJsonLines(file) ? ForEachLine({file.string()}, take_line)
                                                  : ForEachProblem({file.string()}, {}, take));
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
