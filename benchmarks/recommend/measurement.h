#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "benchmarks/campaign/campaign_plan.h"
#include "benchmarks/recommend/problem_steps.h"

namespace lcpbench {

struct MeasurementPlan {
  std::vector<std::string> solvers;  ///< registry keys
  double tolerance = 1e-6;
  int rounds = 5;                             ///< passes of every solver over the steps, each round in another order
  std::vector<std::string> solver_arguments;  ///< of the command line, by which the user named solvers
  int cpu = -1;                               ///< the processor that solves are kept on; -1: any
};

/// What the passes of one solver over the steps found, from cold starts or from warm ones.
struct Measurement {
  std::string solver;
  bool warm = false;
  std::string outcome;  ///< SequenceReply::outcome of the last pass
  std::string detail;
  /// Set-up and solve [s] of every step (of solvers in processes of their own solve and conversion): the median over
  /// the rounds in which it was not preempted. Infinite where the pass ended before.
  std::vector<double> latency_s;
  double raw_max_s = 0;               ///< the largest of all rounds
  std::map<double, int> passed;       ///< steps verified, by tier: of the worst round
  int false_successes = 0;            ///< of the worst round, at the tolerance
  std::map<std::string, int> claims;  ///< steps by the solver's own word, of the last round
  double rho = 0;                     ///< largest of all answers; infinite where there is none
  int disturbed = 0;                  ///< passes that the machine disturbed, again when they were repeated
};

/// Runs every solver over the steps in a worker process, which may crash or hang without harm, as campaigns on
/// sequences do (sequence_runner.h), and judges every answer relative to the problem's rounding floor, which own
/// solvers find beforehand (reference_floor.h). One problem alone is solved as a sequence of copies. Where it is known
/// which rows stay, every solver also runs from warm starts. What fails on every step is not run again.
/// @throws InputError for an unknown solver
std::vector<Measurement> MeasureSolvers(const MeasurementPlan& plan, ProblemSteps steps);

/// What is asked of a solver.
struct RecommendationRequest {
  double tolerance = 1e-6;
  std::optional<double> deadline_s;  ///< of set-up and solve of a step
  bool by_tail = false;              ///< rank by the 99th percentile (several steps), else by the median (one problem)
};

/// A measurement, judged by the request.
struct Assessment {
  Measurement measured;
  // Of the steps' latencies [s] (Quantile).
  double p50_s = 0;
  double p99_s = 0;
  double max_s = 0;
  double in_time = 1;       ///< share of the steps within the deadline; 1 without one
  double verified = 0;      ///< share of the steps verified at the tolerance
  bool meets = false;       ///< all steps verified, and the deadline met at the 99th percentile
  std::string shortcoming;  ///< why it does not meet the request; "" where it does
  double time_s = 0;        ///< what it is ranked by
};

/// Ranks: those that meet the request first, by time; then the rest, by the share of verified steps, the share in time,
/// and time. What is equal stays in the order given.
std::vector<Assessment> RankMeasurements(const std::vector<Measurement>& measurements,
                                         const RecommendationRequest& request);

/// As printf writes it. @param format  of one double
std::string FormatNumber(double value, const char* format);

}  // namespace lcpbench
