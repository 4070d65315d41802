#include <algorithm>
#include <boost/algorithm/string/join.hpp>
#include <filesystem>
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
#include "benchmarks/collection/manifest.h"
#include "benchmarks/collection/recipes/motion_steps.h"
#include "benchmarks/collection/sequence_problems.h"
#include "benchmarks/command/commands.h"
#include "benchmarks/command/options.h"
#include "benchmarks/measure/progress.h"
#include "solvers/io/gzip_file.h"
#include "solvers/io/json_lines.h"
#include "support/input_error.h"
#include "support/text_file.h"

namespace lcpbench {
namespace {

namespace fs = std::filesystem;

struct Build {
  std::string tier_name;
  std::string output = "data";
  bool keep = false;
  ExamineOptions examine;

  void Declare(CLI::App& app) {
    app.add_option("TIER", tier_name, "One of " + boost::algorithm::join(AllTiers(), ", "))->required();
    app.add_option("-o,--output", output, "Folder of the manifests");
    app.add_flag("--keep", keep, "Examine only what the existing manifest does not have");
    app.add_option("--exact-up-to", examine.exact_up_to, "Rows up to which answers are proved exactly")
        ->check(AtLeast(0));
    app.add_option("--time-limit", examine.time_limit_s, "Seconds for one exact answer, and for one that is bounded")
        ->check(AtLeast(0));
    app.add_option("--large-time-limit", examine.large_time_limit_s,
                   "Seconds for the answer to a problem beyond the rows that always get one")
        ->check(AtLeast(0));
  }

  int Run() const {
    const Tier tier = PlanTier(tier_name);
    const fs::path folder(output);
    if (!fs::is_directory(folder)) throw InputError(output + ": expected a folder");
    const std::string path = (folder / (tier.name + ".json")).string();
    std::optional<KnownTier> known;
    if (keep) known.emplace(ReadManifest(path), output);
    std::unique_ptr<ProgressBar> bar;
    const BuiltTier built = BuildTier(
        tier, examine, known ? &*known : nullptr,
        [&](int, int all, const std::string& id) {
          if (!bar) bar = std::make_unique<ProgressBar>("collection", all);
          bar->Advance(1, id);
        },
        output);
    bar.reset();
    const auto write = [&folder](const fs::path& name, const std::string& lines) {
      fs::create_directories((folder / name).parent_path());
      WriteGzipFile((folder / name).string(), lines);
    };
    const Manifest& manifest = built.manifest;
    if (tier.has_files) {
      write(manifest.references, built.references);
      if (!tier.has_friction && !tier.has_literals && !tier.recordings) write(ProblemFileOf(tier), built.problems);
    }
    if (!built.motion_problems.empty()) write(kMotionProblems, built.motion_problems);
    WriteTextFile(path, FormatManifest(manifest));
    std::cerr << path << ": " << manifest.problems.size() << " problems, " << manifest.fill.size() << " fill-ups, "
              << manifest.sequences.size() << " sequences, " << manifest.refused.size() << " refused" << std::endl;
    return 0;
  }
};

struct Check {
  std::vector<std::string> paths;

  void Declare(CLI::App& app) {
    app.add_option("MANIFEST", paths, "JSON")->required();
    app.footer("Exit status 1 where a problem is not what the manifest says.");
  }

  int Run() {
    for (const std::string& path : paths) CheckManifest(path);
    return wrong_ == 0 ? 0 : 1;
  }

 private:
  void Compare(const std::string& id, const std::string& expected, const std::string& found) {
    if (expected == found) return;
    ++wrong_;
    std::cout << id << ": expected sha256 " << expected << ", found " << found << std::endl;
  }

