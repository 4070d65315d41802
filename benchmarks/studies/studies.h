#pragma once

#include <benchmark/benchmark.h>

#include "benchmarks/campaign/campaign_plan.h"
#include "benchmarks/studies/fresh_problems.h"

namespace lcpbench {

// The benchmarks of lcpbench_benchmark. All but those of scenes run on the streams of `problems`, which are read when a
// benchmark begins: CLASS/ORIGIN is a stream's name. What they are given must outlive the run.

/// What a user pays from arrays to f for problems that the solver object has not seen: fresh/CLASS/ORIGIN/SOLVER for
/// plan.solvers, at plan.tiers.front(). A repetition is one pass, as a campaign's launches run it (PassKind::kFresh),
/// by a new solver object, of peers in their workers; its time is the weighted median over the problems, failures
/// infinite. Counted is the share that is solved (`right`). The solver kStepSolver is StepSolver on an engine's arrays,
/// kFromProblem `auto` on an LcpProblem, which is made on the clock.
void RegisterFresh(const CampaignPlan& plan, FreshProblems* problems);
inline constexpr const char* kStepSolver = "step-solver";
inline constexpr const char* kFromProblem = "auto-from-problem";

/// StepSolver::SolveBatch on islands that are drawn from the plain problems of up to 64 rows, together larger than the
/// caches: batch/CLASS/ORIGIN/SPACE/PRECISION/METHOD/threads:N, METHOD an instruction set or `floor`, which reads the
/// arrays once in order and writes f. In space (6 numbers a body) the problems lie in a plane of it. PRECISION is J's.
/// Counted are the time per row, the share of problems that lanes did not solve (`left`) and of answers that the
/// verifier refuses (`refused`).
void RegisterBatch(FreshProblems* problems);

/// Derivatives of the solutions of a stream: derivative/CLASS/ORIGIN/PART, PART the set-up (modes and factor), jvp or
/// vjp, one product; a product at a degenerate point solves once more. `over solve`: the ratio of processor times to
/// fresh solves by `auto` in the same process; `strict`, `unique`: shares of the problems.
void RegisterDerivatives(FreshProblems* problems);

/// What comes before a solve, stage by stage, for every scene family at 10^3 to `largest` rows:
/// scene/FAMILY/STAGE/ROWS. Counted are the time per row and the most memory resident at a time, beside what is
/// resident before; Google Benchmark fits how the time grows.
void RegisterScenes(int largest);

/// The counter of the time per row [s].
inline void CountPerRow(benchmark::State& state, double rows) {
  state.counters["per row"] = {rows, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert};
}

}  // namespace lcpbench
