#include <iostream>

#include "benchmarks/campaign/result_fields.h"
#include "benchmarks/command/commands.h"
#include "build_info.h"
#include "model/scenes/scene.h"
#include "solvers/lcp/metric_table.h"
#include "solvers/registry.h"

namespace lcpbench {
namespace {

constexpr std::size_t kKeyWidth = 26;

void PrintRow(std::string_view key, const std::string& text) {
  std::cout << key << std::string(key.size() < kKeyWidth ? kKeyWidth - key.size() : 1, ' ') << text << '\n';
}

// Paper or library, version and licence; a peer's worker knows the version of its library.
std::string DescribeSource(const SolverEntry& entry) {
  std::string version;
  if (entry.available) {
    version =
        entry.origin == SolverOrigin::kOwn ? std::string(", LCPBench ") + kVersion : " " + WorkerVersion(entry.key);
  }
  return entry.source + version + ", " + entry.licence;
}

}  // namespace

void AddListCommand(CLI::App& app, CommandRun& run) {
  CLI::App* list = app.add_subcommand(
      "list", "Lists solvers, scenes, metrics or fields of result files, the key first on each line");
  list->require_subcommand(1);
  list->add_subcommand("solvers", "Backends: key, method, source")->callback([&run] {
    run = [] {
      for (const SolverEntry& entry : AllSolvers()) {
        PrintRow(entry.key,
                 entry.method + " [" + DescribeSource(entry) + "]" + (entry.available ? "" : " (not in this build)"));
      }
      return 0;
    };
  });
  list->add_subcommand("scenes", "Scene families: key, title, purpose")->callback([&run] {
    run = [] {
      for (const SceneFamily& scene : AllScenes()) {
        PrintRow(scene.key, std::string(scene.title) + ". " + std::string(scene.purpose));
      }
      return 0;
    };
  });
  list->add_subcommand("metrics", "Metrics of the verdict: key, formula")->callback([&run] {
    run = [] {
      for (const MetricEntry& metric : AllMetrics()) PrintRow(metric.key, std::string(metric.formula));
      return 0;
    };
  });
  CLI::App* fields =
      list->add_subcommand("fields", "Fields of a campaign's lines as Markdown: name, type, unit, meaning");
  const auto as_json = std::make_shared<bool>(false);
  fields->add_flag("--json", *as_json, "As one JSON object, by which report/ checks what it reads");
  fields->callback([as_json, &run] {
    run = [as_json] {
      std::cout << (*as_json ? ResultSchemaJson().dump(1) + "\n" : ResultSchemaMarkdown()) << std::flush;
      return 0;
    };
  });
}

}  // namespace lcpbench
