#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "benchmarks/campaign/messages.h"

namespace lcpbench {

/// What is asked of a solver.
struct RecommendationRequest {
  double tolerance = 1e-6;
  std::optional<double> deadline_s = {};  ///< of set-up and solve of a step
  bool by_tail = false;  ///< rank by the 99th percentile (several steps), else by the median (one problem)
};

/// What the passes of one solver over the steps found, from cold starts or from warm ones.
struct Measurement {
  std::string solver;
  bool warm = false;
  int passes = 0;       ///< 0: not run at all
  std::string outcome;  ///< SequenceReply::outcome of the last pass
  std::string detail;
  std::string dropped;  ///< why it was not run again, where a better one left it behind; else ""
  /// Set-up and solve [s] of every step (of solvers in processes of their own solve and conversion): the median over
  /// the passes in which nothing disturbed it, if there are any. Infinite where every pass ended before.
  std::vector<double> latency_s;
  double raw_max_s = 0;               ///< the largest of all passes
  std::map<double, int> passed;       ///< steps verified, by tier: of the worst pass
  int false_successes = 0;            ///< of the worst pass, at the tolerance
  std::map<std::string, int> claims;  ///< steps by the solver's own word, of the last pass
  int proofs = 0;                     ///< steps shown to have no solution, which are right, of the last pass
  double rho = 0;                     ///< largest of all forces; infinite where there are none
  int disturbed = 0;                  ///< passes during which the processor's clock was slow
};

/// A measurement that grows pass by pass.
class Passes {
 public:
  Passes(std::string solver, bool warm, size_t steps);
  /// @param results  of the reply, not null
  void Add(const SequenceReply& reply, bool disturbed, double tolerance);
  const Measurement& found() const { return found_; }
  void Drop(std::string reason) { found_.dropped = std::move(reason); }

 private:
  Measurement found_;
  std::vector<std::vector<double>> calm_, all_;  // latencies by step, in passes without disturbance and in all
};

/// A measurement, judged by the request.
struct Assessment {
  Measurement measured;
  // Quantiles of the steps' latencies [s] (Quantile).
  double p50_s = 0;
  double p99_s = 0;
  double max_s = 0;
  double in_time = 1;       ///< share of the steps within the deadline; 1 without one
  double verified = 0;      ///< share of the steps verified at the tolerance
  bool meets = false;       ///< all steps verified, and the deadline met at the 99th percentile
  std::string shortcoming;  ///< why it does not meet the request; "" where it does
  double time_s = 0;        ///< what it is ranked by
};

/// @param measured  of one pass or more
Assessment Assess(const Measurement& measured, const RecommendationRequest& request);

/// Ranks: those that meet the request first, by time; then the rest, by the share of verified steps, the share in time,
/// and time. What is equal stays in the order given.
std::vector<Assessment> RankMeasurements(const std::vector<Measurement>& measurements,
                                         const RecommendationRequest& request);

}  // namespace lcpbench
