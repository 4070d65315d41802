#include "benchmarks/campaign/problem_file.h"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>

#include "benchmarks/campaign/result_fields.h"
#include "benchmarks/collection/references.h"
#include "benchmarks/measure/oracle.h"
#include "benchmarks/measure/progress.h"
#include "support/append_only_file.h"

namespace lcpbench {
namespace {

using Json = nlohmann::ordered_json;

// What stands in the manifest's own file, for readers of the campaign; of what fills up a stream it has no more than
// the recipe.
nlohmann::json EntriesOf(const std::string& path) {
  std::ifstream text(path);
  nlohmann::json entries = nlohmann::json::object();
  const nlohmann::json manifest = nlohmann::json::parse(text);
  for (const nlohmann::json& problem : manifest.at("problems")) {
    entries[problem.at("id").get<std::string>()] = problem;
  }
  return entries;
}

Json Describe(DescribedProblem of, const References& references) {
  const std::optional<KnownAnswer> answer = references.Find(of.problem);
  if (answer && answer->f.size() > 0) {
    if (std::isfinite(*answer->reference.floor)) of.floor = answer->reference.floor;
    const double oracle_s = TimeOracle(of.problem, answer->f, *answer->reference.w);
    if (oracle_s > 0) of.oracle_s = oracle_s;
  }
  return RecordOf<DescribedProblem>(ProblemFields(), of);
}

}  // namespace

void WriteProblems(const std::string& path, const std::vector<Manifest>& manifests,
                   const std::vector<std::string>& paths, const std::vector<PlannedProblem>& problems) {
  std::set<std::string> done;
  AppendOnlyFile file(path, "a problem of a campaign",
                      [&done](const auto& line) { done.insert(line.at("problem").template get<std::string>()); });
  if (problems.size() <= done.size()) return;
  struct Set {
    Set(const Manifest& manifest, const std::string& manifest_path)
        : source(FolderOf(manifest_path)),
          references(manifest, FolderOf(manifest_path)),
          known(EntriesOf(manifest_path)) {}
    static std::string FolderOf(const std::string& p) { return std::filesystem::path(p).parent_path().string(); }
    ProblemSource source;
    References references;
    nlohmann::json known;
  };
  std::vector<std::unique_ptr<Set>> sets;
  sets.reserve(manifests.size());
  for (std::size_t m = 0; m < manifests.size(); ++m) sets.push_back(std::make_unique<Set>(manifests[m], paths[m]));
  std::vector<ManifestEntry> entries;
  entries.reserve(problems.size());
  for (const PlannedProblem& planned : problems) entries.push_back(*planned.entry);
  const std::map<std::string, double> weights = WeightsByBase(entries);
  ProgressBar bar("problems", static_cast<double>(problems.size() - done.size()));
  for (const PlannedProblem& planned : problems) {
    const ManifestEntry& entry = *planned.entry;
    if (done.count(entry.id) > 0) continue;
    Set& set = *sets[planned.manifest];
    const nlohmann::json known = set.known.value(entry.id, nlohmann::json::object());
    const LcpProblem problem = set.source.Get(entry);
    file.Append({Describe({manifests[planned.manifest].name, planned, known, problem, weights.at(entry.base), {}, {}},
                          set.references)});
    bar.Advance(1, entry.id);
  }
}

}  // namespace lcpbench
