#include "benchmarks/campaign/problem_file.h"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>

#include "benchmarks/collection/references.h"
#include "benchmarks/measure/oracle.h"
#include "benchmarks/measure/progress.h"
#include "support/input_error.h"

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

std::set<std::string> IdsOf(const std::string& path) {
  std::set<std::string> ids;
  std::ifstream file(path);
  std::string line;
  while (std::getline(file, line)) {
    if (file.eof()) break;
    ids.insert(nlohmann::json::parse(line).at("problem").get<std::string>());
  }
  return ids;
}

Json Describe(const Manifest& manifest, const PlannedProblem& planned, const nlohmann::json& known, double weight,
              const LcpProblem& problem, const References& references) {
  const ManifestEntry& entry = *planned.entry;
  Json line;
  line["problem"] = entry.id;
  line["set"] = manifest.name;
  line["family"] = entry.family;
  line["grid"] = entry.grid;
  line["base"] = entry.base;
  line["weight"] = weight;
  line["origin"] = entry.origin;
  line["fill"] = entry.fill;
  line["size_class"] = planned.size_class->key;
  line["rows"] = problem.size();
  line["bilateral"] = problem.bilateral_rows().size();
  for (const char* field : {"redundancy", "condition", "mass_ratio", "fraction_active"}) {
    line[field] = known.value(field, nlohmann::json(nullptr));
  }
  const std::optional<KnownAnswer> answer = references.Find(problem);
  line["reference"] = entry.reference.kind;
  line["counts"] = true;
  line["oracle_s"] = nullptr;
  line["floor"] = nullptr;
  if (!answer.has_value() || answer->f.size() == 0) return line;
  if (std::isfinite(*answer->reference.floor)) line["floor"] = *answer->reference.floor;
  const double oracle_s = TimeOracle(problem, answer->f, *answer->reference.w).best();
  if (oracle_s > 0) line["oracle_s"] = oracle_s;
  return line;
}

}  // namespace

void WriteProblems(const std::string& path, const std::vector<Manifest>& manifests,
                   const std::vector<std::string>& paths, const std::vector<PlannedProblem>& problems) {
  const std::set<std::string> done = IdsOf(path);
  std::ofstream file(path, std::ios::app);
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
    file << Describe(manifests[planned.manifest], planned, set.known.value(entry.id, nlohmann::json::object()),
                     weights.at(entry.base), set.source.Get(entry), set.references)
                .dump()
         << '\n'
         << std::flush;
    if (!file) throw InputError(path + ": writing failed");
    bar.Advance(1, entry.id);
  }
}

}  // namespace lcpbench
