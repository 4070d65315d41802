#include "benchmarks/recommend/embedding.h"

#include <utility>

#include "embedding_template.h"
#include "solvers/registry.h"
#include "support/number_text.h"

namespace lcpbench {
namespace {

void Replace(const std::string& mark, const std::string& by, std::string* text) {
  const size_t at = text->find(mark);
  if (at != std::string::npos) text->replace(at, mark.size(), by);
}

std::string SettingsText(const Settings& settings) {
  if (settings.empty()) return "";
  std::string pairs;
  for (const auto& [name, value] : settings) {
    pairs += (pairs.empty() ? "{\"" : ", {\"") + name + "\", \"" + value + "\"}";
  }
  return ", {" + pairs + "}";
}

}  // namespace

std::string EmbeddingCode(const std::string& solver, bool warm, const RecommendationRequest& request) {
  const SolverEntry& entry = FindSolver(solver);
  const std::string& base = entry.base.empty() ? entry.key : entry.base;
  std::string code = kEmbeddingTemplate;
  Replace("@TOLERANCE@", NumberText(request.tolerance), &code);
  Replace("@LIMIT@",
          request.deadline_s
              ? "    options.time_limit_s = " + NumberText(*request.deadline_s) + ";  // of the solve, without set-up\n"
              : "",
          &code);
  Replace("@START@", warm ? "    options.initial_f = forces_before;\n" : "", &code);
  Replace("@SOLVER@", base, &code);
  Replace("@SETTINGS@", SettingsText(entry.settings), &code);
  // Measured from cold starts: no start value to take.
  if (!warm) {
    Replace(
        "  // forces: of this step; forces_before: a start value for every row of this step, 0 for new ones, or "
        "null.\n",
        "  // forces: of this step.\n", &code);
    Replace("const Eigen::VectorXd* forces_before, ", "", &code);
  }
  return code;
}

std::string EmbeddingCMake() {
  return "find_package(lcpbench REQUIRED)\n"
         "target_link_libraries(your_engine PRIVATE lcpbench::solvers)\n";
}

}  // namespace lcpbench
