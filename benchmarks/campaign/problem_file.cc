#include "benchmarks/campaign/problem_file.h"

#include <cmath>
#include <filesystem>
#include <memory>
#include <set>

#include "benchmarks/campaign/result_fields.h"
#include "benchmarks/measure/oracle.h"
#include "benchmarks/measure/progress.h"
#include "support/append_only_file.h"

namespace lcpbench {
namespace {

std::string FolderOf(const std::string& path) { return std::filesystem::path(path).parent_path().string(); }

}  // namespace

ProblemSet::ProblemSet(const std::string& path)
    : manifest(ReadManifest(path)), source(FolderOf(path)), references(manifest, FolderOf(path)) {}

void WriteProblems(const std::string& path, const std::vector<std::string>& manifests,
                   const std::vector<PlannedProblem>& problems) {
  std::set<std::string> done;
  AppendOnlyFile file(path, "a problem of a campaign",
                      [&done](const auto& line) { done.insert(line.at("problem").template get<std::string>()); });
  if (problems.size() <= done.size()) return;
  std::vector<std::unique_ptr<ProblemSet>> sets;
  for (const std::string& manifest : manifests) sets.push_back(std::make_unique<ProblemSet>(manifest));
  std::vector<ManifestEntry> entries;
  for (const PlannedProblem& planned : problems) entries.push_back(*planned.entry);
  const std::map<std::string, double> weights = WeightsByBase(entries);
  ProgressBar bar("problems", static_cast<double>(problems.size() - done.size()));
  for (const PlannedProblem& planned : problems) {
    const ManifestEntry& entry = *planned.entry;
    if (done.count(entry.id) > 0) continue;
    ProblemSet& set = *sets[planned.manifest];
    const LcpProblem problem = set.source.Get(entry);
    DescribedProblem described{set.manifest.name, planned, problem, weights.at(entry.base), {}, {}};
    const std::optional<KnownAnswer> answer = set.references.Find(problem);
    if (answer && answer->f.size() > 0) {
      if (std::isfinite(*answer->reference.floor)) described.floor = answer->reference.floor;
      const double oracle_s = TimeOracle(problem, answer->f, *answer->reference.w);
      if (oracle_s > 0) described.oracle_s = oracle_s;
    }
    file.Append({RecordOf<DescribedProblem>(ProblemFields(), described)});
    bar.Advance(1, entry.id);
  }
}

}  // namespace lcpbench
