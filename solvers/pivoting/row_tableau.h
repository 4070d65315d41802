#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "solvers/lcp/solver.h"
#include "solvers/lcp/step_rows.h"
#include "solvers/pivoting/small_pivoting.h"
#include "solvers/rows/fixed_size_bpp.h"
#include "solvers/rows/row_judge.h"
#include "solvers/rows/two_body_copy.h"

namespace lcpbench {

/// SmallPivoting on rows that act on at most two moving bodies each, its answer judged by these rows: in double with a
/// bound of what rounding hides, and by RowJudge where that is not clear. Internal to solvers/. Allocates in Reserve
/// only, and SolveArrays where it has met no problem as large.
class RowTableau {
 public:
  using Part = std::span<const std::int32_t>;  ///< rows that share no moving body with others, ascending

  /// How a solve ended.
  enum class End {
    kSolved,   ///< f passed
    kInexact,  ///< f is finite, and misses the tolerance
    kGaveUp,   ///< f is not to be used
  };

  /// @throws InputError if this machine lacks the instructions
  explicit RowTableau(InstructionSet instructions = InstructionSet::kBest,
                      TableauRule rule = TableauRule::kMostViolated)
      : one_(instructions), tableau_(instructions, rule) {}

  /// For steps of up to `max_rows` rows, of which up to SmallPivoting::kMaxRows are solved at a time.
  void Reserve(Index max_rows, Index max_bodies);

  /// @param request  its row_limit is set here
  /// @param f, w     entries `part` are written: forces, and A f + b where solved
  /// @param rho      written where solved
  End Solve(const StepRows& rows, Part part, double tolerance, SmallPivoting::Request request, double* f, double* w,
            double* rho);

  /// A cold start from a caller's arrays. False, with f of zeros, where they are not of this kind, have more rows than
  /// SmallPivoting::kMaxRows, or no f passed: other methods are to be asked.
  bool SolveArrays(const ProblemArrays& arrays, const LcpOptions& options, bool self_check, LcpResult* result);

  /// Pivots of the last solve.
  int pivots() const { return tableau_.pivots(); }
  /// RowJudge::Passes.
  bool Passes(const StepRows& rows, Part part, double tolerance, const double* f, double* w, double* rho) {
    return judge_.Passes(rows, part, tolerance, f, w, rho);
  }

 private:
  FixedSizeBpp one_;
  SmallPivoting tableau_;
  RowJudge judge_;
  // Of SolveArrays.
  TwoBodyCopy copy_;
  std::vector<std::int32_t> all_;  // 0, 1, 2, ...
  std::vector<double> gaps_;
};

}  // namespace lcpbench
