#include "benchmarks/large_study.h"

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <stdexcept>

#include "benchmarks/child_process.h"
#include "benchmarks/exclusion_rules.h"
#include "model/scenes/scene.h"
#include "solvers/lcp/input_error.h"
#include "solvers/registry.h"

namespace lcpbench {
namespace {

using nlohmann::json;

// Where one child leaves an answer for another: memory that both reach by a path, and that is gone with this process
// however it ends.
class AnswerFile {
 public:
  AnswerFile() : descriptor_(memfd_create("answer", 0)) {
    if (descriptor_ < 0) throw std::runtime_error(std::string("memfd_create: ") + std::strerror(errno));
  }
  ~AnswerFile() { close(descriptor_); }
  AnswerFile(const AnswerFile&) = delete;
  AnswerFile& operator=(const AnswerFile&) = delete;
  std::string path() const { return "/proc/self/fd/" + std::to_string(descriptor_); }

 private:
  int descriptor_;
};

std::uint64_t MemoryLimit(const LargeStudy& study) { return static_cast<std::uint64_t>(1e9 * study.memory_limit_gb); }

// What a cell may take besides solving [s]: generating and assembling, verifying, and set-up, which has no limit.
double GraceFor(int size) {
  constexpr double kStart = 30;
  constexpr double kPerRow = 100e-6;
  return kStart + kPerRow * size;
}

// What the child printed; false, with its failure completed, where that is no outcome.
template <typename Outcome>
bool ReadOutcome(ChildOutcome* child, Outcome* outcome) {
  if (!child->ok) return false;
  try {
    *outcome = json::parse(child->output).get<Outcome>();
    return true;
  } catch (const json::exception& error) {
    child->failure = std::string("no outcome: ") + error.what();
    return false;
  }
}

SolveOutcome RunSolve(const LargeStudy& study, const LargeProblem& problem, const std::string& solver,
                      const std::string& answer_file) {
  SolveOutcome outcome;
  const std::string rule = SizeRefusal(FindSolver(solver), problem.size);
  if (!rule.empty()) {
    outcome.verdict = "excluded";
    outcome.detail = rule;
    return outcome;
  }
  const double limit = TimeLimit(study, problem.size);
  const SolveCell cell{problem, solver, study.tolerance, limit, study.cpu_time, answer_file};
  constexpr double kGraceFactor = 2;  // of the limit: a solver that looks at the clock seldom
  ChildOutcome child = RunSelf({kSolveCellOption, json(cell).dump()},
                               {kGraceFactor * limit + GraceFor(problem.size), MemoryLimit(study)});
  if (!ReadOutcome(&child, &outcome)) {
    outcome.verdict = "killed";
    outcome.detail = child.failure;
    outcome.peak_bytes = child.peak_bytes;
  }
  return outcome;
}

void RunOracle(const LargeStudy& study, const LargeProblem& problem, const std::string& answer_file,
               std::vector<LargeRow>* rows) {
  constexpr double kGraceFactor = 10;  // factorises in several ways
  ChildOutcome child = RunSelf({kOracleCellOption, json(OracleCell{problem, study.cpu_time, answer_file}).dump()},
                               {kGraceFactor * GraceFor(problem.size), 0});
  OracleOutcome oracle;
  const bool measured = ReadOutcome(&child, &oracle);
  for (LargeRow& row : *rows) {
    if (measured) {
      row.oracle = oracle;
    } else {
      row.why_no_k = child.failure;
    }
  }
}

std::vector<LargeRow> RunProblem(const LargeStudy& study, const LargeProblem& problem,
                                 const std::function<void(const std::string& what)>& begin) {
  const AnswerFile answer;
  bool answered = false;
  const std::string name =
      problem.family + ", n = " + std::to_string(problem.size) + ", seed " + std::to_string(problem.seed);
  std::vector<LargeRow> rows;
  for (const std::string& solver : study.solvers) {
    begin(name + ": " + solver);
    const SolveOutcome outcome = RunSolve(study, problem, solver, answered ? "" : answer.path());
    rows.push_back({problem, solver, outcome, {}, "no verified answer"});
    answered = answered || outcome.verified;
  }
  if (answered) {
    begin(name + ": K");
    RunOracle(study, problem, answer.path(), &rows);
  }
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
        SizeRefusal(entry, static_cast<Index>(kTimedSize)).empty()) {
      keys.push_back(entry.key);
    }
  }
  return keys;
}

std::vector<std::string> LargePeers(int size) {
  std::vector<std::string> keys;
  for (const SolverEntry& entry : AllSolvers()) {
    if (entry.available && entry.origin == SolverOrigin::kPeer && SizeRefusal(entry, size).empty()) {
      keys.push_back(entry.key);
    }
  }
  return keys;
}

double LargeRow::total_s() const {
  const bool own = FindSolver(solver).origin == SolverOrigin::kOwn;
  return own ? outcome.setup_s + outcome.solve_s : outcome.solve_s;
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
