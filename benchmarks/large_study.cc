#include "benchmarks/large_study.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <stdexcept>

#include "benchmarks/child_process.h"
#include "benchmarks/suite.h"
#include "model/scenes/scene.h"
#include "solvers/lcp/input_error.h"
#include "solvers/registry.h"

namespace lcpbench {
namespace {

using nlohmann::json;

// A file that goes away with this object.
class TemporaryFile {
 public:
  TemporaryFile() : path_((std::filesystem::temp_directory_path() / "lcpbench-answer-XXXXXX").string()) {
    const int file = mkstemp(path_.data());
    if (file < 0) throw InputError(path_ + ": " + std::strerror(errno));
    close(file);
  }
  ~TemporaryFile() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

std::uint64_t MemoryLimit(const LargeStudy& study) { return static_cast<std::uint64_t>(1e9 * study.memory_limit_gb); }

// What a cell may take besides solving [s]: generating and assembling, verifying, and set-up, which has no limit.
double GraceFor(int size) {
  constexpr double kStart = 30;
  constexpr double kPerRow = 100e-6;
  return kStart + kPerRow * size;
}

// Why a solver is not given a problem of this size, by the rules of the suites; "" if it is.
std::string WhyNotRun(const std::string& solver, int size, double tolerance) {
  return ExclusionRule(Suite{}, FindSolver(solver), size, tolerance);
}

SolveOutcome RunSolve(const LargeStudy& study, const LargeProblem& problem, const std::string& solver,
                      const std::string& answer_file) {
  SolveOutcome outcome;
  const std::string rule = WhyNotRun(solver, problem.size, study.tolerance);
  if (!rule.empty()) {
    outcome.verdict = "excluded";
    outcome.detail = rule;
    return outcome;
  }
  const double limit = TimeLimit(study, problem.size);
  const SolveCell cell{problem, solver, study.tolerance, limit, answer_file};
  constexpr double kGraceFactor = 2;  // of the limit: a solver that looks at the clock seldom
  const ChildOutcome child = RunSelf({kSolveCellOption, json(cell).dump()},
                                     {kGraceFactor * limit + GraceFor(problem.size), MemoryLimit(study)});
  if (child.ok) return json::parse(child.output).get<SolveOutcome>();
  outcome.verdict = "killed";
  outcome.detail = child.failure;
  outcome.peak_bytes = child.peak_bytes;
  return outcome;
}

std::optional<OracleOutcome> RunOracle(const LargeProblem& problem, const std::string& answer_file) {
  const ChildOutcome child = RunSelf({kOracleCellOption, json(OracleCell{problem, answer_file}).dump()},
                                     {kLeastTimeLimitS + 10 * GraceFor(problem.size), 0});
  if (!child.ok) {
    std::fprintf(stderr, "no K for %s, n = %d: %s\n", problem.family.c_str(), problem.size, child.failure.c_str());
    return std::nullopt;
  }
  return json::parse(child.output).get<OracleOutcome>();
}

std::vector<LargeRow> RunProblem(const LargeStudy& study, const LargeProblem& problem,
                                 const std::function<void(const std::string& what)>& begin) {
  const TemporaryFile answer;
  bool answered = false;
  const std::string name =
      problem.family + ", n = " + std::to_string(problem.size) + ", seed " + std::to_string(problem.seed);
  std::vector<LargeRow> rows;
  for (const std::string& solver : study.solvers) {
    begin(name + ": " + solver);
    rows.push_back({problem, solver, RunSolve(study, problem, solver, answered ? "" : answer.path()), {}});
    answered = answered || rows.back().outcome.verified;
  }
  if (!answered) return rows;
  begin(name + ": K");
  const std::optional<OracleOutcome> oracle = RunOracle(problem, answer.path());
  for (LargeRow& row : rows) row.oracle = oracle;
  return rows;
}

template <typename Cell>
Cell Parse(const std::string& text) {
  try {
    return json::parse(text).get<Cell>();
  } catch (const json::exception& error) {
    throw InputError(std::string("not a cell: ") + error.what());
  }
}

}  // namespace

void ValidateStudy(const LargeStudy& study) {
  const auto require = [](bool holds, const std::string& what) {
    if (!holds) throw InputError(what);
  };
  for (const std::string& family : study.families) FindScene(family);
  for (const std::string& solver : study.solvers) {
    require(FindSolver(solver).available, "solver '" + solver + "' is not in this build");
  }
  require(!study.families.empty(), "at least one scene is needed");
  require(!study.sizes.empty(), "at least one size is needed");
  require(!study.seeds.empty(), "at least one seed is needed");
  require(!study.solvers.empty(), "at least one solver is needed");
  for (const int size : study.sizes) require(size >= 1, "size must be >= 1, found " + std::to_string(size));
  for (const double ratio : study.mass_ratios) {
    require(ratio >= 1 && std::isfinite(ratio), "mass ratio must be >= 1, found " + std::to_string(ratio));
  }
  require(study.tolerance > 0 && study.tolerance < 1,
          "tolerance must be in (0, 1), found " + std::to_string(study.tolerance));
  require(study.time_limit_s > 0, "time limit must be > 0 s, found " + std::to_string(study.time_limit_s));
  require(study.memory_limit_gb > 0, "memory limit must be > 0 GB, found " + std::to_string(study.memory_limit_gb));
}

double TimeLimit(const LargeStudy& study, int size) {
  constexpr double kMost = 3;
  const double proportional = study.time_limit_s * size / kTimedSize;
  return std::clamp(proportional, std::min(kLeastTimeLimitS, study.time_limit_s), kMost * study.time_limit_s);
}

std::vector<std::string> LargeOwnSolvers() {
  constexpr std::array<std::string_view, 4> kNotMeant = {"pgs", "psor", "ipopt-qp", "ipopt-ncp"};
  std::vector<std::string> keys;
  for (const SolverEntry& entry : AllSolvers()) {
    const bool meant = std::find(kNotMeant.begin(), kNotMeant.end(), entry.key) == kNotMeant.end();
    if (entry.available && entry.origin == SolverOrigin::kOwn && meant &&
        WhyNotRun(entry.key, static_cast<int>(kTimedSize), 1e-9).empty()) {
      keys.push_back(entry.key);
    }
  }
  return keys;
}

std::vector<std::string> LargePeers(int size) {
  std::vector<std::string> keys;
  for (const SolverEntry& entry : AllSolvers()) {
    if (entry.available && entry.origin == SolverOrigin::kPeer && WhyNotRun(entry.key, size, 1e-9).empty()) {
      keys.push_back(entry.key);
    }
  }
  return keys;
}

double LargeRow::in_k() const {
  if (!outcome.verified || !oracle.has_value() || oracle->best.total_s() <= 0) return -1;
  return total_s() / oracle->best.total_s();
}

std::vector<LargeRow> RunLargeStudy(const LargeStudy& study, const std::function<void(const std::string& what)>& begin,
                                    const std::function<void(const std::vector<LargeRow>& rows)>& done) {
  std::vector<LargeRow> all;
  for (const int size : study.sizes) {
    for (const std::string& family : study.families) {
      for (const double ratio : study.mass_ratios) {
        for (const std::uint64_t seed : study.seeds) {
          const std::vector<LargeRow> rows = RunProblem(study, {family, size, seed, ratio}, begin);
          done(rows);
          all.insert(all.end(), rows.begin(), rows.end());
        }
      }
    }
  }
  return all;
}

void PrintSolveCell(const std::string& cell) {
  std::printf("%s\n", json(RunSolveCell(Parse<SolveCell>(cell))).dump().c_str());
}

void PrintOracleCell(const std::string& cell) {
  std::printf("%s\n", json(RunOracleCell(Parse<OracleCell>(cell))).dump().c_str());
}

}  // namespace lcpbench
