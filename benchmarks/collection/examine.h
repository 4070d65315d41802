#pragma once

#include <string>

#include "benchmarks/collection/manifest.h"

namespace lcpbench {

/// Of |D^-1/2 b|_2: some roundings of rows that depend on each other.
inline constexpr double kRounding = 0x1p-44;

struct ExamineOptions {
  /// Up to this many rows answers are proved in exact arithmetic, above they are refined and bounded.
  Index exact_up_to = 250;
  /// Above this many rows there is no reference, and how the answer lies is known to a solver's tolerance only.
  Index bounded_up_to = 20'000;
  double time_limit_s = 300;       ///< for one exact answer (it is bounded then) and one bounded one
  double large_time_limit_s = 60;  ///< for a solver's answer above bounded_up_to
};

/// What examining a problem brings.
struct Examined {
  ManifestEntry entry;         ///< but for its family and where it comes from
  std::string reference_line;  ///< of the file of references; "" for none
};

/// Solves, proves or bounds, and measures one problem. Everything is judged here; solvers only help to find the answer.
/// A problem without a solution, as its doubles say it, for which a solution of a problem nearby is known, with b
/// another by kRounding at most, counts as solved: its rows contradict each other by roundings.
Examined Examine(const LcpProblem& problem, const ExamineOptions& options);

}  // namespace lcpbench
