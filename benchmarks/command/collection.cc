#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iostream>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "benchmarks/collection/build.h"
#include "benchmarks/collection/content_hash.h"
#include "benchmarks/collection/gzip_file.h"
#include "benchmarks/collection/manifest.h"
#include "benchmarks/collection/recipes/motion_steps.h"
#include "benchmarks/command/commands.h"
#include "benchmarks/measure/progress.h"
#include "solvers/io/json_lines.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

namespace fs = std::filesystem;

std::string FolderOf(const std::string& path) { return fs::path(path).parent_path().string(); }

// ----- lcpbench collection build

struct BuildArguments {
  std::string tier;
  std::string folder = "data";
  bool keep = false;
  ExamineOptions examine;
};

int Build(const BuildArguments& arguments) {
  const Tier tier = PlanTier(arguments.tier);
  const fs::path folder(arguments.folder);
  if (!fs::is_directory(folder)) throw InputError(arguments.folder + ": expected a folder");
  const fs::path path = folder / (tier.name + ".json");
  std::optional<KnownTier> known;
  if (arguments.keep) known.emplace(ReadManifest(path.string()), folder.string());
  std::unique_ptr<ProgressBar> bar;
  const BuiltTier built =
      BuildTier(tier, arguments.examine, known ? &*known : nullptr, [&](int, int all, const std::string& id) {
        if (!bar) bar = std::make_unique<ProgressBar>("collection", all);
        bar->Advance(1, id);
      });
  bar.reset();
  const auto write = [&folder](const fs::path& name, const std::string& lines) {
    fs::create_directories((folder / name).parent_path());
    WriteGzipFile((folder / name).string(), lines);
  };
  if (tier.has_files) write(built.manifest.references, built.references);
  if (tier.has_files) write("problems/" + tier.name + ".jsonl.gz", built.problems);
  if (!built.motion_problems.empty()) write(kMotionProblems, built.motion_problems);
  std::ofstream file(path);
  file << FormatManifest(built.manifest);
  file.close();
  if (!file) throw InputError(path.string() + ": cannot be written");
  std::cerr << path.string() << ": " << built.manifest.problems.size() << " problems, " << built.manifest.fill.size()
            << " fill-ups, " << built.manifest.sequences.size() << " sequences, " << built.manifest.refused.size()
            << " refused" << std::endl;
  return 0;
}

// ----- lcpbench collection check

using Comparison = std::function<void(const std::string& id, const std::string& expected, const std::string& found)>;

// Makes the motions anew that problems in files are steps of.
void CheckMotions(const Manifest& manifest, const Comparison& compare) {
  std::map<std::string, std::vector<const ManifestEntry*>> motions;
  for (const ManifestEntry& entry : manifest.problems) {
    if (entry.remake.has_value()) motions[entry.base].push_back(&entry);
  }
  for (const auto& [base, entries] : motions) {
    std::map<int, const ManifestEntry*> steps;
    for (const ManifestEntry* entry : entries) steps[entry->remake->motion_step] = entry;
    Recipe start = *entries.front()->remake;
    start.motion_step = 0;
    const std::string end = FollowMotion(start, steps.rbegin()->first, [&](const MotionStep& step) {
      const auto entry = steps.find(step.number);
      if (entry == steps.end()) return true;
      compare(entry->second->id, entry->second->sha256, ContentHash(step.instance.problem));
      return true;
    });
    if (!end.empty()) compare(base, "a motion", end);
  }
}

// The number of problems and sequences that are not what the manifest says.
int Check(const std::string& path) {
  const Manifest manifest = ReadManifest(path);
  ProblemSource source(FolderOf(path));
  int wrong = 0;
  const auto compare = [&wrong](const std::string& id, const std::string& expected, const std::string& found) {
    if (expected == found) return;
    ++wrong;
    std::cout << id << ": expected sha256 " << expected << ", found " << found << std::endl;
  };
  for (const ManifestEntry& entry : manifest.problems) {
    try {
      compare(entry.id, entry.sha256, ContentHash(source.Get(entry)));
    } catch (const InputError& error) {
      compare(entry.id, entry.sha256, error.what());
    }
  }
  CheckMotions(manifest, compare);
  std::span<const ManifestEntry> fill(manifest.fill);
  for (const FillClass& size_class : manifest.fill_classes) {
    SequenceHash hash;
    for (const ManifestEntry& entry : fill.first(size_class.problems)) hash.Add(source.Get(entry));
    fill = fill.subspan(size_class.problems);
    compare("fill-ups " + size_class.size_class, size_class.sha256, hash.Result());
  }
  for (const SequenceEntry& entry : manifest.sequences) {
    SequenceHash hash;
    ForEachSequenceProblem(entry.start, entry.steps,
                           [&hash](const LcpProblem& problem, const MotionProblem&) { hash.Add(problem); });
    compare(entry.id, entry.sha256, hash.Result());
  }
  const size_t all = manifest.problems.size() + manifest.fill_classes.size() + manifest.sequences.size();
  std::cout << path << ": " << all - static_cast<size_t>(wrong) << " of " << all << " as their hashes say" << std::endl;
  return wrong;
}

