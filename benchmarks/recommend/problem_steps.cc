#include "benchmarks/recommend/problem_steps.h"

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "benchmarks/collection/recipes/motion_steps.h"
#include "benchmarks/motions/scene_source.h"
#include "benchmarks/motions/sequence.h"
#include "model/contact/assembly.h"
#include "model/motion/contact_finder.h"
#include "solvers/io/json_lines.h"
#include "solvers/registry.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

// The rows that are not listed, in order.
std::vector<int> Others(std::size_t rows, const std::vector<int>& listed, const std::string& where) {
  std::vector<bool> is_listed(rows, false);
  for (const int row : listed) {
    if (row < 0 || row >= static_cast<int>(rows)) {
      throw InputError(where + ": field 'motion': expected rows below " + std::to_string(rows) + ", found " +
                       std::to_string(row));
    }
    is_listed[static_cast<std::size_t>(row)] = true;
  }
  std::vector<int> others;
  for (std::size_t row = 0; row < rows; ++row) {
    if (!is_listed[row]) others.push_back(static_cast<int>(row));
  }
  return others;
}

// Where the rows of a line were in the line before; nothing where it does not say.
std::optional<std::vector<int>> PreviousRows(const nlohmann::json& line, std::size_t rows, std::size_t rows_before,
                                             const std::string& where) {
  try {
    if (line.contains("previous")) {
      auto previous = line.at("previous").get<std::vector<int>>();
      RequirePrevious(previous, static_cast<Index>(rows), rows_before, where);
      return previous;
    }
    if (!line.contains("motion")) return std::nullopt;
    const nlohmann::json& motion = line.at("motion");
    const std::vector<int> here = Others(rows, motion.at("entered").get<std::vector<int>>(), where);
    const std::vector<int> before = Others(rows_before, motion.at("left").get<std::vector<int>>(), where);
    if (here.size() != before.size()) {
      throw InputError(where + ": field 'motion': expected as many rows that stay as the line before has, " +
                       std::to_string(before.size()) + ", found " + std::to_string(here.size()));
    }
    std::vector<int> previous(rows, -1);
    for (std::size_t k = 0; k < here.size(); ++k) previous[static_cast<std::size_t>(here[k])] = before[k];
    return previous;
  } catch (const nlohmann::json::exception&) {
    throw InputError(where + ": expected member 'previous', or 'motion' with 'entered' and 'left', lists of rows");
  }
}

// A problem that stands alone.
ProblemSteps Single(LcpProblem problem) {
  ProblemSteps found;
  const auto rows = static_cast<std::size_t>(problem.size());
  found.steps.push_back({std::move(problem), std::vector<int>(rows, -1), {}});
  return found;
}

ProblemSteps Read(const std::string& path, const ReadingOptions& options) {
  ProblemSteps found;
  bool all_known = true;
  std::size_t rows_before = 0;
  ReadEachProblem(path, options, [&](const LcpRecord& record, const std::string& where, const std::string& line) {
    if (line.empty()) {  // of another format
      found = Single(record.problem);
      return;
    }
    const nlohmann::json json = nlohmann::json::parse(line);
    const auto rows = static_cast<std::size_t>(record.problem.size());
    const std::optional<std::vector<int>> previous = PreviousRows(json, rows, rows_before, where);
    all_known = all_known && previous.has_value();
    SequenceStep step{record.problem, previous.value_or(std::vector<int>(rows, -1)), record.reference};
    if (json.contains("floor") && json.at("floor").is_number()) step.reference.floor = json.at("floor").get<double>();
    rows_before = rows;
    found.steps.push_back(std::move(step));
  });
  found.rows_are_known = all_known && found.steps.size() > 1;
  return found;
}

ProblemSteps Moving(const std::string& scene, int size, std::uint64_t seed, int steps) {
  const std::unique_ptr<LcpSolver> solver = MakeSolver(kDrivingSolver);
  ProblemSteps found;
  found.rows_are_known = true;
  RowMatching matching;
  FollowScene(LoadScene(scene, size, seed), *solver, steps, [&](const MotionProblem& met) {
    // Where a time step has no solution, the relaxed problem that is solved instead follows.
    if (met.problem.size() > 0 && met.result.status == LcpStatus::kSolved) {
      found.steps.push_back({met.problem, PreviousRows(&matching, met), {}});
    }
    return true;
  });
  if (found.steps.empty()) throw InputError(scene + ": met no problem within " + std::to_string(steps) + " steps");
  return found;
}

}  // namespace

ProblemSteps ReadProblemSteps(const std::string& path, const ReadingOptions& options) {
  ProblemSteps found = Read(path, options);
  found.name = path == "-" ? "standard input" : std::filesystem::path(path).filename().string();
  return found;
}

ProblemSteps MakeProblemSteps(const std::string& scene, int size, std::uint64_t seed, int steps) {
  if (steps < 1) throw InputError("--steps: expected a number >= 1");
  const auto instant = [&] {
    return AssembleInstant(LoadInstant(scene, size, seed), LoadScene(scene, size, seed).step).problem;
  };
  ProblemSteps found = steps == 1 ? Single(instant()) : Moving(scene, size, seed, steps);
  found.name = scene;
  return found;
}

}  // namespace lcpbench
