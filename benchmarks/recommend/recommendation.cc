#include "benchmarks/recommend/recommendation.h"

#include <algorithm>
#include <boost/algorithm/string/join.hpp>
#include <boost/algorithm/string/replace.hpp>
#include <cmath>
#include <utility>

#include "benchmarks/measure/text_table.h"
#include "embedding_template.h"
#include "solvers/registry.h"
#include "support/number_text.h"

namespace lcpbench {
namespace {

using Json = nlohmann::ordered_json;

// What the engine's CMakeLists.txt needs.
constexpr const char* kCMake =
    "find_package(lcpbench REQUIRED)\n"
    "target_link_libraries(your_engine PRIVATE lcpbench::step)\n";

// Shares and times are no better known than that.
std::string ShortText(double value) { return FormatNumber(value, "%.3g"); }

std::string Rounded(double value) {
  const bool plain = value == 0 || (std::abs(value) >= 1e-3 && std::abs(value) <= 1e5);
  return FormatNumber(value, plain ? "%.5g" : "%.2e");
}

std::string ErrorText(double value) { return std::isfinite(value) ? FormatNumber(value, "%.1e") : "-"; }

std::string LawOf(const Assessment& each) { return std::string(FindSolver(each.measured.solver).law); }

std::string LawNote(const Recommendation& all, const Assessment& each) {
  return all.has_friction && !LawOf(each).empty() ? " (law of friction: " + LawOf(each) + ")" : "";
}

std::string Evidence(const Recommendation& all, const Assessment& each) {
  const char* start = !all.rows_are_known ? "" : each.measured.warm ? ", warm starts" : ", cold starts";
  std::string text = each.measured.solver + LawNote(all, each) + start + ": " + TimeText(each.p50_s) + " median, " +
                     TimeText(each.p99_s) + " p99, rho " + ErrorText(each.measured.rho);
  if (all.request.deadline_s) text += ", in time " + ShortText(100 * each.in_time) + " %";
  if (each.measured.proofs > 0) {
    text += ", shows that " + std::to_string(each.measured.proofs) + " of " +
            std::to_string(each.measured.latency_s.size()) + " steps have no solution";
  }
  return each.shortcoming.empty() ? text : text + "; " + each.shortcoming;
}

std::string Heading(const Recommendation& all) {
  std::string text =
      all.input + ": " + std::to_string(all.problems) + (all.problems == 1 ? " problem, " : " problems, ");
  text += Rounded(all.least_rows);
  if (all.most_rows > all.least_rows) text += " to " + Rounded(all.most_rows);
  text += " rows; asked for: rho <= " + ShortText(all.request.tolerance);
  if (all.request.deadline_s) text += ", set-up and solve within " + TimeText(*all.request.deadline_s);
  return text + "\n";
}

std::string BudgetLine(const Recommendation& all) {
  return "race: at most " + std::to_string(all.rounds) + " rounds of " + std::to_string(all.samples) +
         " solves within " + TimeText(all.budget_s) + ", took " + TimeText(all.spent_s) + "\n";
}

std::string Table(const Recommendation& all) {
  std::vector<std::vector<std::string>> rows = {{"solver", "start", "passes", "median", "p99", "max"}};
  if (all.request.deadline_s) rows.front().emplace_back("in time");
  for (const char* heading : {"verified", "rho", ""}) rows.front().emplace_back(heading);
  if (all.has_friction) rows.front().insert(rows.front().begin() + 1, "law");
  for (const Assessment& each : all.ranked) {
    const Measurement& measured = each.measured;
    std::vector<std::string> row = {measured.solver,
                                    measured.warm ? "warm" : "cold",
                                    std::to_string(measured.passes),
                                    TimeText(each.p50_s),
                                    TimeText(each.p99_s),
                                    TimeText(each.max_s)};
    if (all.request.deadline_s) row.push_back(ShortText(100 * each.in_time) + " %");
    row.push_back(ShortText(100 * each.verified) + " %");
    row.push_back(ErrorText(measured.rho));
    row.push_back(each.shortcoming.empty() ? measured.dropped : each.shortcoming);
    if (all.has_friction) row.insert(row.begin() + 1, LawOf(each));
    rows.push_back(row);
  }
  return FormatTable(rows);
}

// A line per reason, in the order of their first solvers.
std::string UntriedText(const Recommendation& all) {
  constexpr size_t kMostNamed = 8;
  std::vector<std::pair<std::string, std::vector<std::string>>> lines;
  for (const auto& [solver, reason] : all.untried) {
    const auto same = [&reason = reason](const auto& line) { return line.first == reason; };
    auto line = std::find_if(lines.begin(), lines.end(), same);
    if (line == lines.end()) line = lines.insert(lines.end(), {reason, {}});
    line->second.push_back(solver);
  }
  std::string text;
  for (auto& [reason, solvers] : lines) {
    const size_t more = solvers.size() - std::min(solvers.size(), kMostNamed);
    solvers.resize(solvers.size() - more);
    text += "not tried: " + boost::algorithm::join(solvers, ", ");
    text += (more > 0 ? " and " + std::to_string(more) + " more" : "") + " (" + reason + ")\n";
  }
  return text;
}

std::string OriginNote(const std::string& solver) {
  const SolverOrigin origin = FindSolver(solver).origin;
  if (origin == SolverOrigin::kOwn) return "";
  return origin == SolverOrigin::kPeer
             ? "It runs in a process of its own, which takes longer than what was timed; its library can be called "
               "directly.\n"
             : "It is a command of yours: RegisterExternalSolver makes its key known, or call its library directly.\n";
}

std::string DisturbedText(const Recommendation& all) {
  int disturbed = 0;
  for (const Assessment& each : all.ranked) disturbed += each.measured.disturbed;
  if (disturbed == 0) return "";
  return "note: the processor's clock was slower than at its best by a tenth in " + std::to_string(disturbed) +
         " passes; where there were others, these count\n";
}

Json FiniteOrNull(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

std::string SettingsText(const Settings& settings) {
  if (settings.empty()) return "";
  std::string pairs;
  for (const auto& [name, value] : settings) {
    pairs += (pairs.empty() ? "{\"" : ", {\"") + name + "\", \"" + value + "\"}";
  }
  return ", {" + pairs + "}";
}

using Replacements = std::vector<std::pair<std::string, std::string>>;

std::string Filled(std::string code, const Replacements& replacements) {
  for (const auto& [mark, text] : replacements) boost::algorithm::replace_first(code, mark, text);
  return code;
}

// Measured from cold starts: no start value to take.
void LeaveOutStart(const std::string& declaration, Replacements* replacements) {
  replacements->emplace_back("; forces_before: a start value for every row of this step, 0 for new ones, or null.",
                             ".");
  replacements->emplace_back(declaration, "");
}

// The code that uses the best solver.
std::string RecommendedCode(const Recommendation& all) {
  const Measurement& measured = all.ranked.front().measured;
  if (measured.solver == "auto" && all.step_sizes) {
    return StepEmbeddingCode(*all.step_sizes, measured.warm, all.request);
  }
  return EmbeddingCode(measured.solver, measured.warm, all.request);
}

}  // namespace

std::optional<StepSizes> FindStepSizes(const std::vector<SequenceStep>& steps) {
  std::optional<StepSizes> sizes;
  for (const SequenceStep& step : steps) {
    const LcpProblem& problem = step.problem;
    if (problem.size() > kMostStepRows || !problem.has_two_body_rows()) return {};
    if (!sizes) sizes.emplace().columns_per_body = problem.columns_per_body();
    if (problem.columns_per_body() != sizes->columns_per_body) return {};
    sizes->rows = std::max(sizes->rows, problem.size());
    sizes->bodies = std::max(sizes->bodies, problem.J().cols() / problem.columns_per_body());
  }
  return sizes;
}

std::string EmbeddingCode(const std::string& solver, bool warm, const RecommendationRequest& request) {
  const SolverEntry& entry = FindSolver(solver);
  const std::string& base = entry.base.empty() ? entry.key : entry.base;
  Replacements replacements = {
      {"@TOLERANCE@", NumberText(request.tolerance)},
      {"@LIMIT@", request.deadline_s ? "    options.time_limit_s = " + NumberText(*request.deadline_s) +
                                           ";  // of the solve, without set-up\n"
                                     : ""},
      {"@START@", warm ? "    options.initial_f = forces_before;\n" : ""},
      {"@SOLVER@", base},
      {"@SETTINGS@", SettingsText(entry.settings)}};
  if (!warm) LeaveOutStart("const Eigen::VectorXd* forces_before, ", &replacements);
  return Filled(kEmbeddingTemplate, replacements);
}

std::string StepEmbeddingCode(const StepSizes& sizes, bool warm, const RecommendationRequest& request) {
  Replacements replacements = {
      {"@ROWS@", std::to_string(sizes.rows)},
      {"@BODIES@", std::to_string(sizes.bodies)},
      {"@COLUMNS@", std::to_string(sizes.columns_per_body)},
      {"@AXES@", sizes.columns_per_body == 3 ? "x, y, rotation" : "translations, rotations about the principal axes"},
      {"@START@", warm ? "forces_before" : "nullptr"},
      {"@TOLERANCE@", NumberText(request.tolerance)},
      {"@LIMIT@", request.deadline_s ? ", .time_limit_s = " + NumberText(*request.deadline_s) : ""}};
  if (!warm) LeaveOutStart("const double* forces_before, ", &replacements);
  return Filled(kStepEmbeddingTemplate, replacements);
}

std::string FormatRecommendation(const Recommendation& all) {
  const Assessment& best = all.ranked.front();
  const Measurement& measured = best.measured;
  std::string text = Heading(all) + BudgetLine(all) + "\n" + Table(all) + "\n" +
                     (best.meets ? "recommended: " : "nothing that was tried meets the request; nearest: ") +
                     Evidence(all, best) + "\n";
  if (!all.note.empty()) text += "note: " + all.note + "\n";
  text += UntriedText(all) + DisturbedText(all);
  if (!best.meets) return text;
  return text + "\nC++:\n\n" + RecommendedCode(all) + OriginNote(measured.solver) + "\nCMake:\n\n" + kCMake;
}

nlohmann::ordered_json DescribeRecommendation(const Recommendation& all) {
  Json json;
  json["input"] = all.input;
  json["problems"] = all.problems;
  json["rows"] = {all.least_rows, all.most_rows};
  json["tolerance"] = all.request.tolerance;
  json["deadline_s"] = all.request.deadline_s ? Json(*all.request.deadline_s) : Json(nullptr);
  json["ranked_by"] = all.request.by_tail ? "p99_s" : "p50_s";
  json["rounds"] = all.rounds;
  json["samples"] = all.samples;
  json["budget_s"] = all.budget_s;
  json["spent_s"] = all.spent_s;
  json["ranked"] = Json::array();
  for (const Assessment& each : all.ranked) {
    const Measurement& measured = each.measured;
    Json tiers = Json::array();
    for (const auto& [tier, passed] : measured.passed) tiers.push_back({{"tier", tier}, {"passed", passed}});
    json["ranked"].push_back({{"solver", measured.solver},
                              {"law", LawOf(each)},
                              {"start", measured.warm ? "warm" : "cold"},
                              {"passes", measured.passes},
                              {"meets", each.meets},
                              {"shortcoming", each.shortcoming},
                              {"dropped", measured.dropped},
                              {"p50_s", FiniteOrNull(each.p50_s)},
                              {"p99_s", FiniteOrNull(each.p99_s)},
                              {"max_s", FiniteOrNull(each.max_s)},
                              {"raw_max_s", FiniteOrNull(measured.raw_max_s)},
                              {"in_time", each.in_time},
                              {"verified", each.verified},
                              {"verdicts", tiers},
                              {"false_successes", measured.false_successes},
                              {"claims", measured.claims},
                              {"proofs", measured.proofs},
                              {"rho", FiniteOrNull(measured.rho)},
                              {"outcome", measured.outcome},
                              {"detail", measured.detail},
                              {"disturbed", measured.disturbed}});
  }
  json["not_tried"] = Json::array();
  for (const auto& [solver, reason] : all.untried)
    json["not_tried"].push_back({{"solver", solver}, {"reason", reason}});
  json["note"] = all.note.empty() ? Json(nullptr) : Json(all.note);
  const Assessment& best = all.ranked.front();
  json["recommended"] = best.meets ? Json(best.measured.solver) : Json(nullptr);
  json["start"] = best.meets ? Json(best.measured.warm ? "warm" : "cold") : Json(nullptr);
  json["cpp"] = best.meets ? Json(RecommendedCode(all)) : Json(nullptr);
  json["cmake"] = best.meets ? Json(kCMake) : Json(nullptr);
  return json;
}

}  // namespace lcpbench
