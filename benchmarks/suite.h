#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "model/scenes/scene.h"
#include "solvers/registry.h"

namespace lcpbench {

/// What a run consists of: solvers x problems x tiers, with the rules by which cells are left out, all fixed before the
/// first solve.
struct Suite {
  std::string name;
  std::vector<std::string> families;  ///< scene keys
  std::vector<int> sizes;             ///< rows
  std::vector<std::uint64_t> seeds;   ///< the first one is timed, all are judged
  std::vector<std::string> solvers;   ///< registry keys
  std::vector<double> tiers;          ///< tolerances, descending
  double time_limit_s = 2.0;          ///< of one solve
  double min_time_s = 0.05;           ///< Google Benchmark's time per repetition
  int repetitions = 3;
};

/// One problem of a suite.
struct SuiteProblem {
  std::string id;  ///< <family>-n<rows>-s<seed>
  std::string family;
  int size = 0;
  std::uint64_t seed = 0;
};

/// "default" (make report) or "quick" (seconds; for trying things out). @throws InputError naming the known suites
Suite FindSuite(std::string_view name);

/// Checks every name and number. @throws InputError naming what does not fit
void ValidateSuite(const Suite& suite);

std::vector<SuiteProblem> ProblemsOf(const Suite& suite);

/// "" where the cell is run, else the rule by which it is not (recorded as such, never silently).
std::string ExclusionRule(const SolverEntry& solver, int size, double tier);

/// A solver whose settings do not depend on the tolerance runs once, at the strictest tier, for all tiers.
std::vector<double> TiersToRun(const Suite& suite, const SolverEntry& solver);

}  // namespace lcpbench
