#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "benchmarks/campaign/campaign_plan.h"
#include "benchmarks/studies/fresh_contestant.h"
#include "benchmarks/studies/fresh_problems.h"
#include "solvers/lcp/problem.h"

namespace lcpbench {

/// The problems of one size class, streamed through contestants as a campaign does it: every problem is judged by
/// itself first, what was verified is timed in passes (PlanPass), those of all contestants in turns, and what the
/// machine disturbed runs again. Every answer is verified, off the clock; one that is wrong in any pass is wrong.
class FreshStream {
 public:
  /// @param begin, end  of problems->planned()
  /// @param tier  asked for and judged at
  FreshStream(FreshProblems* problems, std::size_t begin, std::size_t end, const CampaignPlan& plan, double tier);

  /// Judges, where that was not done yet, and runs plan.passes timed passes. All budgets begin anew.
  void Measure(const std::vector<Contestant*>& contestants);
  /// Forgets the problems, keeps the times.
  void DropProblems();

  /// Times of all problems [s]: the median over the passes; for a verified one without passes that of its judged solve.
  /// Infinite where it is not verified, NaN where it had no turn.
  std::vector<double> Seconds(const Contestant& contestant) const;

 private:
  // The results of one contestant.
  struct Standing {
    const Contestant* contestant = nullptr;
    std::vector<double> judged_s;           // of the first so many problems: what had its turn
    std::vector<bool> verified;             // of those
    std::vector<Eigen::VectorXd> f;         // of those, dropped with the problems
    std::vector<std::vector<double>> calm;  // times in passes, by problem
    std::vector<std::vector<double>> disturbed;
    double median_s = 0;  // of the last pass; of the judged solves before
    double spent_s = 0;   // in timed passes
  };

  Standing& StandingOf(Contestant* contestant);
  void Judge(Contestant* contestant, Standing* standing);
  void RunPass(Contestant* contestant, Standing* standing, int pass);
  bool Passes(std::size_t place, const Eigen::VectorXd& f) const;
  Index RowsOf(std::size_t place) const { return planned_[place].entry->properties.rows; }

  FreshProblems* source_;
  std::size_t begin_;
  std::span<const PlannedProblem> planned_;
  const CampaignPlan& plan_;
  double tier_;
  int passes_ = 0;  // so far
  std::vector<FreshProblems::Problem> problems_;
  std::vector<ProblemArrays> arrays_;
  std::vector<Standing> standings_;
};

}  // namespace lcpbench
