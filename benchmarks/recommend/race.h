#pragma once

#include <functional>
#include <string>
#include <vector>

#include "benchmarks/recommend/measurement.h"
#include "benchmarks/recommend/problem_steps.h"
#include "support/clock.h"

namespace lcpbench {

struct RaceOptions {
  int rounds = 5;        ///< passes over the steps of a solver that is not dropped, >= 1
  double budget_s = 60;  ///< of all passes together [s], > 0
};

/// A pass that was run. `reply.results` is null where the solver's process ended.
struct PassRun {
  SequenceReply reply;
  bool disturbed = false;  ///< the processor's clock was slow meanwhile
};
using PassRunner = std::function<PassRun(const SequenceRequest& request)>;
using Clock = std::function<double()>;  ///< [s]

/// Lets solvers race over the same steps. In every round each one that is still in the race passes over all steps, in
/// another order each time. After it those are dropped that a better one leaves behind: that are verified on a smaller
/// share of the steps than the leader (RankMeasurements), or whose median and, where the tail is what counts, 99th
/// percentile are both more than 2 + 2 / k times the leader's after k passes. What fails on every step, or ends early,
/// is not run again either.
///
/// No pass is begun that is not expected to end within the budget. In the first round a pass may take its share of what
/// is left, or, up to half of what is left, four times as long as the fastest that was right on all steps. Solvers
/// whose turn does not come have no pass.
/// @param solvers  registry keys, in the order of the first round
/// @param warm     whether each also runs from warm starts, as an entrant of its own
/// @param base     what the requests of all passes have in common
/// @param steps    how many there are
/// @return one per entrant, in order
std::vector<Measurement> Race(const std::vector<std::string>& solvers, bool warm, const RecommendationRequest& request,
                              const RaceOptions& options, SequenceRequest base, size_t steps, const PassRunner& run,
                              const Clock& now = &SteadyNow);

/// Where and how the passes of a race are run.
struct RaceProcess {
  std::vector<std::string> solver_arguments;  ///< of the command line, by which the user named solvers
  int cpu = -1;                               ///< the processor that solves are kept on; -1: any
};

/// The race in worker processes, which may crash or hang without harm, as campaigns on sequences run
/// (sequence_runner.h). Every answer is judged relative to the problem's rounding floor, which own solvers find
/// beforehand (reference_solves.h), as far as half of the budget goes. One problem alone is solved as a sequence of
/// copies. Where it is known which rows stay, every solver also runs from warm starts.
/// @throws InputError for an unknown solver
std::vector<Measurement> RaceOnProblems(const std::vector<std::string>& solvers, ProblemSteps steps,
                                        const RecommendationRequest& request, RaceOptions options,
                                        const RaceProcess& process);

}  // namespace lcpbench
