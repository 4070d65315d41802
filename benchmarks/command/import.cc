#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iostream>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "benchmarks/collection/gzip_file.h"
#include "benchmarks/collection/manifest.h"
#include "benchmarks/collection/problem_formats.h"
#include "benchmarks/collection/references.h"
#include "benchmarks/command/commands.h"
#include "solvers/io/json_lines.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

namespace fs = std::filesystem;

struct ImportArguments {
  std::string folder;
  std::string name;
  std::string version = "1";
  std::string provenance;
  std::string licence;
  ExamineOptions examine;
};

constexpr const char* kManifestName = "manifest.json";
constexpr const char* kReferencesName = "references.jsonl.gz";

bool IsJsonLines(const fs::path& path) {
  const std::string name = path.filename().string();
  return name.ends_with(".jsonl") || (name.ends_with(".jsonl.gz") && name != kReferencesName);
}

// A file of one problem in another format; of Matrix Market name.mtx, and no part of one.
bool IsProblemFile(const fs::path& path) {
  if (FormatOfFile(path.string()).read == nullptr) return false;
  if (path.extension() != ".mtx") return true;
  const std::string stem = path.stem().string();
  for (const char* part : {"_b", "_x", "_J", "_invM", "_bilateral"}) {
    if (stem.ends_with(part) && stem.size() > std::string(part).size()) return false;
  }
  return true;
}

std::vector<fs::path> ProblemFiles(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& item : fs::recursive_directory_iterator(folder)) {
    if (item.is_regular_file() && (IsJsonLines(item.path()) || IsProblemFile(item.path()))) {
      files.push_back(item.path());
    }
  }
  // The same manifest whatever order the file system has.
  std::sort(files.begin(), files.end());
  return files;
}

class Importer {
 public:
  explicit Importer(const ImportArguments& arguments) : arguments_(arguments) {
    // With a slash at the end the folder is its path's parent.
    const fs::path folder = fs::absolute(fs::path(arguments.folder) / "").lexically_normal().parent_path();
    manifest_.name = arguments.name.empty() ? folder.filename().string() : arguments.name;
    manifest_.version = arguments.version;
    manifest_.purpose = "Imported problems.";
    manifest_.references = kReferencesName;
  }

  int Run() {
    const std::vector<fs::path> files = ProblemFiles(arguments_.folder);
    if (files.empty()) {
      throw InputError(arguments_.folder +
                       ": expected files *.jsonl, *.jsonl.gz, *.mtx, *.hdf5, *.h5 or *.dat, found none");
    }
    for (const fs::path& file : files) ReadFile(file);
    if (manifest_.problems.empty()) throw InputError(arguments_.folder + ": no problem could be read");
    Write();
    return status_;
  }

 private:
  void ReadFile(const fs::path& file) {
    const std::string relative = fs::relative(file, arguments_.folder).string();
    if (IsJsonLines(file)) {
      status_ |= ForEachLine({file.string()}, [&](const std::string& line, const std::string& where) {
        const auto number = std::stoul(where.substr(where.rfind(':') + 1));
        Take(ParseLcpRecord(line, where).problem, {relative, number}, where);
      });
      return;
    }
    status_ |= TellRefusal([&] {
      Take(FormatOfFile(file.string()).read(file.string()), {relative, 1}, file.string());
    });
  }

  void Take(const LcpProblem& problem, FileSource source, const std::string& where) {
    if (!ids_.insert(problem.id()).second) throw InputError(where + ": id '" + problem.id() + "' is there already");
    const Examined examined = Examine(problem, arguments_.examine);
    ManifestEntry& entry = manifest_.problems.emplace_back(examined.entry);
    entry.family = manifest_.name;
    entry.source = std::move(source);
    entry.provenance = arguments_.provenance;
    entry.licence = arguments_.licence;
    if (!examined.reference_line.empty()) references_ += examined.reference_line + '\n';
  }

  void Write() {
    const fs::path folder(arguments_.folder);
    WriteGzipFile((folder / kReferencesName).string(), references_);
    const fs::path path = folder / kManifestName;
    std::ofstream file(path);
    file << FormatManifest(manifest_);
    file.close();
    if (!file) throw InputError(path.string() + ": cannot be written");
    std::cerr << path.string() << ": " << manifest_.problems.size() << " problems" << std::endl;
  }

  const ImportArguments& arguments_;
  Manifest manifest_;
  std::string references_;
  std::set<std::string> ids_;
  int status_ = 0;
};

int Import(const ImportArguments& arguments) {
  if (!fs::is_directory(arguments.folder)) throw InputError(arguments.folder + ": expected a folder of problem files");
  return Importer(arguments).Run();
}

}  // namespace

void AddImportCommand(CLI::App& app, CommandRun& run) {
  auto arguments = std::make_shared<ImportArguments>();
  CLI::App* import = app.add_subcommand("import", "Makes a folder of problem files a set: manifest and proved answers");
  import->add_option("FOLDER", arguments->folder, "With files *.jsonl, *.jsonl.gz, name.mtx, *.hdf5, *.h5, *.dat")
      ->required();
  import->add_option("--name", arguments->name, "Of the set [default: the folder's]");
  import->add_option("--set-version", arguments->version, "Of the set");
  import->add_option("--provenance", arguments->provenance, "Where the problems come from")->required();
  import->add_option("--licence", arguments->licence, "SPDX name of their licence")->required();
  import->add_option("--exact-up-to", arguments->examine.exact_up_to, "Rows up to which answers are proved exactly");
  import->footer(
      "Writes FOLDER/manifest.json and FOLDER/references.jsonl.gz. Files that cannot be read are told and left "
      "out; exit status 2 then.");
  import->callback([arguments, &run] { run = [arguments] { return Import(*arguments);
};
}  // namespace lcpbench
);
}

}  // namespace lcpbench
