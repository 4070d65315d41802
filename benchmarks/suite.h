#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "model/scenes/scene.h"
#include "solvers/registry.h"

namespace lcpbench {

/// How much of a suite is run above a size: large problems are dear. An empty list means all.
struct SizeRule {
  int above = 0;                      ///< rows
  std::size_t seeds = 1;              ///< so many of the suite's seeds, the first ones
  std::vector<std::string> families;  ///< of the suite's
  std::vector<double> tiers;          ///< of the suite's; cells at the others are excluded by rule
};

/// What a run consists of: solvers x problems x tiers, with the rules by which cells are left out, all fixed before the
/// first solve.
struct Suite {
  std::string name;
  std::vector<std::string> families;  ///< scene keys
  std::vector<int> sizes;             ///< rows
  std::vector<std::uint64_t> seeds;   ///< the first one is timed, all are judged
  std::vector<std::string> solvers;   ///< registry keys
  std::vector<double> tiers;          ///< tolerances, descending
  std::vector<SizeRule> size_rules;   ///< by `above`, ascending; the last that applies counts
  double time_limit_s = 2.0;          ///< of one solve, whatever the size; see also TimeLimit
  double time_limit_per_row_s = 0;    ///< 0: the same limit for every size
  double min_time_s = 0.05;           ///< Google Benchmark's time per repetition
  int repetitions = 3;                ///< fewer where one solve takes long, see timing_pass.h
  /// Solves that took longer than this in the accuracy pass are not timed again: that one run is their time.
  double repeat_below_s = std::numeric_limits<double>::infinity();
};

/// One problem of a suite.
struct SuiteProblem {
  std::string id;  ///< <family>-n<rows>-s<seed>
  std::string family;
  int size = 0;
  std::uint64_t seed = 0;
};

/// "default" (make report) or "quick" (for trying things out). @throws InputError naming the known suites
Suite FindSuite(std::string_view name);

/// Checks every name and number. @throws InputError naming what does not fit
void ValidateSuite(const Suite& suite);

std::vector<SuiteProblem> ProblemsOf(const Suite& suite);

/// Seconds that one solve of a problem of this size may take: time_limit_per_row_s times its rows, within
/// [kLeastTimeLimit, suite.time_limit_s].
inline constexpr double kLeastTimeLimit = 0.2;
double TimeLimit(const Suite& suite, int size);

/// The largest problem that a solver is given, and why.
struct SizeLimit {
  std::string_view solver;  ///< the key, or its beginning up to a '-'
  int largest;              ///< rows
  std::string_view reason;
};

/// All of them. Solvers that are not listed are given everything.
std::span<const SizeLimit> SizeLimits();

/// "" where problems of this size are given to the solver, else the rule by which they are not (SizeLimits).
std::string SizeRefusal(const SolverEntry& solver, Index size);

/// "" where the cell is run, else the rule by which it is not (recorded as such, never silently).
/// Solvers that are not in the build have no cells at all.
std::string ExclusionRule(const Suite& suite, const SolverEntry& solver, int size, double tier);

/// What the cells of a solver at stricter tiers are excluded by after it ran out of time at `tier` on the same problem.
std::string OutOfTimeRule(double tier);

/// The tiers to run, loosest first. A solver whose settings do not depend on the tolerance runs once, at the strictest
/// tier, for all tiers.
std::vector<double> TiersToRun(const Suite& suite, const SolverEntry& solver);

}  // namespace lcpbench
