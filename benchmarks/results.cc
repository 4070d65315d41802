#include "benchmarks/results.h"

#include <cmath>
#include <ctime>
#include <fstream>
#include <nlohmann/json.hpp>

#include "benchmarks/environment.h"
#include "benchmarks/picture_solution.h"
#include "model/assembly.h"
#include "model/scenes/picture.h"
#include "solvers/lcp/input_error.h"
#include "solvers/lcp/metric_table.h"

namespace lcpbench {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kSchemaVersion = 1;
// Large enough to show the structure, small enough that forces and normals can be read.
constexpr int kPictureRows = 24;

void WriteText(const std::string& path, const std::string& text) {
  std::ofstream file(path);
  file << text << '\n' << std::flush;
  if (!file) throw InputError(path + ": cannot be written");
}

}  // namespace

const char* OriginKey(SolverOrigin origin) {
  switch (origin) {
    case SolverOrigin::kOwn:
      return "own";
    case SolverOrigin::kPeer:
      return "peer";
    case SolverOrigin::kExternal:
      return "external";
  }
  return "unknown";
}

void WriteRunFile(const std::string& folder, const Suite& suite, const std::string& started, double wall_s) {
  Json run;
  run["schema"] = "lcpbench-run/" + std::to_string(kSchemaVersion);
  run["suite"] = suite.name;
  run["started"] = started;
  run["wall_s"] = wall_s < 0 ? Json(nullptr) : Json(wall_s);
  run.update(ToJson(DescribeEnvironment()));
  run["tiers"] = suite.tiers;
  run["sizes"] = suite.sizes;
  run["seeds"] = suite.seeds;
  run["seed"] = suite.seeds.front();
  run["time_limit_s"] = suite.time_limit_s;
  run["time_limits"] = Json::array();
  for (const int size : suite.sizes) run["time_limits"].push_back({{"n", size}, {"s", TimeLimit(suite, size)}});
  run["size_rules"] = Json::array();
  for (const SizeRule& rule : suite.size_rules) {
    run["size_rules"].push_back(
        {{"above", rule.above}, {"seeds", rule.seeds}, {"families", rule.families}, {"tiers", rule.tiers}});
  }
  run["size_limits"] = Json::array();
  for (const SizeLimit& limit : SizeLimits()) {
    run["size_limits"].push_back({{"solver", limit.solver}, {"largest", limit.largest}, {"reason", limit.reason}});
  }
  run["min_time_s"] = suite.min_time_s;
  if (std::isfinite(suite.repeat_below_s)) run["repeat_below_s"] = suite.repeat_below_s;
  run["repetitions"] = suite.repetitions;
  run["solvers"] = Json::array();
  for (const std::string& key : suite.solvers) {
    const SolverEntry& entry = FindSolver(key);
    run["solvers"].push_back({{"key", entry.key},
                              {"method", entry.method},
                              {"source", entry.source},
                              {"origin", OriginKey(entry.origin)},
                              {"licence", entry.licence},
                              {"library_version", entry.available ? WorkerVersion(entry.key) : ""},
                              {"available", entry.available},
                              {"uses_tolerance", entry.uses_tolerance}});
  }
  run["scenes"] = Json::array();
  for (const std::string& key : suite.families) {
    const SceneFamily& scene = FindScene(key);
    run["scenes"].push_back({{"key", scene.key},
                             {"title", scene.title},
                             {"purpose", scene.purpose},
                             {"picture", std::string(scene.key) + ".svg"}});
  }
  run["metrics"] = Json::array();
  for (const MetricEntry& metric : AllMetrics()) {
    run["metrics"].push_back({{"key", metric.key}, {"formula", metric.formula}});
  }
  WriteText(folder + "/run.json", run.dump(2));
}

void WritePictures(const std::string& folder, const Suite& suite) {
  for (const std::string& family : suite.families) {
    const ContactSystem system = GenerateScene(family, kPictureRows, suite.seeds.front());
    const AssembledLcp lcp = AssembleContactLcp(system);
    // Any verified answer will do; without one the picture shows the geometry alone.
    const PictureSolution solution = SolveForPicture(lcp.problem, "");
    WriteText(folder + "/" + family + ".svg",
              RenderSvg(system, lcp, solution.found ? &solution.f : nullptr, solution.found ? &solution.w : nullptr));
  }
}

std::string UtcNow() {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&now, &utc);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &utc);
  return text;
}

}  // namespace lcpbench
