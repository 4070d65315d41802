#include "benchmarks/command/tuned_file.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "benchmarks/collection/content_hash.h"
#include "benchmarks/command/variant_option.h"
#include "solvers/registry.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kSchema = "lcpbench-tuned/1";

std::string ReadText(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw InputError(path + ": cannot be opened for reading");
  return std::string(std::istreambuf_iterator<char>(file), {});
}

struct Chosen {
  std::string solver;
  Settings settings;  // other than its defaults
};

struct TunedFile {
  int budget = 0;
  std::vector<Chosen> solvers;
};

TunedFile Parse(const std::string& text, const std::string& path) {
  TunedFile tuned;
  try {
    const Json json = Json::parse(text);
    if (json.at("schema") != kSchema) throw InputError(path + ": expected schema " + std::string(kSchema));
    tuned.budget = json.at("budget").get<int>();
    for (const Json& solver : json.at("solvers")) {
      tuned.solvers.push_back({solver.at("solver").get<std::string>(), solver.at("chosen").get<Settings>()});
    }
  } catch (const Json::exception&) {
    throw InputError(path + ": expected the JSON object that lcpbench tune writes, of schema " + kSchema);
  }
  return tuned;
}

}  // namespace

void AddTunedVariants(const std::string& path, CampaignPlan* plan, std::vector<std::string>* variants) {
  const std::string text = ReadText(path);
  const TunedFile tuned = Parse(text, path);
  std::vector<std::string> added;
  for (const Chosen& chosen : tuned.solvers) {
    const bool available = FindSolver(chosen.solver).available;
    const auto base = std::find(plan->solvers.begin(), plan->solvers.end(), chosen.solver);
    if (chosen.settings.empty() || !available || base == plan->solvers.end()) continue;
    const std::string key = chosen.solver + "-tuned";
    std::string variant = key;
    variant += "=" + chosen.solver;
    for (const auto& [name, value] : chosen.settings) variant += "," + name + "=" + value;
    added.push_back(variant);
    // Who names it among the solvers gets it once.
    if (std::find(plan->solvers.begin(), plan->solvers.end(), key) == plan->solvers.end()) {
      plan->solvers.insert(base + 1, key);
    }
  }
  RegisterVariants(added);
  variants->insert(variants->end(), added.begin(), added.end());
  plan->tuning = {std::filesystem::path(path).filename().string(), TextHash(text), tuned.budget};
}

}  // namespace lcpbench