  void CheckManifest(const std::string& path) {
    const Manifest manifest = ReadManifest(path);
    ProblemSource source(FolderOf(path));
    const int wrong_before = wrong_;
    for (const ManifestEntry& entry : manifest.problems) {
      try {
        Compare(entry.id, entry.sha256, ContentHash(source.Get(entry)));
      } catch (const InputError& error) {
        Compare(entry.id, entry.sha256, error.what());
      }
    }
    CheckMotions(manifest);
    std::span<const ManifestEntry> fill(manifest.fill);
    for (const FillClass& size_class : manifest.fill_classes) {
      SequenceHash hash;
      for (const ManifestEntry& entry : fill.first(size_class.problems)) hash.Add(source.Get(entry));
      fill = fill.subspan(size_class.problems);
      Compare("fill-ups " + size_class.size_class, size_class.sha256, hash.Result());
    }
    for (const SequenceEntry& entry : manifest.sequences) {
      SequenceHash hash;
      ForEachProblemOf(entry, FolderOf(path), [&hash](const SequenceProblem& met) { hash.Add(met.problem); });
      Compare(entry.id, entry.sha256, hash.Result());
    }
    const auto all =
        static_cast<int>(manifest.problems.size() + manifest.fill_classes.size() + manifest.sequences.size());
    std::cout << path << ": " << all - (wrong_ - wrong_before) << " of " << all << " as their hashes say" << std::endl;
  }

  // Makes the motions anew that problems in files are steps of.
  void CheckMotions(const Manifest& manifest) {
    std::map<std::string, std::map<int, const ManifestEntry*>> motions;  // by base and step
    for (const ManifestEntry& entry : manifest.problems) {
      if (entry.remake) motions[entry.base][entry.remake->motion_step] = &entry;
    }
    for (const auto& [base, steps] : motions) {
      Recipe start = *steps.begin()->second->remake;
      start.motion_step = 0;
      const std::string end = FollowMotion(start, steps.rbegin()->first, [&](const MotionStep& step) {
        const auto entry = steps.find(step.number);
        if (entry == steps.end()) return true;
        Compare(entry->second->id, entry->second->sha256, ContentHash(step.instance.problem));
        return true;
      });
      if (!end.empty()) Compare(base, "a motion", end);
    }
  }

  int wrong_ = 0;
};

struct WriteProblems {
  std::string path;
  std::vector<std::string> ids;
  std::string output = "-";

  void Declare(CLI::App& app) {
    app.add_option("MANIFEST", path, "JSON")->required();
    app.add_option("ID", ids, "Problems, fill-ups and sequences [default: all but fill-ups]");
    app.add_option("-o,--output", output, "File, or - for standard output");
  }

  int Run() const {
    const Manifest manifest = ReadManifest(path);
    TextOrGzipOutput out(output);
    const auto write = [&](const LcpProblem& problem) { out.Write(FormatLcpRecord(problem) + "\n"); };
    std::vector<std::string> left = ids;
    const auto wanted = [&](const std::string& id) { return ids.empty() || std::erase(left, id) > 0; };
    ProblemSource source(FolderOf(path));
    for (const ManifestEntry& entry : manifest.problems) {
      if (wanted(entry.id)) write(source.Get(entry));
    }
    for (const ManifestEntry& entry : manifest.fill) {
      if (!ids.empty() && wanted(entry.id)) write(source.Get(entry));
    }
    for (const SequenceEntry& entry : manifest.sequences) {
      if (!wanted(entry.id)) continue;
      ForEachProblemOf(entry, FolderOf(path), [&](const SequenceProblem& met) { write(met.problem); });
    }
    out.Close();
    if (!left.empty()) throw InputError(path + ": no problem or sequence '" + left.front() + "'");
    return 0;
  }
};

}  // namespace

void AddCollectionCommand(CLI::App& app, CommandRun& run) {
  CLI::App* collection = app.add_subcommand("collection", "The problem collection: make, check, write");
  collection->require_subcommand(1);
  AddCommand<Build>(*collection, run, "build", "Makes a tier anew: manifest and proved answers");
  AddCommand<Check>(*collection, run, "check", "Makes all problems of manifests and compares their hashes");
  AddCommand<WriteProblems>(*collection, run, "write", "Writes a manifest's problems as JSON lines");
}

}  // namespace lcpbench