int CheckAll(const std::vector<std::string>& paths) {
  int wrong = 0;
  for (const std::string& path : paths) wrong += Check(path);
  return wrong == 0 ? 0 : 1;
}

// ----- lcpbench collection write

struct WriteArguments {
  std::string manifest;
  std::vector<std::string> ids;
  std::string output = "-";
};

int WriteProblems(const WriteArguments& arguments) {
  const Manifest manifest = ReadManifest(arguments.manifest);
  std::ofstream file;
  const bool to_file = arguments.output != "-";
  if (to_file) {
    file.open(arguments.output);
    if (!file) throw InputError(arguments.output + ": cannot be opened for writing");
  }
  std::ostream& out = to_file ? file : std::cout;
  const auto write = [&](const LcpProblem& problem) {
    out << FormatLcpRecord(problem) << '\n';
    if (!out) throw InputError(arguments.output + ": writing failed");
  };
  std::vector<std::string> left = arguments.ids;
  const auto wanted = [&](const std::string& id) {
    if (arguments.ids.empty()) return true;
    const auto found = std::find(left.begin(), left.end(), id);
    if (found == left.end()) return false;
    left.erase(found);
    return true;
  };
  ProblemSource source(FolderOf(arguments.manifest));
  for (const ManifestEntry& entry : manifest.problems) {
    if (wanted(entry.id)) write(source.Get(entry));
  }
  for (const ManifestEntry& entry : manifest.fill) {
    if (!arguments.ids.empty() && wanted(entry.id)) write(source.Get(entry));
  }
  for (const SequenceEntry& entry : manifest.sequences) {
    if (!wanted(entry.id)) continue;
    ForEachSequenceProblem(entry.start, entry.steps,
                           [&](const LcpProblem& problem, const MotionProblem&) { write(problem); });
  }
  if (!left.empty()) throw InputError(arguments.manifest + ": no problem or sequence '" + left.front() + "'");
  out.flush();
  return 0;
}

void AddBuild(CLI::App* collection, CommandRun& run) {
  auto arguments = std::make_shared<BuildArguments>();
  CLI::App* build = collection->add_subcommand("build", "Makes a tier anew: manifest and proved answers");
  build->add_option("TIER", arguments->tier, "smoke, engine, standard, large, sequences or pathological")->required();
  build->add_option("-o,--output", arguments->folder, "Folder of the manifests");
  build->add_flag("--keep", arguments->keep, "Examine again only what the manifest there does not have");
  build->add_option("--exact-up-to", arguments->examine.exact_up_to, "Rows up to which answers are proved exactly");
  build->callback([arguments, &run] { run = [arguments] { return Build(*arguments); }; });
}

void AddCheck(CLI::App* collection, CommandRun& run) {
  auto paths = std::make_shared<std::vector<std::string>>();
  CLI::App* check = collection->add_subcommand("check", "Makes all problems of manifests and compares their hashes");
  check->add_option("MANIFEST", *paths, "JSON")->required();
  check->footer("Exit status 1 where a problem is not what the manifest says.");
  check->callback([paths, &run] { run = [paths] { return CheckAll(*paths); }; });
}

void AddWrite(CLI::App* collection, CommandRun& run) {
  auto arguments = std::make_shared<WriteArguments>();
  CLI::App* write = collection->add_subcommand("write", "Writes a manifest's problems as JSON lines");
  write->add_option("MANIFEST", arguments->manifest, "JSON")->required();
  write->add_option("ID", arguments->ids, "Problems, fill-ups and sequences [default: all but fill-ups]");
  write->add_option("-o,--output", arguments->output, "File, or - for standard output");
  write->callback([arguments, &run] { run = [arguments] { return WriteProblems(*arguments); }; });
}

}  // namespace

void AddCollectionCommand(CLI::App& app, CommandRun& run) {
  CLI::App* collection = app.add_subcommand("collection", "The problem collection: make, check, write");
  collection->require_subcommand(1);
  AddBuild(collection, run);
  AddCheck(collection, run);
  AddWrite(collection, run);
}

}  // namespace lcpbench
