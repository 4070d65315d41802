#pragma once

#include <string>
#include <vector>

#include "benchmarks/accuracy_pass.h"
#include "benchmarks/suite.h"

namespace lcpbench {

/// Times, with Google Benchmark, every cell of the suite's first seed: set-up and solve apart, in separate benchmarks
/// (names and counters: RESULTS.md). A cell is verified before it is timed; one that the accuracy pass found wanting is
/// recorded as an error with the reason, never dropped. Solves are repeated suite.repetitions times (fewer, at least
/// once, where that would take longer than 0.15 s), set-up once; solves that took longer than suite.repeat_below_s
/// before are not timed again. Writes <folder>/timing.json.
/// @param extra_flags  --benchmark_... flags handed on
/// @throws InputError for a flag that Google Benchmark does not know
void RunTimingPass(const Suite& suite, const CellOutcomes& outcomes, const std::string& folder,
                   const std::vector<std::string>& extra_flags);

}  // namespace lcpbench
