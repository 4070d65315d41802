#pragma once

#include <ostream>
#include <string>
#include <vector>

#include "model/motion/contact_finder.h"
#include "model/motion/motion.h"
#include "solvers/lcp/verify.h"

namespace lcpbench {

/// For each row the index of the same row in the problem before (RowMatching::Follow), or -1: it was not there.
std::vector<int> PreviousRows(RowMatching* matching, const MotionProblem& met);

/// How a problem differs from the one before it. Indices are rows of the problem itself but for `left`, which are rows
/// of the one before.
struct ActiveSetChange {
  std::vector<int> entered;
  std::vector<int> left;
  std::vector<int> activated;    ///< in both, active (D f > w, D = A_ii) here only; unilateral rows
  std::vector<int> deactivated;  ///< in both, active there only
};

/// Compares every problem of a sequence with the one before.
class ActiveSetHistory {
 public:
  /// @param previous  of each row the index of the same row before, or -1
  /// @param w  Metrics::w of the answer f
  ActiveSetChange Follow(const LcpProblem& problem, const std::vector<int>& previous, const Eigen::VectorXd& f,
                         const Eigen::VectorXd& w);

 private:
  std::vector<bool> active_;  // of the problem before
};

/// What a sequence consists of, for its summary.
struct SequenceCounts {
  std::vector<Index> rows;           ///< of every problem written
  std::int64_t failed = 0;           ///< not claimed solved
  std::int64_t not_passed = 0;       ///< does not pass the tolerance
  std::int64_t false_successes = 0;  ///< claimed solved and does not pass
};

/// Writes the LCPs of a motion as JSON lines: FormatLcpRecord, and a member "motion" that readers of problems pass
/// over (fields in RESULTS.md). The id is the problem's with the step, `-step12`; of further problems of a step also
/// their number, `-step12-2`. Flushed after every line.
class SequenceWriter {
 public:
  /// What lines have besides.
  struct Contents {
    bool with_matrix = false;  ///< A of problems by factors
    bool with_forces = false;  ///< f and w of the answer that drove the motion
  };
  /// @param out        not owned; must outlive the writer
  SequenceWriter(std::ostream& out, std::string solver, double tolerance, Contents contents);

  /// The sequence's next step begins. Of the acceleration problems until the next call the first one is written: how
  /// many steps the integrator takes in between is its own matter. Impacts and time steps are written all.
  void BeginStep(int step);

  /// Judges and writes one problem.
  /// Throws what `out` throws.
  void Write(const MotionProblem& met);

  const SequenceCounts& counts() const { return counts_; }

 private:
  std::ostream& out_;
  std::string solver_;
  double tolerance_;
  Contents contents_;
  int step_ = 0;
  int written_of_step_ = 0;
  bool acceleration_written_ = false;
  RowMatching matching_;
  ActiveSetHistory history_;
  SequenceCounts counts_;
};

}  // namespace lcpbench
