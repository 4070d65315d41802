#include "benchmarks/campaign/problem_file.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <set>

#include "benchmarks/collection/references.h"
#include "benchmarks/oracle.h"
#include "benchmarks/progress.h"
#include "solvers/lcp/input_error.h"

namespace lcpbench {
namespace {

using Json = nlohmann::ordered_json;

// Problems of so few rows are timed, and count in no comparison of what is hard.
constexpr Index kFewestRowsThatCount = 4;

// What stands in the manifest's own file, for readers of the campaign.
nlohmann::json EntriesOf(const std::string& text) {
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

Json Describe(const Manifest& manifest, const ManifestEntry& entry, const nlohmann::json& known,
              const LcpProblem& problem, const References& references) {
  Json line;
  line["problem"] = entry.id;
  line["set"] = manifest.name;
  line["family"] = entry.family;
  line["grid"] = entry.grid;
  for (const char* field : {"rows", "bilateral", "redundancy", "condition", "mass_ratio", "fraction_active"}) {
    line[field] = known.value(field, nlohmann::json(nullptr));
  }
  line["reference"] = entry.reference.kind;
  line["counts"] = problem.size() >= kFewestRowsThatCount;
  line["oracle_s"] = nullptr;
  line["floor"] = nullptr;
  const std::optional<KnownAnswer> answer = references.Find(problem);
  if (!answer.has_value() || answer->f.size() == 0) return line;
  if (std::isfinite(*answer->reference.floor)) line["floor"] = *answer->reference.floor;
  const double oracle_s = TimeOracle(problem, answer->f, *answer->reference.w).best();
  if (oracle_s > 0) line["oracle_s"] = oracle_s;
  return line;
}

}  // namespace

void WriteProblems(const std::string& path, const std::vector<Manifest>& manifests,
                   const std::vector<std::string>& paths, const std::vector<std::vector<bool>>& wanted) {
  const std::set<std::string> done = IdsOf(path);
  std::size_t all = 0;
  for (const auto& flags : wanted) all += static_cast<std::size_t>(std::count(flags.begin(), flags.end(), true));
  std::ofstream file(path, std::ios::app);
  if (all <= done.size()) return;
  ProgressBar bar("problems", static_cast<double>(all - done.size()));
  for (std::size_t m = 0; m < manifests.size(); ++m) {
    const std::string folder = std::filesystem::path(paths[m]).parent_path().string();
    ProblemSource source(folder);
    const References references(manifests[m], folder);
    std::ifstream text(paths[m]);
    const nlohmann::json known = EntriesOf(std::string(std::istreambuf_iterator<char>(text), {}));
    for (std::size_t k = 0; k < manifests[m].problems.size(); ++k) {
      const ManifestEntry& entry = manifests[m].problems[k];
      if (!wanted[m][k] || done.count(entry.id) > 0) continue;
      file << Describe(manifests[m], entry, known.at(entry.id), source.Get(entry), references).dump() << '\n'
           << std::flush;
      if (!file) throw InputError(path + ": writing failed");
      bar.Advance(1, entry.id);
    }
  }
}

}  // namespace lcpbench
